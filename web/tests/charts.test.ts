// What is counted over time, as it is drawn: scales, gaps, encounters, maps of heat, chances, files of experiments.
import { describe, expect, test } from 'vitest';
import { areas, bands, Chances, lostShare, SPAN_S } from '../src/people/chances';
import { readExperiment, reach } from '../src/charts/experiment';
import { logTicks, scaleOf, ticks, timeTicks } from '../src/charts/scale';
import { CHARTS, gaps, gridOf, PICKING, picks, runs, valuesOf } from '../src/charts/series';
import { replayOf, sorted } from '../src/encounters/encounters';
import { placeNear } from '../src/floor/scene/places';
import { feedWords } from '../src/people/feedwords';
import { sequenceLines } from '../src/people/sequence';
import { forecastsOf } from '../src/floor/paint/heat';
import { borders, cellsOf, heatOfPlaces, words } from '../src/floor/paint/heatmap';
import { EMPTY, reduce, type Mirror } from '../src/wire/mirror';
import type { Bucket, Encounter, Episode, HistoryPage, WorkerDetail } from '../src/wire';
import { snapshot, worker } from './samples';

describe('scales', () => {
  test('marks are round and reach the largest value', () => {
    expect(ticks(7)).toEqual([0, 2.5, 5, 7.5]);
    expect(ticks(0.3)).toEqual([0, 0.1, 0.2, 0.3]);
    expect(ticks(1_200)).toEqual([0, 500, 1_000, 1_500]);
    for (const nothing of [0, -Infinity, NaN]) expect(ticks(nothing)).toEqual([0, 1]);
  });
  test('logarithmic marks are powers of ten around all of it', () => {
    expect(logTicks(30, 2_500)).toEqual([10, 100, 1_000, 10_000]);
    expect(logTicks(100, 100)).toEqual([100, 1_000]);
    expect(logTicks(Infinity, 0)).toEqual([1, 10]);
    const scale = scaleOf([10, 100, 1_000], 'log');
    expect([10, 1_000, 1].map(scale)).toEqual([0, 1, 0]);
    expect(scale(100)).toBeCloseTo(0.5);
  });
  test('times below an axis are whole minutes or hours', () => {
    const at = Date.parse('2027-01-31T12:03:20Z');
    expect(timeTicks(at, at + 900_000, 4, 0).map((t) => new Date(t).toISOString().slice(11, 16))).toEqual([
      '12:05',
      '12:10',
      '12:15',
    ]);
    expect(timeTicks(at, at + 86_400_000, 4, 3_600_000).map((t) => new Date(t).toISOString().slice(11, 16))).toEqual([
      '17:00',
      '23:00',
      '05:00',
      '11:00',
    ]);
  });
});

const bucket = (second: number, more: Partial<Bucket> = {}): Bucket => ({
  at: new Date(Date.parse('2027-01-31T12:00:00Z') + 1_000 * second).toISOString(),
  covered_s: 30,
  robot_deliveries: 0,
  human_deliveries: 0,
  encounters: 0,
  interruptions: 0,
  replans: 0,
  worker_s: 0,
  waiting_s: 0,
  lines: 0,
  wrong_reaches: 0,
  idle_s: 0,
  plan_us_p50: null,
  plan_us_p95: null,
  plan_us_max: null,
  step_us_max: null,
  ...more,
});
const page = (buckets: Bucket[]): HistoryPage => ({
  from: '2027-01-31T11:00:00Z',
  to: '2027-01-31T12:05:00.000001Z',
  step_s: 30,
  started: '2027-01-31T12:00:00Z',
  arm: 'giveway',
  buckets,
});

