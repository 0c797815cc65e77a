// What the server and a reel say of the past: spans, bookmarks, running sums.
import type { Encounter } from './history';
import type { Sentence } from './sentence';

/** What is kept of the past, in seconds from the server's start. */
export interface Past {
  /** RFC 3339; null in a recorded simulation. */
  start: string | null;
  now_s: number;
  /** A recording is shown, and no fleet. */
  recording: boolean;
  spans: { from_s: number; to_s: number }[];
  bookmarks: Mark[];
}

export const MARK_KINDS = ['deviation', 'encounter', 'replan', 'stop', 'failure', 'closure', 'alarm'] as const;
export type MarkKind = (typeof MARK_KINDS)[number];
export interface Mark {
  at_s: number;
  kind: MarkKind;
  words: Sentence | string;
  who: string[];
  place: [x: number, y: number] | null;
  /** The details of an encounter; older versions wrote none. */
  encounter?: Met;
}
/** An encounter in the seconds of the reel; its bookmark says when it began. */
export type Met = Omit<Encounter, 'id' | 'began' | 'lasted_s' | 'region'> & { ended_s: number };
/** What was counted so far: differences are figures. */
export interface Sum {
  at_s: number;
  /** Seconds of which there are frames. */
  covered_s: number;
  robot_deliveries: number;
  human_deliveries: number;
  encounters: number;
  interruptions: number;
  replans: number;
  waiting_s: number;
  worker_s: number;
  plan_us_p50: number;
  plan_us_p99: number;
}
