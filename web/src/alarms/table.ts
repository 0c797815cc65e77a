// The table of alarms: its lines, which of them are wanted, and in which order. Pure.
import type { AlarmRecord, Severity } from '../wire';
import { personName, said } from '../words';

/** `calls`: nobody looks after it yet. */
export const ALARM_FILTERS = ['all', 'calls', 'critical', 'shelved'] as const;
export type AlarmFilter = (typeof ALARM_FILTERS)[number];
export const ALARM_SORTS = ['since', 'severity', 'subject', 'acknowledged'] as const;
export type AlarmSort = (typeof ALARM_SORTS)[number];
export interface AlarmOrder {
  readonly by: AlarmSort;
  readonly way: 'up' | 'down';
}

const WEIGHT: Readonly<Record<Severity, number>> = { critical: 2, warning: 1, notice: 0 };
/** Robots as they are named: robot-2 before robot-10. */
const natural = new Intl.Collator('en', { numeric: true });

/** What somebody reads as the subject of an alarm. */
export const subjectOf = ({ subject }: Pick<AlarmRecord, 'subject'>): string =>
  subject.kind === 'worker' ? personName(subject.id) : subject.id;

const fits = (alarm: AlarmRecord, filter: AlarmFilter): boolean => {
  switch (filter) {
    case 'all':
      return true;
    case 'calls':
      return (
        alarm.cleared === null && alarm.severity !== 'notice' && alarm.acknowledged === null && alarm.shelved === null
      );
    case 'critical':
      return alarm.severity === 'critical';
    case 'shelved':
      return alarm.shelved !== null;
  }
};

/** Those that a filter lets through and that have every word of a search in them, or in a member. */
export function wantedAlarms(alarms: readonly AlarmRecord[], filter: AlarmFilter, search: string): AlarmRecord[] {
  const words = search
    .toLowerCase()
    .split(/\s+/)
    .filter((word) => word !== '');
  return alarms.filter((alarm) => {
    const cells = [
      alarm.id,
      subjectOf(alarm),
      said(alarm),
      alarm.acknowledged?.by,
      ...alarm.members.map(subjectOf),
      ...alarm.notes.map((n) => n.text),
    ];
    const text = cells.filter(Boolean).join(' ').toLowerCase();
    return fits(alarm, filter) && words.every((word) => text.includes(word));
  });
}

/** In an order; what is put aside comes last. */
export function sortedAlarms(alarms: readonly AlarmRecord[], { by, way }: AlarmOrder): AlarmRecord[] {
  const sign = way === 'up' ? 1 : -1;
  const compare = (a: AlarmRecord, b: AlarmRecord): number => {
    switch (by) {
      case 'since':
        return a.since < b.since ? -1 : a.since > b.since ? 1 : 0;
      case 'severity':
        return WEIGHT[a.severity] - WEIGHT[b.severity];
      case 'subject':
        return natural.compare(subjectOf(a), subjectOf(b));
      case 'acknowledged':
        return natural.compare(a.acknowledged?.by ?? '', b.acknowledged?.by ?? '');
    }
  };
  const aside = (a: AlarmRecord): number => (a.cleared === null && a.shelved !== null ? 1 : 0);
  return alarms.toSorted((a, b) => aside(a) - aside(b) || sign * compare(a, b) || natural.compare(b.id, a.id));
}

/** The order after a click on a heading. */
export function turnedAlarms(order: AlarmOrder, by: AlarmSort): AlarmOrder {
  if (order.by === by) return { by, way: order.way === 'up' ? 'down' : 'up' };
  return { by, way: by === 'since' || by === 'severity' ? 'down' : 'up' };
}
