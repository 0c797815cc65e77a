// Requests of this page to the public API; the browser adds the cookie of the session.
import type { MapFile } from './file';

export interface Finding { severity: 'error' | 'warning'; place: string; text: string; remedy: string; nodes: string[]; at: [number, number][] }
export interface Review { good: boolean; errors: number; warnings: number; findings: Finding[] }
export interface Waited { node: string; x: number; y: number; seconds: number }
export interface Trial {
  robots: number; simulated_s: number; complete: boolean; took_s: number; deliveries: number; deliveries_per_hour: number;
  mean_job_s: number | null; waited: Waited[]; waited_s: number; law_violations: number; broken: string[];
}
export type Answer<T> = { kind: 'ok'; value: T } | { kind: 'refused'; text: string } | { kind: 'locked' } | { kind: 'unreachable' };

export class Server {
  map = (): Promise<Answer<MapFile>> => this.#ask('GET', '/v1/map:file');
  check = (text: string, signal?: AbortSignal): Promise<Answer<Review>> => this.#ask('POST', '/v1/maps:check', text, signal);
  try = (map: MapFile, robots: number, jobs_per_hour: number | null): Promise<Answer<Trial>> =>
    this.#ask('POST', '/v1/maps:try', JSON.stringify({ map, robots, ...(jobs_per_hour === null ? {} : { jobs_per_hour }) }));

  async #ask<T>(method: string, path: string, body?: string, signal?: AbortSignal): Promise<Answer<T>> {
    const headers: Record<string, string> = body === undefined ? {} : { 'Content-Type': 'application/json' };
    try {
      const answer = await fetch(path, { method, headers, ...(body === undefined ? {} : { body }), ...(signal ? { signal } : {}) });
      if (answer.ok) return { kind: 'ok', value: (await answer.json()) as T };
      if (answer.status === 401) return { kind: 'locked' };
      const problem = (await answer.json().catch(() => ({}))) as { detail?: string };
      return { kind: 'refused', text: problem.detail ?? `The server answered ${answer.status}.` };
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
