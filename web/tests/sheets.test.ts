// What is put on the sheets: that every state has its own shape, and that nothing is made anew for a frame
// that changes nothing.
import { describe, expect, test } from 'vitest';
import { Composer } from '../src/floor/paint/compose';
import { axes, putHeat, strength, type Forecast, type Gaussian } from '../src/floor/paint/heat';
import type { Palette } from '../src/floor/paint/palette';
import { isInside, placeOf, thingAt, thingBeside } from '../src/floor/scene/pick';
import { LOOKS, Stage } from '../src/floor/scene/scene';
import { cssOf, inkOf, KIND, Sheet, STRIDE } from '../src/floor/paint/sheet';
import { fit } from '../src/floor/scene/view';
import { EMPTY, reduce, type Mirror } from '../src/wire/mirror';
import { Story } from '../src/cards/changes';
import type { FloorMap, Snapshot } from '../src/wire';
import { robot, snapshot, worker } from './samples';

const MAP: FloorMap = {
  name: 'Row',
  bounds: [0, 0, 20, 10],
  footprint_m: 0.9,
  nodes: [
    { id: 'A', x: 1, y: 1, kind: 'aisle' },
    { id: 'S', x: 2, y: 1, kind: 'storage' },
    { id: 'C', x: 9, y: 1, kind: 'charger' },
    { id: 'P', x: 5, y: 5, kind: 'station' },
    { id: 'Q', x: 6, y: 5, kind: 'queue' },
  ],
  lanes: [{ from: 0, to: 1, both: true, for: [] }],
  stations: [{ id: 'P1', node: 3, queue: [4] }],
  racks: [{ id: 'K1', node: 1 }],
  obstacles: [],
  walkable: [],
};
// Any colour will do, as long as each name has its own.
let used = 0;
const colour = () => `rgb(${(used += 1)}, 0, 0)`;
const PALETTE: Palette = { of: new Proxy({}, { get: () => colour() }) as Palette['of'], looks: LOOKS.map(colour) };
const VIEW = fit(MAP.bounds, 800, 500);
const NOTHING: readonly Forecast[] = [];
const NOBODY = { robot: -1, person: -1, place: null, look: -1 };

function mirrorOf(more: Partial<Snapshot>): Mirror {
  const reduced = reduce(EMPTY, snapshot(more));
  if (reduced.kind === 'gap') throw new Error('no gap in a snapshot');
  return reduced.mirror;
}
function stageOf(more: Partial<Snapshot>): Stage {
  const stage = new Stage(MAP);
  stage.take(mirrorOf(more), 0, 'jump');
  return stage;
}
const kinds = (sheet: Sheet): number[] => Array.from({ length: sheet.count }, (_, i) => sheet.marks[i * STRIDE + 5]!);

describe('a sheet', () => {
  test('keeps its marks and their ink when it grows', () => {
    const sheet = new Sheet();
    for (let i = 0; i < 1_000; i++) sheet.put(KIND.disc, i, -i, 1, 1, 0xff0000ff + i);
    expect([sheet.count, sheet.marks[999 * STRIDE], sheet.inks[7]]).toEqual([1_000, 999, 0xff0000ff]);
    expect(sheet.inks[999 * STRIDE + 7]).toBe(0xff0000ff + 999);
  });

  test('ink goes to bytes and back', () => {
    expect(inkOf('rgba(1, 2, 3, 0.5)')).toBe(0x80030201);
    expect(cssOf(0xff030201)).toBe('rgb(1 2 3 / 1.000)');
  });
});

