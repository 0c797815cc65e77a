// One robot with what the live feed leaves out, and what happened to it.
import type { AlarmRecord } from './alarms';
import type { Replanned } from './feed';
import type { SentenceArg } from './sentence';

/** The link by which a robot is reached, and how it is with the robot there. */
export interface RobotLink {
  name: string;
  connected: boolean;
  /** How many visits the robot can be told beyond the last that it reached; null for any number. */
  capacity: number | null;
  /** Why it takes no orders, in the link's words; null where it takes them. */
  refuses: string | null;
}
/** One robot with what the feed leaves out. */
export interface RobotDetail {
  id: string;
  link: RobotLink;
  /** When its last report came in, RFC 3339; null if none has since the server started. */
  heard: string | null;
  silent_s: number | null;
  /** Since the server started. */
  driven_m: number;
  started: string;
  jobs_done: number;
  jobs_failed: number;
  alarms: AlarmRecord[];
}
/** Something that happened to a robot. */
export interface RobotEvent {
  at: string;
  kind: 'job' | 'alarm' | 'change' | 'replan';
  /** The job or the alarm. */
  id: string | null;
  /** The state of the job, the kind of the alarm, or the change in a word. */
  what: string;
  text: string | null;
  /** Of an alarm, which sentence the text is. */
  code?: string;
  args?: Record<string, SentenceArg>;
  ended: string | null;
  /** Of a replan: because of whom or what, and the nodes ahead before and since. */
  cause?: Pick<Replanned, 'kind' | 'id'>;
  was?: string[];
  now?: string[];
}
export interface RobotHistoryPage {
  items: RobotEvent[];
  next: string | null;
}
