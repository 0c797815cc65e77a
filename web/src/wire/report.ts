// What the server says of a stretch of time, for the leader of a shift.
import type { Act } from './acts';
import type { Activity } from './feed';

export interface Quantiles {
  p50: number;
  p95: number;
}

export interface ShiftReport {
  from: string;
  to: string;
  /** Seconds of that in which the server ran; rates and shares are of these. */
  covered_s: number;
  deliveries: {
    done: number;
    per_hour: number;
    with_deadline: number;
    late: number;
    overdue: number;
    order_to_station_s: Quantiles | null;
    order_to_done_s: Quantiles | null;
  };
  jobs: { kind: string; done: number; failed: number; cancelled: number }[];
  stations: {
    station: string;
    deliveries: number;
    per_hour: number;
    late: number;
    picking_share: number;
    order_to_station_s: Quantiles | null;
    pick_s: Quantiles | null;
  }[];
  robots: { mean: number; shares: Partial<Record<Activity, number>> };
  waiting: { cause: WaitCause; robot_s: number; share: number }[];
  chargers: { count: number; share: number };
  /** What was done, the most frequent first; an older server does not say. */
  acts?: { act: Act; count: number }[];
  alarms: { kind: string; count: number; lasted_s: number }[];
  people: { worker_h: number; assignments_done: number; deviations: number; interruptions: number };
  encounters: {
    count: number;
    per_worker_hour: number | null;
    closest_m: { min: number; p50: number } | null;
    reactions: Record<string, number>;
  };
}

/** What waiting robots wait for in the end. */
export type WaitCause =
  'traffic' | 'person' | 'closure' | 'station' | 'robot_out' | 'by_hand' | 'obstacle' | 'no_route';
