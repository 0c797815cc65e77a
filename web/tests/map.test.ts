// The map first: names that keep clear of each other, margins for them, the floor from afar, finding by a part of a
// name, addresses, the share of the map, and taking back what was done.
import { describe, expect, test, vi } from 'vitest';
import { alarmedOf, Composer, FAR_BELOW, NAMES_FROM } from '../src/floor/paint/compose';
import { unusual } from '../src/floor/paint/heatmap';
import { Labels, stationTitle, titlesOf } from '../src/floor/paint/labels';
import type { Palette } from '../src/floor/paint/palette';
import { KIND, STRIDE, Words, type Sheet } from '../src/floor/paint/sheet';
import { foundJob, matching, namesOn } from '../src/floor/find';
import { LOOKS, Stage } from '../src/floor/scene/scene';
import { fit, toScreen, type View } from '../src/floor/scene/view';
import { addressOf, hashOf, HOME, isThere } from '../src/page/address';
import { afterKey, LEAST, MOST, USUAL, within } from '../src/page/share';
import { Notices, OFFERED_MS } from '../src/parts/notices.svelte';
import { closedAgain } from '../src/places/closureform';
import { undoOf, ROBOT_ACTS, type ActsApi } from '../src/robots/acts';
import { EMPTY, reduce, type Alarm, type FloorMap, type Job, type Mirror, type Snapshot } from '../src/wire';
import { robot, snapshot, worker } from './samples';

const MAP: FloorMap = {
  name: 'Row',
  bounds: [0, 0, 40, 20],
  footprint_m: 0.9,
  nodes: [
    { id: 'A1', x: 1, y: 1, kind: 'aisle' },
    { id: 'S1', x: 2, y: 1, kind: 'storage' },
    { id: 'W', x: 0.5, y: 10, kind: 'station' },
    { id: 'E', x: 39.5, y: 19.8, kind: 'station' },
  ],
  lanes: [{ from: 0, to: 1, both: true, for: [] }],
  stations: [
    { id: 'W1', node: 2, queue: [] },
    { id: 'E1', node: 3, queue: [] },
  ],
  racks: [],
  obstacles: [],
  walkable: [],
};
const PALETTE: Palette = {
  of: new Proxy({}, { get: () => 'rgb(1, 2, 3)' }) as Palette['of'],
  looks: LOOKS.map((_, i) => `rgb(${i}, 0, 0)`),
};
const NOBODY = { robot: -1, person: -1, place: null, look: -1 };

function mirrorOf(more: Partial<Snapshot>): Mirror {
  const reduced = reduce(EMPTY, snapshot(more));
  if (reduced.kind === 'gap') throw new Error('no gap in a snapshot');
  return reduced.mirror;
}
const alarm = (subject: string): Alarm => ({
  id: 'al1',
  text: 'It is silent.',
  since_s: 0,
  kind: 'robot_silent',
  severity: 'warning',
  subject_kind: 'robot',
  subject,
});

