// Requests of this page to the public API, with the token where one is wanted.
import { said } from '../language';
import type { Line, LineEvents } from './feed';
import type { Task } from './guide';
import type { FloorMap, Problem, RobotKind, Worker } from '../wire';

export type Answer<T> =
  { kind: 'ok'; value: T } | { kind: 'locked' } | { kind: 'refused'; text: string } | { kind: 'unreachable' };

const TOKEN = 'giveway.token';
const PATIENCE_MS = 15_000;

export class Server {
  get token(): string {
    return sessionStorage.getItem(TOKEN) ?? '';
  }
  set token(token: string) {
    sessionStorage.setItem(TOKEN, token);
  }

  map = () => this.#ask<FloorMap>('GET', '/v1/map');
  kinds = () => this.#ask<RobotKind[]>('GET', '/v1/kinds');
  workers = () => this.#ask<{ items: Worker[] }>('GET', '/v1/workers?limit=200');
  worker = (id: string) => this.#ask<Worker>('GET', `/v1/workers/${encodeURIComponent(id)}`);
  /** What an assignment of a worker is about; null where the server does not say. */
  task = async (worker: string, assignment: string): Promise<Task | null> => {
    const answer = await this.#ask<{ items: Task[] }>(
      'GET',
      `/v1/workers/${encodeURIComponent(worker)}/assignments?limit=50`,
    );
    return answer.kind === 'ok' ? (answer.value.items.find(({ id }) => id === assignment) ?? null) : null;
  };
  /** The same name is the same worker. */
  hire = (name: string) => this.#ask<Worker>('POST', '/v1/workers', { name });
  /** The worker has left the floor, and says so. */
  clear = (id: string, by: string) => this.#ask<null>('POST', `/v1/workers/${encodeURIComponent(id)}/clear`, { by });

  open(id: string, events: LineEvents): Line {
    const url = new URL(`/v1/workers/${encodeURIComponent(id)}/feed`, location.href);
    url.protocol = url.protocol.replace('http', 'ws');
    const socket = new WebSocket(url, this.token ? ['giveway', `bearer.${this.token}`] : ['giveway']);
    socket.onopen = () => events.opened();
    socket.onmessage = ({ data }) => events.message(String(data));
    socket.onclose = ({ code, reason }) => events.closed(code, reason);
    return { send: (text) => socket.send(text), close: () => socket.close(), waiting: () => socket.bufferedAmount };
  }

  async #ask<T>(method: string, path: string, body?: object): Promise<Answer<T>> {
    const headers: Record<string, string> = { Accept: 'application/json' };
    if (this.token) headers['Authorization'] = `Bearer ${this.token}`;
    if (body) headers['Content-Type'] = 'application/json';
    try {
      const response = await fetch(path, {
        method,
        headers,
        signal: AbortSignal.timeout(PATIENCE_MS),
        ...(body ? { body: JSON.stringify(body) } : {}),
      });
      if (response.status === 401) return { kind: 'locked' };
      if (response.status === 204) return { kind: 'ok', value: null as T };
      if (response.ok) return { kind: 'ok', value: (await response.json()) as T };
      const problem = (await response.json().catch(() => ({}))) as Partial<Problem>;
      const { detail, title, ...sentence } = problem;
      return {
        kind: 'refused',
        text: said({ ...sentence, text: detail ?? title ?? `the server answered ${response.status}` }),
      };
    } catch {
      return { kind: 'unreachable' };
    }
  }
}
