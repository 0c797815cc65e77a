// Requests of this page to the public API; the browser adds the cookie of the session.
import type { MapFile } from './file';

export interface Finding {
  severity: 'error' | 'warning';
  place: string;
  text: string;
  remedy: string;
  nodes: string[];
  at: [number, number][];
}
export interface Review {
  good: boolean;
  errors: number;
  warnings: number;
  findings: Finding[];
}
export interface Waited {
  node: string;
  x: number;
  y: number;
  seconds: number;
}
export interface Trial {
  robots: number;
  simulated_s: number;
  complete: boolean;
  took_s: number;
  deliveries: number;
  deliveries_per_hour: number;
  mean_job_s: number | null;
  waited: Waited[];
  waited_s: number;
  law_violations: number;
  broken: string[];
}
/** Where the map in operation comes from; null where it is the file with which the server was started. */
export type Origin = { number: number; at: string; by: string } | null;
export interface MapChange {
  what: string;
  how: 'added' | 'removed' | 'moved' | 'changed';
  count: number;
  names: string[];
  at: [number, number][];
}
/** Something on the floor that is in the way, or would be lost. */
export interface CarryFinding {
  text: string;
  remedy: string;
  at: [number, number][];
}
/** What publishing a map would mean now. */
export interface Outlook {
  version: string;
  published: Origin;
  good: boolean;
  review: Review;
  changes: MapChange[];
  obstacles: CarryFinding[];
  losses: CarryFinding[];
  notes: string[];
}
export interface Published {
  version: string;
  published: Origin;
  losses: CarryFinding[];
  notes: string[];
}
export type Answer<T> =
  | { kind: 'ok'; value: T; version: string | null }
  | { kind: 'refused'; status: number; text: string }
  | { kind: 'locked' }
  | { kind: 'unreachable' };

const JSON_BODY = { 'Content-Type': 'application/json' };

export class Server {
  map = (): Promise<Answer<MapFile>> => this.#ask('GET', '/v1/map:file');
  check = (text: string, signal?: AbortSignal): Promise<Answer<Review>> =>
    this.#ask('POST', '/v1/maps:check', text, {}, signal);
  try = (map: MapFile, robots: number, jobs_per_hour: number | null): Promise<Answer<Trial>> =>
    this.#ask(
      'POST',
      '/v1/maps:try',
      JSON.stringify({ map, robots, ...(jobs_per_hour === null ? {} : { jobs_per_hour }) }),
    );
  outlook = (text: string): Promise<Answer<Outlook>> => this.#ask('POST', '/v1/map:check', text);
  /** Publishes a map that is based on a version of the one in operation. */
  publish = (text: string, version: string, losses: 'accept' | 'refuse'): Promise<Answer<Published>> =>
    this.#ask('PUT', `/v1/map${losses === 'accept' ? '?accept_losses=true' : ''}`, text, {
      'If-Match': `"${version}"`,
    });

  async #ask<T>(
    method: string,
    path: string,
    body?: string,
    more: Record<string, string> = {},
    signal?: AbortSignal,
  ): Promise<Answer<T>> {
    const headers = body === undefined ? more : { ...JSON_BODY, ...more };
    try {
      const answer = await fetch(path, {
        method,
        headers,
        ...(body === undefined ? {} : { body }),
        ...(signal ? { signal } : {}),
      });
      const version = answer.headers.get('ETag')?.replace(/^W\/|"/g, '') ?? null;
      if (answer.ok) return { kind: 'ok', value: (await answer.json()) as T, version };
      if (answer.status === 401) return { kind: 'locked' };
      const problem = (await answer.json().catch(() => ({}))) as { detail?: string };
      return {
        kind: 'refused',
        status: answer.status,
        text: problem.detail ?? `The server answered ${answer.status}.`,
      };
    } catch {
      return { kind: 'unreachable' };
    }
  }
}

/** What an answer without a value means, for people. */
export function whyNot(answer: Exclude<Answer<unknown>, { kind: 'ok' }>): string {
  if (answer.kind === 'refused') return answer.text;
  return answer.kind === 'locked' ? 'Nobody is signed in.' : 'The server cannot be reached.';
}
