// Figures over time, heat maps and encounters.

/** Figures over time; buckets of which nothing is known are left out. */
export interface HistoryPage {
  from: string;
  to: string;
  step_s: number;
  /** When `time_s` of the live feed was zero. */
  started: string;
  /** How the fleet deals with people. */
  arm: string;
  buckets: Bucket[];
}
export interface Bucket {
  at: string;
  covered_s: number;
  robot_deliveries: number;
  human_deliveries: number;
  encounters: number;
  interruptions: number;
  replans: number;
  /** Seconds of workers on the floor, all together. */
  worker_s: number;
  /** Seconds that robots stood and would have driven on, all together. */
  waiting_s: number;
  /** At picking stations: lines that were over, reaches that were warned of, seconds without a rack of all together. */
  lines: number;
  wrong_reaches: number;
  idle_s: number;
  plan_us_p50: number | null;
  plan_us_p95: number | null;
  plan_us_max: number | null;
  step_us_max: number | null;
}
export const HEAT_KINDS = ['waiting', 'encounters'] as const;
export type HeatKind = (typeof HEAT_KINDS)[number];
export interface HeatPage {
  kind: HeatKind;
  from: string;
  to: string;
  /** Side of the square that stands for a place, metres. */
  size: number;
  cells: { x: number; y: number; node: string | null; amount: number }[];
}
export const REACTIONS = ['kept', 'slowed', 'held', 'rerouted', 'stopped'] as const;
export type Reaction = (typeof REACTIONS)[number];
/** A robot came into region 1 of a worker. */
export interface Encounter {
  id: number;
  /** Null when it has been forgotten who it was. */
  worker: string | null;
  robot: string;
  began: string;
  lasted_s: number;
  x: number;
  y: number;
  /** Which region of the worker the robot came into. */
  region: number;
  radius: number;
  closest: number;
  robot_speed: number;
  worker_speed: number;
  reaction: Reaction;
  delay_s: number;
}
export interface EncounterPage {
  items: Encounter[];
  next: string | null;
}
