// What the server says of a station, as it comes over the wire.

/** A line: so many pieces from a slot into a tote. */
export interface Line {
  n: number;
  slot: string;
  quantity: number;
  tote: string;
  item: string | null;
  by: 'hand' | 'arm' | 'either';
  state: 'open' | 'lit' | 'done' | 'short' | 'undone' | 'arm';
  /** Pieces that are in the tote. */
  done: number;
}
/** How the slots of a rack are arranged: equally wide columns, and the middle of each row above the floor. */
export interface Face {
  columns: number;
  heights_m: readonly number[];
  width_m: number;
}
/** Where a tote stands, as the picker sees it who looks at the rack. */
export interface Tote {
  id: string;
  right_m: number;
  out_m: number;
}
export interface Visit {
  job: string;
  rack: string | null;
  robot: string;
  since: string | null;
  face: Face | null;
  lines: readonly Line[];
  pieces_left: number;
  expected_end: { p10: number; p50: number; p90: number } | null;
}
export interface Warning {
  kind: 'wrong_slot' | 'wrong_tote';
  slot: string | null;
  tote: string | null;
}
export interface Station {
  now: string;
  id: string;
  robot: string | null;
  queue: readonly string[];
  served: number;
  picking: boolean;
  paused: string | null;
  has_cell: boolean;
  totes: readonly Tote[];
  visit: Visit | null;
  /** The line that was not confirmed when its rack left. */
  unconfirmed: { job: string; line: Line } | null;
  next: { rack: string; robot: string; in_s: number | null } | null;
  arm: { kind: string } | null;
  /** Whether the hands of one person alone were seen of late, so that lines may be confirmed without a button. */
  hands_seen: boolean;
  /** Where hands most likely go: a slot or a tote. */
  reach: readonly { hand: 'left' | 'right'; slot: string | null; tote: string | null; probability: number }[];
  warnings: readonly Warning[];
}

/** Reads a message; null for what is none. What a server leaves out that has nothing to say is empty. */
export function readStation(text: string): Station | null {
  let read: unknown;
  try {
    read = JSON.parse(text);
  } catch {
    return null;
  }
  const given = read as Partial<Station> | null;
  if (typeof given !== 'object' || given === null) return null;
  if (typeof given.now !== 'string' || typeof given.id !== 'string') return null;
  return {
    robot: null,
    queue: [],
    served: 0,
    picking: false,
    paused: null,
    has_cell: false,
    totes: [],
    visit: null,
    unconfirmed: null,
    next: null,
    arm: null,
    hands_seen: false,
    reach: [],
    warnings: [],
    ...given,
    now: given.now,
    id: given.id,
  };
}
