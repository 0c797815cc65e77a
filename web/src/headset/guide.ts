// What the wearer is to see now: the server's guidance, judged by how well position and connection are known.
import { said, type Said } from '../language';
import { duration, metres, seconds, t, type Key } from './words';
import type { GuidanceState, Point } from '../wire';

export interface NearRobot {
  id: string;
  distance: number;
  /** Radians, positive to the left of where the wearer faces. */
  bearing: number | null;
  bearing_map: number;
  closest_s: number | null;
  speed: number;
}
/** Why the worker is told something: a kind, and what its sentence names. */
export interface Cause {
  kind: string;
  robot: string | null;
  /** Why an area is closed, in the supervisor's words. */
  closure: string | null;
}
export interface Guidance {
  state: GuidanceState;
  /** For kinds of causes that this page does not know. */
  reason: Said | string | null;
  cause?: Cause | null;
  version: number;
  path: Point[];
  next: Point | null;
  eta_s: number | null;
  /** For about how long to wait for a robot to pass, seconds. */
  wait_s?: number | null;
  assignment: string | null;
  /** Whether the worker is at the place of the assignment. */
  arrived?: boolean;
  near: NearRobot[];
}
/** An assignment, as the worker is told of it. */
export interface Task {
  id: string;
  /** In the customer's words; may be empty. */
  what: string;
  place: string;
  /** How far it has come. */
  state?: 'waiting' | 'walking' | 'working' | 'done' | 'cancelled';
}
/** How an assignment ended. */
export interface Ended {
  id: string;
  how: 'done' | 'cancelled';
}

/** What this page knows about itself. */
export interface Standing {
  /** Guidance older than this is not shown as true: milliseconds since it came; none where it never came. */
  age_ms: number | null;
  link: 'live' | 'connecting' | 'lost' | 'ended';
  /** Whether the device knows where it is; `none` where it does not try, such as a phone. */
  tracking: 'tracked' | 'emulated' | 'lost' | 'none';
  aligned: boolean;
}

export type Tone = 'calm' | 'notice' | 'warn' | 'stop';
export interface Shown {
  kind: 'offline' | 'marks' | 'lost' | 'idle' | 'following' | 'deviating' | 'redirected' | 'stop';
  tone: Tone;
  title: string;
  detail: string;
  path: readonly Point[];
  next: Point | null;
  near: readonly NearRobot[];
  /** Why, in a sentence; empty where all is as planned. */
  why: string;
  /** At the place of the assignment. */
  arrived: boolean;
}

/** Guidance comes four times a second. */
export const STALE_MS = 2_000;
const NOTHING = { path: [], next: null, near: [], why: '', arrived: false } as const;
/** Longer texts are cut on the board, which is read in passing. */
const LONGEST_WHAT = 80;

export function show(g: Guidance | null, at: Standing, task: Task | null = null): Shown {
  const fresh = at.link === 'live' && at.age_ms !== null && at.age_ms < STALE_MS;
  // A stop that was said stands until something newer is known.
  if (g?.state === 'stop' && fresh && g.wait_s !== null && g.wait_s !== undefined) {
    const why = whyOf(g, at) || t('wait.why');
    const title = t('wait', { time: seconds(Math.max(1, Math.ceil(g.wait_s))) });
    return { ...NOTHING, kind: 'stop', tone: 'stop', title, detail: why, why, near: g.near };
  }
  if (g?.state === 'stop') {
    const why = whyOf(g, at) || t('stop.why');
    const detail = fresh ? why : t('stop.broken', { why });
    return { ...NOTHING, kind: 'stop', tone: 'stop', title: t('stop'), detail, why, near: fresh ? g.near : [] };
  }
  if (!fresh && g && at.tracking === 'none' && at.age_ms !== null) return kept(g, at.age_ms, task);
  if (!fresh || !g) {
    const key = at.link === 'connecting' && at.age_ms === null ? 'connecting' : 'offline';
    return { ...NOTHING, kind: 'offline', tone: 'warn', title: t(key), detail: t(`${key}.detail`) };
  }
  if (at.tracking === 'lost')
    return { ...NOTHING, kind: 'lost', tone: 'warn', title: t('lost'), detail: t('lost.detail') };
  if (!at.aligned) return { ...NOTHING, kind: 'marks', tone: 'notice', title: t('marks'), detail: t('marks.detail') };
  return following(g, at, task);
}

