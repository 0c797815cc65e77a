// What travels between this page and the server: the public API, and nothing else. Keys that are not
// listed here are ignored, so that an older page keeps working with a newer server.
import type { Act } from './acts';

export type NodeKind = 'aisle' | 'storage' | 'station' | 'queue' | 'charger' | 'parking' | 'exit';
export type Traveller = 'loaded' | 'unloaded' | 'people';
export type Point = [x: number, y: number];

/** Metres and radians in a right-handed frame with y up; only the screen flips y. */
export interface FloorMap {
  /** Names what is in it; earlier recordings do not say. */
  version?: string;
  name: string;
  bounds: [x0: number, y0: number, x1: number, y1: number];
  footprint_m: number;
  nodes: MapNode[];
  lanes: Lane[];
  stations: { id: string; node: number; queue: number[] }[];
  racks: { id: string; node: number }[];
  obstacles: Point[][];
  walkable: Point[][];
  /** Marks on the floor, by which headsets find where they are; none where a file does not say. */
  marks?: readonly { name: string; x: number; y: number }[];
  /** The kinds of robots that may join; empty where a file does not say. */
  kinds?: readonly RobotKind[];
}
/** An outline around the point on which a robot turns, metres. */
export type Footprint = { square_m: number } | { circle_m: number } | { polygon_m: Point[] };
export interface RobotKind {
  name: string;
  /** Null for the square that the map gives. */
  footprint: Footprint | null;
  footprint_loaded: Footprint | null;
}
export interface MapNode {
  id: string;
  x: number;
  y: number;
  kind: NodeKind;
}
export interface Lane {
  from: number;
  to: number;
  both: boolean;
  for: Traveller[];
}

/** What a robot can be at, as the server says it. */
export const ACTIVITIES = [
  'idle',
  'driving',
  'handling',
  'picking',
  'queueing',
  'charging',
  'waiting',
  'paused',
  'stopped',
  'out_of_service',
  'offline',
  'failed',
] as const;
/** One that has left the floor keeps its place in the list of the feed, where robots go by number. */
export type Activity = (typeof ACTIVITIES)[number] | 'gone';
/** What the server says to people: which sentence, what stands in its places, and the same in English. Recordings of earlier
 *  versions have the text alone. */
export interface Sentence {
  code?: string | null;
  args?: Record<string, SentenceArg>;
  text: string;
}
export type SentenceArg = string | number | Sentence | readonly SentenceArg[];
/** Whether the task of a robot goes on. */
export type RobotState = 'idle' | 'busy' | 'free' | 'interrupted' | 'failed' | 'gone';
export type Doing =
  | 'to_rack'
  | 'lifting'
  | 'carrying'
  | 'queueing'
  | 'picking'
  | 'returning'
  | 'setting_down'
  | 'to_charger'
  | 'charging'
  | 'parking'
  | 'going'
  | 'idle'
  | 'waiting'
  | 'failed';

