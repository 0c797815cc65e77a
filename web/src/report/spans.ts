// The stretches of time that a report can be of.
import { wordsBy } from '../words';

export const SPANS = wordsBy({
  hour: 'report.span.hour',
  eight: 'report.span.eight',
  today: 'report.span.today',
  yesterday: 'report.span.yesterday',
  week: 'report.span.week',
  own: 'report.span.own',
});
export type SpanName = keyof typeof SPANS;

const HOUR_MS = 3_600_000;

/** From when to when, of the reader's own days; `own` is what was typed, as `datetime-local` has it. */
export function spanOf(name: SpanName, now: Date, own: { from: string; to: string }): { from: Date; to: Date } | null {
  const midnight = (days: number): Date => new Date(now.getFullYear(), now.getMonth(), now.getDate() + days);
  const back = (hours: number): { from: Date; to: Date } => ({
    from: new Date(now.getTime() - hours * HOUR_MS),
    to: now,
  });
  switch (name) {
    case 'hour':
      return back(1);
    case 'eight':
      return back(8);
    case 'today':
      return { from: midnight(0), to: now };
    case 'yesterday':
      return { from: midnight(-1), to: midnight(0) };
    case 'week':
      return back(7 * 24);
    case 'own': {
      const [from, to] = [new Date(own.from), new Date(own.to)];
      return Number.isNaN(from.getTime()) || Number.isNaN(to.getTime()) ? null : { from, to };
    }
  }
}

/** A time as `datetime-local` has it, in the reader's own time zone. */
export function typed(at: Date): string {
  const two = (n: number): string => String(n).padStart(2, '0');
  const day = [at.getFullYear(), two(at.getMonth() + 1), two(at.getDate())].join('-');
  return `${day}T${two(at.getHours())}:${two(at.getMinutes())}`;
}
