// The list of encounters: chosen, sorted, and where in the recorded time each can be seen again. Pure.
import type { Encounter, Reaction } from '../wire';
import { wordsBy } from '../words';

export const REACTION_WORDS = wordsBy<Reaction>({
  kept: 'encounter.kept',
  slowed: 'encounter.slowed',
  held: 'encounter.held',
  rerouted: 'encounter.rerouted',
  stopped: 'encounter.stopped',
});
export const SORTS = ['began', 'closest', 'robot_speed', 'worker_speed', 'delay_s'] as const;
export type Sort = (typeof SORTS)[number];

/** How much before and after an encounter is worth seeing, seconds. */
const AROUND_S = 10;

export function sorted(items: readonly Encounter[], by: Sort, most: 'first' | 'last'): Encounter[] {
  const value = (e: Encounter): number => (by === 'began' ? Date.parse(e.began) : e[by]);
  const sign = most === 'first' ? -1 : 1;
  // Newest first among equals, as they come.
  return [...items].sort((a, b) => sign * (value(a) - value(b)) || b.id - a.id);
}

/** Where in the replay an encounter is; null where it was before the clock of the feed began. */
export function replayOf(e: Encounter, started: string): { from: number; to: number; href: string } | null {
  const began_s = (Date.parse(e.began) - Date.parse(started)) / 1_000;
  if (!Number.isFinite(began_s) || began_s < 0) return null;
  const from = Math.max(0, Math.floor(began_s - AROUND_S));
  const to = Math.ceil(began_s + e.lasted_s + AROUND_S);
  return { from, to, href: `#replay?from=${from}&to=${to}` };
}

/** What narrows the list down on the server, as a query. */
export function queryOf(worker: string, robot: string): Record<string, string> {
  return { ...(worker === '' ? {} : { worker }), ...(robot === '' ? {} : { robot }) };
}