export interface Robot {
  id: string;
  x: number;
  y: number;
  heading: number;
  speed: number;
  /** Null in recordings of earlier versions. */
  activity: Activity | null;
  /** Since when it has been at that, RFC 3339; null in recordings of earlier versions. */
  since: string | null;
  state: RobotState;
  doing: Doing;
  /** What robots of its kind are called. */
  kind: string;
  /** Whether it is in maintenance, or will be when it has finished what it has begun. */
  maintenance: boolean;
  /** Whether it is to leave the floor, and has not left yet. */
  leaving: boolean;
  /** What it says is wrong with it; `why` has it in words. */
  fault: 'broken' | 'emergency_stop' | 'manual' | 'obstructed' | 'unplugged' | null;
  rack: string | null;
  job: string | null;
  battery: number;
  /** Nodes that the robot may drive to now, in order. */
  granted: number[];
  /** Nodes kept for it further on, which it may not enter yet. */
  held: number[];
  why: Sentence | string | null;
  /** The worker whom it passes beside the line; null in recordings of earlier versions. */
  passes: string | null;
  /** Because of whom or what it got another way last, and when; null in recordings of earlier versions. */
  replanned: Replanned | null;
}
/** Because of whom or what a robot got another way. */
export interface Replanned {
  kind: 'worker' | 'closure' | 'robot' | 'obstruction';
  id: string | null;
  /** RFC 3339. */
  at: string;
}
/** One robot with what the feed leaves out. */
export interface RobotDetail {
  id: string;
  /** When its last report came in, RFC 3339; null if none has since the server started. */
  heard: string | null;
  silent_s: number | null;
  /** Since the server started. */
  driven_m: number;
  started: string;
  jobs_done: number;
  jobs_failed: number;
  alarms: AlarmRecord[];
}
/** Something that happened to a robot. */
export interface RobotEvent {
  at: string;
  kind: 'job' | 'alarm' | 'change' | 'replan';
  /** The job or the alarm. */
  id: string | null;
  /** The state of the job, the kind of the alarm, or the change in a word. */
  what: string;
  text: string | null;
  /** Of an alarm, which sentence the text is. */
  code?: string;
  args?: Record<string, SentenceArg>;
  ended: string | null;
  /** Of a replan: because of whom or what, and the nodes ahead before and since. */
  cause?: Pick<Replanned, 'kind' | 'id'>;
  was?: string[];
  now?: string[];
}
export interface RobotHistoryPage {
  items: RobotEvent[];
  next: string | null;
}
export interface Rack {
  id: string;
  node: number | null;
  robot: string | null;
}
export interface Station {
  id: string;
  robot: string | null;
  queue: string[];
  served: number;
  /** Whether a rack stands there to be picked from. Older recordings do not say. */
  picking?: boolean;
  /** Since when nobody picks, by hand. */
  paused?: string | null;
}
export type Presence = 'absent' | 'tracked' | 'stale' | 'lost';
export type GuidanceState = 'idle' | 'following' | 'deviating' | 'redirected' | 'stop';
export interface Goal {
  x: number;
  y: number;
  /** Probability. */
  p: number;
}
export interface Worker {
  id: string;
  name: string;
  presence: Presence;
  /** null while the worker has not been seen. */
  x: number | null;
  y: number | null;
  heading: number | null;
  speed: number;
  /** One standard deviation of the position, metres. */
  accuracy: number;
  /** Where a person who is lost may be: places that robots keep out of, metres; empty while the person is seen. */
  area: Point[];
  /** Radii, metres: robots stop, keep out, go slowly. */
  regions: [stop: number, out: number, slow: number];
  state: GuidanceState;
  reason: Sentence | string | null;
  /** From here on, metres. */
  path: Point[];
  assignment: string | null;
  /** Most probable first. */
  goals: Goal[];
  undecided: number;
  elsewhere: number;
}
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
/** One bell curve of where somebody may be: metres, standard deviations and correlation. */
export interface Curve {
  /** How far ahead, seconds. */
  after_s: number;
  /** Its share of the probability at that moment. */
  p: number;
  x: number;
  y: number;
  sx: number;
  sy: number;
  tilt: number;
}
export interface WorkerForecast {
  worker: string;
  parts: readonly Curve[];
}
export interface JobCounts {
  waiting: number;
  active: number;
  done: number;
  cancelled: number;
  failed: number;
}
export interface Counters {
  robot_deliveries: number;
  human_deliveries: number;
  deliveries_per_hour: number;
  encounters: number;
  deviations: number;
  interruptions: number;
  plan_us_p50: number;
  plan_us_p99: number;
  step_us_p99: number;
}
export const SEVERITIES = ['critical', 'warning', 'notice'] as const;
export type Severity = (typeof SEVERITIES)[number];
export type SubjectKind = 'robot' | 'worker' | 'job' | 'station' | 'closure' | 'floor' | 'server';
/** An active alarm in the feed. What recordings of earlier versions lack is optional: there the id was the kind. */
export interface Alarm extends Sentence {
  id: string;
  since_s: number;
  kind?: string;
  severity?: Severity;
  subject_kind?: SubjectKind;
  /** Null for the floor and the server. */
  subject?: string | null;
  remedy?: Sentence | string;
  x?: number | null;
  y?: number | null;
  /** How many robots wait because of it. */
  waiting?: number;
  acknowledged_by?: string | null;
  /** Until when somebody has put it aside, RFC 3339. */
  shelved_until?: string | null;
  /** What can be done about it in one request. */
  acts?: readonly Act[];
  /** Of a group: the alarms of single robots in it. */
  members?: readonly { id: string; subject: string; acknowledged_by: string | null }[];
}
/** An alarm in the list, active or past. */
export interface AlarmRecord extends Sentence {
  id: string;
  kind: string;
  severity: Severity;
  state: 'active' | 'cleared';
  subject: { kind: SubjectKind; id: string };
  remedy: Sentence;
  x: number | null;
  y: number | null;
  waiting: number;
  since: string;
  acknowledged: { by: string; at: string } | null;
  shelved: { by: string; at: string; until: string; reason: string } | null;
  notes: { by: string; at: string; text: string }[];
  acts: Act[];
  group: string | null;
  members: AlarmMember[];
  cleared: string | null;
}
export interface AlarmMember extends Sentence {
  id: string;
  subject: { kind: SubjectKind; id: string };
  x: number | null;
  y: number | null;
  since: string;
  acknowledged_by: string | null;
}
export type AuditOutcome = 'done' | 'refused' | 'failed' | 'unanswered';
/** A request that was to change something: who asked, in which role, and what came of it. */
export interface AuditEntry {
  id: string;
  at: string;
  actor: string;
  role: string;
  what: string;
  /** The same as an act; null where another version knew it. */
  act?: Act | null;
  subject: string | null;
  outcome: AuditOutcome;
  status: number | null;
}
export interface AuditPage {
  items: AuditEntry[];
  next: string | null;
}
export interface AlarmPage {
  items: AlarmRecord[];
  next: string | null;
}