describe('the composition', () => {
  test('every state has a shape of its own', () => {
    const shapes = LOOKS.map((look) => {
      const stage = stageOf({ robots: [robot('r', { activity: look })] });
      const composer = new Composer(PALETTE);
      composer.compose(stage.scene, { ...VIEW, scale: 20 }, NOBODY, []);
      return kinds(composer.sheets.robots).join();
    });
    expect(new Set(shapes).size).toBe(LOOKS.length);
  });

  test('what is granted is solid and what is held is dashed', () => {
    const stage = stageOf({ robots: [robot('r1', { granted: [0, 1] }), robot('r2', { granted: [0], held: [1] })] });
    const composer = new Composer(PALETTE);
    composer.compose(stage.scene, VIEW, NOBODY, []);
    expect(kinds(composer.sheets.ways)).toEqual([KIND.dashes, KIND.box]);
  });

  test('three regions are drawn around a person, with the radii of the server', () => {
    const stage = stageOf({ workers: [worker('w', { regions: [1.5, 2.5, 4] })] });
    const composer = new Composer(PALETTE);
    composer.compose(stage.scene, VIEW, NOBODY, []);
    const { marks, count } = composer.sheets.regions;
    const widths = Array.from({ length: count }, (_, i) => marks[i * STRIDE + 2]);
    expect(widths).toEqual([8, 5, 5, 3, 3]);
  });

  test('somebody off the path bears a flag and says so', () => {
    const marks = (state: 'following' | 'deviating') => {
      const composer = new Composer(PALETTE);
      const { scene } = stageOf({ workers: [worker('w', { state })] });
      composer.compose(scene, VIEW, NOBODY, []);
      return { count: composer.sheets.people.count, titles: scene.people.map((p) => p.title) };
    };
    expect(marks('deviating').count).toBeGreaterThan(marks('following').count);
    expect(marks('deviating').titles).toEqual(['w: off the path']);
  });

  test('racks and ways are not put down again when nothing changed, and lists are kept', () => {
    const stage = stageOf({ robots: [robot('r', { granted: [0, 1] })], racks: [{ id: 'K1', node: 1, robot: null }] });
    const composer = new Composer(PALETTE);
    composer.compose(stage.scene, VIEW, NOBODY, NOTHING);
    const { racks, ways, heat, robots } = composer.sheets;
    const before = [racks.turn, ways.turn, heat.turn];
    const memory = robots.marks;
    for (let i = 0; i < 10; i++) composer.compose(stage.scene, { ...VIEW, x: i }, NOBODY, NOTHING);
    expect([racks.turn, ways.turn, heat.turn]).toEqual(before);
    expect(robots.marks).toBe(memory);
    // The names of the station and of the robot.
    expect(composer.words.list.length).toBe(2);
  });

  test('a station says how many wait in its queue', () => {
    const { scene } = stageOf({ robots: [robot('r')], stations: [{ id: 'P1', robot: null, queue: ['r'], served: 0 }] });
    expect(scene.stations.map((s) => s.title)).toEqual(['P1  1/1']);
  });
});

describe('heat', () => {
  const bell: Gaussian = { x: 1, y: 2, sxx: 4, sxy: 0, syy: 1, weight: 1 };

  test('the long axis lies where the covariance says', () => {
    expect(axes(bell)).toEqual({ long: 2, short: 1, turn: 0 });
    const turned = axes({ ...bell, sxx: 2.5, syy: 2.5, sxy: 1.5 });
    expect(turned.long).toBeCloseTo(2);
    expect(turned.short).toBeCloseTo(1);
    expect(turned.turn).toBeCloseTo(Math.PI / 4);
  });

  test('it is stronger where more probability is on less floor, and never quite opaque', () => {
    const near = strength({ ...bell, sxx: 0.04, syy: 0.04 });
    expect(near).toBeGreaterThan(strength(bell));
    expect(strength({ ...bell, weight: 0.1 })).toBeLessThan(strength(bell));
    expect(near).toBeLessThanOrEqual(0.8);
  });

  test('a forecast becomes one mark a part, and what says nothing becomes none', () => {
    const sheet = new Sheet();
    const forecasts: Forecast[] = [
      { worker: 'w1', parts: [bell, { ...bell, weight: 0.5 }, { ...bell, weight: 0 }] },
      { worker: 'w2', parts: [{ ...bell, x: NaN }] },
    ];
    sheet.begin();
    putHeat(sheet, forecasts, inkOf('rgb(9, 8, 7)'));
    expect(kinds(sheet)).toEqual([KIND.heat, KIND.heat]);
    expect([...sheet.marks.slice(0, 5)]).toEqual([1, 2, 12, 6, 0]);
    expect(sheet.inks[7]! & 0xffffff).toBe(0x070809);
  });

  test('it is put on its sheet once per forecast', () => {
    const stage = stageOf({ robots: [robot('r')] });
    const composer = new Composer(PALETTE);
    const forecasts: Forecast[] = [{ worker: 'w1', parts: [bell] }];
    for (let i = 0; i < 3; i++) composer.compose(stage.scene, VIEW, NOBODY, forecasts);
    expect([composer.sheets.heat.count, composer.sheets.heat.turn]).toEqual([1, 1]);
    composer.compose(stage.scene, VIEW, NOBODY, []);
    expect(composer.sheets.heat.count).toBe(0);
  });
});

