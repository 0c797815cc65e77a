// Why something waits, and what holds the nodes of an area when.
import type { Sentence } from './sentence';

/** One link of a wait chain. */
export interface WhyLink {
  who: string;
  kind: 'robot' | 'job' | 'worker';
  /** resource, queue, person, closure … or, if it waits for nothing, stop, drives, later, stays. */
  cause: string;
  /** In words, without its own name. */
  text: Sentence;
  by: string | null;
  by_kind: 'robot' | 'worker' | 'job' | 'closure' | 'station' | null;
  ahead: number;
  /** RFC 3339; null if it cannot be known. */
  until: string | null;
  until_s: number | null;
}
export interface Why {
  id: string;
  waiting: boolean;
  text: string;
  /** From the one that waits to the root. */
  chain: WhyLink[];
}
/** What holds the nodes of an area when; times are seconds from `at`, null is for ever. */
export interface Timelines {
  at: string;
  ahead_s: number;
  nodes: Strip[];
}
export interface Strip {
  id: string;
  x: number;
  y: number;
  holds: Hold[];
  conditions: Condition[];
  regions: RegionStay[];
}
/** The place is in the safety region of a robot or a worker for a time. */
export interface RegionStay {
  of: string;
  kind: 'robot' | 'worker';
  /** 2: nothing is planned into it; 3: robots are slow. */
  region: 2 | 3;
  from_s: number;
  to_s: number | null;
}
export interface Hold {
  by: string;
  kind: 'robot' | 'worker';
  from_s: number;
  to_s: number | null;
  /** The holder may be there already, rather than only being promised it. */
  granted: boolean;
  /** Only something in conflict with the node is held. */
  conflict: boolean;
}
export interface Condition {
  by: string;
  kind: 'worker' | 'closure' | 'robot' | 'obstruction';
  from_s: number;
  to_s: number | null;
  effect: 'closed' | 'still' | 'slow' | 'price';
  limit_mps: [unloaded: number, loaded: number] | null;
  price_s: number | null;
}
