// Numbers and words for people: one place, so that the same thing reads the same everywhere.
import {
  atMost,
  listed as listedIn,
  number as numberIn,
  quantity as quantityIn,
  significant as significantIn,
  spelt,
  spoken,
  together,
  type Unit,
} from '../language';
import { t, wordsBy } from './say';
import type { Activity, Doing, GuidanceState, JobKind, JobState, Presence, Replanned } from '../wire';

/** With so many digits behind the point. */
export const number = (n: number, decimals: number): string => numberIn(spoken(), n, decimals);
export const count = (n: number): string => number(n, 0);
/** How often in some time, or how many on average. */
export const rate = (n: number): string => atMost(spoken(), n, 1);
export const significant = (n: number, digits: number): string => significantIn(spoken(), n, digits);
export const quantity = (n: number, unit: Unit, decimals = 0): string => quantityIn(spoken(), n, unit, decimals);

export const percent = (share: number): string => quantity(Math.round(share * 100), '%');

/** Microseconds, in the unit a person would say. */
export function micros(us: number): string {
  if (!Number.isFinite(us) || us < 0) return '–';
  if (us < 1_000) return quantity(us, 'µs');
  if (us < 1_000_000) return quantity(us / 1_000, 'ms', us < 10_000 ? 1 : 0);
  return quantity(us / 1_000_000, 's', us < 10_000_000 ? 1 : 0);
}

/** A time in its two largest units, rounded down. */
function unitsOf(seconds: number): [n: number, unit: 's' | 'min' | 'h'][] {
  const s = Math.max(0, Math.floor(seconds));
  if (s < 60) return [[s, 's']];
  if (s < 3_600)
    return [
      [Math.floor(s / 60), 'min'],
      [s % 60, 's'],
    ];
  return [
    [Math.floor(s / 3_600), 'h'],
    [Math.floor((s % 3_600) / 60), 'min'],
  ];
}
const said = (units: readonly [n: number, unit: Unit][]): string =>
  together(
    spoken(),
    units.map(([n, unit]) => quantity(n, unit)),
  );

/** How long ago or how long for, rounded down: never claims more than has passed. */
export const span = (seconds: number): string => said(unitsOf(seconds));

/** The same in the largest unit alone. */
export const roughly = (seconds: number): string => said(unitsOf(seconds).slice(0, 1));

/** A time that somebody set, mostly a round one: what is 0 of it is not said. */
export const roundSpan = (seconds: number): string => said(unitsOf(seconds).filter(([n], i) => n > 0 || i === 0));

/** A time that can be chosen: whole hours and days in words. */
export function longSpan(seconds: number): string {
  if (seconds % 86_400 === 0) return spelt(spoken(), seconds / 86_400, 'day');
  return seconds % 3_600 === 0 ? spelt(spoken(), seconds / 3_600, 'hour') : roundSpan(seconds);
}

export const listed = (parts: readonly string[]): string => listedIn(spoken(), parts);

/** How far, in the unit a person would say. */
export const metres = (m: number): string => (m < 1_000 ? quantity(m, 'm') : quantity(m / 1_000, 'km', 1));

/** The floor's own clock, which in a simulation is not the time of day. */
export function clock(seconds: number): string {
  const s = Math.max(0, Math.floor(seconds));
  const two = (n: number) => String(n).padStart(2, '0');
  return `${two(Math.floor(s / 3_600))}:${two(Math.floor(s / 60) % 60)}:${two(s % 60)}`;
}

/** How dates and times are written: in English as in Britain, since a day has 24 hours in a warehouse. */
export const dates = (): string => (spoken() === 'en' ? 'en-GB' : spoken());

export function timeOfDay(rfc3339: string | null): string {
  const date = rfc3339 === null ? null : new Date(rfc3339);
  if (!date || Number.isNaN(date.getTime())) return '–';
  return date.toLocaleTimeString(dates(), { hour: '2-digit', minute: '2-digit', second: '2-digit' });
}

