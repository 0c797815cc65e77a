// What replays show beside the floor: charts from running sums, jobs that waited, encounters from bookmarks.
import { describe, expect, test } from 'vitest';
import { gaps, valuesOf } from '../src/charts/series';
import { CHARTS_THEN, gridOfSums, stepOf } from '../src/charts/sums';
import { FileRecording, ServerRecording } from '../src/replay/recording';
import { readReel } from '../src/replay/frames';
import { Replay } from '../src/replay/replay.svelte';
import { metIn } from '../src/encounters/bookmarked';
import { waitedAt } from '../src/jobs/waited';
import { PastTimelines, timelinesOf } from '../src/timelines/shown';
import type { Api, FloorMap, Mark, Sum } from '../src/wire';
import { robot, snapshot } from './samples';

const map: FloorMap = {
  name: 'm',
  bounds: [0, 0, 9, 9],
  footprint_m: 1,
  nodes: [],
  lanes: [],
  stations: [],
  racks: [],
  obstacles: [],
  walkable: [],
};
const header = JSON.stringify({ reel: 1, name: 'lab', start: null, map });
const sum = (at_s: number, more: Partial<Sum> = {}): Sum => ({
  at_s,
  covered_s: at_s,
  robot_deliveries: 0,
  human_deliveries: 0,
  encounters: 0,
  interruptions: 0,
  replans: 0,
  waiting_s: 0,
  worker_s: 0,
  plan_us_p50: 0,
  plan_us_p99: 0,
  ...more,
});
const chart = (id: string) => CHARTS_THEN.find((c) => c.id === id)!;

describe('charts of the past', () => {
  test('there are about a hundred steps at most', () => {
    expect([60, 600, 3_600, 7_200, 36_000, 86_400, 604_800].map(stepOf)).toEqual([10, 30, 60, 60, 300, 600, 3_600]);
  });
  test('differences of sums are rates, shared out where sums lie between the steps', () => {
    const sums = [0, 10, 20, 30].map((at) =>
      sum(at + 5, { covered_s: at, robot_deliveries: at / 10, waiting_s: 2 * at, worker_s: at }),
    );
    const grid = gridOfSums(sums, 0, 40, null);
    expect(grid.at).toEqual([0, 10_000, 20_000, 30_000]);
    expect(grid.ofDay).toBe(false);
    const robots = valuesOf(chart('deliveries').lines[0]!, grid);
    robots.forEach((value) => expect(value).toBeCloseTo(360));
    expect(valuesOf(chart('waiting').lines[0]!, grid)).toEqual([2, 2, 2, 2]);
    expect(grid.buckets.map((b) => b!.covered_s)).toEqual([5, 10, 10, 5]);
    expect(gridOfSums(sums, 12, 40, 1_000).from).toBe(1_010_000);
  });
  test('a restart, or a time without pictures, is a gap and no rate below zero', () => {
    const sums = [
      sum(0, { robot_deliveries: 5 }),
      sum(10, { robot_deliveries: 6 }),
      // Another run, whose seconds begin anew; then nothing for a minute; then a count that was lost.
      sum(20, { covered_s: 0, robot_deliveries: 6 }),
      sum(30, { covered_s: 10, robot_deliveries: 7 }),
      sum(90, { covered_s: 10, robot_deliveries: 9 }),
      sum(100, { covered_s: 20, robot_deliveries: 9 }),
      sum(110, { covered_s: 30, robot_deliveries: 0 }),
    ];
    const grid = gridOfSums(sums, 0, 110, 0);
    const robots = valuesOf(chart('deliveries').lines[0]!, grid);
    expect(robots).toEqual([360, null, 360, null, null, null, null, null, null, 0, null]);
    expect(gaps(grid)).toEqual([
      [1 / 11, 2 / 11],
      [3 / 11, 9 / 11],
    ]);
    expect(gridOfSums([], 0, 20, null).buckets).toEqual([null, null]);
  });
  test('searches have a median and 99 %, and none that nobody measured', () => {
    const { lines } = chart('plans');
    expect(lines.map((l) => l.id)).toEqual(['median', '99 %']);
    const grid = gridOfSums([sum(0), sum(10, { plan_us_p50: 40, plan_us_p99: 900 }), sum(20)], 0, 20, null);
    expect(lines.map((line) => valuesOf(line, grid))).toEqual([
      [40, null],
      [900, null],
    ]);
  });
});

const met = (at_s: number, more: Partial<Mark> = {}): Mark => ({
  at_s,
  kind: 'encounter',
  words: '',
  who: ['w1', 'robot-1'],
  place: [1, 2],
  encounter: {
    worker: 'w1',
    robot: 'robot-1',
    ended_s: at_s + 1.5,
    x: 1,
    y: 2,
    radius: 1.4,
    closest: 0.6,
    robot_speed: 0.5,
    worker_speed: 1.2,
    reaction: 'stopped',
    delay_s: 2,
  },
  ...more,
});
/** A reel of a minute in which a job is taken every ten seconds. */
function lines(): string[] {
  const all = [header];
  for (let i = 0; i <= 6; i++) {
    const at = 10 * i;
    const robots = [robot('r1', { job: i > 0 ? `j${i}` : null })];
    const jobs = [1, 2, 3, 4, 5, 6]
      .filter((j) => j > i)
      .map((j) => ({ id: `j${j}`, kind: 'deliver', what: [`R${j}`, 'S1'], priority: 0, submitted_s: 0 }));
    all.push(`{"at":${at},"key":${JSON.stringify(snapshot({ version: i + 1, time_s: at, robots }))}}`);
    all.push(`{"at":${at},"sum":${JSON.stringify({ ...sum(at), at_s: undefined, robot_deliveries: i })}}`);
    all.push(`{"at":${at - 0.5},"waiting":${JSON.stringify(jobs)}}`);
  }
  all.push(`{"at":12,"mark":${JSON.stringify(met(12))}}`, '{"at":60,"sum":{"cut":', '{"at":70,"comet":{}}');
  return all;
}

