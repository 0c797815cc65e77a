// Numbers and words for people: one place, so that the same thing reads the same everywhere.
import type { Activity, Doing, GuidanceState, JobKind, JobState, Presence } from '../wire';

const whole = new Intl.NumberFormat('en', { maximumFractionDigits: 0 });

export const count = (n: number): string => whole.format(n);

export const percent = (share: number): string => `${Math.round(share * 100)} %`;

/** Microseconds, in the unit a person would say. */
export function micros(us: number): string {
  if (!Number.isFinite(us) || us < 0) return '–';
  if (us < 1_000) return `${Math.round(us)} µs`;
  if (us < 1_000_000) return `${trim(us / 1_000)} ms`;
  return `${trim(us / 1_000_000)} s`;
}

/** How long ago or how long for, rounded down: never claims more than has passed. */
export function span(seconds: number): string {
  const s = Math.max(0, Math.floor(seconds));
  if (s < 60) return `${s} s`;
  if (s < 3_600) return `${Math.floor(s / 60)} min ${s % 60} s`;
  return `${Math.floor(s / 3_600)} h ${Math.floor((s % 3_600) / 60)} min`;
}

/** The same in the largest unit alone. */
export const roughly = (seconds: number): string => span(seconds).split(' ').slice(0, 2).join(' ');

/** How far, in the unit a person would say. */
export const metres = (m: number): string => (m < 1_000 ? `${Math.round(m)} m` : `${(m / 1_000).toFixed(1)} km`);

/** The floor's own clock, which in a simulation is not the time of day. */
export function clock(seconds: number): string {
  const s = Math.max(0, Math.floor(seconds));
  const two = (n: number) => String(n).padStart(2, '0');
  return `${two(Math.floor(s / 3_600))}:${two(Math.floor(s / 60) % 60)}:${two(s % 60)}`;
}

export function timeOfDay(rfc3339: string | null): string {
  const date = rfc3339 === null ? null : new Date(rfc3339);
  if (!date || Number.isNaN(date.getTime())) return '–';
  return date.toLocaleTimeString('en-GB', { hour: '2-digit', minute: '2-digit', second: '2-digit' });
}

export const ACTIVITY_WORDS: Record<Activity, string> = {
  idle: 'Idle', driving: 'Driving', handling: 'Handling', picking: 'Picking', queueing: 'Queueing', charging: 'Charging',
  waiting: 'Waiting', paused: 'Paused', stopped: 'Stopped', out_of_service: 'Out of service', offline: 'Offline', failed: 'Failed',
  gone: 'Gone',
};
/** A newer server may name something this page has no words for; then its own word is shown. */
export const activityWords = (a: Activity): string => ACTIVITY_WORDS[a] ?? String(a).replaceAll('_', ' ');

export const GUIDANCE_WORDS: Record<GuidanceState, string> = {
  idle: 'No task', following: 'On the path', deviating: 'Off the path', redirected: 'On a new path',
  stop: 'Told to stop',
};
export const PRESENCE_WORDS: Record<Presence, string> = {
  absent: 'not here', tracked: 'now', stale: 'a moment ago', lost: 'lost',
};

const DOING_WORDS: Record<Doing, string> = {
  to_rack: 'driving to its rack', lifting: 'lifting the rack', carrying: 'carrying the rack to the station',
  queueing: 'queueing at the station', picking: 'at the station for picking',
  returning: 'returning the rack', setting_down: 'setting the rack down',
  to_charger: 'driving to a charger', charging: 'charging', parking: 'driving to its parking place',
  going: 'driving', idle: 'idle', waiting: 'waiting for its path to clear', failed: 'failed',
};
/** A newer server may name something this page has no words for; then its own word is shown. */
export const doing = (d: Doing): string => DOING_WORDS[d] ?? String(d).replaceAll('_', ' ');

export const KIND_WORDS: Record<JobKind, string> = {
  deliver: 'Deliver a rack to a station', return: 'Return a rack to storage', relocate: 'Move a rack to a place',
  charge: 'Send a robot to charge', park: 'Send a robot to park', go: 'Send a robot to a place',
};

export const isOver = (state: JobState): boolean =>
  state === 'done' || state === 'cancelled' || state === 'failed';

function trim(n: number): string {
  return n < 10 ? n.toFixed(1) : String(Math.round(n));
}
