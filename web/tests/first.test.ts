// What somebody sees in the first minute: the one line that says what is happening, and the visitor who gets lost.
import { expect, test } from 'vitest';
import { happening } from '../src/page/happening';
import { stroll, Visitor } from '../src/page/visitor';
import { EMPTY, reduce, type Alarm, type FloorMap, type Mirror, type Worker } from '../src/wire';
import { robot, snapshot } from './samples';

const worker = (id: string, more: Partial<Worker> = {}): Worker =>
  ({ id, name: `picker-${id}`, presence: 'tracked', state: 'following', ...more }) as Worker;
const floor = (workers: Worker[], more: Partial<Parameters<typeof snapshot>[0]> = {}): Mirror => {
  const reduced = reduce(
    EMPTY,
    snapshot({ robots: [robot('r1'), robot('r2', { why: 'giving way to worker w1' })], ...more }),
  );
  if (reduced.kind === 'gap') throw new Error('a snapshot never leaves a gap');
  return { ...reduced.mirror, workers: { rows: workers, at: new Map() } };
};
const alarm = (kind: string): Alarm => ({ id: 'al1', kind, text: '', since_s: 0 });

test('one line says what is happening, and what matters most comes in its place', () => {
  expect(happening(EMPTY)).toBeNull();
  const quiet = happening(floor([worker('w1'), worker('w2', { presence: 'absent' })]));
  const [racks, people] = ['2 robots bring racks to \\d+ stations?', '1 person walks among them, and they give way'];
  expect(quiet).toMatch(new RegExp(`^${racks}\\. ${people}\\. 1 robot gives way to somebody now\\.$`));
  expect(happening(floor([worker('w1', { state: 'deviating' })]))).toContain('One left the path');
  expect(happening(floor([worker('w1', { presence: 'lost' })]))).toContain('picker-w1 is lost');
  expect(happening(floor([], { alarms: [alarm('stopped')] }))).toBe('All robots stand: somebody stopped them.');
});

test('a visitor walks along lanes from the middle of the floor, and is reported once for each step', async () => {
  const nodes = [0, 1, 2, 3].map((x) => ({ id: `n${x}`, x, y: 0, kind: x === 3 ? 'storage' : 'aisle' }));
  const map = {
    bounds: [0, 0, 4, 0],
    nodes,
    lanes: [
      [0, 1],
      [1, 2],
      [2, 3],
    ].map(([from, to]) => ({ from, to, both: true, for: ['people'] })),
  } as unknown as FloorMap;
  expect(stroll(map, 5).map((node) => node.id)).toEqual(['n2', 'n1', 'n0']);
  const said: unknown[] = [];
  const ok = <T>(value: T) => Promise.resolve({ kind: 'ok' as const, value });
  const api = {
    enrol: (name: string) => {
      said.push(name);
      return ok({ id: 'w9', name });
    },
    seenAt: (id: string, at: object) => {
      said.push([id, at]);
      return ok({});
    },
  };
  await new Visitor(api, map, () => Promise.resolve()).walk((id) => said.push(`seen ${id}`));
  expect(said).toEqual([
    'Visitor',
    ['w9', { x: 2, y: 0, accuracy_m: 0.2 }],
    'seen w9',
    ['w9', { x: 1, y: 0, accuracy_m: 0.2 }],
    ['w9', { x: 0, y: 0, accuracy_m: 0.2 }],
  ]);
});