describe('what is where', () => {
  const floor: Partial<Snapshot> = {
    robots: [robot('r1', { x: 1, y: 1 })],
    workers: [worker('w1', { x: 15, y: 8 })],
    racks: [{ id: 'K1', node: 1, robot: null }],
    stations: [{ id: 'P1', robot: null, queue: [], served: 3 }],
    closures: [
      {
        id: 'c1',
        outline: [
          [10, 4],
          [14, 4],
          [14, 7],
          [10, 7],
        ],
        reason: 'spill',
      },
    ],
  };
  const mirror = mirrorOf(floor);
  const { scene } = stageOf(floor);

  test('everything on the floor can be pointed at, and found again', () => {
    const points = [
      [1, 1],
      [15, 8],
      [2, 1],
      [5, 5],
      [6, 5],
      [9, 1],
      [12, 5],
    ] as const;
    const picked = points.map(([x, y]) => thingAt(MAP, mirror, scene, x, y, 0.01));
    expect(picked.map((p) => p && `${p.kind} ${p.id}`)).toEqual([
      'robot r1',
      'worker w1',
      'rack K1',
      'station P1',
      'station P1',
      'place C',
      'closure c1',
    ]);
    expect(thingAt(MAP, mirror, scene, 18, 2, 0.01)).toBeNull();
    const found = picked.map((p) => placeOf(MAP, mirror, scene, p!));
    expect(found).toEqual([
      [1, 1],
      [15, 8],
      [2, 1],
      [5, 5],
      [5, 5],
      [9, 1],
      [12, 5.5],
    ]);
  });

  test('keys go round through what is in sight', () => {
    const seen = ['w1', 'P1', 'r1', 'w1'];
    let at = null;
    for (const id of seen) expect((at = thingBeside(MAP, scene, VIEW, at, 1))?.id).toBe(id);
    expect(thingBeside(MAP, scene, VIEW, null, -1)?.id).toBe('r1');
    expect(thingBeside(MAP, scene, { ...VIEW, x: 500 }, null, 1)).toBeNull();
  });

  test('inside is inside, also of a shape with a bay', () => {
    const bay: [number, number][] = [
      [0, 0],
      [4, 0],
      [4, 4],
      [2, 1],
      [0, 4],
    ];
    expect([isInside(bay, 0.5, 1), isInside(bay, 2, 3), isInside(bay, 3.5, 1)]).toEqual([true, false, true]);
  });
});

describe('a story', () => {
  test('it tells what changed, newest first, and nothing else', () => {
    const story = new Story();
    story.places = MAP.nodes;
    let mirror = mirrorOf({
      robots: [robot('r1'), robot('r2')],
      racks: [{ id: 'K1', node: 1, robot: null }],
      workers: [worker('w1')],
    });
    story.note(mirror);
    const next = (patch: object): void => {
      const reduced = reduce(mirror, {
        type: 'patch',
        base: mirror.version!,
        version: mirror.version! + 1,
        time_s: 61,
        ...patch,
      });
      if (reduced.kind === 'gap') throw new Error('gap');
      story.note((mirror = reduced.mirror));
    };
    next({ robots: [{ id: 'r1', activity: 'driving', state: 'busy', doing: 'to_rack' }], moves: [1, 500, 0] });
    next({
      racks: [{ id: 'K1', node: null, robot: 'r1' }],
      workers: [{ id: 'w1', state: 'deviating', reason: 'you left the path' }],
    });
    next({ racks: [{ id: 'K1', node: 1, robot: null }], robots: [{ id: 'r1', why: 'giving way to worker w1' }] });
    const told = (kind: 'robot' | 'rack' | 'worker', id: string) => story.of({ kind, id }).map((line) => line.text);
    expect(told('robot', 'r1')).toEqual(['giving way to worker w1', 'driving to its rack', 'driving']);
    expect(told('robot', 'r2')).toEqual([]);
    expect(told('rack', 'K1')).toEqual(['set down at S', 'lifted by r1']);
    expect(told('worker', 'w1')).toEqual(['off the path: you left the path']);
    expect(story.of({ kind: 'robot', id: 'r1' })[0]!.at).toBe('00:01:01');
  });
});
