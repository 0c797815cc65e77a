// What panels show of the present and of the past, in one type each.
import { describe, expect, test, vi } from 'vitest';
import { jobsThen, lateFor_s, latestJobs, NEWEST, turnedJobs } from '../src/jobs/shown';
import { poll } from '../src/parts';
import { whyOf } from '../src/why';
import { EMPTY, reduce, type Job, type Mirror } from '../src/wire';
import { robot, snapshot } from './samples';

const job = (id: string, more: Partial<Job> = {}): Job => ({
  id,
  kind: 'deliver',
  rack: 'K1',
  station: 'W1',
  node: null,
  robot: null,
  priority: 3,
  deadline: null,
  state: 'waiting',
  why: null,
  created: '',
  updated: '',
  ...more,
});
const mirrorOf = (more: Parameters<typeof snapshot>[0]): Mirror => {
  const reduced = reduce(EMPTY, snapshot(more));
  if (reduced.kind === 'gap') throw new Error('a snapshot never leaves a gap');
  return reduced.mirror;
};
const texts = (table: { lines: readonly { cells: readonly { text: string }[] }[] }) =>
  table.lines.map((line) => line.cells.map((c) => c.text));

describe('jobs', () => {
  test('those submitted here come first, once, with what can be done about them', () => {
    const own = [job('j2')];
    const {
      tables: [table],
    } = latestJobs({ own, items: [job('j1', { robot: 'r1', why: { text: 'late' } }), ...own], state: 'any', part: '' });
    expect(table!.lines.map((line) => [line.id, line.mine, line.job?.id])).toEqual([
      ['j2', true, 'j2'],
      ['j1', false, 'j1'],
    ]);
    expect(table!.lines[1]!.cells[3]).toEqual({ text: 'r1', kind: 'robot' });
    expect(table!.lines[1]!.cells[4]).toEqual({ text: 'waiting', more: 'late' });
  });
  test('are sorted as one asks, and what has no value comes last', () => {
    const items = [
      job('j10', { priority: 9, deadline: '2027-01-31T12:00:00Z' }),
      job('j9', { priority: 0 }),
      job('j2', { priority: 3, deadline: '2027-01-31T11:00:00Z' }),
    ];
    const ids = (order = NEWEST) =>
      latestJobs({ own: [], items, state: 'any', part: '' }, null, order).tables[0]!.lines.map((line) => line.id);
    expect(ids()).toEqual(['j10', 'j9', 'j2']);
    expect(ids(turnedJobs(NEWEST, 'id'))).toEqual(['j2', 'j9', 'j10']);
    expect(ids(turnedJobs(NEWEST, 'priority'))).toEqual(['j10', 'j2', 'j9']);
    expect(ids(turnedJobs(NEWEST, 'deadline'))).toEqual(['j2', 'j10', 'j9']);
    expect(ids(turnedJobs(turnedJobs(NEWEST, 'deadline'), 'deadline'))).toEqual(['j10', 'j2', 'j9']);
    expect(turnedJobs(turnedJobs(NEWEST, 'id'), 'id')).toBe(NEWEST);
  });
  test('a reason that begins with the state stands for both', () => {
    const state = (text: string) =>
      latestJobs({ own: [], items: [job('j1', { why: { text } })], state: 'any', part: '' }).tables[0]!.lines[0]!
        .cells[4]!;
    expect(state('waits for j2 to be over')).toEqual({ text: 'waits for j2 to be over' });
    expect(state('no robot is free')).toEqual({ text: 'waiting', more: 'no robot is free' });
  });

  test('one that is late says so, while it waits and when it is done', () => {
    const at = (time: string) => Date.parse(`2027-01-31T${time}Z`);
    const late = job('j1', { deadline: '2027-01-31T12:00:00Z' });
    expect([at('11:59:00'), at('12:05:00'), null].map((now) => lateFor_s(late, now))).toEqual([null, 300, null]);
    expect(lateFor_s({ ...late, state: 'done', updated: '2027-01-31T12:01:00Z' }, at('15:00:00'))).toBe(60);
    expect(lateFor_s({ ...late, state: 'cancelled' }, at('15:00:00'))).toBeNull();
    const cell = latestJobs({ own: [], items: [late], state: 'any', part: '' }, at('12:05:00')).tables[0]!.lines[0]!
      .cells[6];
    expect(cell).toEqual({ text: 'late by 5 min', kind: 'late' });
  });
  test('every line has a cell for each column, of now and of then', () => {
    const lists = [
      { at: 0, text: JSON.stringify([{ id: 'j9', kind: 'deliver', what: ['K9', 'W1'], priority: 0, submitted_s: 1 }]) },
    ];
    const mirror = mirrorOf({
      robots: [robot('r1', { job: 'j1' })],
      jobs: { waiting: 1, active: 1, done: 0, cancelled: 0, failed: 0 },
    });
    const recording = { start: null, lists: () => lists } as never;
    const then = jobsThen({ recording, t: 5, waiting: false }, mirror);
    for (const table of [
      ...then.tables,
      ...latestJobs({ own: [job('j1')], items: [], state: 'any', part: '' }).tables,
    ]) {
      expect(table.lines.length, table.kind).toBe(1);
      for (const line of table.lines) expect(line.cells.length, table.kind).toBe(table.columns.length);
    }
    expect(texts(then.tables[1]!)).toEqual([['deliver', 'K9 → W1', '0', '00:00:01', '–']]);
    expect(then.foot).toBeNull();
  });
  test('of then there is nothing to act on, and what the list lacks is said', () => {
    const mirror = mirrorOf({ jobs: { waiting: 4, active: 0, done: 0, cancelled: 0, failed: 0 } });
    const recording = (lists: unknown) => ({ start: null, lists: () => lists }) as never;
    const then = jobsThen({ recording: recording([{ at: 0, text: '[]' }]), t: 5, waiting: false }, mirror);
    expect(then.tables.flatMap((table) => table.lines.map((line) => line.job)).filter(Boolean)).toEqual([]);
    expect(then.foot).toBe('4 were submitted after the list was made.');
    expect(jobsThen({ recording: recording(null), t: 5, waiting: true }, mirror).foot).toBe('Loading…');
    expect(jobsThen({ recording: recording(null), t: 5, waiting: false }, mirror).foot).toBe(
      'An older version recorded only their number.',
    );
  });
});

