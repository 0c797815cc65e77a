// Jobs and orders for them.
import type { Problem, Sentence } from './sentence';

export const JOB_KINDS = ['deliver', 'return', 'relocate', 'charge', 'park', 'go'] as const;
export type JobKind = (typeof JOB_KINDS)[number];
export const JOB_STATES = ['waiting', 'assigned', 'carrying', 'picking', 'done', 'cancelled', 'failed'] as const;
export type JobState = (typeof JOB_STATES)[number];
/** A line of a delivery: so many pieces from a slot of the rack into a tote. */
export interface OrderLine {
  n: number;
  slot: string;
  quantity: number;
  tote: string;
  item: string | null;
  state: 'open' | 'lit' | 'done' | 'short' | 'undone';
  /** Pieces in the tote. */
  done: number;
}
export interface Job {
  id: string;
  /** What the customer calls it. */
  reference?: string | null;
  kind: JobKind;
  rack: string | null;
  station: string | null;
  /** The stations of a delivery to several of them, in their order; empty for one. */
  stops?: { station: string; served: string | null; lines?: OrderLine[] }[];
  /** What is picked at its station; of several, `stops` have it. */
  lines?: OrderLine[];
  node: string | null;
  robot: string | null;
  /** The robot that an operator has chosen for it, until a robot has it. */
  only?: string | null;
  priority: number;
  deadline: string | null;
  state: JobState;
  why: Sentence | null;
  created: string;
  updated: string;
}
export interface JobPage {
  items: Job[];
  next: string | null;
}
export interface NewJob {
  kind: JobKind;
  rack?: string;
  station?: string;
  stops?: { station: string; pick_s?: number }[];
  node?: string;
  robot?: string;
  priority: number;
  deadline?: string;
  pick_s?: number;
  reference?: string;
}
/** What became of each of many jobs, in their order. */
export interface JobBatch {
  accepted: number;
  refused: number;
  results: { id: string | null; new: boolean; problem: Problem | null }[];
}
