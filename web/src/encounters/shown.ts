// What the panel of encounters shows: those that a server keeps, or those that a replay has in sight.
import type { Source } from '../replay';
import type { Encounter } from '../wire';
import { LiveEncounters } from './live.svelte';
import { PastEncounters } from './past.svelte';

/** How an encounter can be seen again. */
export type Again = { kind: 'link'; href: string } | { kind: 'go'; go(): void } | { kind: 'never'; why: string };

export interface EncountersShown {
  readonly title: string;
  /** What is said where there are none at all. */
  readonly none: string;
  /** The worker and the robot to show encounters of, by id; empty for all. */
  worker: string;
  robot: string;
  readonly items: readonly Encounter[];
  readonly wrong: string | null;
  /** What else is to be said of them. */
  readonly note: string | null;
  /** The table as a file, where there is one. */
  readonly csv: string | null;
  /** Fetches older ones; null where there are none. */
  readonly older: (() => Promise<void>) | null;
  when(e: Encounter): string;
  again(e: Encounter): Again;
  /** Keeps it fresh while it is shown; returns what ends that. */
  keep(): () => void;
}

export function encountersOf(source: Source<'encounters' | 'encountersFile' | 'history'>): EncountersShown {
  return source.tense === 'now' ? new LiveEncounters(source.api) : new PastEncounters(source.replay);
}