describe('names keep clear of each other', () => {
  const view: View = { x: 20, y: 5, scale: 40, width: 720, height: 400 };
  /** The names that are written, in the order in which they were put. */
  function written(more: Partial<Snapshot>, chosen = NOBODY, alarms: Alarm[] = [], scale = 40): string[] {
    const stage = new Stage(MAP);
    stage.take(mirrorOf(more), 0, 'jump');
    const composer = new Composer(PALETTE);
    composer.alarmed = alarmedOf(alarms);
    composer.compose(stage.scene, { ...view, scale }, chosen, []);
    return composer.words.list.slice(0, composer.words.count).map((word) => word.text);
  }
  // All in one place, so that there is room for two names of them: one below and one above.
  const robots = ['r1', 'r2', 'r3', 'r4'].map((id) => robot(id, { x: 20, y: 5 }));

  test('no two boxes overlap, and each is as wide as its letters need', () => {
    const words = new Words();
    const labels = new Labels(words);
    labels.begin(view);
    expect(labels.put('robot-1', 20, 5, 0, 11)).toBe(true);
    expect(labels.put('robot-2', 20.5, 5, 0, 11), 'beside it, over its end').toBe(false);
    expect(labels.put('robot-3', 20, 5, 20, 11), 'below it').toBe(true);
    expect(labels.put('robot-4', 22, 5, 0, 11), 'far enough aside').toBe(true);
    expect(labels.put('robot-5', 20, 50, 0, 11), 'out of sight').toBe(false);
    expect(labels.put('robot-6', NaN, NaN, 0, 11), 'nowhere').toBe(false);
    expect(words.count).toBe(3);
  });
  test('a name finds room above its mark if there is none below', () => {
    expect(written({ robots: robots.slice(0, 2) })).toEqual(['r1', 'r2']);
    expect(written({ robots })).toEqual(['r1', 'r2']);
  });
  test('what is chosen comes first, then what has an alarm, then people, then other robots', () => {
    expect(written({ robots }, { ...NOBODY, robot: 3 }, [alarm('r3')])).toEqual(['r4', 'r3']);
    expect(written({ robots, workers: [worker('anna', { x: 20, y: 5 })] }, NOBODY, [alarm('r3')])).toEqual([
      'r3',
      'anna',
    ]);
    expect(written({ robots, workers: [worker('anna', { x: 20, y: 5 }), worker('ben', { x: 20, y: 5 })] })).toEqual([
      'anna',
      'ben',
    ]);
  });
  test('stations come before robots, robots before racks, racks before places', () => {
    const stage = new Stage(MAP);
    stage.take(
      mirrorOf({
        robots: [robot('r1', { x: 3, y: 1 })],
        racks: [{ id: 'K1', node: 1, robot: null }],
        stations: [{ id: 'W1', robot: null, queue: [], served: 0 }],
      }),
      0,
      'jump',
    );
    const composer = new Composer(PALETTE);
    composer.compose(stage.scene, { x: 2, y: 5, scale: 70, width: 900, height: 900 }, NOBODY, []);
    expect(composer.words.list.slice(0, composer.words.count).map((word) => word.text)).toEqual([
      'W1  0/0',
      'r1',
      'K1',
      'A1',
      'S1',
    ]);
  });
  test('a robot with an alarm has its name at every scale, others from where they can be told apart', () => {
    expect(
      written(
        { robots: [robot('r1', { x: 20, y: 5 }), robot('r2', { x: 22, y: 5 })] },
        NOBODY,
        [alarm('r2')],
        NAMES_FROM - 1,
      ),
    ).toEqual(['r2']);
    expect(
      written({ robots: [robot('r1', { x: 20, y: 5 }), robot('r2', { x: 22, y: 5 })] }, NOBODY, [], NAMES_FROM),
    ).toEqual(['r1', 'r2']);
  });
});

describe('the whole floor', () => {
  test.each([
    [1400, 700],
    [820, 500],
    [390, 300],
  ])('leaves room for the titles at its edge at %i × %i', (width, height) => {
    const view = fit(MAP.bounds, width, height, titlesOf(MAP));
    const { below, px } = stationTitle(view.scale);
    for (const { x, y, half_px } of titlesOf(MAP)) {
      const [cx, cy] = toScreen(view, x, y);
      expect(cx - half_px, 'left').toBeGreaterThanOrEqual(0);
      expect(cx + half_px, 'right').toBeLessThanOrEqual(width);
      expect(cy + below - px / 2, 'top').toBeGreaterThanOrEqual(0);
      // Half a station, in metres.
      expect(cx - 0.62 * view.scale, 'its mark').toBeGreaterThanOrEqual(0);
      expect(cx + 0.62 * view.scale, 'its mark').toBeLessThanOrEqual(width);
    }
  });
  test('ends above what is kept free', () => {
    for (const foot of [52, 180]) {
      const [, bottom] = toScreen(fit(MAP.bounds, 600, 500, titlesOf(MAP), foot), 0, -0.62);
      expect(bottom).toBeLessThanOrEqual(500 - foot);
    }
  });
});

