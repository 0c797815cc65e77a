// The page's copy of the floor: a pure reducer over snapshots and patches. Untouched rows keep their
// identity from one version to the next. It opens no socket and reads no clock.
import type { Alarm } from './alarms';
import type { Closure } from './closures';
import type { Activity, Changed, Counters, JobCounts, Message, Patch, Rack, Robot, RobotState, Station } from './feed';
import type { WorkerForecast, Worker } from './workers';

export interface Table<T> {
  readonly rows: readonly T[];
  readonly at: ReadonlyMap<string, number>;
}
export interface Mirror {
  /** null until the first snapshot. */
  readonly version: number | null;
  readonly time_s: number;
  /** When `time_s` was zero, in milliseconds of the epoch; null where a recording does not say. */
  readonly started: number | null;
  /** The version of the map; null where nothing says it. */
  readonly map: string | null;
  readonly source: 'simulated' | 'real' | 'unknown';
  /** Seconds of the floor in a second: more than 1 where a simulated floor runs fast. */
  readonly speed: number;
  readonly robots: Table<Robot>;
  readonly racks: Table<Rack>;
  readonly stations: Table<Station>;
  readonly workers: Table<Worker>;
  readonly closures: readonly Closure[];
  readonly forecasts: readonly WorkerForecast[];
  readonly jobs: JobCounts;
  readonly counters: Counters;
  readonly alarms: readonly Alarm[];
}
/** The robots without those that have left. */
export const onFloor = (mirror: Mirror): readonly Robot[] => mirror.robots.rows.filter((r) => r.state !== 'gone');

/** What earlier versions recorded, in the words of today. */
const OF_STATE: Record<RobotState, Activity> = {
  idle: 'idle',
  busy: 'driving',
  free: 'driving',
  interrupted: 'waiting',
  failed: 'failed',
  gone: 'gone',
};
/** What a robot is at. */
export const activityOf = (robot: Pick<Robot, 'activity' | 'state'>): Activity =>
  robot.activity ?? OF_STATE[robot.state];

/** For how long a robot has been at what it is at, seconds; null where a recording does not say. */
export function ageOf(mirror: Pick<Mirror, 'time_s' | 'started'>, robot: Pick<Robot, 'since'>): number | null {
  if (mirror.started === null || robot.since === null) return null;
  const since_s = (Date.parse(robot.since) - mirror.started) / 1_000;
  return Math.max(0, mirror.time_s - since_s);
}
/** `gap`: the patch builds on another version, and only a new snapshot helps. */
export type Reduced = { kind: 'snapshot' | 'patched'; mirror: Mirror } | { kind: 'gap' };

const NO_JOBS: JobCounts = { waiting: 0, active: 0, done: 0, cancelled: 0, failed: 0 };
const NO_COUNTERS: Counters = {
  robot_deliveries: 0,
  human_deliveries: 0,
  deliveries_per_hour: 0,
  encounters: 0,
  deviations: 0,
  interruptions: 0,
  plan_us_p50: 0,
  plan_us_p99: 0,
  step_us_p99: 0,
};
const BLANK_ROBOT: Robot = {
  id: '',
  x: 0,
  y: 0,
  heading: 0,
  speed: 0,
  activity: null,
  since: null,
  state: 'idle',
  doing: 'idle',
  kind: 'robot',
  maintenance: false,
  leaving: false,
  fault: null,
  rack: null,
  job: null,
  battery: 1,
  granted: [],
  held: [],
  why: null,
  passes: null,
  replanned: null,
};
const BLANK_RACK: Rack = { id: '', node: null, robot: null };
const BLANK_STATION: Station = { id: '', robot: null, queue: [], served: 0, picking: false, paused: null };
const BLANK_WORKER: Worker = {
  id: '',
  name: '',
  vehicle: null,
  presence: 'absent',
  x: null,
  y: null,
  heading: null,
  speed: 0,
  accuracy: 0,
  area: [],
  regions: [0, 0, 0],
  state: 'idle',
  reason: null,
  path: [],
  assignment: null,
  goals: [],
  undecided: 1,
  elsewhere: 0,
};

