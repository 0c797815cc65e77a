// The jobs of a past moment: those that waited, from the lists of a reel; those under way, from its frames. Pure.
import type { Listed } from '../replay';
import type { Mirror, Robot } from '../wire';

export interface Waiter {
  id: string;
  kind: string;
  /** Names of the rack or robot, and of the station or node it is to go to. */
  what: string[];
  priority: number;
  submitted_s: number;
  /** A job that had to be over first. */
  after?: string;
}
export interface Waited {
  /** When the list was made. */
  at: number;
  jobs: readonly Waiter[];
}

const read = new WeakMap<Listed, Waited>();

/** The jobs that waited at `t`, most urgent first: the last list that was made by then. Null where there is none. */
export function waitedAt(lists: readonly Listed[], t: number): Waited | null {
  const last = lists.findLast((one) => one.at <= t) ?? lists[0];
  if (!last) return null;
  const known = read.get(last) ?? { at: last.at, jobs: JSON.parse(last.text) as Waiter[] };
  read.set(last, known);
  return known;
}

/** Robots with a job, by the number of the job. */
export function jobsUnderWay(mirror: Mirror): Robot[] {
  const number = (r: Robot) => Number(/\d+$/.exec(r.job ?? '')?.[0] ?? 0);
  return mirror.robots.rows.filter((r) => r.job !== null).sort((a, b) => number(a) - number(b));
}
