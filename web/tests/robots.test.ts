// Robots in counts and in their table, what several of them are told, and the history of one.
import { describe, expect, test } from 'vitest';
import { ROBOT_ACTS, tellAll, type ActsApi } from '../src/robots/acts';
import { countsOf } from '../src/robots/counts';
import { eventWords, RobotLife } from '../src/robots/life.svelte';
import { linesOf, sortedBy, turned, wantedOf } from '../src/robots/table';
import { activityOf, ageOf, EMPTY, reduce, type Alarm, type Mirror, type RobotEvent } from '../src/wire';
import { robot, snapshot } from './samples';

const at = (s: number): string => new Date(s * 1_000).toISOString();
const alarm: Alarm = {
  id: 'al1',
  text: 'robot-10 cannot drive',
  since_s: 1,
  subject_kind: 'robot',
  subject: 'robot-10',
  severity: 'warning',
};
const reduced = reduce(
  EMPTY,
  snapshot({
    time_s: 100,
    alarms: [alarm],
    robots: [
      robot('robot-10', { activity: 'failed', since: at(40), battery: 0.1, granted: [1], why: 'cannot drive' }),
      robot('robot-2', {
        activity: 'waiting',
        since: at(90),
        job: 'j7',
        granted: [0],
        why: { code: 'waits_for', args: { place: 'R33', robot: 'robot-10' }, text: 'waits for R33, held by robot-10' },
      }),
      robot('robot-1', { activity: 'waiting', since: at(70), kind: 'mover', battery: 0.5, granted: [] }),
      robot('robot-9', { activity: 'gone', state: 'gone' }),
    ],
  }),
);
if (reduced.kind === 'gap') throw new Error('a snapshot never leaves a gap');
const mirror: Mirror = reduced.mirror;
const places = [
  { id: 'A1', x: 0, y: 0, kind: 'aisle' },
  { id: 'A2', x: 1, y: 0, kind: 'aisle' },
] as const;
const lines = linesOf(mirror, places);
const ids = (found: readonly { id: string }[]): string[] => found.map((line) => line.id);

describe('counts', () => {
  test('each activity has how many robots are at it and for how long the first of them', () => {
    const found = countsOf(mirror).filter((c) => c.robots > 0);
    expect(found).toEqual([
      { activity: 'waiting', robots: 2, longest_s: 30 },
      { activity: 'failed', robots: 1, longest_s: 60 },
    ]);
  });
  test('what an earlier version recorded has an activity, and no age', () => {
    const old = robot('r', { activity: null, since: null, state: 'interrupted' });
    expect([activityOf(old), ageOf(mirror, old), ageOf({ time_s: 5, started: null }, robot('r'))]).toEqual([
      'waiting',
      null,
      null,
    ]);
  });
});

describe('the table', () => {
  test('a line has the name of the place and the alarms, and none is of a robot that has left', () => {
    expect(lines.map((l) => [l.id, l.place, l.alarms.length, l.age_s])).toEqual([
      ['robot-10', 'A2', 1, 60],
      ['robot-2', 'A1', 0, 10],
      ['robot-1', null, 0, 30],
    ]);
  });
  test('a search looks into every cell, and a state narrows it down', () => {
    expect(ids(wantedOf(lines, null, 'R33 waiting'))).toEqual(['robot-2']);
    expect(ids(wantedOf(lines, null, 'Mover'))).toEqual(['robot-1']);
    expect(ids(wantedOf(lines, 'waiting', ''))).toEqual(['robot-2', 'robot-1']);
    expect(ids(wantedOf(lines, 'waiting', 'robot-10 cannot'))).toEqual([]);
  });
  test('names sort as people count, figures by size, and what has none comes last either way', () => {
    expect(ids(sortedBy(lines, { by: 'id', way: 'up' }))).toEqual(['robot-1', 'robot-2', 'robot-10']);
    expect(ids(sortedBy(lines, { by: 'battery', way: 'up' }))).toEqual(['robot-10', 'robot-1', 'robot-2']);
    for (const way of ['up', 'down'] as const) expect(sortedBy(lines, { by: 'job', way })[0]!.id).toBe('robot-2');
    expect(turned({ by: 'id', way: 'up' }, 'age')).toEqual({ by: 'age', way: 'down' });
    expect(turned({ by: 'age', way: 'down' }, 'age')).toEqual({ by: 'age', way: 'up' });
  });
});

