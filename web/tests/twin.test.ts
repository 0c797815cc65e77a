// The twin without browser and network: walking, looking, the frame of a VR headset, the narrow view, what is drawn.
import { describe, expect, test } from 'vitest';
import { aim, multiply } from '../src/headset/arrow';
import { rotate, toDevice, toMap, type Alignment, type Quat, type Vec2, type Vec3 } from '../src/headset/frame';
import { Glide } from '../src/headset/glide';
import { ground, halfOf, movers, racks, type HallInk } from '../src/headset/hall';
import { mask, NARROW, sight, straight } from '../src/headset/mask';
import { canStand, isInside, triangles } from '../src/headset/polygon';
import { Shapes, STRIDE, type Colour } from '../src/headset/shapes';
import { box } from '../src/headset/solids';
import { driveOf, driveOfPad } from '../src/headset/steer';
import {
  drag,
  EYE_M,
  fromMap,
  headingOf,
  matricesOf,
  onMap,
  perspective,
  poseOf,
  seated,
  shifted,
  step,
  turned,
  WALK_MPS,
  type Eye,
} from '../src/headset/walk';
import { ACTIVITIES, EMPTY, reduce, type FloorMap, type Mirror, type Snapshot } from '../src/wire';

const close = (v: readonly number[]) => [...v].map((n) => expect.closeTo(n, 5) as number);
const corners = (shapes: Shapes): Vec3[] => {
  const c = shapes.corners;
  return Array.from(
    { length: c.length / STRIDE },
    (_, i) => [c[i * STRIDE]!, c[i * STRIDE + 1]!, c[i * STRIDE + 2]!] as const,
  );
};
const apply = (m: ArrayLike<number>, [x, y, z]: Vec3): number[] =>
  [0, 1, 2].map((i) => m[i]! * x + m[4 + i]! * y + m[8 + i]! * z + m[12 + i]!);
const degrees = (half: number): number => (2 * Math.atan(half) * 180) / Math.PI;

/** A hall of 8 m by 4 m with a block of racks in the middle, and a charger outside of where people go. */
const map: FloorMap = {
  name: 'test',
  bounds: [0, 0, 8, 4],
  footprint_m: 0.9,
  nodes: [
    { id: 'A', x: 1, y: 1, kind: 'aisle' },
    { id: 'B', x: 7, y: 1, kind: 'station' },
    { id: 'S', x: 4, y: 2, kind: 'storage' },
    { id: 'C', x: 9, y: 1, kind: 'charger' },
  ],
  lanes: [{ from: 0, to: 1, both: true, for: ['people'] }],
  stations: [],
  racks: [],
  obstacles: [
    [
      [3, 1.5],
      [5, 1.5],
      [5, 2.5],
      [3, 2.5],
    ],
  ],
  walkable: [
    [
      [0, 0],
      [8, 0],
      [8, 4],
      [0, 4],
    ],
  ],
};
const free = (at: Vec2): boolean => canStand(map, at);
const still = { ahead: 0, left: 0, turn: 0 };

describe('walking in the window', () => {
  const eye: Eye = { at: [1, 1], heading: 0, pitch: 0 };
  test('one goes ahead as fast as people walk, and sideways no faster', () => {
    expect(step(eye, { ...still, ahead: 1 }, 0.1, free).at).toEqual(close([1 + WALK_MPS * 0.1, 1]));
    const [x, y] = step(eye, { ...still, ahead: 1, left: 1 }, 0.1, free).at;
    expect(Math.hypot(x - 1, y - 1)).toBeCloseTo(WALK_MPS * 0.1);
    expect(y, 'left of the x axis is up the map').toBeGreaterThan(1);
  });
  test('a frame that took long is no leap', () => {
    expect(step(eye, { ...still, ahead: 1 }, 60, free).at[0]).toBeLessThan(1.2);
  });
  test('one slides along racks and walls, and gets out of where nobody can stand', () => {
    const low: Eye = { at: [4, 1.25], heading: Math.PI / 4, pitch: 0 };
    const slid = step(low, { ...still, ahead: 1 }, 0.1, free).at;
    expect(slid[0]).toBeGreaterThan(4);
    expect(slid[1]).toBe(1.25);
    const shut: Eye = { at: [4, 2], heading: 0, pitch: 0 };
    expect(free(shut.at)).toBe(false);
    expect(step(shut, { ...still, ahead: 1 }, 0.1, free).at[0]).toBeGreaterThan(4);
  });
  test('keys add up, opposite ones cancel, and a finger near the middle of the pad does nothing', () => {
    expect(driveOf(['w', 'arrowup', 'a'])).toEqual({ ahead: 1, left: 1, turn: 0 });
    expect(driveOf(['w', 's', 'arrowright', 'x'])).toEqual({ ahead: 0, left: 0, turn: -1 });
    expect(driveOfPad([0.1, -0.1])).toEqual(still);
    expect(driveOfPad([-0.5, -3])).toEqual({ ahead: 1, left: 0, turn: 0.5 });
  });
  test('what is dragged stays below the pointer, and nobody looks behind over the head', () => {
    // A quarter of a turn of view lies in a window of 800 pixels.
    const perPixel = 2 / 800;
    expect(drag(eye, 400, 0, perPixel).heading).toBeCloseTo(Math.PI / 4);
    expect(drag(eye, 0, 1e6, perPixel).pitch).toBeLessThan(Math.PI / 2);
  });
});