export const EMPTY: Mirror = {
  version: null,
  time_s: 0,
  started: null,
  map: null,
  source: 'unknown',
  speed: 1,
  robots: tableOf([], BLANK_ROBOT),
  racks: tableOf([], BLANK_RACK),
  stations: tableOf([], BLANK_STATION),
  workers: tableOf([], BLANK_WORKER),
  closures: [],
  forecasts: [],
  jobs: NO_JOBS,
  counters: NO_COUNTERS,
  alarms: [],
};

export function reduce(mirror: Mirror, message: Message): Reduced {
  if (message.type === 'patch') {
    if (message.base !== mirror.version) return { kind: 'gap' };
    return { kind: 'patched', mirror: patched(mirror, message) };
  }
  return {
    kind: 'snapshot',
    mirror: {
      version: message.version,
      time_s: message.time_s,
      started: message.started === undefined ? null : Date.parse(message.started),
      map: message.map ?? null,
      source: message.simulated ? 'simulated' : 'real',
      speed: message.speed ?? 1,
      robots: tableOf(message.robots, BLANK_ROBOT),
      racks: tableOf(message.racks, BLANK_RACK),
      stations: tableOf(message.stations, BLANK_STATION),
      workers: tableOf(message.workers, BLANK_WORKER),
      closures: message.closures ?? [],
      forecasts: message.forecasts ?? [],
      jobs: overlay(NO_JOBS, message.jobs),
      counters: overlay(NO_COUNTERS, message.counters),
      alarms: message.alarms ?? [],
    },
  };
}

export function row<T>(table: Table<T>, id: string | null): T | undefined {
  const at = id === null ? undefined : table.at.get(id);
  return at === undefined ? undefined : table.rows[at];
}

function patched(old: Mirror, patch: Patch): Mirror {
  const workers = walk(merge(old.workers, patch.workers, BLANK_WORKER), old.workers, patch);
  return {
    version: patch.version,
    time_s: patch.time_s ?? old.time_s,
    started: old.started,
    map: old.map,
    source: old.source,
    speed: old.speed,
    robots: drive(merge(old.robots, patch.robots, BLANK_ROBOT), old.robots, patch),
    racks: merge(old.racks, patch.racks, BLANK_RACK),
    stations: merge(old.stations, patch.stations, BLANK_STATION),
    workers,
    closures: patch.closures ?? old.closures,
    forecasts: patch.ahead
      ? patch.ahead.map((numbers) => forecastOf(numbers, workers))
      : (patch.forecasts ?? old.forecasts),
    jobs: overlay(old.jobs, patch.jobs),
    counters: overlay(old.counters, patch.counters),
    alarms: patch.alarms ?? old.alarms,
  };
}

function tableOf<T extends { id: string }>(rows: readonly Changed<T>[] | undefined, blank: T): Table<T> {
  return merge<T>({ rows: [], at: new Map() }, rows, blank);
}

function merge<T extends { id: string }>(
  old: Table<T>,
  changes: readonly Changed<T>[] | undefined,
  blank: T,
): Table<T> {
  if (!changes || changes.length === 0) return old;
  const rows = old.rows.slice();
  let at = old.at as Map<string, number>;
  for (const change of changes) {
    const i = at.get(change.id);
    if (i !== undefined) {
      rows[i] = overlay(rows[i]!, change);
      continue;
    }
    // A row that joined since the snapshot. The index is shared with older mirrors until it grows.
    if (at === old.at) at = new Map(old.at);
    at.set(change.id, rows.length);
    rows.push(overlay(blank, change));
  }
  return { rows, at };
}