export interface Snapshot {
  type: 'snapshot';
  version: number;
  time_s: number;
  /** When `time_s` was zero, RFC 3339. Recordings of earlier versions do not say. */
  started?: string;
  /** The version of the map of which it speaks; recordings have their map with them. */
  map?: string;
  simulated: boolean;
  robots: Robot[];
  racks: Rack[];
  stations: Station[];
  workers: Worker[];
  closures: Closure[];
  /** Where people may be in the coming seconds. */
  forecasts?: WorkerForecast[];
  jobs: JobCounts;
  counters: Counters;
  alarms: Alarm[];
}
/** A row that carries only what changed. */
export type Changed<T extends { id: string }> = Pick<T, 'id'> & Partial<T>;
export interface Patch {
  type: 'patch';
  base: number;
  version: number;
  time_s?: number;
  robots?: Changed<Robot>[];
  racks?: Changed<Rack>[];
  stations?: Changed<Station>[];
  workers?: Changed<Worker>[];
  /** All of them, as they rarely change. */
  closures?: Closure[];
  /** All of them. */
  forecasts?: WorkerForecast[];
  jobs?: Partial<JobCounts>;
  counters?: Partial<Counters>;
  alarms?: Alarm[];

  // What changes all the time comes as numbers by row of the snapshot, one list for all rows (`thin=true`).
  // "Passed" is how many rows were passed over since the entry before.
  /** Passed, and the step from the base in millimetres: passed, dx, dy, passed, dx, dy … */
  moves?: number[];
  /** Passed, and the heading in milliradians. */
  turns?: number[];
  /** Passed, and the speed in centimetres a second. */
  speeds?: number[];
  /** Row, nodes left behind, nodes granted now, nodes of the rest that stay, and the nodes that come after. */
  ways?: number[][];
  /** Passed, x and y of a worker in millimetres, heading in milliradians, speed in centimetres a second. */
  walks?: (number | null)[];
  /** Row of a worker, points at the end of the path that stay, and those before them in millimetres: x, y … */
  paths?: number[][];
  /** All forecasts, one list each: row of the worker, then seconds ahead, percent, x, y, sx, sy in centimetres, tilt in percent … */
  ahead?: number[][];
}
export type Message = Snapshot | Patch;