describe('the eye as a pose', () => {
  test('it looks along its heading, as the server reads it', () => {
    for (const heading of [0, 1, -2.5, Math.PI / 2]) {
      const { pos, quat } = poseOf({ at: [3, 5], heading, pitch: 0.4 });
      expect(pos).toEqual([3, EYE_M, -5]);
      const [x, y, z] = rotate(quat, [0, 0, -1]);
      expect(Math.atan2(-z, x)).toBeCloseTo(heading);
      expect(y).toBeCloseTo(Math.sin(0.4));
      expect(headingOf(quat)).toBeCloseTo(heading);
    }
  });
  test('its matrices are each other’s inverse, and agree with the quaternion', () => {
    const { pos, quat } = poseOf({ at: [3, 5], heading: 2, pitch: -0.3 });
    const { matrix, inverse } = matricesOf(pos, quat);
    const one = multiply(matrix, inverse);
    expect([...one]).toEqual(close([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]));
    const turnedAhead = rotate(quat, [0, 0, -2]);
    expect(apply(matrix, [0, 0, -2])).toEqual(close(turnedAhead.map((v, i) => v + pos[i]!)));
  });
  test('a point ahead is in the middle of the window; the longer side sees 80°', () => {
    const { inverse } = matricesOf([0, 0, 0], [0, 0, 0, 1]);
    expect(aim([0, 0, -5], inverse, perspective(1600, 900))).toEqual({ kind: 'in view', x: 0, y: 0 });
    for (const [width, height] of [
      [1600, 900],
      [400, 800],
    ] as const) {
      const seen = sight(perspective(width, height), false);
      expect(degrees(Math.max(...seen))).toBeCloseTo(80);
      expect(seen[0] / seen[1]).toBeCloseTo(width / height);
    }
  });
});

describe('the frame of a VR headset', () => {
  const head: Vec3 = [0.4, 1.6, -0.7];
  const quarter: Quat = [0, Math.SQRT1_2, 0, Math.SQRT1_2];
  test('it begins where the window was, facing the same way', () => {
    const rig = seated(head, headingOf(quarter)!, [5, 2], 0.3);
    expect(toMap(rig, head)).toEqual(close([5, 2]));
    const { pos, quat } = onMap(rig, head, quarter);
    expect(pos).toEqual(close([5, 1.6, -2]));
    expect(headingOf(quat)).toBeCloseTo(0.3);
  });
  test('the stick moves the frame, and a turn leaves the head where it is', () => {
    const rig = seated(head, 0, [5, 2], 0);
    expect(toMap(shifted(rig, head, [6, 3]), head)).toEqual(close([6, 3]));
    const round = turned(rig, head, 0.5);
    expect(toMap(round, head)).toEqual(close([5, 2]));
    expect(headingOf(onMap(round, head, quarter).quat)! - headingOf(onMap(rig, head, quarter).quat)!).toBeCloseTo(0.5);
  });
  test('the hall is drawn where the marks of the guidance are', () => {
    const rig: Alignment = { theta: 0.7, shift: [4, -2] };
    expect(apply(fromMap(rig), [3, 0.5, -6])).toEqual(close(toDevice(rig, [3, 6], 0.5)));
  });
});

