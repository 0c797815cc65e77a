// What one shift tells the next: alarms that are active, who looks after each, what was found out, and what is put
// aside.
import type { AlarmRecord } from '../wire';
import { said, t, timeOfDay } from '../words';
import { SEVERITY_WORDS } from './shown';
import { sortedAlarms } from './table';

/** As a text that is pasted into a mail or a book; `over` are alarms that ended in the shift. */
export function handover(active: readonly AlarmRecord[], over: readonly AlarmRecord[], now: Date): string {
  const lines = [t('handover.title', { time: timeOfDay(now.toISOString()) }), ''];
  if (active.length === 0) lines.push(t('alarm.none'));
  for (const alarm of sortedAlarms(active, { by: 'severity', way: 'down' })) {
    lines.push(
      `${SEVERITY_WORDS[alarm.severity]}: ${said(alarm)} ${t('handover.since', { time: timeOfDay(alarm.since) })}`,
    );
    if (alarm.acknowledged) lines.push(`  ${t('alarm.acknowledged.by', { name: alarm.acknowledged.by })}`);
    else if (alarm.severity !== 'notice') lines.push(`  ${t('handover.nobody')}`);
    if (alarm.shelved) {
      const { until, by: name, reason } = alarm.shelved;
      lines.push(`  ${t('alarm.shelved.until', { time: timeOfDay(until), name, reason })}`);
    }
    for (const note of alarm.notes) lines.push(`  ${timeOfDay(note.at)} ${note.by}: ${note.text}`);
  }
  lines.push('', t('handover.over', { count: over.length }));
  for (const alarm of over.filter((one) => one.notes.length > 0)) {
    lines.push(
      `${said(alarm)} ${t('handover.from-to', { from: timeOfDay(alarm.since), to: timeOfDay(alarm.cleared) })}`,
    );
    for (const note of alarm.notes) lines.push(`  ${timeOfDay(note.at)} ${note.by}: ${note.text}`);
  }
  return lines.join('\n');
}