export const ACTIVITY_WORDS = wordsBy<Activity>({
  idle: 'activity.idle',
  driving: 'activity.driving',
  handling: 'activity.handling',
  picking: 'activity.picking',
  queueing: 'activity.queueing',
  charging: 'activity.charging',
  waiting: 'activity.waiting',
  paused: 'activity.paused',
  stopped: 'activity.stopped',
  out_of_service: 'activity.out_of_service',
  offline: 'activity.offline',
  failed: 'activity.failed',
  gone: 'activity.gone',
});
/** A newer server may name something this page has no words for; then its own word is shown. */
export const activityWords = (a: Activity): string => ACTIVITY_WORDS[a] ?? String(a).replaceAll('_', ' ');

export const GUIDANCE_WORDS = wordsBy<GuidanceState>({
  idle: 'guidance.idle',
  following: 'guidance.following',
  deviating: 'guidance.deviating',
  redirected: 'guidance.redirected',
  stop: 'guidance.stop',
});
export const PRESENCE_WORDS = wordsBy<Presence>({
  absent: 'presence.absent',
  tracked: 'presence.tracked',
  stale: 'presence.stale',
  lost: 'presence.lost',
});

const DOING_WORDS = wordsBy<Doing>({
  to_rack: 'doing.to_rack',
  lifting: 'doing.lifting',
  carrying: 'doing.carrying',
  queueing: 'doing.queueing',
  picking: 'doing.picking',
  returning: 'doing.returning',
  setting_down: 'doing.setting_down',
  to_charger: 'doing.to_charger',
  charging: 'doing.charging',
  parking: 'doing.parking',
  going: 'doing.going',
  idle: 'doing.idle',
  waiting: 'doing.waiting',
  failed: 'doing.failed',
});
/** A newer server may name something this page has no words for; then its own word is shown. */
export const doing = (d: Doing): string => DOING_WORDS[d] ?? String(d).replaceAll('_', ' ');

export const KIND_WORDS = wordsBy<JobKind>({
  deliver: 'kind.deliver',
  return: 'kind.return',
  relocate: 'kind.relocate',
  charge: 'kind.charge',
  park: 'kind.park',
  go: 'kind.go',
});

/** The same in one word, as cells of tables have it. */
export const SHORT_KIND_WORDS = wordsBy<JobKind>({
  deliver: 'kind.short.deliver',
  return: 'kind.short.return',
  relocate: 'kind.short.relocate',
  charge: 'kind.short.charge',
  park: 'kind.short.park',
  go: 'kind.short.go',
});
export const STATE_WORDS = wordsBy<JobState>({
  waiting: 'job.state.waiting',
  assigned: 'job.state.assigned',
  carrying: 'job.state.carrying',
  picking: 'job.state.picking',
  done: 'job.state.done',
  cancelled: 'job.state.cancelled',
  failed: 'job.state.failed',
});

const ROLE_WORDS: Readonly<Record<string, string>> = wordsBy({
  viewer: 'role.viewer',
  operator: 'role.operator',
  integrator: 'role.integrator',
  device: 'role.device',
  admin: 'role.admin',
});
/** Because of whom or what a robot got another way. */
export function replanCause({ kind, id }: Pick<Replanned, 'kind' | 'id'>): string {
  const what = id ?? '';
  switch (kind) {
    case 'worker':
      return t('replan.worker', { id: what });
    case 'closure':
      return t('replan.closure', { id: what });
    case 'robot':
      return t('replan.robot', { id: what });
    case 'obstruction':
      return t('replan.obstruction');
  }
}

/** A newer server may know other roles; then its own word is shown. */
export const roleWords = (role: string): string => ROLE_WORDS[role] ?? role;

export const isOver = (state: JobState): boolean => state === 'done' || state === 'cancelled' || state === 'failed';