describe('why', () => {
  test('of the past the pictures answer, from the one that waits to the root', () => {
    const mirror = mirrorOf({
      robots: [robot('r1', { why: 'waiting for A, held by r2' }), robot('r2', { doing: 'lifting' })],
    });
    const shown = whyOf({ tense: 'then', replay: null as never }, 'robot', 'r1', () => mirror);
    expect(shown.label).toBe('Why it waited');
    expect(shown.chain.map((step) => step.who)).toEqual(['r1', 'r2']);
    // One link alone says no more than the robot's own words.
    expect(whyOf({ tense: 'then', replay: null as never }, 'robot', 'r2', () => mirror).chain).toEqual([]);
  });
});

describe('asking again', () => {
  test('goes on until it is ended, and hears of that', async () => {
    vi.useFakeTimers();
    const overs: boolean[] = [];
    let times = 0;
    const end = poll(async (over) => {
      times += 1;
      await new Promise((done) => {
        setTimeout(done, 50);
      });
      overs.push(over());
      return 100;
    });
    await vi.advanceTimersByTimeAsync(320);
    // The third answer is still under way.
    expect([times, overs]).toEqual([3, [false, false]]);
    end();
    await vi.advanceTimersByTimeAsync(1_000);
    expect([times, overs]).toEqual([3, [false, false, true]]);
    vi.useRealTimers();
  });
  test('null ends it', async () => {
    vi.useFakeTimers();
    let times = 0;
    poll(() => {
      times += 1;
      return Promise.resolve(null);
    });
    await vi.advanceTimersByTimeAsync(1_000);
    expect(times).toBe(1);
    vi.useRealTimers();
  });
});
