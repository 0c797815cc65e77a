// The reducer: what a snapshot makes, what a patch changes, and what is refused.
import { describe, expect, test } from 'vitest';
import { EMPTY, reduce, row, type Mirror } from '../src/wire/mirror';
import { parseMessage, type Message, type Patch } from '../src/wire';
import { robot, snapshot, worker } from './samples';

const begun = (): Mirror => mirrorOf(reduce(EMPTY, snapshot({ version: 7, robots: [robot('r1'), robot('r2')] })));
const patch = (more: object): Patch => ({ type: 'patch', base: 7, version: 8, ...more });

function mirrorOf(reduced: ReturnType<typeof reduce>): Mirror {
  if (reduced.kind === 'gap') throw new Error('the message did not fit');
  return reduced.mirror;
}

describe('the mirror', () => {
  test('a snapshot replaces whatever was there', () => {
    const next = mirrorOf(reduce(begun(), snapshot({ version: 3, robots: [robot('r9')] })));
    expect(next.version).toBe(3);
    expect(next.robots.rows.map((r) => r.id)).toEqual(['r9']);
  });

  test('a patch on another version is a gap and changes nothing', () => {
    const old = begun();
    expect(reduce(old, patch({ base: 6 }))).toEqual({ kind: 'gap' });
    expect(reduce(EMPTY, patch({}))).toEqual({ kind: 'gap' });
    expect(old.version).toBe(7);
  });

  test('a partial row changes only the keys it carries', () => {
    const next = mirrorOf(reduce(begun(), patch({ time_s: 12, robots: [{ id: 'r1', x: 5, state: 'busy' }] })));
    expect(row(next.robots, 'r1')).toEqual({ ...robot('r1'), x: 5, state: 'busy' });
    expect(next).toMatchObject({ version: 8, time_s: 12 });
  });

  test('a null in a partial row is a value, not an absence', () => {
    const carrying = mirrorOf(reduce(begun(), patch({ robots: [{ id: 'r1', rack: 'K1' }] })));
    const down = mirrorOf(reduce(carrying, { type: 'patch', base: 8, version: 9, robots: [{ id: 'r1', rack: null }] }));
    expect(row(carrying.robots, 'r1')?.rack).toBe('K1');
    expect(row(down.robots, 'r1')?.rack).toBeNull();
  });

  test('untouched rows keep their identity', () => {
    const old = begun();
    const next = mirrorOf(reduce(old, patch({ robots: [{ id: 'r1', x: 5 }] })));
    expect(next.robots.rows[1]).toBe(old.robots.rows[1]);
    expect(next.racks).toBe(old.racks);
    expect(next.robots.at).toBe(old.robots.at);
  });

  test('the old mirror is never changed', () => {
    const old = begun();
    reduce(
      old,
      patch({
        robots: [
          { id: 'r1', x: 5 },
          { id: 'r3', x: 1 },
        ],
        jobs: { waiting: 9 },
      }),
    );
    expect(row(old.robots, 'r1')?.x).toBe(0);
    expect(row(old.robots, 'r3')).toBeUndefined();
    expect(old.jobs.waiting).toBe(0);
  });

  test('unknown keys are ignored, in the message and in its rows', () => {
    const message = patch({ moon: 'full', robots: [{ id: 'r1', hat: 'red' }], counters: { spins: 3 } }) as Message;
    const next = mirrorOf(reduce(begun(), message));
    expect(row(next.robots, 'r1')).toEqual(robot('r1'));
    expect(next).not.toHaveProperty('moon');
    expect(next.counters).not.toHaveProperty('spins');
  });

  test('a row that joins by a patch is filled up with blanks', () => {
    const next = mirrorOf(reduce(begun(), patch({ robots: [{ id: 'r3', x: 2, y: 4 }] })));
    expect(row(next.robots, 'r3')).toMatchObject({ x: 2, y: 4, state: 'idle', granted: [] });
    expect(next.robots.rows).toHaveLength(3);
  });

  test('counters, jobs and alarms not in a patch stay as they were', () => {
    const one = mirrorOf(
      reduce(begun(), patch({ jobs: { waiting: 4 }, alarms: [{ id: 'a', text: 't', since_s: 1 }] })),
    );
    const two = mirrorOf(reduce(one, { type: 'patch', base: 8, version: 9, counters: { encounters: 2 } }));
    expect(two.jobs.waiting).toBe(4);
    expect(two.alarms).toHaveLength(1);
    expect(two.counters).toMatchObject({ encounters: 2, robot_deliveries: 0 });
  });
});

describe('people in the mirror', () => {
  const peopled = (): Mirror =>
    mirrorOf(
      reduce(
        EMPTY,
        snapshot({
          version: 7,
          workers: [
            worker('w1', {
              state: 'following',
              path: [
                [0, 0],
                [1, 0],
              ],
            }),
            worker('w2'),
          ],
        }),
      ),
    );

  test('a patch of a worker changes only the keys it carries', () => {
    const old = peopled();
    const next = mirrorOf(
      reduce(old, patch({ workers: [{ id: 'w1', x: 3, presence: 'stale', reason: 'you left the path' }] })),
    );
    expect(row(next.workers, 'w1')).toMatchObject({
      x: 3,
      presence: 'stale',
      state: 'following',
      reason: 'you left the path',
    });
    expect(row(next.workers, 'w1')?.path).toBe(row(old.workers, 'w1')?.path);
    expect(next.workers.rows[1]).toBe(old.workers.rows[1]);
  });

  test('a worker made known after the snapshot joins with blanks', () => {
    const next = mirrorOf(reduce(peopled(), patch({ workers: [{ id: 'w3', name: 'Ana' }] })));
    expect(row(next.workers, 'w3')).toMatchObject({ name: 'Ana', presence: 'absent', x: null, goals: [] });
  });

  test('closures come all at once, and stay when a patch says nothing of them', () => {
    const area = { id: 'c1', outline: [], reason: 'spill' };
    const one = mirrorOf(reduce(peopled(), patch({ closures: [area] })));
    const two = mirrorOf(reduce(one, { type: 'patch', base: 8, version: 9 }));
    const three = mirrorOf(reduce(two, { type: 'patch', base: 9, version: 10, closures: [] }));
    expect(two.closures).toBe(one.closures);
    expect([one.closures.length, three.closures.length]).toEqual([1, 0]);
  });

  test('a server that knows no people shows none', () => {
    const { workers: _, closures: __, ...older } = snapshot();
    const next = mirrorOf(reduce(EMPTY, older as Message));
    expect([next.workers.rows, next.closures]).toEqual([[], []]);
  });
});

describe('a message', () => {
  test('of an unknown type is nothing', () => {
    expect(parseMessage('{"type":"weather"}')).toBeNull();
    expect(parseMessage('[]')).toBeNull();
    expect(parseMessage('null')).toBeNull();
  });

  test('that is no JSON throws', () => {
    expect(() => parseMessage('{"type":')).toThrow();
  });
});
