// The form for a closed area without its looks: the request made of what somebody typed.
import type { Affected, Binds, ClosingEffect, Closure, NewClosure, Point } from '../wire';
import { listed, t, timeOfDay, wordsBy } from '../words';

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

export const BINDS_WORDS = wordsBy<Binds>({
  both: 'closure.binds.both',
  robots: 'closure.binds.robots',
  people: 'closure.binds.people',
});

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
    area.recurs = {
      from: clock(at(begins ?? 0)),
      to: clock(at((begins ?? 0) + (lasts ?? 0))),
      utc_offset: zone() ?? offset(now),
    };
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

/** What closing an area does, a line each; grave is what stands until it is opened. */
export function effectWords(effect: ClosingEffect): { words: string; grave: boolean }[] {
  const { stations, racks, trapped, waiting, under_way: passing, clear_at } = effect;
  const lines = [{ words: t('closure.effect.nodes', { count: effect.nodes }), grave: false }];
  const add = (words: string, grave = true) => lines.push({ words, grave });
  if (stations.length > 0) add(t('closure.effect.stations', { count: stations.length, names: listed(stations) }));
  if (racks.total > 0) add(t('closure.effect.racks', { count: racks.total, names: namesOf(racks) }));
  if (trapped.total > 0) add(t('closure.effect.trapped', { names: namesOf(trapped) }));
  if (waiting.total > 0) add(t('closure.effect.waiting', { count: waiting.total, names: namesOf(waiting) }));
  if (passing.total > 0) {
    add(
      t('closure.effect.passing', { count: passing.total, names: namesOf(passing), time: timeOfDay(clear_at) }),
      false,
    );
  }
  return lines;
}

/** The first names, and how many more there are. */
function namesOf({ total, first }: Affected): string {
  const shown = first.slice(0, 6);
  const names = listed(shown);
  return total > shown.length ? t('closure.effect.more', { names, count: total - shown.length }) : names;
}

/** The request that closes an area again as it was. */
export function closedAgain({ outline, reason, binds, from, until, state }: Closure): NewClosure {
  return {
    outline: [...outline],
    reason,
    binds: binds ?? 'robots',
    ...(state === 'announced' && from ? { from } : {}),
    ...(until ? { until } : {}),
  };
}
