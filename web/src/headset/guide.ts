// What the wearer is to see now: the server's guidance, judged by how well position and connection are known. Pure.
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
export interface Guidance {
  state: GuidanceState;
  reason: string | null;
  version: number;
  path: Point[];
  next: Point | null;
  eta_s: number | null;
  /** For about how long to wait for a robot to pass, seconds. */
  wait_s?: number | null;
  assignment: string | null;
  near: NearRobot[];
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
}

/** Guidance comes four times a second. */
export const STALE_MS = 2_000;
const NOTHING = { path: [], next: null, near: [] } as const;

export function show(g: Guidance | null, at: Standing): Shown {
  const fresh = at.link === 'live' && at.age_ms !== null && at.age_ms < STALE_MS;
  // A stop that was said stands until something newer is known.
  if (g?.state === 'stop' && fresh && g.wait_s !== null && g.wait_s !== undefined) {
    const detail = sentence(g.reason ?? 'a robot passes');
    return { kind: 'stop', tone: 'stop', title: `WAIT ${Math.max(1, Math.ceil(g.wait_s))} s`, detail, ...NOTHING, near: g.near };
  }
  if (g?.state === 'stop') {
    const why = sentence(g.reason ?? 'the fleet asks you to');
    return { kind: 'stop', tone: 'stop', title: 'STOP', detail: fresh ? why : `${why} The connection has been lost since then.`, ...NOTHING, near: fresh ? g.near : [] };
  }
  if (!fresh || !g) {
    const waiting = at.link === 'connecting' && at.age_ms === null;
    return {
      kind: 'offline', tone: 'warn', title: waiting ? 'Connecting' : 'No connection',
      detail: waiting ? 'The server has not answered yet.' : 'No guidance. Robots do not know where you are: look out for yourself.', ...NOTHING,
    };
  }
  if (at.tracking === 'lost') {
    return { kind: 'lost', tone: 'warn', title: 'Position lost', detail: 'Stand still and look around slowly. Robots keep away from where you were.', ...NOTHING };
  }
  if (!at.aligned) return { kind: 'marks', tone: 'notice', title: 'Marks needed', detail: 'Show this device where it is.', ...NOTHING };
  return following(g, at);
}

function following(g: Guidance, at: Standing): Shown {
  const floor = { path: g.path, next: g.next, near: g.near };
  const guess = at.tracking === 'emulated' ? ' The position is a guess.' : '';
  const way = [g.path.length > 1 ? far(lengthOf(g.path)) : '', g.eta_s === null ? '' : clock(g.eta_s)].filter(Boolean).join(' · ');
  switch (g.state) {
    case 'deviating':
      return { kind: 'deviating', tone: 'warn', title: 'The path is over there', detail: sentence(g.reason ?? 'you left the path') + guess, ...floor };
    case 'redirected':
      return { kind: 'redirected', tone: 'notice', title: 'Redirected: a new path', detail: [g.reason ? sentence(g.reason) : '', way].filter(Boolean).join(' ') + guess, ...floor };
    case 'following':
      return { kind: 'following', tone: 'calm', title: 'Follow the path', detail: [g.reason ? sentence(g.reason) : '', way].filter(Boolean).join(' ') + guess, ...floor };
    default:
      // Whoever is to wait is told why: the place of the task is closed, or the building is evacuated.
      return { kind: 'idle', tone: g.reason ? 'notice' : 'calm', title: g.reason ? 'Wait here' : 'Nothing to do', detail: (g.reason ? sentence(g.reason) : 'Wait for the next task.') + guess, ...floor };
  }
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
export const far = (m: number): string => (m < 10 ? `${m.toFixed(1)} m` : `${Math.round(m)} m`);
const clock = (s: number): string => {
  const whole = Math.max(0, Math.round(s));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
};
const sentence = (text: string): string => {
  const begun = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(begun) ? begun : `${begun}.`;
};