describe('the narrow view', () => {
  const wide = perspective(1600, 900);
  test('is 30° by 17.5°, and no wider than the display', () => {
    const [x, y] = sight(wide, true);
    expect(degrees(x)).toBeCloseTo(30);
    expect(degrees(y)).toBeCloseTo(17.5);
    const small = Float32Array.from(wide);
    small[0] = 1 / 0.1;
    expect(sight(small, true)).toEqual([expect.closeTo(0.1, 5), NARROW[1]]);
  });
  test('the mask covers everything outside of it, nothing inside, and nothing twice', () => {
    const triangles = corners(mask([0, 0, 0, 1]));
    const covers = (right: number, up: number): number => {
      let count = 0;
      for (let i = 0; i < triangles.length; i += 3) {
        // As directions: one metre ahead.
        const flat = triangles.slice(i, i + 3).map(([x, y, z]): Vec2 => [x / -z, y / -z]);
        if (isInside(flat, [right, up])) count += 1;
      }
      return count;
    };
    const [x, y] = NARROW;
    for (const [i, j] of [
      [0, 0],
      [0.99, 0.98],
      [-0.99, 0.97],
      [0.3, -0.99],
    ] as const)
      expect(covers(i * x, j * y), `${i}, ${j}`).toBe(0);
    for (const [i, j] of [
      [1.01, 0.1],
      [-1.01, 0.2],
      [0.1, 1.02],
      [0.2, -1.02],
      [4, 4.1],
      [-6, 3],
      [5, -9],
    ] as const)
      expect(covers(i * x, j * y), `${i}, ${j}`).toBe(1);
  });
  test('a point that the window shows and the narrow view does not gets an arrow', () => {
    const { inverse } = matricesOf([0, 0, 0], [0, 0, 0, 1]);
    const at: Vec3 = [2, 0, -5];
    expect(aim(at, inverse, straight(wide, sight(wide, false))).kind).toBe('in view');
    expect(aim(at, inverse, straight(wide, sight(wide, true)))).toMatchObject({ kind: 'off view', angle: 0 });
  });
  test('the eyes’ own asymmetry does not move the arrow', () => {
    const skew = Float32Array.from(wide);
    skew[8] = 0.3;
    expect([...straight(skew, sight(skew, false))]).toEqual([...wide]);
  });
});

