// What the panel of jobs shows: tables of the jobs that the server lists, or of those that a replay knows of a moment.
import { untrack } from 'svelte';
import type { Replay } from '../replay';
import type { Job, JobKind, JobState, Mirror, Robot } from '../wire';
import { doing, isOver, moment, roughly, said, SHORT_KIND_WORDS, STATE_WORDS, t, timeOfDay } from '../words';
import type { Jobs } from './jobs.svelte';
import { jobsUnderWay, waitedAt, type Waited, type Waiter } from './waited';

export interface Cell {
  readonly text: string;
  /** `robot`: the text is the name of one, which can be chosen. `extra`: left out on a phone. `late`: too late. */
  readonly kind?: 'plain' | 'robot' | 'extra' | 'late';
  /** What else there is to say of it, shown after it as far as there is room. */
  readonly more?: string | null;
}
export interface JobLine {
  readonly id: string;
  /** It was submitted on this page. */
  readonly mine: boolean;
  readonly cells: readonly Cell[];
  /** The job itself, where something can be done about it. */
  readonly job: Job | null;
}
export interface JobTable {
  readonly kind: 'latest' | 'under way' | 'waited';
  /** Its name, where there is more than one table. */
  readonly label: string | undefined;
  readonly heading: { readonly text: string; readonly note: string | null } | null;
  /** `by`: it can be sorted by this. */
  readonly columns: readonly { readonly name: string; readonly kind?: 'extra'; readonly by?: JobSort }[];
  readonly lines: readonly JobLine[];
  /** What is said where there are none; null where the table is left out then. */
  readonly none: string | null;
}
export interface JobsShown {
  readonly label: string;
  readonly title: string;
  readonly note: string | null;
  /** The name of what scrolls. */
  readonly region: string;
  readonly tables: readonly JobTable[];
  /** What is said below the tables. */
  readonly foot: string | null;
}

const extra = (text: string): Cell => ({ text, kind: 'extra' });
const robotCell = (id: string | null): Cell => (id === null ? { text: '–' } : { text: id, kind: 'robot' });

export const JOB_SORTS = [
  'id',
  'reference',
  'kind',
  'what',
  'robot',
  'state',
  'priority',
  'deadline',
  'created',
] as const;
export type JobSort = (typeof JOB_SORTS)[number];
export interface JobOrder {
  readonly by: JobSort;
  readonly way: 'up' | 'down';
}
/** As the server lists them. */
export const NEWEST: JobOrder = { by: 'id', way: 'down' };
/** The order after a click on a heading: what is urgent comes first. */
export function turnedJobs(order: JobOrder, by: JobSort): JobOrder {
  if (by === 'id' && (order.by !== 'id' || order.way === 'up')) return NEWEST;
  if (order.by === by) return { by, way: order.way === 'up' ? 'down' : 'up' };
  return { by, way: by === 'id' || by === 'priority' || by === 'created' ? 'down' : 'up' };
}

const whatOf = (job: Job): string => [job.rack, job.station ?? job.node].filter(Boolean).join(' → ');
/** j9 before j10. */
const natural = new Intl.Collator('en', { numeric: true });
/** How far jobs have come, in this order. */
const STAGES: readonly JobState[] = ['waiting', 'assigned', 'carrying', 'picking', 'done', 'cancelled', 'failed'];

function sortedJobs(jobs: readonly Job[], { by, way }: JobOrder): Job[] {
  const of = (job: Job): string | number | null => {
    switch (by) {
      case 'what':
        return whatOf(job) || null;
      case 'kind':
        return SHORT_KIND_WORDS[job.kind] ?? job.kind;
      case 'state':
        return STAGES.indexOf(job.state);
      default:
        return job[by] ?? null;
    }
  };
  const sign = way === 'up' ? 1 : -1;
  return jobs.toSorted((a, b) => {
    const [left, right] = [of(a), of(b)];
    const newest = natural.compare(b.id, a.id);
    // What has none stands below what has one, whichever way it is sorted.
    if (left === null || right === null) return left === right ? newest : left === null ? 1 : -1;
    const order =
      typeof left === 'number' && typeof right === 'number'
        ? left - right
        : natural.compare(String(left), String(right));
    return sign * order || newest;
  });
}

/** By how much a job is past its deadline, seconds: at `now`, or when it was done; null where it is not, or will not be
 *  done. */
export function lateFor_s(job: Pick<Job, 'deadline' | 'state' | 'updated'>, now: number | null): number | null {
  if (job.deadline === null || job.state === 'cancelled' || job.state === 'failed') return null;
  const at = isOver(job.state) ? Date.parse(job.updated) : now;
  const late = at === null ? 0 : (at - Date.parse(job.deadline)) / 1_000;
  return late > 0 ? late : null;
}

/** A job's state and why it does not go on; the reason alone where it begins with the same word, such as "waiting" and
 *  "waits for …". */
function stateCell(job: Job): Cell {
  const [state, why] = [STATE_WORDS[job.state] ?? job.state, job.why === null ? null : said(job.why)];
  const repeats = why?.toLowerCase().startsWith(state.toLowerCase().slice(0, 4));
  return why !== null && repeats ? { text: why } : { text: state, more: why };
}

function deadlineCell(job: Job, now: number | null): Cell {
  const late = lateFor_s(job, now);
  if (late === null) return extra(timeOfDay(job.deadline));
  return { text: t(isOver(job.state) ? 'jobs.late.was' : 'jobs.late', { time: roughly(late) }), kind: 'late' };
}

