// Rows and messages for tests, complete and dull, to be changed where a test needs it.
import type { Robot, Snapshot, Worker } from '../src/wire/types';

export const robot = (id: string, more: Partial<Robot> = {}): Robot => ({
  id, x: 0, y: 0, heading: 0, speed: 0, activity: 'idle', since: '1970-01-01T00:00:00Z', state: 'idle', doing: 'idle', kind: 'robot', maintenance: false, leaving: false, fault: null, rack: null, job: null, battery: 1,
  granted: [], held: [], why: null, passes: null, replanned: null, ...more,
});

export const worker = (id: string, more: Partial<Worker> = {}): Worker => ({
  id, name: id, presence: 'tracked', x: 0, y: 0, heading: 0, speed: 0, accuracy: 0.1, area: [], regions: [1, 2, 3],
  state: 'idle', reason: null, path: [], assignment: null, goals: [], undecided: 1, elsewhere: 0, ...more,
});

export const snapshot = (more: Partial<Snapshot> = {}): Snapshot => ({
  type: 'snapshot', version: 1, time_s: 0, started: '1970-01-01T00:00:00Z', simulated: true, robots: [], racks: [], stations: [],
  workers: [], closures: [],
  jobs: { waiting: 0, active: 0, done: 0, cancelled: 0, failed: 0 },
  counters: {
    robot_deliveries: 0, human_deliveries: 0, deliveries_per_hour: 0, encounters: 0,
    deviations: 0, interruptions: 0,
    plan_us_p50: 0, plan_us_p99: 0, step_us_p99: 0,
  },
  alarms: [], ...more,
});