describe('from afar', () => {
  const far: View = { x: 20, y: 10, scale: FAR_BELOW - 1, width: 600, height: 400 };
  const kinds = (sheet: Sheet): number[] => Array.from({ length: sheet.count }, (_, i) => sheet.marks[i * STRIDE + 5]!);
  function composed(more: Partial<Snapshot>, view: View, chosen = NOBODY): Composer {
    const stage = new Stage(MAP);
    stage.take(mirrorOf(more), 0, 'jump');
    const composer = new Composer(PALETTE);
    composer.compose(stage.scene, view, chosen, []);
    return composer;
  }
  const robots = [robot('r1', { granted: [0, 1] }), robot('r2', { granted: [1, 0] })];

  test('routes are drawn for the chosen robot alone, and for all from near', () => {
    expect(composed({ robots }, far).sheets.ways.count).toBe(0);
    expect(composed({ robots }, far, { ...NOBODY, robot: 1 }).sheets.ways.count).toBe(2);
    expect(composed({ robots }, { ...far, scale: FAR_BELOW }).sheets.ways.count).toBe(2);
  });
  test('a robot is one mark of at least three pixels, and no disc if it needs somebody', () => {
    const tiny = { ...far, scale: 1 };
    for (const look of LOOKS) {
      const { robots: sheet } = composed({ robots: [robot('r', { activity: look })] }, tiny).sheets;
      expect(sheet.count, look).toBe(1);
      expect(sheet.marks[2]! * tiny.scale, look).toBeGreaterThanOrEqual(3);
    }
    const kindOf = (activity: (typeof LOOKS)[number]) =>
      kinds(composed({ robots: [robot('r', { activity })] }, far).sheets.robots);
    expect([kindOf('driving'), kindOf('waiting'), kindOf('failed')]).toEqual([[KIND.disc], [KIND.box], [KIND.box]]);
  });
  test('cells show where several wait, also left of and below the origin', () => {
    const waiting = (id: string, x: number, y: number) => robot(id, { x, y, activity: 'waiting' });
    const many = [
      waiting('r1', -1, -1),
      waiting('r2', -2, -1),
      waiting('r3', 20, 10),
      robot('r4', { x: 20, y: 10, activity: 'driving' }),
    ];
    const { crowds } = composed({ robots: many }, far).sheets;
    expect(crowds.count).toBe(1);
    const [x, y, size] = [crowds.marks[0]!, crowds.marks[1]!, crowds.marks[2]!];
    for (const at of [
      [-1, -1],
      [-2, -1],
    ] as const) {
      expect(Math.abs(at[0] - x)).toBeLessThanOrEqual(size / 2);
      expect(Math.abs(at[1] - y)).toBeLessThanOrEqual(size / 2);
    }
    expect(composed({ robots: many }, { ...far, scale: FAR_BELOW }).sheets.crowds.count).toBe(0);
  });
});

describe('finding', () => {
  const mirror = mirrorOf({
    robots: [robot('robot-1', { job: 'j7' }), robot('robot-17'), robot('old', { state: 'gone' })],
    workers: [worker('w1', { name: 'Anna Berg' })],
    stations: [{ id: 'W1', robot: null, queue: [], served: 0 }],
    racks: [{ id: 'K17', node: 1, robot: null }],
    closures: [
      {
        id: 'c1',
        outline: [
          [0, 0],
          [1, 0],
          [1, 1],
        ],
        reason: 'Oil in aisle 3',
      },
    ],
  });
  const all = namesOn(mirror, MAP);
  const ids = (text: string): string[] => matching(all, text).map((one) => `${one.kind} ${one.id}`);

  test('goes without case and by parts, in any order', () => {
    expect(ids('ROBOT-17')).toEqual(['robot robot-17']);
    expect(ids('17')).toEqual(['robot robot-17', 'rack K17']);
    expect(ids('17 rob')).toEqual(['robot robot-17']);
    expect(ids('berg')).toEqual(['worker w1']);
    expect(ids('w1')).toEqual(['worker w1', 'station W1']);
    expect(ids('aisle oil')).toEqual(['closure c1']);
    expect(ids('s1')).toEqual(['place S1']);
    expect(ids('a1')).toEqual(['place A1']);
  });
  test('what is called exactly so comes first', () => {
    expect(ids('robot-1')[0]).toBe('robot robot-1');
  });
  test('a job is found by its id and by what the customer calls it', () => {
    expect(ids('j7')).toEqual(['job j7']);
    const job = { id: 'j90', reference: 'order 4711', state: 'waiting' } as Job;
    expect(matching([foundJob(job)], 'ORDER 4711').map((one) => one.id)).toEqual(['j90']);
  });
  test('nothing is found of what is gone, and nothing for no text', () => {
    expect(ids('old')).toEqual([]);
    expect(ids('  ')).toEqual([]);
  });
  test('one kind does not hide the others', () => {
    const many = mirrorOf({
      robots: Array.from({ length: 40 }, (_, i) => robot(`x${i}`)),
      racks: [{ id: 'K-x', node: 1, robot: null }],
    });
    const kinds = matching(namesOn(many, MAP), 'x').map((one) => one.kind);
    expect(kinds).toContain('rack');
    expect(kinds.length).toBeLessThanOrEqual(12);
  });
});