describe('what a reel has beside pictures', () => {
  test('sums have their time, and what cannot be read or is not known is passed over', async () => {
    const recording = new FileRecording(readReel(lines()));
    const sums = await recording.sums();
    expect(sums.map((s) => [s.at_s, s.robot_deliveries])).toEqual([0, 1, 2, 3, 4, 5, 6].map((i) => [10 * i, i]));
    expect(recording.spans).toEqual([0, 10, 20, 30, 40, 50, 60].map((t) => ({ from_s: t, to_s: t })));
  });
  test('the jobs that waited are those of the last list by then', () => {
    const { lists } = readReel(lines());
    const at = (t: number) => {
      const found = waitedAt(lists, t);
      return [found?.at, found?.jobs.map((j) => j.id).join()];
    };
    expect(at(25)).toEqual([19.5, 'j3,j4,j5,j6']);
    expect(at(19.5)[0]).toBe(19.5);
    expect(at(-5)[0]).toBe(-0.5);
    expect(waitedAt(lists, 25)).toBe(waitedAt(lists, 26));
    expect(waitedAt([], 25)).toBeNull();
  });
  test('a reel of an older version has neither, and says so by having none', async () => {
    const recording = new FileRecording(
      readReel(lines().filter((line) => !/^\{"at":[-\d.]+,"(sum|waiting)":/.test(line))),
    );
    expect([recording.lists().length, (await recording.sums()).length]).toEqual([0, 0]);
  });
  test('encounters are listed as live ones are, and those without details are counted', () => {
    const bare: Mark = { at_s: 20, kind: 'encounter', words: '', who: [], place: null };
    const marks = [met(12), bare, met(30), met(40, { kind: 'alarm' })];
    const found = metIn(marks, 1_000);
    expect(found.items.map((e) => [e.id, e.began, e.lasted_s, e.reaction])).toEqual([
      [0, '1970-01-01T00:16:52.000Z', 1.5, 'stopped'],
      [1, '1970-01-01T00:17:10.000Z', 1.5, 'stopped'],
    ]);
    expect(found.marks[1]).toBe(marks[2]);
    expect(found.bare).toBe(1);
  });
  test('the past of a server has lists with its pictures, and is asked for its sums', async () => {
    const asked: unknown[] = [];
    const api = {
      past: async () => ({
        kind: 'ok',
        value: {
          start: '2027-01-31T12:00:00Z',
          now_s: 60,
          recording: false,
          spans: [{ from_s: 0, to_s: 60 }],
          bookmarks: [met(12)],
        },
      }),
      reel: async () => ({ kind: 'ok', value: new Blob([`${lines().join('\n')}\n`]) }),
      figures: async (...words: unknown[]) => {
        asked.push(words);
        return words[0] === 0 ? { kind: 'ok', value: { start: null, sums: [sum(0)] } } : { kind: 'unreachable' };
      },
    } as unknown as Api;
    const recording = (await ServerRecording.open(api, () => 0)) as ServerRecording;
    expect(recording.lists(30)).toBeNull();
    recording.frames(30);
    await new Promise((done) => setTimeout(done, 20));
    expect(waitedAt(recording.lists(30)!, 30)?.at).toBe(29.5);
    expect(await recording.sums(0, 600, 10)).toEqual([sum(0)]);
    expect(typeof (await recording.sums(1, 600, 10))).toBe('string');
    expect(asked).toEqual([
      [0, 600, 10],
      [1, 600, 10],
    ]);
  });
  test('an area that is too large is refused once, and not asked for again', async () => {
    const refused = (status: number) =>
      ({ kind: 'refused', problem: { title: 'No', status, detail: 'more than 200: choose a smaller area' } }) as const;
    const answers = [refused(422), refused(503)];
    const timelines = () => Promise.resolve(answers.shift()!);
    const shown = timelinesOf({ tense: 'now', api: { timelines } }, map);
    expect(await shown.ask([0, 0, 9, 9], 60)).toMatchObject({
      wrong: 'more than 200: choose a smaller area',
      pause_ms: null,
    });
    expect((await shown.ask([0, 0, 9, 9], 60)).pause_ms).toBeGreaterThan(0);
  });
  test('timelines are worked out again only where the moment or the area changed', () => {
    const replay = new Replay(new FileRecording(readReel(lines())), 10, null, () => {});
    const past = new PastTimelines(replay);
    const first = past.around(map, [0, 0, 5, 5], 60);
    expect(past.around(map, [0, 0, 5, 5], 60)).toBe(first);
    expect(past.around(map, [0, 0, 5, 6], 60)).not.toBe(first);
    const here = past.around(map, [0, 0, 5, 5], 60);
    replay.seek(30);
    expect(past.around(map, [0, 0, 5, 5], 60)).not.toBe(here);
  });
});
