// The camera and the scene: arithmetic that a wrong sign would spoil.
import { describe, expect, test } from 'vitest';
import { personNear } from '../src/floor/scene/people';
import { heldBeyond, robotNear, Stage } from '../src/floor/scene/scene';
import { shortTurn } from '../src/floor/scene/turn';
import { fit, pan, toScreen, toWorld, zoomAt } from '../src/floor/scene/view';
import { History } from '../src/page/history';
import { EMPTY, reduce, type Mirror } from '../src/wire/mirror';
import type { FloorMap, Robot, Snapshot } from '../src/wire';
import { robot, snapshot, worker } from './samples';

const MAP: FloorMap = {
  name: 'Four',
  bounds: [0, 0, 40, 20],
  footprint_m: 0.9,
  nodes: [0, 1, 2, 9].map((x, i) => ({ id: `N${i}`, x, y: 0, kind: 'aisle' as const })),
  lanes: [
    { from: 0, to: 1, both: true, for: [] },
    { from: 1, to: 2, both: true, for: [] },
  ],
  stations: [],
  racks: [],
  obstacles: [],
  walkable: [],
};
function mirror(robots: Robot[], more: Partial<Snapshot> = {}): Mirror {
  const reduced = reduce(EMPTY, snapshot({ robots, ...more }));
  if (reduced.kind === 'gap') throw new Error('no gap in a snapshot');
  return reduced.mirror;
}

describe('the camera', () => {
  const view = fit(MAP.bounds, 800, 500);

  test('the whole floor is in sight, and up is up', () => {
    const [left, bottom] = toScreen(view, 0, 0);
    const [right, top] = toScreen(view, 40, 20);
    expect(left).toBeGreaterThan(0);
    expect(right).toBeLessThan(800);
    expect(top).toBeGreaterThan(0);
    expect(bottom).toBeLessThan(500);
    expect(top).toBeLessThan(bottom);
  });

  test('screen and world undo each other', () => {
    const [x, y] = toWorld(view, ...toScreen(view, 12.5, 3.25));
    expect(x).toBeCloseTo(12.5);
    expect(y).toBeCloseTo(3.25);
  });

  test('zooming keeps what is under the pointer under the pointer', () => {
    const before = toWorld(view, 300, 200);
    const after = toWorld(zoomAt(view, 2, 300, 200, MAP.bounds), 300, 200);
    expect(after[0]).toBeCloseTo(before[0]);
    expect(after[1]).toBeCloseTo(before[1]);
  });

  test('a floor that stands upright is turned in a picture that lies, and only if that is worth it', () => {
    const standing = [0, 0, 14, 40] as const;
    const turned = fit(standing, 1400, 500);
    expect([turned.turned, fit(MAP.bounds, 1400, 500).turned, fit([0, 0, 20, 20.5], 800, 700).turned]).toEqual([
      true,
      undefined,
      undefined,
    ]);
    const places = standing.map((_, i) => [standing[i < 2 ? 0 : 2], standing[i % 2 ? 1 : 3]] as const);
    for (const [x, y] of places) {
      const [px, py] = toScreen(turned, x, y);
      expect([px >= 0 && px <= 1400, py >= 0 && py <= 500]).toEqual([true, true]);
    }
    const across = Math.abs(toScreen(turned, 0, 40)[0] - toScreen(turned, 0, 0)[0]);
    expect(across, 'it uses its pane').toBeGreaterThan(0.8 * 1400);
    expect(toScreen(turned, 0, 40)[0], 'what is up is to the right').toBeGreaterThan(toScreen(turned, 0, 0)[0]);
    expect(toScreen(turned, 14, 0)[1], 'a turn, and no mirror').toBeGreaterThan(toScreen(turned, 0, 0)[1]);
    const [x, y] = toWorld(turned, ...toScreen(turned, 3, 17));
    expect([x.toFixed(6), y.toFixed(6)]).toEqual(['3.000000', '17.000000']);
    const [before, after] = [turned, zoomAt(turned, 2, 300, 200, standing)].map((view) => toWorld(view, 300, 200));
    expect(after![0]).toBeCloseTo(before![0]!);
    expect(after![1]).toBeCloseTo(before![1]!);
    const panned = pan(zoomAt(turned, 2, 700, 250, standing), 10, 0, standing);
    expect(toScreen(panned, 7, 20)[0] - toScreen(zoomAt(turned, 2, 700, 250, standing), 7, 20)[0]).toBeCloseTo(10);
  });

  test('nobody can pan the floor out of sight', () => {
    const far = pan(view, 1e6, 1e6, MAP.bounds);
    expect([far.x, far.y]).toEqual([0, 20]);
  });
});