describe('series', () => {
  test('what is missing stays missing, and what was not seen for long enough has no rate', () => {
    const grid = gridOf(
      page([
        bucket(0, { robot_deliveries: 2 }),
        bucket(30, { robot_deliveries: 1 }),
        bucket(120),
        bucket(270, { covered_s: 1 }),
      ]),
      300,
    );
    expect(grid.at.length).toBe(10);
    const robots = valuesOf(CHARTS[0]!.lines[0]!, grid);
    expect(robots).toEqual([240, 120, null, null, 0, null, null, null, null, null]);
    expect(runs(robots)).toEqual([
      [0, 1],
      [4, 4],
    ]);
    expect(gaps(grid)).toEqual([
      [0.2, 0.4],
      [0.5, 0.9],
    ]);
  });
  test('charts of picking are of floors with picking stations: lines and mistakes an hour, mean idle stations', () => {
    const page = (more: Partial<Bucket>): HistoryPage => ({
      from: '2027-01-31T12:00:00Z',
      to: '2027-01-31T12:01:00Z',
      step_s: 30,
      started: '',
      arm: 'giveway',
      buckets: [bucket(0, more)],
    });
    expect(picks(gridOf(page({}), 60))).toBe(false);
    const grid = gridOf(page({ lines: 3, wrong_reaches: 1, idle_s: 45 }), 60);
    expect(picks(grid)).toBe(true);
    const [lines, idle] = PICKING.map((id) => CHARTS.find((chart) => chart.id === id)!);
    expect(lines!.lines.map((line) => valuesOf(line, grid)[0])).toEqual([360, 120]);
    expect(valuesOf(idle!.lines[0]!, grid)[0]).toBe(1.5);
  });
  test('encounters are counted by the time of workers, not of the clock', () => {
    const grid = gridOf(page([bucket(0, { encounters: 2, worker_s: 60 }), bucket(30, { encounters: 0 })]), 300);
    expect(valuesOf(CHARTS[1]!.lines[0]!, grid).slice(0, 2)).toEqual([2, null]);
  });
});

const encounter = (id: number, more: Partial<Encounter> = {}): Encounter => ({
  id,
  worker: 'w1',
  robot: 'robot-1',
  began: new Date(Date.parse('2027-01-31T12:00:00Z') + 1_000 * id).toISOString(),
  lasted_s: 1.5,
  x: 1,
  y: 2,
  region: 1,
  radius: 1.4,
  closest: 0.9,
  robot_speed: 0.5,
  worker_speed: 1.2,
  reaction: 'stopped',
  delay_s: 2,
  ...more,
});

describe('encounters', () => {
  test('they are sorted by any figure, newest first among equals', () => {
    const all = [encounter(3), encounter(2, { closest: 0.4 }), encounter(1)];
    expect(sorted(all, 'began', 'first').map((e) => e.id)).toEqual([3, 2, 1]);
    expect(sorted(all, 'closest', 'last').map((e) => e.id)).toEqual([2, 3, 1]);
    expect(sorted(all, 'closest', 'first').map((e) => e.id)).toEqual([3, 1, 2]);
  });
  test('a replay begins ten seconds before and ends ten seconds after, in the seconds of the feed', () => {
    expect(replayOf(encounter(60), '2027-01-31T12:00:00Z')).toEqual({
      from: 50,
      to: 72,
      href: '#replay?from=50&to=72',
    });
    expect(replayOf(encounter(5), '2027-01-31T12:00:00Z')?.from).toBe(0);
    expect(replayOf(encounter(5), '2027-01-31T12:00:10Z')).toBeNull();
  });
  test('a place is the nearest node', () => {
    const nodes = [
      { id: 'A', x: 0, y: 0, kind: 'aisle' as const },
      { id: 'B', x: 2, y: 2, kind: 'aisle' as const },
    ];
    expect([placeNear(nodes, 1.5, 2), placeNear([], 0, 0)]).toEqual(['B', null]);
  });
});

describe('maps of heat', () => {
  test('places of encounters are counted by square metre', () => {
    const cells = heatOfPlaces([
      [1.2, 3.9],
      [1.8, 3.1],
      [-0.2, 0.4],
    ]);
    expect(cells).toEqual([
      { x: 1.5, y: 3.5, node: null, amount: 2 },
      { x: -0.5, y: 0.5, node: null, amount: 1 },
    ]);
  });
  test('classes have round borders, and the most is in the last one', () => {
    expect(borders('waiting', 75)).toEqual([2, 5, 10, 30, 60]);
    expect(borders('encounters', 1)).toEqual([1, 2, 3, 4, 5]);
    expect(words('waiting', [2, 5, 10, 30, 60], 4)).toBe('1 min or more');
    expect(words('waiting', [2, 5, 10, 30, 60], 3)).toBe('30 s to 1 min');
    expect(words('encounters', [1, 2, 3, 4, 5], 0)).toBe('1');
    expect(words('encounters', [2, 5, 10, 20, 50], 0)).toBe('2 to 4');
  });
  test('a place below the least border is not drawn', () => {
    const cells = [75, 3, 1].map((amount, x) => ({ x, y: 0, node: null, amount }));
    const drawn = cellsOf({ kind: 'waiting', from: '', to: '', size: 1, cells });
    expect(drawn.cells.map((c) => [c.x, c.level])).toEqual([
      [0, 4],
      [1, 0],
    ]);
  });
});

