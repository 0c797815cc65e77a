// Times and kinds of the past in words, once for all modules that say them.
import { clock, dates } from './format';
import { wordsBy } from './say';
import type { MarkKind } from '../wire';

export const MARK_WORDS = wordsBy<MarkKind>({
  deviation: 'happened.deviation',
  encounter: 'happened.encounter',
  replan: 'happened.replan',
  stop: 'happened.stop',
  failure: 'happened.failure',
  closure: 'happened.closure',
  alarm: 'happened.alarm',
});

/** The time of day here, or the floor's own clock in a simulation. */
export function moment(start: number | null, t: number): string {
  if (start === null) return clock(t);
  return new Date((start + t) * 1_000).toLocaleTimeString(dates(), {
    hour: '2-digit',
    minute: '2-digit',
    second: '2-digit',
  });
}

/** The day, where that is not today's. */
export function day(start: number | null, t: number, today: Date): string | null {
  if (start === null) return null;
  const then = new Date((start + t) * 1_000);
  if (then.toDateString() === today.toDateString()) return null;
  return then.toLocaleDateString(dates(), { weekday: 'short', day: 'numeric', month: 'short' });
}

/** The latest moment up to `end` at which a clock here showed `hh:mm` or `hh:mm:ss`; null where that is no time. */
export function momentOf(start: number, end: number, text: string): number | null {
  const found = /^(\d\d):(\d\d)(?::(\d\d))?$/.exec(text);
  if (!found) return null;
  const last = new Date((start + end) * 1_000);
  const then = new Date(last);
  then.setHours(Number(found[1]), Number(found[2]), Number(found[3] ?? 0), 0);
  if (then > last) then.setDate(then.getDate() - 1);
  return then.getTime() / 1_000 - start;
}