/** Takes over what came as numbers about robots. */
function drive(table: Table<Robot>, old: Table<Robot>, patch: Patch): Table<Robot> {
  const { moves = [], turns = [], speeds = [], ways = [] } = patch;
  if (moves.length + turns.length + speeds.length + ways.length === 0) return table;
  const own = ownRows(table, old);
  for (let k = 0, i = 0; k + 2 < moves.length; k += 3, i++) {
    const robot = own.row((i += moves[k]!));
    if (!robot) continue;
    robot.x = (Math.round(robot.x * 1_000) + moves[k + 1]!) / 1_000;
    robot.y = (Math.round(robot.y * 1_000) + moves[k + 2]!) / 1_000;
  }
  for (let k = 0, i = 0; k + 1 < turns.length; k += 2, i++) {
    const robot = own.row((i += turns[k]!));
    if (robot) robot.heading = turns[k + 1]! / 1_000;
  }
  for (let k = 0, i = 0; k + 1 < speeds.length; k += 2, i++) {
    const robot = own.row((i += speeds[k]!));
    if (robot) robot.speed = speeds[k + 1]! / 100;
  }
  for (const [i = -1, left = 0, granted = 0, stay = 0, ...after] of ways) {
    const robot = own.row(i);
    if (!robot) continue;
    const way = [...robot.granted, ...robot.held].slice(left, left + stay).concat(after);
    robot.granted = way.slice(0, granted);
    robot.held = way.slice(granted);
  }
  return own.table;
}

/** Takes over what came as numbers about workers. */
function walk(table: Table<Worker>, old: Table<Worker>, { walks = [], paths = [] }: Patch): Table<Worker> {
  if (walks.length + paths.length === 0) return table;
  const own = ownRows(table, old);
  const part = (n: number | null | undefined, by: number) => (n === null || n === undefined ? null : n / by);
  for (let k = 0, i = 0; k + 4 < walks.length; k += 5, i++) {
    const worker = own.row((i += walks[k] ?? 0));
    if (!worker) continue;
    worker.x = part(walks[k + 1], 1_000);
    worker.y = part(walks[k + 2], 1_000);
    worker.heading = part(walks[k + 3], 1_000);
    worker.speed = part(walks[k + 4], 100) ?? 0;
  }
  for (const [i = -1, stay = 0, ...fresh] of paths) {
    const worker = own.row(i);
    if (!worker) continue;
    const before: Worker['path'] = [];
    for (let k = 0; k + 1 < fresh.length; k += 2) before.push([fresh[k]! / 1_000, fresh[k + 1]! / 1_000]);
    worker.path = before.concat(stay === 0 ? [] : worker.path.slice(-stay));
  }
  return own.table;
}

/** What is forecast of one worker, from numbers. */
function forecastOf([row = -1, ...n]: readonly number[], workers: Table<Worker>): WorkerForecast {
  const parts: WorkerForecast['parts'] = Array.from({ length: Math.floor(n.length / 7) }, (_, k) => {
    const [after_s = 0, p = 0, x = 0, y = 0, sx = 0, sy = 0, tilt = 0] = n.slice(7 * k, 7 * k + 7);
    return { after_s, p: p / 100, x: x / 100, y: y / 100, sx: sx / 100, sy: sy / 100, tilt: tilt / 100 };
  });
  return { worker: workers.rows[row]?.id ?? '', parts };
}

/** Rows that may be changed: each is copied once, and rows of the older mirror stay as they were. */
function ownRows<T extends { id: string }>(
  table: Table<T>,
  old: Table<T>,
): { table: Table<T>; row(i: number): T | undefined } {
  const rows = table.rows.slice();
  const row = (i: number): T | undefined => {
    const known = rows[i];
    if (known === undefined || known !== old.rows[i]) return known;
    return (rows[i] = { ...known });
  };
  return { table: { rows, at: table.at }, row };
}

/** Takes from `changes` only the keys that `old` has, so an unknown key never spreads into the page. */
function overlay<T extends object>(old: T, changes: Partial<T> | undefined): T {
  if (!changes) return old;
  const next = { ...old };
  for (const key in old) {
    const value = changes[key];
    if (value !== undefined) next[key] = value as T[typeof key];
  }
  return next;
}
