// What is picked at one station now.

/** What is picked at a station now. */
export interface StationDetail {
  has_cell: boolean;
  visit: {
    lines: {
      n: number;
      slot: string;
      tote: string;
      quantity: number;
      done: number;
      state: 'open' | 'lit' | 'done' | 'short' | 'undone' | 'arm';
    }[];
    pieces_left: number;
    expected_end: { p10: number; p50: number; p90: number } | null;
  } | null;
  arm: {
    state: 'off' | 'idle' | 'moving' | 'stopped' | 'stuck' | 'trouble';
    line: { job: string; n: number } | null;
  } | null;
  /** How well the ends of visits were expected as they began. */
  ends: { visits: number; held: number | null; off_s: number | null };
  warnings: { slot: string | null; tote: string | null }[];
}
