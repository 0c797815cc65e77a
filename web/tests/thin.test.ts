// Thin patches: numbers by row must end in the rows that plain patches end in.
import { describe, expect, test } from 'vitest';
import { EMPTY, reduce, type Mirror } from '../src/wire/mirror';
import type { Patch, Snapshot } from '../src/wire';
import { robot, snapshot, worker } from './samples';

const begin = (more: Partial<Snapshot>): Mirror => {
  const reduced = reduce(EMPTY, snapshot(more));
  if (reduced.kind === 'gap') throw new Error('no gap in a snapshot');
  return reduced.mirror;
};
const apply = (mirror: Mirror, patch: Partial<Patch>): Mirror => {
  const reduced = reduce(mirror, { type: 'patch', base: mirror.version!, version: mirror.version! + 1, ...patch });
  if (reduced.kind === 'gap') throw new Error('gap');
  return reduced.mirror;
};

describe('a thin patch', () => {
  const three = begin({
    robots: [robot('a'), robot('b', { x: 1.234, y: -0.5, granted: [1, 2], held: [3, 4] }), robot('c')],
  });

  test('moves robots by millimetres, and a thousand steps lose nothing', () => {
    let mirror = three;
    for (let k = 0; k < 1_000; k++) mirror = apply(mirror, { moves: [1, 7, -3] });
    expect(mirror.robots.rows[1]).toMatchObject({ x: 8.234, y: -3.5 });
  });

  test('leaves the rows of the mirror before, and of robots that did nothing, as they are', () => {
    const next = apply(three, { moves: [1, 100, 0], turns: [1, 1571], speeds: [1, 120] });
    expect(next.robots.rows[1]).toMatchObject({ x: 1.334, heading: 1.571, speed: 1.2 });
    expect(three.robots.rows[1]).toMatchObject({ x: 1.234, heading: 0, speed: 0 });
    expect(next.robots.rows[0]).toBe(three.robots.rows[0]);
    expect(next.robots.rows[1]!.held).toBe(three.robots.rows[1]!.held);
  });

  test('moves a way on: left behind, granted, kept and new', () => {
    const next = apply(three, { ways: [[1, 1, 2, 3, 9, 8]] });
    expect(next.robots.rows[1]).toMatchObject({ granted: [2, 3], held: [4, 9, 8] });
    expect(apply(next, { ways: [[1, 5, 1, 0, 7]] }).robots.rows[1]).toMatchObject({ granted: [7], held: [] });
  });

  test('says where people are, or that nobody knows', () => {
    const one = begin({
      workers: [
        worker('w1', {
          path: [
            [0, 0],
            [1, 0],
            [2, 0],
          ],
        }),
      ],
    });
    const next = apply(one, { walks: [0, 500, 0, -1571, 110], paths: [[0, 2, 500, 0]] });
    expect(next.workers.rows[0]).toMatchObject({
      x: 0.5,
      y: 0,
      heading: -1.571,
      speed: 1.1,
      path: [
        [0.5, 0],
        [1, 0],
        [2, 0],
      ],
    });
    const gone = apply(next, { walks: [0, null, null, null, 0], paths: [[0, 0]] });
    expect(gone.workers.rows[0]).toMatchObject({ x: null, heading: null, path: [] });
  });

  test('goes together with rows, and rows that are not there are passed over', () => {
    const next = apply(three, {
      robots: [
        { id: 'a', state: 'busy' },
        { id: 'd', x: 5 },
      ],
      moves: [0, 1_000, 0, 1, 5, 5, 77, 1, 1],
      ways: [[78, 0, 0, 0]],
    });
    expect(next.robots.rows[0]).toMatchObject({ state: 'busy', x: 1 });
    expect([next.robots.rows[1], next.robots.rows[2]]).toMatchObject([{ x: 1.234 }, { x: 0.005, y: 0.005 }]);
    expect(next.robots.rows.map((r) => r.id)).toEqual(['a', 'b', 'c', 'd']);
  });
});