const seen = (t: number, more: object): Mirror => {
  const reduced = reduce(EMPTY, snapshot({ time_s: t, workers: [worker('w1', more)] }));
  if (reduced.kind === 'gap') throw new Error('a snapshot fits always');
  return reduced.mirror;
};

describe('chances', () => {
  test('there is one sample a second for two minutes, and bands add up to one', () => {
    const chances = new Chances();
    for (let t = 0; t < 200; t += 0.25) {
      const p = t < 150 ? 0.5 : 0.1;
      chances.note(
        seen(t, {
          goals: [
            { x: 1, y: 2, p },
            { x: 3, y: 4, p: 0.2 },
          ],
          elsewhere: 0.1,
          undecided: 0.7 - p,
        }),
      );
    }
    const samples = chances.of('w1');
    expect(samples.length).toBe(SPAN_S);
    const all = bands(samples, 1);
    expect(all.map((b) => b.kind)).toEqual(['goal', 'others', 'elsewhere', 'undecided']);
    for (const i of [0, 60, 119]) expect(all.reduce((sum, b) => sum + b.values[i]!, 0)).toBeCloseTo(1);
    expect(all[0]!.values[0]).toBe(0.5);
    expect(all[0]!.values.at(-1)).toBe(0.1);
    expect(areas(all)[3]!.outlines[0]!.some(([, y]) => y > 0.99)).toBe(true);
  });
  test('whoever was away leaves a gap, whoever was not seen is counted, and a clock that runs back begins anew', () => {
    const chances = new Chances();
    for (let t = 0; t < 10; t += 1) chances.note(seen(t, { presence: t < 5 ? 'tracked' : t < 7 ? 'absent' : 'lost' }));
    expect(lostShare(chances.of('w1'))).toBeCloseTo(3 / 8);
    expect(areas(bands(chances.of('w1'))).at(-1)!.outlines.length).toBe(2);
    chances.note(seen(1, {}));
    expect(chances.of('w1').length).toBe(1);
    expect(lostShare([])).toBeNull();
  });
  test('it is known since when somebody is told the same', () => {
    const chances = new Chances();
    for (const [t, state] of [
      [1, 'following'],
      [2.5, 'deviating'],
      [9, 'deviating'],
    ] as const)
      chances.note(seen(t, { state }));
    expect(chances.since('w1')).toBe(2.5);
  });
});

describe('the feed of somebody in words', () => {
  const look = (taken: number, more: Partial<WorkerDetail> = {}): WorkerDetail => ({
    id: 'w1',
    name: 'Ana',
    connected: true,
    clock_error_ms: 3.2,
    age_s: 0.05,
    accuracy: 0.1,
    feed: { taken, late: 0, jumps: 0, absurd: 0 },
    sequence: [],
    ...more,
  });
  test('a good feed is said to be well in all that is known', () => {
    const all = feedWords({ before: look(100), now: look(140), apart_s: 2 }, 0);
    expect(all.map((w) => w.text)).toEqual([
      '20 poses a second',
      '0.05 s old',
      '± 0.10 m',
      'accurate to ± 3.2 ms',
      'none of 140',
      '0 % of the last two minutes',
    ]);
    expect(all.every((w) => w.well)).toBe(true);
  });
  test('what is wrong is marked', () => {
    const bad = look(101, {
      age_s: 14,
      accuracy: 0.8,
      clock_error_ms: 400,
      feed: { taken: 101, late: 30, jumps: 5, absurd: 0 },
    });
    const all = feedWords({ before: look(100), now: bad, apart_s: 2 }, 0.4);
    expect(all.filter((w) => w.well)).toEqual([]);
    expect(all.find((w) => w.name === 'Refused')?.text).toBe('26 % of 136: 30 late, 5 jumps');
  });
});