/** A phone does not know where its wearer is: what it showed last is of use, if it says how old that is. */
function kept(g: Guidance, age_ms: number, task: Task | null): Shown {
  const mine = task?.id === g.assignment ? task : null;
  const detail = joined(
    mine ? t('sentence', { text: taskText(mine) }) : '',
    t('offline.kept', { time: duration(age_ms / 1000) }),
  );
  return { ...NOTHING, kind: 'offline', tone: 'warn', title: t('offline'), detail, path: g.path, next: g.next };
}

function following(g: Guidance, at: Standing, task: Task | null): Shown {
  const why = whyOf(g, at);
  const arrived = g.arrived === true && g.assignment !== null;
  const floor = { path: g.path, next: g.next, near: g.near, why, arrived };
  const guess = at.tracking === 'emulated' ? t('guess') : '';
  const length = g.path.length > 1 ? metres(lengthOf(g.path)) : '';
  const way = [length, g.eta_s === null ? '' : duration(g.eta_s)].filter(Boolean).join(' · ');
  const mine = task?.id === g.assignment ? task : null;
  const toDo = mine ? taskText(mine) : '';
  const said = toDo === '' ? '' : t('sentence', { text: toDo });
  switch (g.state) {
    case 'deviating':
      return {
        ...floor,
        kind: 'deviating',
        tone: 'warn',
        title: t('deviating'),
        detail: joined(why || t('cause.left_path'), guess),
      };
    case 'redirected':
      return {
        ...floor,
        kind: 'redirected',
        tone: 'notice',
        title: t('redirected'),
        detail: joined(why, said, way, guess),
      };
    case 'following':
      if (arrived) {
        // Whoever is there needs no "go to".
        const here = mine && mine.what.trim() === '' ? t('sentence', { text: mine.place }) : said;
        return { ...floor, kind: 'following', tone: 'calm', title: t('task.there'), detail: joined(why, here, guess) };
      }
      return {
        ...floor,
        kind: 'following',
        tone: 'calm',
        title: toDo || t('following'),
        detail: joined(why, way, guess),
      };
    default: {
      // Whoever is to wait is told why: the place of the task is closed, or the building is evacuated.
      const title = why ? t('idle.wait') : t('idle');
      return {
        ...floor,
        kind: 'idle',
        tone: why ? 'notice' : 'calm',
        title,
        detail: joined(why || t('idle.detail'), guess),
      };
    }
  }
}

/** What is to be done and where: "Count K1 at G6-7". */
export function taskText({ what, place }: Task): string {
  const words = what.trim();
  const short = words.length > LONGEST_WHAT ? `${words.slice(0, LONGEST_WHAT - 1).trimEnd()}…` : words;
  return short === '' ? t('task.place', { place }) : t('task', { what: short, place });
}

/** The kinds of causes that this page has sentences for; a newer server may know more. */
const CAUSES = [
  'left_path',
  'robot_comes',
  'robot_in_the_way',
  'robot_waits',
  'robot_passes',
  'robot_crosses',
  'place_unsure',
  'cuts_off',
  'round_closure',
  'leaves_closure',
  'place_closed',
  'evacuation',
  'no_way',
  'not_tracked',
] as const;

/** A phone has no marks to touch: its wearer taps the map. */
const BY_PHONE = ['place_unsure', 'not_tracked'] as const;

function whyOf({ cause, reason }: Guidance, { tracking }: Standing): string {
  const kind = CAUSES.find((one) => one === cause?.kind);
  const phone = tracking === 'none' ? BY_PHONE.find((one) => one === kind) : undefined;
  const key: Key | null = phone ? `cause.${phone}.phone` : kind ? `cause.${kind}` : null;
  if (key) return t(key, { robot: cause?.robot ?? '', closure: cause?.closure ?? '' });
  return reason === null ? '' : sentence(said(reason));
}

/** How the device makes itself felt when this replaces that: milliseconds on and off; empty for not at all. */
export function buzz(before: Shown['kind'] | null, now: Shown['kind']): number[] {
  if (before === now) return [];
  if (now === 'stop') return [400, 100, 400, 100, 400];
  if (now === 'redirected') return [150, 80, 150];
  return now === 'deviating' || now === 'lost' || (now === 'offline' && before !== null) ? [250] : [];
}

export const lengthOf = (path: readonly Point[]): number =>
  path.slice(1).reduce((sum, p, i) => sum + Math.hypot(p[0] - path[i]![0], p[1] - path[i]![1]), 0);
/** What there is of some sentences, one after the other. */
export const joined = (...parts: readonly string[]): string => parts.filter((part) => part !== '').join(' ');
const sentence = (text: string): string => {
  const begun = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(begun) ? begun : `${begun}.`;
};
