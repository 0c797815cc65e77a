// The live feed: whole pictures of the floor, and patches of what changed. Keys that are not listed here are ignored,
// so that an older page keeps working with a newer server.
import type { Alarm } from './alarms';
import type { Closure } from './closures';
import type { Sentence } from './sentence';
import type { Worker, WorkerForecast } from './workers';

/** What a robot can be at, as the server says it. */
export const ACTIVITIES = [
  'idle',
  'driving',
  'handling',
  'picking',
  'queueing',
  'charging',
  'waiting',
  'paused',
  'stopped',
  'out_of_service',
  'offline',
  'failed',
] as const;
/** One that has left the floor keeps its place in the list of the feed, where robots go by number. */
export type Activity = (typeof ACTIVITIES)[number] | 'gone';
/** Whether the task of a robot goes on. */
export type RobotState = 'idle' | 'busy' | 'free' | 'interrupted' | 'failed' | 'gone';
export type Doing =
  | 'to_rack'
  | 'lifting'
  | 'carrying'
  | 'queueing'
  | 'picking'
  | 'returning'
  | 'setting_down'
  | 'to_charger'
  | 'charging'
  | 'parking'
  | 'going'
  | 'idle'
  | 'waiting'
  | 'failed';
export interface Robot {
  id: string;
  x: number;
  y: number;
  heading: number;
  speed: number;
  /** Null in recordings of earlier versions. */
  activity: Activity | null;
  /** Since when it has been at that, RFC 3339; null in recordings of earlier versions. */
  since: string | null;
  state: RobotState;
  doing: Doing;
  /** What robots of its kind are called. */
  kind: string;
  /** Whether it is in maintenance, or will be when it has finished what it has begun. */
  maintenance: boolean;
  /** Whether it is to leave the floor, and has not left yet. */
  leaving: boolean;
  /** What it says is wrong with it; `why` has it in words. */
  fault: 'broken' | 'emergency_stop' | 'manual' | 'obstructed' | 'unplugged' | null;
  rack: string | null;
  job: string | null;
  battery: number;
  /** Nodes that the robot may drive to now, in order. */
  granted: number[];
  /** Nodes kept for it further on, which it may not enter yet. */
  held: number[];
  why: Sentence | string | null;
  /** The worker whom it passes beside the line; null in recordings of earlier versions. */
  passes: string | null;
  /** Because of whom or what it got another way last, and when; null in recordings of earlier versions. */
  replanned: Replanned | null;
}
/** Because of whom or what a robot got another way. */
export interface Replanned {
  kind: 'worker' | 'closure' | 'robot' | 'obstruction';
  id: string | null;
  /** RFC 3339. */
  at: string;
}
export interface Rack {
  id: string;
  node: number | null;
  robot: string | null;
}
export interface Station {
  id: string;
  robot: string | null;
  queue: string[];
  served: number;
  /** Whether a rack stands there to be picked from. Older recordings do not say. */
  picking?: boolean;
  /** Since when nobody picks, by hand. */
  paused?: string | null;
}
export interface JobCounts {
  waiting: number;
  active: number;
  done: number;
  cancelled: number;
  failed: number;
}
export interface Counters {
  robot_deliveries: number;
  human_deliveries: number;
  deliveries_per_hour: number;
  encounters: number;
  deviations: number;
  interruptions: number;
  plan_us_p50: number;
  plan_us_p99: number;
  step_us_p99: number;
}
export interface Snapshot {
  type: 'snapshot';
  version: number;
  time_s: number;
  /** When `time_s` was zero, RFC 3339. Recordings of earlier versions do not say. */
  started?: string;
  /** The version of the map of which it speaks; recordings have their map with them. */
  map?: string;
  simulated: boolean;
  speed?: number;
  robots: Robot[];
  racks: Rack[];
  stations: Station[];
  workers: Worker[];
  closures: Closure[];
  /** Where people may be in the coming seconds. */
  forecasts?: WorkerForecast[];
  jobs: JobCounts;
  counters: Counters;
  alarms: Alarm[];
}
/** A row that carries only what changed. */
export type Changed<T extends { id: string }> = Pick<T, 'id'> & Partial<T>;
export interface Patch {
  type: 'patch';
  base: number;
  version: number;
  time_s?: number;
  robots?: Changed<Robot>[];
  racks?: Changed<Rack>[];
  stations?: Changed<Station>[];
  workers?: Changed<Worker>[];
  /** All of them, as they rarely change. */
  closures?: Closure[];
  /** All of them. */
  forecasts?: WorkerForecast[];
  jobs?: Partial<JobCounts>;
  counters?: Partial<Counters>;
  alarms?: Alarm[];

  // What changes all the time comes as numbers by row of the snapshot, one list for all rows (`thin=true`).
  // "Passed" is how many rows were passed over since the entry before.
  /** Passed, and the step from the base in millimetres: passed, dx, dy, passed, dx, dy … */
  moves?: number[];
  /** Passed, and the heading in milliradians. */
  turns?: number[];
  /** Passed, and the speed in centimetres a second. */
  speeds?: number[];
  /** Row, nodes left behind, nodes granted now, nodes of the rest that stay, and the nodes that come after. */
  ways?: number[][];
  /** Passed, x and y of a worker in millimetres, heading in milliradians, speed in centimetres a second. */
  walks?: (number | null)[];
  /** Row of a worker, points at the end of the path that stay, and those before them in millimetres: x, y … */
  paths?: number[][];
  /** All forecasts, one list each: row of the worker, then seconds ahead, percent, x, y, sx, sy in centimetres, tilt in
   *  percent … */
  ahead?: number[][];
}
export type Message = Snapshot | Patch;

/** A message of a kind this page does not know is null, and ignored; bad JSON throws. */
export function parseMessage(text: string): Message | null {
  const raw: unknown = JSON.parse(text);
  if (typeof raw !== 'object' || raw === null || !('type' in raw)) return null;
  return raw.type === 'snapshot' || raw.type === 'patch' ? (raw as Message) : null;
}
