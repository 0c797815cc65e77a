// What the panel of jobs shows: tables of the jobs that the server lists, or of those that a replay knows of a moment.
import { untrack } from 'svelte';
import type { Replay } from '../replay';
import type { Job, Mirror, Robot } from '../wire';
import { count, doing, moment, timeOfDay } from '../words';
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
      extra(job.kind), { text: [job.rack, job.station ?? job.node].filter(Boolean).join(' → ') || '–' }, robotCell(job.robot),
      { text: job.state, more: job.why }, extra(String(job.priority)), extra(timeOfDay(job.deadline)), extra(timeOfDay(job.created)),
    ],
  }));
  const columns: JobTable['columns'] = [
    { name: 'Kind', kind: 'extra' }, { name: 'What' }, { name: 'Robot' }, { name: 'State' },
    { name: 'Priority', kind: 'extra' }, { name: 'Deadline', kind: 'extra' }, { name: 'Created', kind: 'extra' },
  ];
  const none = `No jobs${state === 'any' ? ' yet' : ` in state ${state}`}.`;
  return {
    label: 'Jobs', title: 'Latest jobs', note: null, region: 'Table of jobs', foot: null,
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
    label: 'Jobs at this moment', title: `Jobs in progress at this moment: ${robots.length}`, region: 'Tables of jobs at this moment',
    note: `${waiting} waited for a robot, ${done} were done, ${cancelled} cancelled, ${failed} failed`,
    tables: [underWay(robots), waitingThen(waited, waiting, list && at(list.at), at)],
    foot: footOf(list, waiting - waited.length, waited.length, replay.waiting),
  };
}

function underWay(robots: readonly Robot[]): JobTable {
  const lines = robots.map((robot): JobLine => ({
    id: robot.job ?? '', job: null, mine: false,
    cells: [robotCell(robot.id), { text: robot.rack ?? '–' }, { text: doing(robot.doing) }, { text: robot.why ?? '–' }],
  }));
  const columns = ['Robot', 'Rack on it', 'What it did', 'Why it waited'].map((name) => ({ name }));
  return { kind: 'under way', label: 'Jobs under way then', heading: null, columns, lines, none: 'No robot had a job.' };
}

function waitingThen(jobs: readonly Waiter[], all: number, asOf: string | null, at: (t: number) => string): JobTable {
  const lines = jobs.map((job): JobLine => ({
    id: job.id, job: null, mine: false,
    cells: [job.kind, job.what.join(' → ') || '–', String(job.priority), at(job.submitted_s), job.after ?? '–'].map((text) => ({ text })),
  }));
  const note = asOf === null ? null : `(the list is as of ${asOf}, most urgent first)`;
  const columns = ['Kind', 'What', 'Priority', 'Submitted', 'After'].map((name) => ({ name }));
  return {
    kind: 'waited', label: 'Jobs that waited then', heading: { text: `Jobs that waited for a robot: ${count(all)}`, note },
    columns, lines, none: null,
  };
}

function footOf(list: Waited | null, more: number, listed: number, loading: boolean): string | null {
  if (list === null) return more <= 0 ? null : loading ? 'Loading…' : 'An older version recorded only their number.';
  if (more <= 0) return null;
  return listed === 0 ? `${count(more)} were submitted after the list was made.` : `and ${count(more)} more`;
}
