// What the panel of jobs shows: tables of the jobs that the server lists, or of those that a replay knows of a moment.
import { untrack } from 'svelte';
import type { Replay } from '../replay';
import type { Job, JobKind, Mirror, Robot } from '../wire';
import { doing, moment, said, SHORT_KIND_WORDS, STATE_WORDS, t, timeOfDay } from '../words';
import type { Jobs } from './jobs.svelte';
import { jobsUnderWay, waitedAt, type Waited, type Waiter } from './waited';

export interface Cell {
  readonly text: string;
  /** `robot`: the text is the name of one, which can be chosen. `extra`: left out on a phone. */
  readonly kind?: 'plain' | 'robot' | 'extra';
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
  readonly columns: readonly { readonly name: string; readonly kind?: 'extra' }[];
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

/** The latest jobs, those submitted here first. */
export function latestJobs({ own, items, state }: Pick<Jobs, 'own' | 'items' | 'state'>): JobsShown {
  const lines = [...own, ...items.filter((j) => !own.some((o) => o.id === j.id))].map((job, i): JobLine => ({
    id: job.id, job, mine: i < own.length,
    cells: [
      extra(SHORT_KIND_WORDS[job.kind] ?? job.kind), { text: [job.rack, job.station ?? job.node].filter(Boolean).join(' → ') || '–' }, robotCell(job.robot),
      { text: STATE_WORDS[job.state] ?? job.state, more: job.why === null ? null : said(job.why) }, extra(String(job.priority)), extra(timeOfDay(job.deadline)), extra(timeOfDay(job.created)),
    ],
  }));
  const columns: JobTable['columns'] = [
    { name: t('robot.kind'), kind: 'extra' }, { name: t('jobs.what') }, { name: t('robot') }, { name: t('robot.state') },
    { name: t('job.priority'), kind: 'extra' }, { name: t('job.deadline'), kind: 'extra' }, { name: t('job.created'), kind: 'extra' },
  ];
  const none = state === 'any' ? t('jobs.none') : t('jobs.none.state', { state: STATE_WORDS[state] });
  return {
    label: t('jobs'), title: t('jobs.latest'), note: null, region: t('jobs.table'), foot: null,
    tables: [{ kind: 'latest', label: undefined, heading: null, columns, lines, none }],
  };
}

/** The jobs of the moment that a replay shows: those under way, and below them those that waited for a robot. */
export function jobsThen(replay: Pick<Replay, 'recording' | 't' | 'waiting'>, mirror: Mirror): JobsShown {
  const { recording } = replay;
  // The time runs on with every frame; the mirror is the sign that a panel may look again.
  const lists = untrack(() => recording.lists(replay.t));
  const list = lists && waitedAt(lists, untrack(() => replay.t));
  const robots = jobsUnderWay(mirror);
  const taken = new Set(robots.map((r) => r.job));
  const waited = list?.jobs.filter((job) => !taken.has(job.id)) ?? [];
  const { waiting, done, cancelled, failed } = mirror.jobs;
  const at = (t: number): string => moment(recording.start, t);
  return {
    label: t('jobs.then'), title: t('jobs.then.active', { count: robots.length }), region: t('jobs.then.tables'),
    note: t('jobs.then.counts', { waiting, done, cancelled, failed }),
    tables: [underWay(robots), waitingThen(waited, waiting, list && at(list.at), at)],
    foot: footOf(list, waiting - waited.length, waited.length, replay.waiting),
  };
}

function underWay(robots: readonly Robot[]): JobTable {
  const lines = robots.map((robot): JobLine => ({
    id: robot.job ?? '', job: null, mine: false,
    cells: [robotCell(robot.id), { text: robot.rack ?? '–' }, { text: doing(robot.doing) }, { text: robot.why === null ? '–' : said(robot.why) }],
  }));
  const columns = [t('robot'), t('jobs.then.rack'), t('jobs.then.did'), t('jobs.then.waited')].map((name) => ({ name }));
  return { kind: 'under way', label: t('jobs.then.robots'), heading: null, columns, lines, none: t('jobs.then.none') };
}

function waitingThen(jobs: readonly Waiter[], all: number, asOf: string | null, at: (t: number) => string): JobTable {
  const lines = jobs.map((job): JobLine => ({
    id: job.id, job: null, mine: false,
    cells: [kindOf(job.kind), job.what.join(' → ') || '–', String(job.priority), at(job.submitted_s), job.after ?? '–'].map((text) => ({ text })),
  }));
  const note = asOf === null ? null : t('jobs.then.as-of', { time: asOf });
  const columns = [t('robot.kind'), t('jobs.what'), t('job.priority'), t('job.submitted'), t('job.after')].map((name) => ({ name }));
  return {
    kind: 'waited', label: t('jobs.then.waiting'), heading: { text: t('jobs.then.waiting.count', { count: all }), note },
    columns, lines, none: null,
  };
}

/** A recording may be of a version that named other kinds. */
const kindOf = (kind: string): string => SHORT_KIND_WORDS[kind as JobKind] ?? kind;

function footOf(list: Waited | null, more: number, listed: number, loading: boolean): string | null {
  if (list === null) return more <= 0 ? null : loading ? t('loading') : t('jobs.then.number');
  if (more <= 0) return null;
  return listed === 0 ? t('jobs.then.after', { count: more }) : t('jobs.then.more', { count: more });
}
