// What the list of alarms shows, and which of them call for a person: pure, so that it can be tested without a page.
import type { Picked } from '../floor';
import type { Alarm, AlarmRecord, Severity, SubjectKind } from '../wire';
import { wordsBy } from '../words';

export const SEVERITY_WORDS = wordsBy<Severity>({
  critical: 'alarm.critical',
  warning: 'alarm.warning',
  notice: 'alarm.notice',
});

/** Recordings of earlier versions do not say how bad an alarm was. */
export const severityOf = (alarm: Alarm): Severity => alarm.severity ?? 'warning';

/** Whether somebody should look after it and nobody does yet. */
export const calls = (alarm: Alarm): boolean =>
  severityOf(alarm) !== 'notice' && !alarm.acknowledged_by && !alarm.shelved_until;

/** The title of the tab, with how many alarms call for a person. */
export function titleOf(alarms: readonly Alarm[]): string {
  const count = alarms.filter(calls).length;
  return count === 0 ? 'Giveway' : `(${count}) Giveway`;
}

/** Alarms that call for a person and did not the last time; `known` is what did then, with how bad each was. */
export function fresh(alarms: readonly Alarm[], known: ReadonlyMap<string, Severity>): Alarm[] {
  const isWorse = (now: Severity, before: Severity): boolean => now === 'critical' && before !== 'critical';
  return alarms.filter((alarm) => {
    const before = known.get(alarm.id);
    return calls(alarm) && (before === undefined || isWorse(severityOf(alarm), before));
  });
}

/** What a click on the subject does: choose it on the floor, open a job, show a place; or there is nothing to show. */
export type Shows =
  | { kind: 'pick'; picked: Picked }
  | { kind: 'job'; id: string }
  | { kind: 'place'; at: [number, number] }
  | { kind: 'nothing' };

interface Shown {
  kind: SubjectKind | undefined;
  id: string | null | undefined;
  x: number | null | undefined;
  y: number | null | undefined;
}

function shows({ kind, id, x, y }: Shown): Shows {
  switch (kind) {
    case 'robot':
    case 'worker':
    case 'station':
    case 'closure':
      if (id) return { kind: 'pick', picked: { kind, id } };
      break;
    case 'job':
      if (id) return { kind: 'job', id };
      break;
    default:
  }
  return typeof x === 'number' && typeof y === 'number' ? { kind: 'place', at: [x, y] } : { kind: 'nothing' };
}

export const showsOf = (alarm: Alarm): Shows =>
  shows({ kind: alarm.subject_kind, id: alarm.subject, x: alarm.x, y: alarm.y });
export const showsOfRecord = (alarm: Pick<AlarmRecord, 'subject' | 'x' | 'y'>): Shows =>
  shows({ kind: alarm.subject.kind, id: alarm.subject.id, x: alarm.x, y: alarm.y });

/** Seconds from one time of the server to another one. */
export const secondsBetween = (from: string, to: string): number =>
  (new Date(to).getTime() - new Date(from).getTime()) / 1_000;