describe('several robots at once', () => {
  test('each is told once, and what was refused is said by name', async () => {
    const told: string[] = [];
    const pause = (id: string) => {
      told.push(id);
      return Promise.resolve(
        id === 'robot-2'
          ? ({ kind: 'refused', problem: { title: 'No', status: 503, detail: 'too busy' } } as const)
          : ({ kind: 'ok', value: null } as const),
      );
    };
    const act = ROBOT_ACTS.find((one) => one.id === 'pause')!;
    const api = { pause } as unknown as ActsApi;
    expect(await tellAll(act, api, ['robot-1', 'robot-3'])).toEqual({
      words: '2 robots paused.',
      wrong: false,
      done: ['robot-1', 'robot-3'],
    });
    expect(await tellAll(act, api, ['robot-1', 'robot-2'])).toEqual({
      words: '1 robot of 2 refused. robot-2: too busy',
      wrong: true,
      done: ['robot-1'],
    });
    expect(told).toEqual(['robot-1', 'robot-3', 'robot-1', 'robot-2']);
  });
  test('an act is offered for robots that it changes', () => {
    const fitting = (one: ReturnType<typeof robot>): string[] =>
      ROBOT_ACTS.filter((act) => act.fits(one)).map((act) => act.id);
    expect(fitting(robot('r', { activity: 'driving' }))).toEqual(['pause', 'charge', 'park', 'out']);
    expect(fitting(robot('r', { activity: 'paused', maintenance: true }))).toEqual(['resume', 'back']);
  });
});

describe('the history of a robot', () => {
  const event = (id: string | null, what: string, more: Partial<RobotEvent> = {}): RobotEvent => ({
    at: at(1),
    kind: id === null ? 'change' : 'job',
    id,
    what,
    text: id === null ? null : 'deliver',
    ended: null,
    ...more,
  });
  test('it is put into words', () => {
    expect(eventWords(event('j7', 'done'))).toBe('deliver j7: done');
    expect(eventWords(event(null, 'out_of_service'))).toBe('sent out of service');
    expect(eventWords(event(null, 'painted_blue'))).toBe('painted blue');
    expect(
      eventWords(event('al3', 'robot_failed', { kind: 'alarm', text: 'robot-1 cannot drive', ended: at(2) })),
    ).toBe('robot-1 cannot drive (over)');
  });
  test('older pages stay below while the newest is asked for again, and a job is listed once', async () => {
    let newest = [event('j2', 'carrying')];
    const api = {
      robot: () => Promise.resolve({ kind: 'unreachable' } as const),
      robotHistory: (_: string, cursor: string | null) =>
        Promise.resolve({
          kind: 'ok',
          value:
            cursor === null
              ? { items: newest, next: 'c' }
              : { items: [event('j1', 'done'), event(null, 'joined')], next: null },
        } as const),
    };
    const life = new RobotLife(api, 'robot-1');
    let end = life.keep();
    await expect.poll(() => life.events.length).toBe(1);
    await life.more();
    end();
    newest = [event('j3', 'assigned'), event('j2', 'done')];
    end = life.keep();
    await expect.poll(() => life.events.length).toBe(4);
    end();
    expect(life.events.map((e) => `${e.id ?? ''} ${e.what}`)).toEqual(['j3 assigned', 'j2 done', 'j1 done', ' joined']);
    expect([life.next, life.wrong]).toEqual([null, 'The server cannot be reached.']);
  });
});
