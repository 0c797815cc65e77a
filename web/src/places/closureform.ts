// The form for a closed area without its looks: the request made of what somebody typed.
import type { Binds, Closure, NewClosure, Point } from '../wire';
import { t, wordsBy } from '../words';

export interface ClosureValues {
  reason: string;
  binds: Binds;
  /** Minutes from now; empty for at once. */
  begins: string;
  /** Minutes; empty until somebody opens it. */
  lasts: string;
  /** Whether it recurs every day, counted from the first time. */
  daily: boolean;
}
export type ClosureErrors = Partial<Record<keyof ClosureValues, string>>;
export type BuiltClosure = { kind: 'ready'; area: NewClosure } | { kind: 'wrong'; errors: ClosureErrors };

export const BINDS_WORDS = wordsBy<Binds>({ both: 'closure.binds.both', robots: 'closure.binds.robots', people: 'closure.binds.people' });

const WEEK = 7 * 24 * 60;
const DAY = 24 * 60;

export function buildClosure(values: ClosureValues, outline: readonly Point[], now: Date): BuiltClosure {
  const errors: ClosureErrors = {};
  const area: NewClosure = { outline: [...outline], reason: values.reason.trim(), binds: values.binds };
  if (area.reason === '') errors.reason = t('closure.reason.wrong');
  const minutes = (field: 'begins' | 'lasts', least: number): number | null => {
    if (values[field].trim() === '') return null;
    const n = Number(values[field]);
    if (Number.isFinite(n) && n >= least && n <= WEEK) return n;
    errors[field] = t('closure.minutes.wrong');
    return null;
  };
  const begins = minutes('begins', 0);
  const lasts = minutes('lasts', values.daily ? 1 : 0.1);
  if (values.daily && errors.lasts === undefined && (lasts === null || lasts >= DAY)) {
    errors.lasts = t('closure.daily.wrong');
  }
  const at = (m: number) => new Date(now.getTime() + m * 60_000);
  if (values.daily) {
    area.recurs = { from: clock(at(begins ?? 0)), to: clock(at((begins ?? 0) + (lasts ?? 0))), utc_offset: zone() ?? offset(now) };
  } else {
    if (begins !== null && begins > 0) area.from = at(begins).toISOString();
    if (lasts !== null) area.until = at((begins ?? 0) + lasts).toISOString();
  }
  return Object.keys(errors).length > 0 ? { kind: 'wrong', errors } : { kind: 'ready', area };
}

const two = (n: number) => String(n).padStart(2, '0');
/** The time of day where the page is shown. */
const clock = (t: Date) => `${two(t.getHours())}:${two(t.getMinutes())}`;
/** The time zone there, so that what recurs follows its summer time; nothing where a browser does not tell. */
function zone(): string | undefined {
  const name = Intl.DateTimeFormat().resolvedOptions().timeZone as string | undefined;
  return name === undefined || !/^[A-Za-z]/.test(name) ? undefined : name;
}
/** How far that is ahead of UTC. */
function offset(t: Date): string {
  const ahead = -t.getTimezoneOffset();
  return `${ahead < 0 ? '-' : '+'}${two(Math.floor(Math.abs(ahead) / 60))}:${two(Math.abs(ahead) % 60)}`;
}

/** The request that closes an area again as it was. */
export function closedAgain({ outline, reason, binds, from, until, state }: Closure): NewClosure {
  return {
    outline: [...outline], reason, binds: binds ?? 'robots',
    ...(state === 'announced' && from ? { from } : {}), ...(until ? { until } : {}),
  };
}
