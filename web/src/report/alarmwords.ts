// Kinds of alarms in a few words, as the report counts them; docs/alarms.md has a table of all kinds.
import { wordsBy } from '../words';

export const ALARM_WORDS: Readonly<Record<string, string>> = wordsBy({
  robot_failed: 'alarm.kind.robot_failed', emergency_stop: 'alarm.kind.emergency_stop',
  robot_silent: 'alarm.kind.robot_silent', robot_displaced: 'alarm.kind.robot_displaced',
  robot_obstructed: 'alarm.kind.robot_obstructed', robot_unplugged: 'alarm.kind.robot_unplugged',
  robot_low: 'alarm.kind.robot_low', robot_blocked: 'alarm.kind.robot_blocked',
  robot_stuck: 'alarm.kind.robot_stuck', grant: 'alarm.kind.grant', robot_returned: 'alarm.kind.robot_returned',
  fenced: 'alarm.kind.fenced', waits: 'alarm.kind.waits', standstill: 'alarm.kind.standstill',
  floor_standstill: 'alarm.kind.floor_standstill', deliveries: 'alarm.kind.deliveries',
  worker_lost: 'alarm.kind.worker_lost', worker_kept: 'alarm.kind.worker_kept',
  closed_areas: 'alarm.kind.closed_areas', job_stuck: 'alarm.kind.job_stuck',
  deadline_at_risk: 'alarm.kind.deadline_at_risk', deadline_missed: 'alarm.kind.deadline_missed',
  station_starved: 'alarm.kind.station_starved', flow: 'alarm.kind.flow', arm_trouble: 'alarm.kind.arm_trouble',
  steps_late: 'alarm.kind.steps_late',
  plan_backlog: 'alarm.kind.plan_backlog', forecast: 'alarm.kind.forecast', clock: 'alarm.kind.clock',
  journal: 'alarm.kind.journal', halt: 'alarm.kind.halt', database: 'alarm.kind.database', loop: 'alarm.kind.loop',
  broken: 'alarm.kind.broken', ledger: 'alarm.kind.ledger', past: 'alarm.kind.past', stopped: 'alarm.kind.stopped',
  paused: 'alarm.kind.paused', evacuation: 'alarm.kind.evacuation',
});
