// Areas that are closed, and what closing one does.
import type { Point } from './map';

/** Whom a closure keeps out. */
export type Binds = 'robots' | 'people' | 'both';
/** An area that robots, people or both keep out of. */
export interface Closure {
  id: string;
  outline: Point[];
  /** Those that are over are not sent. */
  state?: 'announced' | 'closed' | 'over';
  /** RFC 3339. */
  from?: string;
  /** Nothing until somebody opens it. */
  until?: string | null;
  /** Recordings from before people could be kept out have none: robots alone. */
  binds?: Binds;
  /** The recurring closure of which it is an occurrence. */
  series?: string | null;
  reason: string;
}
export interface NewClosure {
  outline: Point[];
  from?: string;
  until?: string;
  reason: string;
  binds: Binds;
  /** On every day from one time to another. */
  recurs?: { from: string; to: string; utc_offset: string };
}
/** Some things, the first of them by name. */
export interface Affected {
  total: number;
  first: string[];
}
/** What closing an area does to robots, racks and jobs. */
export interface ClosingEffect {
  nodes: number;
  /** Stations that no rack reaches, or leaves. */
  stations: string[];
  racks: Affected;
  trapped: Affected;
  /** Jobs that wait until it is opened. */
  waiting: Affected;
  /** Jobs whose robots are to pass it, until `clear_at`. */
  under_way: Affected;
  clear_at: string | null;
}
