// Requests of this page to the public API. The browser adds the cookie of the session.
import type { Said } from '../language';
import type { Problem, Socket, SocketEvents } from '../wire';

export type Answer<T> =
  | { kind: 'ok'; value: T }
  | { kind: 'locked' }
  | { kind: 'unknown' }
  | { kind: 'refused'; said: Said | null; status: number }
  | { kind: 'unreachable' };

/** What is said about a line: so many more pieces, that the slot is empty, or that all that is taken back. */
export type Change = { done: number } | { short: true } | { undo: true };
export interface Changed {
  job: string;
  n: number;
  state: string;
  done: number;
  changed: boolean;
}

const PATIENCE_MS = 15_000;

async function ask<T>(method: string, path: string, body?: object): Promise<Answer<T>> {
  const headers: Record<string, string> = { Accept: 'application/json' };
  if (body) headers['Content-Type'] = 'application/json';
  try {
    const sent = body ? { body: JSON.stringify(body) } : {};
    const response = await fetch(path, { method, headers, signal: AbortSignal.timeout(PATIENCE_MS), ...sent });
    if (response.status === 204) return { kind: 'ok', value: null as T };
    if (response.ok) return { kind: 'ok', value: (await response.json()) as T };
    if (response.status === 401) return { kind: 'locked' };
    if (response.status === 404) return { kind: 'unknown' };
    const problem = (await response.json().catch(() => ({}))) as Partial<Problem>;
    const { detail, title, ...sentence } = problem;
    const text = detail ?? title;
    return { kind: 'refused', said: text === undefined ? null : { ...sentence, text }, status: response.status };
  } catch {
    return { kind: 'unreachable' };
  }
}

const at = (id: string): string => `/v1/stations/${encodeURIComponent(id)}`;

export const stations = (): Promise<Answer<{ items: { id: string }[] }>> => ask('GET', '/v1/stations?limit=500');
export const station = (id: string): Promise<Answer<object>> => ask('GET', at(id));
export const changeLine = (id: string, n: number, change: Change): Promise<Answer<Changed>> =>
  ask('POST', `${at(id)}/lines/${n}`, change);
/** The same of the line that was not confirmed when its rack left. */
export const changeLast = (id: string, change: Change): Promise<Answer<Changed>> =>
  ask('POST', `${at(id)}/last`, change);
export const say = (id: string, word: 'done' | 'pause' | 'resume' | 'release'): Promise<Answer<null>> =>
  ask('POST', `${at(id)}/${word}`);

export function openLive(id: string, events: SocketEvents): Socket {
  const url = new URL(`${at(id)}/live`, location.href);
  url.protocol = url.protocol.replace('http', 'ws');
  const socket = new WebSocket(url);
  socket.onmessage = ({ data }) => events.message(String(data));
  socket.onclose = () => events.closed();
  return socket;
}

/** Where the browser signs in and comes back from. `session/` says the same, but comes with Svelte. */
export const signInAt = ({ pathname, search }: Pick<Location, 'pathname' | 'search'>): string =>
  `/sign-in?${new URLSearchParams({ back: pathname + search })}`;