describe('outlines', () => {
  const size = (t: readonly [Vec2, Vec2, Vec2][]): number =>
    t.reduce((sum, [a, b, c]) => sum + Math.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2, 0);
  test('a corner that points inwards is left out, whichever way round the outline goes', () => {
    const angle: Vec2[] = [
      [0, 0],
      [4, 0],
      [4, 1],
      [1, 1],
      [1, 3],
      [0, 3],
    ];
    for (const outline of [angle, [...angle].reverse()]) {
      const found = triangles(outline);
      expect(found).toHaveLength(4);
      expect(size(found)).toBeCloseTo(6);
      for (const [a, b, c] of found)
        expect(isInside(angle, [(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3])).toBe(true);
    }
  });
  test('points in a row and crossings end', () => {
    expect(
      size(
        triangles([
          [0, 0],
          [1, 0],
          [2, 0],
          [2, 2],
          [0, 2],
        ]),
      ),
    ).toBeCloseTo(4);
    expect(
      triangles([
        [0, 0],
        [2, 2],
        [2, 0],
        [0, 2],
      ]).length,
    ).toBeLessThan(3);
    expect(
      triangles([
        [0, 0],
        [1, 1],
      ]),
    ).toEqual([]);
  });
  test('a person needs room for the whole body', () => {
    expect(free([1, 1])).toBe(true);
    expect(free([0.1, 1]), 'in the wall').toBe(false);
    expect(free([4, 2]), 'in the racks').toBe(false);
    expect(free([2.9, 2]), 'too close to the racks').toBe(false);
  });
});

describe('the hall', () => {
  const c: Colour = [1, 1, 1, 1];
  const ink: HallInk = {
    sky: c,
    floor: c,
    edge: c,
    lane: c,
    blocked: c,
    closed: [1, 0, 0, 1],
    places: { charger: [0, 1, 0, 1] },
    frame: c,
    goods: [c, c],
    states: Object.fromEntries([...ACTIVITIES, 'gone'].map((one) => [one, c])) as HallInk['states'],
    nose: c,
    person: c,
    region: c,
  };
  const row = {
    heading: 0,
    speed: 0,
    state: 'idle',
    doing: 'idle',
    kind: 'robot',
    maintenance: false,
    leaving: false,
    fault: null,
    rack: null,
    job: null,
    battery: 1,
    granted: [],
    held: [],
    why: null,
    passes: null,
    replanned: null,
  };
  const floor = (more: object): Mirror => {
    const told = {
      type: 'snapshot',
      version: 1,
      time_s: 0,
      simulated: true,
      stations: [],
      closures: [],
      jobs: EMPTY.jobs,
      counters: EMPTY.counters,
      alarms: [],
      robots: [],
      racks: [],
      workers: [],
      ...more,
    };
    const reduced = reduce(EMPTY, told as unknown as Snapshot);
    if (reduced.kind === 'gap') throw new Error('a gap');
    return reduced.mirror;
  };
  const boundsOf = (shapes: Shapes): number[] => {
    const all = corners(shapes);
    return [0, 1, 2].flatMap((i) => [Math.min(...all.map((p) => p[i]!)), Math.max(...all.map((p) => p[i]!))]);
  };
  test('a box lies where it should, turned by its heading, with a lid', () => {
    const shapes = new Shapes();
    box(shapes, { at: [2, 3], heading: Math.PI / 2, half: [1, 0.5], from: 0.1, to: 0.4 }, c);
    expect(boundsOf(shapes)).toEqual(close([1.5, 2.5, 0.1, 0.4, -4, -2]));
    expect(corners(shapes).length).toBe(5 * 6);
  });
  test('closed areas lie on the ground, announced ones do not, and chargers have a floor', () => {
    const outline = [
      [1, 1],
      [2, 1],
      [2, 2],
    ];
    const red = (state: string): number => {
      const all = ground(map, [{ id: 'c1', outline, state, reason: '' } as never], ink).corners;
      return Array.from({ length: all.length / STRIDE }, (_, i) => all[i * STRIDE + 4]!).filter(
        (green, i) => green === 0 && all[i * STRIDE + 3] === 1,
      ).length;
    };
    expect(red('closed')).toBe(3 + 3 * 6);
    expect(red('announced')).toBe(0);
    expect(boundsOf(ground(map, [], ink)).slice(0, 2), 'the charger is at x = 9').toEqual(close([-0.025, 9.5]));
  });
  test('racks that stand in sight are drawn; carried ones come with their robots', () => {
    const standing = floor({ racks: [{ id: 'K1', node: 2, robot: null }] });
    expect(boundsOf(racks(map, standing, [1, 1], ink)).slice(0, 2)).toEqual(close([3.58, 4.42]));
    expect(racks(map, standing, [100, 1], ink).isEmpty, 'far away').toBe(true);
    const carried = floor({
      racks: [{ id: 'K1', node: null, robot: 'r1' }],
      robots: [{ ...row, id: 'r1', x: 1, y: 3, rack: 'K1' }],
    });
    expect(racks(map, carried, [1, 1], ink).isEmpty).toBe(true);
    const glide = new Glide();
    glide.take(carried, 0);
    const { shapes, robots } = movers(map, carried, (id) => glide.where(id, 0), [1, 1], '', ink);
    expect(robots).toBe(1);
    expect(boundsOf(shapes)[3], 'as high as a rack').toBeGreaterThan(1.9);
  });
  test('the wearer does not see themselves, nor who is not there', () => {
    const person = {
      name: '',
      speed: 0,
      heading: 0,
      accuracy: 0,
      regions: [1, 2, 3],
      state: 'idle',
      reason: null,
      path: [],
      assignment: null,
      goals: [],
      undecided: 1,
      elsewhere: 0,
    };
    const people = floor({
      workers: [
        { ...person, id: 'w1', x: 1, y: 1, presence: 'tracked' },
        { ...person, id: 'w2', x: 2, y: 1, presence: 'tracked' },
        { ...person, id: 'w3', x: 3, y: 1, presence: 'absent' },
      ],
    });
    const glide = new Glide();
    glide.take(people, 0);
    expect(movers(map, people, (id) => glide.where(id, 0), [1, 1], 'w1', ink).people).toBe(1);
  });
  test('a robot is as large as its kind', () => {
    expect(halfOf(null, 0.9)).toEqual([0.45, 0.45]);
    expect(halfOf({ circle_m: 0.3 }, 0.9)).toEqual([0.3, 0.3]);
    expect(
      halfOf(
        {
          polygon_m: [
            [1, 0.2],
            [-0.5, 0.2],
            [-0.5, -0.4],
          ],
        },
        0.9,
      ),
    ).toEqual([1, 0.4]);
  });
  test('what moves glides from where it was drawn, the short way round, and jumps if it was carried off', () => {
    const glide = new Glide();
    const put = (x: number, heading: number, now: number) =>
      glide.take(floor({ robots: [{ ...row, id: 'r1', x, y: 0, heading }] }), now);
    put(0, 3, 1000);
    put(1, -3, 1100);
    const half = glide.where('r1', 1150)!;
    expect(half.at).toEqual(close([0.5, 0]));
    expect(half.heading).toBeCloseTo(Math.PI);
    expect(glide.where('r1', 9000)!.at).toEqual(close([1, 0]));
    put(50, 0, 9100);
    expect(glide.where('r1', 9100)!.at).toEqual(close([50, 0]));
    expect(glide.where('nobody', 0)).toBeUndefined();
  });
});
