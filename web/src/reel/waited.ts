// What reels have beside pictures: the jobs that waited at a moment, and the encounters that they know. Pure.
import type { Encounter } from '../wire';
import type { Listed, Mark } from './reel';

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

/** The encounters among bookmarks, as they are listed, with the bookmark of each by its number; and how many bookmarks
 *  say too little, which older versions wrote. */
export function metIn(marks: readonly Mark[], start: number | null): { items: Encounter[]; marks: readonly Mark[]; bare: number } {
  const met = marks.filter((mark) => mark.kind === 'encounter');
  const known = met.filter((mark) => mark.encounter !== undefined);
  const items = known.map((mark, id): Encounter => {
    const { ended_s, ...rest } = mark.encounter!;
    const began = new Date(1_000 * ((start ?? 0) + mark.at_s)).toISOString();
    return { ...rest, id, began, lasted_s: ended_s - mark.at_s };
  });
  return { items, marks: known, bare: met.length - known.length };
}
