// What the panel of charts shows: figures that a server keeps, or those of what a replay has in sight.
import type { Source } from '../replay';
import type { Mirror } from '../wire';
import { LiveCharts } from './live.svelte';
import { PastCharts } from './past.svelte';
import type { Chart, Grid } from './series';

export interface ChartsShown {
  readonly title: string;
  readonly charts: readonly Chart[];
  readonly grid: Grid | null;
  /** What is said where there is no grid. */
  readonly instead: string;
  readonly wrong: string | null;
  /** How far back is shown, where that can be chosen. */
  readonly spans: { readonly words: readonly string[]; chosen: number } | null;
  /** How the fleet deals with people, where that is known. */
  readonly arm: string | null;
  /** The moment that is shown elsewhere on the page, milliseconds. */
  readonly moment: number | null;
  /** Goes to a moment, where that is possible, milliseconds. */
  readonly onGo: ((ms: number) => void) | undefined;
  /** Keeps it fresh while it is shown; returns what ends that. */
  keep(): () => void;
}

/** `mirror` is looked at as the sign that a replay has moved on. */
export function chartsOf(source: Source<'history'>, mirror: () => Mirror): ChartsShown {
  return source.tense === 'now' ? new LiveCharts(source.api) : new PastCharts(source.replay, mirror);
}
