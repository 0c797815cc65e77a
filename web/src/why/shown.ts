// Why something waits, as the panel shows it: of the present, or of the past.
import type { Picked } from '../floor';
import type { Source } from '../replay';
import type { Mirror } from '../wire';
import { t } from '../words';
import { LiveWhy } from './live.svelte';
import { chainOf } from './chain';

/** One link of a chain: what waits, for what, until when. */
export interface WhyStep {
  readonly who: string;
  readonly kind: 'robot' | 'job' | 'worker';
  readonly text: string;
  /** Until when, in words; null where that is not known. */
  readonly until: string | null;
  /** What it waits for, where that is no link of the chain itself. */
  readonly by: Picked | null;
}
export interface WhyShown {
  readonly label: string;
  readonly title: string;
  /** From the one that waits down to the root; empty where there is nothing to say. */
  readonly chain: readonly WhyStep[];
  readonly wrong: string | null;
  /** Keeps it fresh while it is shown; returns what ends that. */
  keep(): () => void;
}

/** `mirror` is asked of the past only: the present asks the server. */
export function whyOf(source: Source<'why'>, kind: 'robot' | 'job', id: string, mirror: () => Mirror): WhyShown {
  if (source.tense === 'now') return new LiveWhy(source.api, kind, id);
  const links = chainOf(mirror(), id);
  // A chain of one says no more than the words of the robot itself.
  const chain =
    links.length < 2 ? [] : links.map((link): WhyStep => ({ ...link, kind: 'robot', until: null, by: null }));
  return { label: t('jobs.then.waited'), title: t('jobs.then.waited'), chain, wrong: null, keep: () => () => {} };
}