describe('the most probable sequence of somebody', () => {
  const places = [
    { id: 'R1', x: 0, y: 0, kind: 'storage' as const },
    { id: 'R2', x: 5, y: 0, kind: 'storage' as const },
  ];
  test('the newest comes first, with the place it leads to', () => {
    const all: Episode[] = [
      { state: 'undecided', x: null, y: null, since: '2026-01-01T10:00:00Z' },
      { state: 'goal', x: 0.1, y: 0, since: '2026-01-01T10:00:05Z' },
      { state: 'goal', x: 5, y: 0.2, since: '2026-01-01T10:00:09Z' },
      { state: 'elsewhere', x: null, y: null, since: '2026-01-01T10:00:12Z' },
    ];
    expect(sequenceLines(all, places).map((l) => l.text)).toEqual(['elsewhere', 'to R2', 'to R1', 'undecided']);
    expect(sequenceLines(all, places, 2).map((l) => l.text)).toEqual(['elsewhere', 'to R2']);
    expect(sequenceLines(all, places)[0]!.since).toMatch(/\d\d:\d\d:12/);
  });
});

describe('forecasts', () => {
  const part = { p: 0.5, x: 1, y: 2, sx: 2, sy: 1, tilt: 0.5 };
  const forecasts = [
    {
      worker: 'w1',
      parts: [
        { ...part, after_s: 1 },
        { ...part, after_s: 4 },
      ],
    },
  ];
  test('one moment ahead is drawn, or all of them with the soonest on top', () => {
    expect(forecastsOf(forecasts, 4)).toEqual([
      { worker: 'w1', parts: [{ x: 1, y: 2, sxx: 4, sxy: 1, syy: 1, weight: 0.5 }] },
    ]);
    expect(forecastsOf(forecasts, 'all')[0]!.parts.length).toBe(2);
    expect(forecastsOf(forecasts, 'none')).toEqual([]);
  });
  test('thin patches carry them as numbers, and rows as they are', () => {
    const mirror = seen(1, {});
    const thin = reduce(mirror, { type: 'patch', base: 1, version: 2, ahead: [[0, 1, 50, 100, 200, 200, 100, 50]] });
    expect(thin.kind === 'gap' ? null : thin.mirror.forecasts).toEqual([
      { worker: 'w1', parts: [{ ...part, after_s: 1 }] },
    ]);
    const plain = reduce(mirror, { type: 'patch', base: 1, version: 2, forecasts });
    expect(plain.kind === 'gap' ? null : plain.mirror.forecasts).toBe(forecasts);
    expect(
      thin.kind === 'gap'
        ? null
        : (reduce(thin.mirror, { type: 'patch', base: 2, version: 3 }) as { mirror: Mirror }).mirror.forecasts.length,
    ).toBe(1);
  });
});

describe('files of experiments', () => {
  const file = JSON.stringify({
    scenarios: [
      {
        workers: 5,
        arms: {
          phir: { total_deliveries: { mean: 80, sd: 3 } },
          giveway: { total_deliveries: { mean: 100, sd: null } },
        },
        paired: { 'giveway-phir': { total_deliveries: { mean: 20, ci95: [15, 25] } } },
      },
    ],
    law_violations: 0,
  });
  test('arms and pairs are read as they were written', () => {
    const read = readExperiment(file);
    if (read.kind === 'wrong') throw new Error(read.why);
    expect(read.figures).toEqual(['total_deliveries']);
    expect(read.comparisons[0]!.arms.map(([arm, f]) => [arm, f['total_deliveries']!.mean])).toEqual([
      ['phir', 80],
      ['giveway', 100],
    ]);
    expect(read.comparisons[0]!.paired[0]![1]['total_deliveries']!.ci95).toEqual([15, 25]);
  });
  test('anything else is refused with a reason', () => {
    for (const other of ['', '{}', '[]', '{"scenarios": []}', '{"scenarios": [3]}'])
      expect(readExperiment(other).kind, other).toBe('wrong');
  });
  test('an axis holds all of it, and zero', () => {
    const [low, high] = reach([-2, 5]);
    expect(low < -2 && high > 5).toBe(true);
    expect(reach([3, 5])[0]).toBe(0);
  });
});
