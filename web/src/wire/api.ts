// Requests to the public API. Every answer is a value, never an exception: done, refused with a reason,
// or unreachable. The browser adds the cookie of the session; the page is told when the server wants somebody to sign
// in.
import type { Socket, SocketEvents } from './link';
import type { Past, Sum } from './past';
import type { ShiftReport } from './report';
import type { AlarmPage, AlarmRecord } from './alarms';
import type { AuditPage } from './audit';
import type { ClosingEffect, Closure, NewClosure } from './closures';
import type { EncounterPage, HeatKind, HeatPage, HistoryPage } from './history';
import type { Job, JobBatch, JobPage, JobState, NewJob } from './jobs';
import type { FloorMap, RobotKind } from './map';
import { linkedRequests } from './linked';
import type { RobotDetail, RobotHistoryPage } from './robots';
import type { Problem } from './sentence';
import type { StationDetail } from './station';
import type { Timelines, Why } from './why';
import type { WorkerDetail } from './workers';

export type Answer<T> = { kind: 'ok'; value: T } | { kind: 'refused'; problem: Problem } | { kind: 'unreachable' };

const PATIENCE_MS = 15_000;
/** Why nothing is changed while the past is shown. */
export const PAST: Problem = { title: '', status: 409 };

export class Api {
  /** Called when the server answers 401. */
  onLocked: () => void = () => {};
  /** While the past is shown, nothing is asked of the present that would change it, except to stop all robots. */
  shows: 'present' | 'past' = 'present';

  map = () => this.#ask<FloorMap>('GET', '/v1/map');
  kinds = () => this.#ask<RobotKind[]>('GET', '/v1/kinds');
  job = (id: string) => this.#ask<Job>('GET', `/v1/jobs/${encodeURIComponent(id)}`);
  /** Gives a job to this robot, or to any other than the one that has it. */
  reassign = (id: string, robot: string | null) =>
    this.#ask<Job>('POST', `/v1/jobs/${encodeURIComponent(id)}/reassign`, {}, robot === null ? {} : { robot });
  cancel = (id: string) => this.#ask<Job>('DELETE', `/v1/jobs/${encodeURIComponent(id)}`);

  why = (kind: 'robot' | 'job', id: string) => this.#ask<Why>('GET', `/v1/${kind}s/${encodeURIComponent(id)}/why`);
  previewClosure = (area: NewClosure) => this.#ask<ClosingEffect>('POST', '/v1/closures/preview', {}, area);
  close = (area: NewClosure) => this.#ask<Closure>('POST', '/v1/closures', {}, area);
  reopen = (id: string) => this.#ask<null>('DELETE', `/v1/closures/${encodeURIComponent(id)}`);

  evacuate = () => this.#ask<null>('POST', '/v1/evacuation');
  endEvacuation = () => this.#ask<null>('DELETE', '/v1/evacuation');
  stopFleet = () => this.#send<null>('POST', '/v1/fleet/stop');
  resumeFleet = () => this.#ask<null>('POST', '/v1/fleet/resume');
  pause = (robot: string) => this.#ask<null>('POST', `/v1/robots/${encodeURIComponent(robot)}/pause`);
  resume = (robot: string) => this.#ask<null>('POST', `/v1/robots/${encodeURIComponent(robot)}/resume`);
  maintain = (robot: string) => this.#ask<null>('PUT', `/v1/robots/${encodeURIComponent(robot)}/maintenance`);
  workAgain = (robot: string) => this.#ask<null>('DELETE', `/v1/robots/${encodeURIComponent(robot)}/maintenance`);
  robot = (id: string) => this.#ask<RobotDetail>('GET', `/v1/robots/${encodeURIComponent(id)}`);
  /** What happened to a robot, newest first: a page of it. */
  robotHistory = (id: string, cursor: string | null) => {
    const query = new URLSearchParams({ limit: '20', ...(cursor === null ? {} : { cursor }) });
    return this.#ask<RobotHistoryPage>('GET', `/v1/robots/${encodeURIComponent(id)}/history?${query}`);
  };
  /** Requests about robots of other vendors. */
  readonly linked = linkedRequests((method, path, body) => this.#ask(method, path, {}, body));
  retire = (robot: string) => this.#ask<null>('DELETE', `/v1/robots/${encodeURIComponent(robot)}`);
  stationDetail = (id: string) => this.#ask<StationDetail>('GET', `/v1/stations/${encodeURIComponent(id)}`);
  station = (id: string, says: 'done' | 'short' | 'pause' | 'resume') =>
    this.#ask<null>('POST', `/v1/stations/${encodeURIComponent(id)}/${says}`);
  clear = (worker: string, by: string) =>
    this.#ask<null>('POST', `/v1/workers/${encodeURIComponent(worker)}/clear`, {}, { by });
  narrow = (worker: string, where: { by: string; at: readonly [number, number]; within_m: number }) =>
    this.#ask<null>('POST', `/v1/workers/${encodeURIComponent(worker)}/narrow`, {}, where);
  prioritise = (id: string, priority: number) =>
    this.#ask<Job>('PATCH', `/v1/jobs/${encodeURIComponent(id)}`, {}, { priority });
  assign = (worker: string, task: { place: string; what: string; stay_s: number }, key: string) =>
    this.#ask<{ id: string }>(
      'POST',
      `/v1/workers/${encodeURIComponent(worker)}/assignments`,
      { 'Idempotency-Key': key },
      task,
    );