/** A message of a kind this page does not know is null, and ignored; bad JSON throws. */
export function parseMessage(text: string): Message | null {
  const raw: unknown = JSON.parse(text);
  if (typeof raw !== 'object' || raw === null || !('type' in raw)) return null;
  return raw.type === 'snapshot' || raw.type === 'patch' ? (raw as Message) : null;
}

export const JOB_KINDS = ['deliver', 'return', 'relocate', 'charge', 'park', 'go'] as const;
export type JobKind = (typeof JOB_KINDS)[number];
export const JOB_STATES = ['waiting', 'assigned', 'carrying', 'picking', 'done', 'cancelled', 'failed'] as const;
export type JobState = (typeof JOB_STATES)[number];

/** A line of a delivery: so many pieces from a slot of the rack into a tote. */
export interface OrderLine {
  n: number;
  slot: string;
  quantity: number;
  tote: string;
  item: string | null;
  state: 'open' | 'lit' | 'done' | 'short' | 'undone';
  /** Pieces in the tote. */
  done: number;
}

export interface Job {
  id: string;
  /** What the customer calls it. */
  reference?: string | null;
  kind: JobKind;
  rack: string | null;
  station: string | null;
  /** The stations of a delivery to several of them, in their order; empty for one. */
  stops?: { station: string; served: string | null; lines?: OrderLine[] }[];
  /** What is picked at its station; of several, `stops` have it. */
  lines?: OrderLine[];
  node: string | null;
  robot: string | null;
  /** The robot that an operator has chosen for it, until a robot has it. */
  only?: string | null;
  priority: number;
  deadline: string | null;
  state: JobState;
  why: Sentence | null;
  created: string;
  updated: string;
}
export interface JobPage {
  items: Job[];
  next: string | null;
}
export interface NewJob {
  kind: JobKind;
  rack?: string;
  station?: string;
  stops?: { station: string; pick_s?: number }[];
  node?: string;
  robot?: string;
  priority: number;
  deadline?: string;
  pick_s?: number;
  reference?: string;
}
/** What became of each of many jobs, in their order. */
export interface JobBatch {
  accepted: number;
  refused: number;
  results: { id: string | null; new: boolean; problem: Problem | null }[];
}

/** One link of a wait chain. */
export interface WhyLink {
  who: string;
  kind: 'robot' | 'job' | 'worker';
  /** resource, queue, person, closure … or, if it waits for nothing, stop, drives, later, stays. */
  cause: string;
  /** In words, without its own name. */
  text: Sentence;
  by: string | null;
  by_kind: 'robot' | 'worker' | 'job' | 'closure' | 'station' | null;
  ahead: number;
  /** RFC 3339; null if it cannot be known. */
  until: string | null;
  until_s: number | null;
}
export interface Why {
  id: string;
  waiting: boolean;
  text: string;
  /** From the one that waits to the root. */
  chain: WhyLink[];
}