/** The latest jobs, those submitted here first; in another order if that is wanted. `now` is the floor's, in
 *  milliseconds. */
export function latestJobs(
  { own, items, state, part }: Pick<Jobs, 'own' | 'items' | 'state' | 'part'>,
  now: number | null = null,
  order: JobOrder = NEWEST,
): JobsShown {
  // What is looked for is what is shown, whoever submitted it.
  const mine = new Set(own.map((job) => job.id));
  const all = part === '' ? [...own, ...items.filter((job) => !mine.has(job.id))] : items;
  const lines = (order === NEWEST ? all : sortedJobs(all, order)).map((job): JobLine => ({
    id: job.id,
    job,
    mine: mine.has(job.id),
    cells: [
      extra(job.reference ?? '–'),
      extra(SHORT_KIND_WORDS[job.kind] ?? job.kind),
      { text: whatOf(job) || '–' },
      robotCell(job.robot),
      stateCell(job),
      extra(String(job.priority)),
      deadlineCell(job, now),
      extra(timeOfDay(job.created)),
    ],
  }));
  const columns: JobTable['columns'] = [
    { name: t('job.reference'), kind: 'extra', by: 'reference' },
    { name: t('robot.kind'), kind: 'extra', by: 'kind' },
    { name: t('jobs.what'), by: 'what' },
    { name: t('robot'), by: 'robot' },
    { name: t('robot.state'), by: 'state' },
    { name: t('job.priority'), kind: 'extra', by: 'priority' },
    { name: t('job.deadline'), by: 'deadline' },
    { name: t('job.created'), kind: 'extra', by: 'created' },
  ];
  const none =
    part !== ''
      ? t('jobs.none.part', { part })
      : state === 'any'
        ? t('jobs.none')
        : t('jobs.none.state', { state: STATE_WORDS[state] });
  return {
    label: t('jobs'),
    title: t('jobs.latest'),
    note: null,
    region: t('jobs.table'),
    foot: null,
    tables: [{ kind: 'latest', label: undefined, heading: null, columns, lines, none }],
  };
}

/** The jobs of the moment that a replay shows: those under way, and below them those that waited for a robot. */
export function jobsThen(replay: Pick<Replay, 'recording' | 't' | 'waiting'>, mirror: Mirror): JobsShown {
  const { recording } = replay;
  // The time runs on with every frame; the mirror is the sign that a panel may look again.
  const lists = untrack(() => recording.lists(replay.t));
  const list =
    lists &&
    waitedAt(
      lists,
      untrack(() => replay.t),
    );
  const robots = jobsUnderWay(mirror);
  const taken = new Set(robots.map((r) => r.job));
  const waited = list?.jobs.filter((job) => !taken.has(job.id)) ?? [];
  const { waiting, done, cancelled, failed } = mirror.jobs;
  const at = (t: number): string => moment(recording.start, t);
  return {
    label: t('jobs.then'),
    title: t('jobs.then.active', { count: robots.length }),
    region: t('jobs.then.tables'),
    note: t('jobs.then.counts', { waiting, done, cancelled, failed }),
    tables: [underWay(robots), waitingThen(waited, waiting, list && at(list.at), at)],
    foot: footOf(list, waiting - waited.length, waited.length, replay.waiting),
  };
}

function underWay(robots: readonly Robot[]): JobTable {
  const lines = robots.map((robot): JobLine => ({
    id: robot.job ?? '',
    job: null,
    mine: false,
    cells: [
      robotCell(robot.id),
      { text: robot.rack ?? '–' },
      { text: doing(robot.doing) },
      { text: robot.why === null ? '–' : said(robot.why) },
    ],
  }));
  const columns = [t('robot'), t('jobs.then.rack'), t('jobs.then.did'), t('jobs.then.waited')].map((name) => ({
    name,
  }));
  return { kind: 'under way', label: t('jobs.then.robots'), heading: null, columns, lines, none: t('jobs.then.none') };
}

function waitingThen(jobs: readonly Waiter[], all: number, asOf: string | null, at: (t: number) => string): JobTable {
  const lines = jobs.map((job): JobLine => ({
    id: job.id,
    job: null,
    mine: false,
    cells: [
      kindOf(job.kind),
      job.what.join(' → ') || '–',
      String(job.priority),
      at(job.submitted_s),
      job.after ?? '–',
    ].map((text) => ({ text })),
  }));
  const note = asOf === null ? null : t('jobs.then.as-of', { time: asOf });
  const columns = [t('robot.kind'), t('jobs.what'), t('job.priority'), t('job.submitted'), t('job.after')].map(
    (name) => ({ name }),
  );
  return {
    kind: 'waited',
    label: t('jobs.then.waiting'),
    heading: { text: t('jobs.then.waiting.count', { count: all }), note },
    columns,
    lines,
    none: null,
  };
}

/** A recording may be of a version that named other kinds. */
const kindOf = (kind: string): string => SHORT_KIND_WORDS[kind as JobKind] ?? kind;

function footOf(list: Waited | null, more: number, listed: number, loading: boolean): string | null {
  if (list === null) return more <= 0 ? null : loading ? t('loading') : t('jobs.then.number');
  if (more <= 0) return null;
  return listed === 0 ? t('jobs.then.after', { count: more }) : t('jobs.then.more', { count: more });
}