  timelines([x0, y0, x1, y1]: readonly number[], ahead: number): Promise<Answer<Timelines>> {
    const query = new URLSearchParams({ x0: `${x0}`, y0: `${y0}`, x1: `${x1}`, y1: `${y1}`, ahead_s: `${ahead}` });
    return this.#ask<Timelines>('GET', `/v1/timelines?${query}`);
  }

  /** What is kept of the past, with the bookmarks since a moment. */
  past = (since: number | null) => this.#ask<Past>('GET', since === null ? '/v1/past' : `/v1/past?from=${since}`);

  /** Running sums of a span, one for so many seconds. */
  figures = (from: number, to: number, step: number) =>
    this.#ask<{ sums: Sum[] }>('GET', `/v1/past/figures?from=${from}&to=${to}&step=${step}`);

  /** The frames of a span. */
  async reel(from: number, to: number, map: 'with map' | 'without map'): Promise<Answer<Blob>> {
    const query = new URLSearchParams({ from: `${from}`, to: `${to}`, map: `${map === 'with map'}` });
    return this.#ask<Blob>('GET', `/v1/past/reel?${query}`, { Accept: 'application/gzip' });
  }
  alarms = (query: Record<string, string>) => this.#ask<AlarmPage>('GET', `/v1/alarms?${new URLSearchParams(query)}`);
  /** People in order of joining, for those who may see names. */
  people = (cursor: string | null) =>
    this.#ask<{ items: { id: string; pseudonym: string; name: string }[]; next: string | null }>(
      'GET',
      `/v1/people?${new URLSearchParams({ limit: '500', ...(cursor === null ? {} : { cursor }) })}`,
    );
  audit = (query: Record<string, string>) => this.#ask<AuditPage>('GET', `/v1/audit?${new URLSearchParams(query)}`);
  acknowledge = (id: string, by: string) =>
    this.#ask<AlarmRecord>('POST', `/v1/alarms/${encodeURIComponent(id)}/acknowledge`, {}, { by });
  enrol = (name: string) => this.#ask<{ id: string; name: string }>('POST', '/v1/workers', {}, { name });
  seenAt = (worker: string, at: { x: number; y: number; accuracy_m: number }) =>
    this.#ask<unknown>('POST', `/v1/workers/${encodeURIComponent(worker)}/position`, {}, at);
  shelve = (id: string, body: { by: string; for_s: number; reason: string }) =>
    this.#ask<AlarmRecord>('POST', `/v1/alarms/${encodeURIComponent(id)}/shelve`, {}, body);
  unshelve = (id: string) => this.#ask<AlarmRecord>('DELETE', `/v1/alarms/${encodeURIComponent(id)}/shelve`);
  noteAlarm = (id: string, by: string, text: string) =>
    this.#ask<AlarmRecord>('POST', `/v1/alarms/${encodeURIComponent(id)}/notes`, {}, { by, text });
  worker = (id: string) => this.#ask<WorkerDetail>('GET', `/v1/workers/${encodeURIComponent(id)}`);
  history = (query: Record<string, string>) =>
    this.#ask<HistoryPage>('GET', `/v1/history?${new URLSearchParams(query)}`);
  heat = (kind: HeatKind, query: Record<string, string>) =>
    this.#ask<HeatPage>('GET', `/v1/heat?${new URLSearchParams({ kind, ...query })}`);
  encounters = (query: Record<string, string>) =>
    this.#ask<EncounterPage>('GET', `/v1/encounters?${new URLSearchParams(query)}`);

  report = (query: Record<string, string>) => this.#ask<ShiftReport>('GET', `/v1/report?${new URLSearchParams(query)}`);
  /** The same as a table: a line for each figure. */
  reportTable = (query: Record<string, string>) =>
    this.#ask<Blob>('GET', `/v1/report?${new URLSearchParams({ ...query, format: 'csv' })}`, { Accept: 'text/csv' });

  /** Where the table of encounters is as a file. */
  encountersFile = (query: Record<string, string>) =>
    `/v1/encounters?${new URLSearchParams({ ...query, format: 'csv' })}`;

  /** Jobs newest first; with `part`, those whose reference has it in it, three characters or more. */
  jobs(state: JobState | 'any', cursor: string | null, part = ''): Promise<Answer<JobPage>> {
    const query = new URLSearchParams({ limit: '50' });
    if (state !== 'any') query.set('state', state);
    if (part !== '') query.set('reference_part', part);
    if (cursor) query.set('cursor', cursor);
    return this.#ask<JobPage>('GET', `/v1/jobs?${query}`);
  }

  /** Jobs that were done since a time, newest first. */
  jobsDone(since: string, cursor: string | null): Promise<Answer<JobPage>> {
    const query = new URLSearchParams({ limit: '500', state: 'done', updated_since: since });
    if (cursor) query.set('cursor', cursor);
    return this.#ask<JobPage>('GET', `/v1/jobs?${query}`);
  }

  /** Jobs that are not over, newest first. */
  jobsOpen(cursor: string | null): Promise<Answer<JobPage>> {
    const query = new URLSearchParams({ limit: '500', state: 'waiting,assigned,carrying,picking' });
    if (cursor) query.set('cursor', cursor);
    return this.#ask<JobPage>('GET', `/v1/jobs?${query}`);
  }

  /** Jobs that a customer calls so, newest first. */
  jobsCalled = (reference: string) =>
    this.#ask<JobPage>('GET', `/v1/jobs?${new URLSearchParams({ limit: '5', reference })}`);

  submit(job: NewJob, key: string): Promise<Answer<Job>> {
    return this.#ask<Job>('POST', '/v1/jobs', { 'Idempotency-Key': key }, job);
  }

  /** Up to 1000 jobs, each with a key of its own, in one request: they become durable together. */
  submitAll(jobs: readonly { key: string; job: NewJob }[]): Promise<Answer<JobBatch>> {
    return this.#ask<JobBatch>('POST', '/v1/jobs:batch', {}, { jobs });
  }

  openLive(since: number | null, events: SocketEvents): Socket {
    const url = new URL('/v1/live', location.href);
    url.protocol = url.protocol.replace('http', 'ws');
    url.searchParams.set('thin', 'true');
    url.searchParams.set('packed', 'true');
    if (since !== null) url.searchParams.set('since', String(since));
    const socket = new WebSocket(url);
    socket.binaryType = 'arraybuffer';
    // Unpacking takes a moment: what comes meanwhile waits, since no message may overtake another one.
    let unpacking: Promise<void> | null = null;
    const inTurn = (run: () => void): void => {
      if (unpacking) void unpacking.finally(run);
      else run();
    };
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === 'string') return inTurn(() => events.message(data));
      const before = unpacking;
      const mine: Promise<void> = unpacked(data).then(async (text) => {
        await before;
        // What waited runs right after this, in the order in which it came.
        if (unpacking === mine) unpacking = null;
        events.message(text);
      });
      unpacking = mine;
    };
    socket.onclose = () => inTurn(() => events.closed());
    return socket;
  }

  async #ask<T>(method: string, path: string, headers: Record<string, string> = {}, body?: object): Promise<Answer<T>> {
    if (this.shows === 'past' && method !== 'GET') return { kind: 'refused', problem: PAST };
    return this.#send<T>(method, path, headers, body);
  }

  async #send<T>(
    method: string,
    path: string,
    headers: Record<string, string> = {},
    body?: object,
  ): Promise<Answer<T>> {
    const all: Record<string, string> = { Accept: 'application/json', ...headers };
    if (body) all['Content-Type'] = 'application/json';
    try {
      const response = await fetch(path, {
        method,
        headers: all,
        signal: AbortSignal.timeout(PATIENCE_MS),
        ...(body ? { body: JSON.stringify(body) } : {}),
      });
      // Done, with nothing to tell: 204, or 202 without a body.
      if (response.status === 204 || (response.ok && !response.headers.has('content-type')))
        return { kind: 'ok', value: null as T };
      if (response.ok) {
        const isFile = /^(application\/gzip|text\/csv)\b/.test(response.headers.get('content-type') ?? '');
        return { kind: 'ok', value: (await (isFile ? response.blob() : response.json())) as T };
      }
      if (response.status === 401) this.onLocked();
      return { kind: 'refused', problem: await problemOf(response) };
    } catch {
      return { kind: 'unreachable' };
    }
  }
}

/** The text of a message that came packed with gzip; an empty one, which nobody understands, if it is none. */
async function unpacked(data: ArrayBuffer): Promise<string> {
  try {
    return await new Response(new Blob([data]).stream().pipeThrough(new DecompressionStream('gzip'))).text();
  } catch {
    return '';
  }
}

async function problemOf(response: Response): Promise<Problem> {
  // Without words of its own, its status is all there is to tell.
  const plain = { title: '', status: response.status };
  try {
    const body: unknown = await response.json();
    return typeof body === 'object' && body !== null ? { ...plain, ...body } : plain;
  } catch {
    // A proxy in between answers in HTML.
    return plain;
  }
}