/** What holds the nodes of an area when; times are seconds from `at`, null is for ever. */
export interface Timelines {
  at: string;
  ahead_s: number;
  nodes: Strip[];
}
export interface Strip {
  id: string;
  x: number;
  y: number;
  holds: Hold[];
  conditions: Condition[];
  regions: RegionStay[];
}
/** The place is in the safety region of a robot or a worker for a time. */
export interface RegionStay {
  of: string;
  kind: 'robot' | 'worker';
  /** 2: nothing is planned into it; 3: robots are slow. */
  region: 2 | 3;
  from_s: number;
  to_s: number | null;
}
export interface Hold {
  by: string;
  kind: 'robot' | 'worker';
  from_s: number;
  to_s: number | null;
  /** The holder may be there already, rather than only being promised it. */
  granted: boolean;
  /** Only something in conflict with the node is held. */
  conflict: boolean;
}
export interface Condition {
  by: string;
  kind: 'worker' | 'closure' | 'robot' | 'obstruction';
  from_s: number;
  to_s: number | null;
  effect: 'closed' | 'still' | 'slow' | 'price';
  limit_mps: [unloaded: number, loaded: number] | null;
  price_s: number | null;
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
/** Figures over time; buckets of which nothing is known are left out. */
export interface HistoryPage {
  from: string;
  to: string;
  step_s: number;
  /** When `time_s` of the live feed was zero. */
  started: string;
  /** How the fleet deals with people. */
  arm: string;
  buckets: Bucket[];
}
export interface Bucket {
  at: string;
  covered_s: number;
  robot_deliveries: number;
  human_deliveries: number;
  encounters: number;
  interruptions: number;
  replans: number;
  /** Seconds of workers on the floor, all together. */
  worker_s: number;
  /** Seconds that robots stood and would have driven on, all together. */
  waiting_s: number;
  /** At picking stations: lines that were over, reaches that were warned of, seconds without a rack of all together. */
  lines: number;
  wrong_reaches: number;
  idle_s: number;
  plan_us_p50: number | null;
  plan_us_p95: number | null;
  plan_us_max: number | null;
  step_us_max: number | null;
}
export const HEAT_KINDS = ['waiting', 'encounters'] as const;
export type HeatKind = (typeof HEAT_KINDS)[number];
export interface HeatPage {
  kind: HeatKind;
  from: string;
  to: string;
  /** Side of the square that stands for a place, metres. */
  size: number;
  cells: { x: number; y: number; node: string | null; amount: number }[];
}
export const REACTIONS = ['kept', 'slowed', 'held', 'rerouted', 'stopped'] as const;
export type Reaction = (typeof REACTIONS)[number];
/** A robot came into region 1 of a worker. */
export interface Encounter {
  id: number;
  /** Null when it has been forgotten who it was. */
  worker: string | null;
  robot: string;
  began: string;
  lasted_s: number;
  x: number;
  y: number;
  /** Which region of the worker the robot came into. */
  region: number;
  radius: number;
  closest: number;
  robot_speed: number;
  worker_speed: number;
  reaction: Reaction;
  delay_s: number;
}
export interface EncounterPage {
  items: Encounter[];
  next: string | null;
}
/** One worker with what the live feed leaves out. */
export interface WorkerDetail {
  id: string;
  /** The name for those who may see names, and the pseudonym of the live feed for others. */
  name: string;
  connected: boolean;
  clock_error_ms: number | null;
  age_s: number | null;
  accuracy: number;
  feed: { taken: number; late: number; jumps: number; absurd: number };
  /** The oldest first. */
  sequence: Episode[];
}
/** A stretch of time in which a worker was most probably up to the same thing. */
export interface Episode {
  state: 'goal' | 'undecided' | 'elsewhere';
  x: number | null;
  y: number | null;
  since: string;
}

/** One wrong field; the detail is a sentence. */
export interface FieldError {
  field: string;
  detail: string;
  code?: string;
  args?: Record<string, SentenceArg>;
}
/** RFC 9457, with the field each error belongs to. */
export interface Problem {
  type?: string;
  title: string;
  status: number;
  detail?: string;
  /** Which sentence the detail is. */
  code?: string;
  args?: Record<string, SentenceArg>;
  errors?: FieldError[];
}