describe('the scene', () => {
  test('a robot is drawn as wide as robots of its kind are', () => {
    const kinds = [
      { name: 'shuttle', footprint: { circle_m: 0.22 }, footprint_loaded: null },
      {
        name: 'mover',
        footprint: {
          polygon_m: [
            [0.38, 0.22],
            [0.38, -0.22],
            [-0.32, -0.22],
            [-0.32, 0.22],
          ],
        },
        footprint_loaded: null,
      },
      { name: 'box', footprint: { square_m: 0.5 }, footprint_loaded: null },
      { name: 'usual', footprint: null, footprint_loaded: null },
    ] satisfies FloorMap['kinds'];
    const stage = new Stage({ ...MAP, kinds });
    stage.take(mirror([...kinds.map((k) => k.name), 'unknown'].map((kind) => ({ ...robot(kind), kind }))), 0, 'jump');
    expect([...stage.scene.reach].map((reach) => reach.toFixed(2))).toEqual(['0.22', '0.38', '0.25', '0.38', '0.38']);
  });

  test('a robot glides to where a patch puts it', () => {
    const stage = new Stage(MAP);
    const one = mirror([robot('r1')]);
    stage.take(one, 0, 'jump');
    const two = reduce(one, { type: 'patch', base: 1, version: 2, robots: [{ id: 'r1', x: 1 }] });
    if (two.kind === 'gap') throw new Error('gap');
    stage.take(two.mirror, 100, 'glide');
    stage.at(150);
    expect(stage.scene.x[0]).toBeGreaterThan(0.3);
    expect(stage.scene.x[0]).toBeLessThan(0.7);
    expect(stage.at(1_000)).toBe(false);
    expect(stage.scene.x[0]).toBe(1);
  });

  test('a robot that is far away at once is put there, not slid', () => {
    const stage = new Stage(MAP);
    const one = mirror([robot('r1')]);
    stage.take(one, 0, 'jump');
    const two = reduce(one, { type: 'patch', base: 1, version: 2, robots: [{ id: 'r1', x: 9 }] });
    if (two.kind === 'gap') throw new Error('gap');
    stage.take(two.mirror, 100, 'glide');
    expect(stage.scene.x[0]).toBe(9);
  });

  test('a carried rack is where its robot is', () => {
    const stage = new Stage(MAP);
    stage.take(
      mirror([robot('r1', { x: 3, y: 2 })], {
        racks: [
          { id: 'K1', node: null, robot: 'r1' },
          { id: 'K2', node: 1, robot: null },
        ],
      }),
      0,
      'jump',
    );
    stage.at(1);
    expect([...stage.scene.rackX]).toEqual([3, 1]);
    expect([...stage.scene.rackOn]).toEqual([0, -1]);
  });

  test('ways are drawn only along lanes, straight ones as one line', () => {
    const stage = new Stage(MAP);
    stage.take(mirror([robot('r1', { granted: [0, 1, 2, 3] }), robot('r2', { granted: [2, 1] })]), 0, 'jump');
    expect([...stage.scene.granted.at]).toEqual([0, 0, 2, 0, 2, 0, 1, 0]);
    expect([...stage.scene.granted.from]).toEqual([0, 1, 2]);
  });

  test('what is held begins where the grant ends', () => {
    expect(heldBeyond([0, 1], [0, 1, 2])).toEqual([1, 2]);
    expect(heldBeyond([0, 1], [0, 1])).toEqual([]);
    expect(heldBeyond([], [2, 3])).toEqual([2, 3]);
  });

  test('turns go the short way round', () => {
    expect(shortTurn(3, -3)).toBeCloseTo(2 * Math.PI - 6);
    expect(shortTurn(0.1, -0.1)).toBeCloseTo(-0.2);
  });

  test('the nearest robot within reach is the one meant', () => {
    const stage = new Stage(MAP);
    stage.take(mirror([robot('r1', { x: 1 }), robot('r2', { x: 2 })]), 0, 'jump');
    expect(robotNear(stage.scene, 1.8, 0, 1)).toBe(1);
    expect(robotNear(stage.scene, 30, 0, 1)).toBe(-1);
  });
});

describe('people on the floor', () => {
  const seen = (more: Partial<Snapshot>): Mirror => mirror([robot('r1')], more);

  test('a person glides to where a patch puts them, and turns the short way', () => {
    const stage = new Stage(MAP);
    const one = seen({ workers: [worker('w1', { x: 1, heading: 3 })] });
    stage.take(one, 0, 'jump');
    const two = reduce(one, { type: 'patch', base: 1, version: 2, workers: [{ id: 'w1', x: 2, heading: -3 }] });
    if (two.kind === 'gap') throw new Error('gap');
    stage.take(two.mirror, 1_000, 'glide');
    stage.at(1_050);
    const [person] = stage.scene.people;
    expect(person!.x).toBeGreaterThan(1);
    expect(person!.x).toBeLessThan(2);
    expect(person!.heading).toBeGreaterThan(3);
  });

  test('whoever is absent or was never seen is not on the floor', () => {
    const stage = new Stage(MAP);
    const workers = [
      worker('w1', { x: null, y: null }),
      worker('w2', { presence: 'absent' }),
      worker('w3', { presence: 'lost' }),
    ];
    stage.take(seen({ workers }), 0, 'jump');
    expect(stage.scene.people.map((p) => p.title)).toEqual(['w3 (lost)']);
    expect(personNear(stage.scene.people, 0.5, 0, 1)).toBe(0);
    expect(personNear(stage.scene.people, 5, 0, 1)).toBe(-1);
  });
});

describe('the history of deliveries', () => {
  test('it keeps ten minutes, newest at the right', () => {
    const history = new History();
    for (let s = 0; s <= 1_200; s += 1) history.add(s, s);
    const points = history.points();
    expect(points).toHaveLength(120);
    expect(points.at(-1)).toEqual([1, 0]);
    expect(points[0]![0]).toBeCloseTo(0);
  });

  test('a clock that starts again starts the line again', () => {
    const history = new History();
    [10, 20, 30, 0, 10].forEach((s) => history.add(s, 1));
    expect(history.points()).toHaveLength(2);
  });
});
