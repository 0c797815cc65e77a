// Workers: a row of the live feed, where each may be soon, and one worker in detail.
import type { Point } from './map';
import type { Sentence } from './sentence';

export type Presence = 'absent' | 'tracked' | 'stale' | 'lost';
export type GuidanceState = 'idle' | 'following' | 'deviating' | 'redirected' | 'stop';
export interface Goal {
  x: number;
  y: number;
  /** Probability. */
  p: number;
}
/** A vehicle that somebody drives: metres, and metres per second. The worker's place is that of its tag. */
export interface Vehicle {
  length_m: number;
  width_m: number;
  /** From the tag to the rear end. */
  behind_m: number;
  speed_mps: number;
  accel_mps2: number;
  brake_mps2: number;
}
export interface Worker {
  id: string;
  name: string;
  /** null on foot. */
  vehicle: Vehicle | null;
  presence: Presence;
  /** null while the worker has not been seen. */
  x: number | null;
  y: number | null;
  heading: number | null;
  speed: number;
  /** One standard deviation of the position, metres. */
  accuracy: number;
  /** Where a person who is lost may be: places that robots keep out of, metres; empty while the person is seen. */
  area: Point[];
  /** Radii, metres: robots stop, keep out, go slowly. */
  regions: [stop: number, out: number, slow: number];
  state: GuidanceState;
  reason: Sentence | string | null;
  /** From here on, metres. */
  path: Point[];
  assignment: string | null;
  /** Most probable first. */
  goals: Goal[];
  undecided: number;
  elsewhere: number;
}
/** One bell curve of where somebody may be: metres, standard deviations and correlation. */
export interface Curve {
  /** How far ahead, seconds. */
  after_s: number;
  /** Its share of the probability at that moment. */
  p: number;
  x: number;
  y: number;
  sx: number;
  sy: number;
  tilt: number;
}
export interface WorkerForecast {
  worker: string;
  parts: readonly Curve[];
}
/** One worker with what the live feed leaves out. */
export interface WorkerDetail {
  id: string;
  /** The name for those who may see names, and the pseudonym of the live feed for others. */
  name: string;
  connected: boolean;
  clock_error_ms: number | null;
  age_s: number | null;
  accuracy: number;
  feed: { taken: number; late: number; jumps: number; absurd: number };
  /** The oldest first. */
  sequence: Episode[];
}
/** A stretch of time in which a worker was most probably up to the same thing. */
export interface Episode {
  state: 'goal' | 'undecided' | 'elsewhere';
  x: number | null;
  y: number | null;
  since: string;
}