describe('addresses', () => {
  test.each([
    '',
    '#robot/robot-17',
    '#worker/picker-7',
    '#job/j12',
    '#station/W1',
    '#rack/K%2F1',
    '#tab/robots',
    '#robot/r&job/j1&tab/audit',
    '#wall',
  ])('%s says what it is made of', (hash) => {
    const { address, unknown } = addressOf(hash);
    expect(unknown).toEqual([]);
    expect(hashOf(address)).toBe(hash);
  });
  test('ids keep their own signs', () => {
    const address = { ...HOME, picked: { kind: 'rack' as const, id: 'a&b/c d' } };
    expect(addressOf(hashOf(address)).address).toEqual(address);
  });
  test('what says nothing is named', () => {
    expect(addressOf('#robot').unknown).toEqual(['robot']);
    expect(addressOf('#tab/nonsense&robot/r1')).toEqual({
      address: { ...HOME, picked: { kind: 'robot', id: 'r1' } },
      unknown: ['tab/nonsense'],
    });
    expect(addressOf('#robot/%E0%A4%A').unknown).toHaveLength(1);
    expect(addressOf('#toString/x&tab/toString').unknown).toHaveLength(2);
  });
  test('a thing is there or not', () => {
    const mirror = mirrorOf({ robots: [robot('r1'), robot('r2', { state: 'gone' })] });
    expect(isThere({ kind: 'robot', id: 'r1' }, mirror, MAP)).toBe(true);
    expect(isThere({ kind: 'robot', id: 'r2' }, mirror, MAP)).toBe(false);
    expect(isThere({ kind: 'place', id: 'S1' }, mirror, MAP)).toBe(true);
    expect(isThere({ kind: 'worker', id: 'r1' }, mirror, MAP)).toBe(false);
  });
});

describe('the share of the map', () => {
  test('stays within bounds, whatever is pressed', () => {
    expect([within(5), within(99), within(50.4)]).toEqual([LEAST, MOST, 50]);
    expect([
      afterKey(USUAL, 'ArrowUp'),
      afterKey(USUAL, 'ArrowDown'),
      afterKey(USUAL, 'Home'),
      afterKey(USUAL, 'End'),
      afterKey(USUAL, 'x'),
    ]).toEqual([USUAL - 2, USUAL + 2, LEAST, MOST, null]);
    expect(afterKey(LEAST, 'ArrowUp')).toBe(LEAST);
  });
});

describe('taking back what was done', () => {
  test('is offered for ten seconds, and longer while somebody is at it', () => {
    vi.useFakeTimers();
    const notices = new Notices();
    notices.did('robot-1 is paused.', () => Promise.resolve(null));
    vi.advanceTimersByTime(OFFERED_MS - 1);
    expect(notices.notice?.words).toBe('robot-1 is paused.');
    notices.hold();
    vi.advanceTimersByTime(10 * OFFERED_MS);
    expect(notices.notice).not.toBeNull();
    notices.resume();
    vi.advanceTimersByTime(OFFERED_MS);
    expect(notices.notice).toBeNull();
    vi.useRealTimers();
  });
  test('happens once, and says why it could not', async () => {
    const notices = new Notices();
    let undone = 0;
    notices.did('done', () => {
      undone += 1;
      return Promise.resolve(null);
    });
    await Promise.all([notices.undo(), notices.undo()]);
    expect([undone, notices.notice]).toEqual([1, null]);
    notices.did('done', () => Promise.resolve('The robot has left.'));
    await notices.undo();
    expect(notices.notice).toMatchObject({
      words: 'It could not be undone. The robot has left.',
      wrong: true,
      undo: null,
    });
  });
  test('of several robots tells those that did it the opposite', async () => {
    const told: string[] = [];
    const api = {
      resume: (id: string) => {
        told.push(id);
        return Promise.resolve({ kind: 'ok', value: null });
      },
    } as unknown as ActsApi;
    const [pause, charge] = [
      ROBOT_ACTS.find((act) => act.id === 'pause')!,
      ROBOT_ACTS.find((act) => act.id === 'charge')!,
    ];
    expect(await undoOf(pause, api, ['r1', 'r2'])!()).toBeNull();
    expect(told).toEqual(['r1', 'r2']);
    expect(undoOf(charge, api, ['r1'])).toBeNull();
    expect(undoOf(pause, api, [])).toBeNull();
  });
  test('of an opened area closes it with the same reason and end', () => {
    const outline: [number, number][] = [
      [0, 0],
      [1, 0],
      [1, 1],
    ];
    expect(
      closedAgain({
        id: 'c1',
        outline,
        reason: 'oil',
        state: 'closed',
        from: '2031-01-31T12:00:00Z',
        until: null,
        binds: 'both',
      }),
    ).toEqual({ outline, reason: 'oil', binds: 'both' });
    expect(
      closedAgain({
        id: 'c1',
        outline,
        reason: 'oil',
        state: 'announced',
        from: '2031-01-31T12:00:00Z',
        until: '2031-01-31T13:00:00Z',
      }),
    ).toEqual({ outline, reason: 'oil', binds: 'robots', from: '2031-01-31T12:00:00Z', until: '2031-01-31T13:00:00Z' });
  });
});

describe('names and unusual waiting', () => {
  test('a name stays on its side of a mark as long as there is room there', () => {
    const words = new Words();
    const labels = new Labels(words);
    const view: View = { x: 0, y: 0, scale: 10, width: 400, height: 400 };
    const side = (blocked: 'below' | 'above' | 'none'): number => {
      labels.begin(view);
      if (blocked !== 'none') labels.put('in the way', 0, 0, blocked === 'below' ? 20 : -20, 12);
      labels.beside('r1', 0, 0, 20, 12);
      return words.list[words.count - 1]!.below;
    };
    expect([side('none'), side('below'), side('none'), side('above'), side('none')]).toEqual([20, -20, -20, 20, 20]);
  });
  test('waiting is unusual where a place has more than its usual share of it, however much is going on', () => {
    const page = (...amounts: number[]) => ({
      kind: 'waiting' as const,
      from: '',
      to: '',
      size: 1,
      cells: amounts.map((amount, x) => ({ x, y: 0, node: null, amount })),
    });
    const found = (now: number[], before: number[]) =>
      unusual(page(...now), page(...before))?.cells.map((c) => [c.x, c.amount]);
    expect(found([1000, 100], [5000, 500]), 'as always').toEqual([]);
    expect(found([10_000, 1000], [500, 50]), 'ten times as much everywhere').toEqual([]);
    expect(found([1000, 500], [5000, 500])).toEqual([[1, expect.closeTo(363.6, 1)]]);
    expect(found([1000, 20], [5000, 0]), 'too little to look at').toEqual([]);
    expect(found([1000, 500], [10, 10]), 'too little is known').toBeUndefined();
  });
});
