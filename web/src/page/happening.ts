// What is happening on the floor, in one line: for whoever sees it for the first time, or looks up for a second. Pure.
import { onFloor, type Mirror, type Robot } from '../wire';
import { t } from '../words';

/** Whether a robot waits for a person, or makes way for one. */
function givesWay({ why, passes }: Pick<Robot, 'why' | 'passes'>): boolean {
  // Recordings of earlier versions have words alone.
  return passes !== null || (typeof why === 'string' ? /\bworker\b/.test(why) : why?.code === 'gives_way');
}

/** The line; null until something is known. */
export function happening(mirror: Mirror): string | null {
  if (mirror.version === null) return null;
  const is = (kind: string): boolean => mirror.alarms.some((alarm) => alarm.kind === kind);
  if (is('evacuation')) return t('happening.evacuation');
  if (is('stopped')) return t('happening.stopped');
  const robots = onFloor(mirror);
  const people = mirror.workers.rows.filter((worker) => worker.presence !== 'absent');
  const lost = people.filter((worker) => worker.presence === 'lost');
  const off = people.filter((worker) => worker.state === 'deviating').length;
  const giving = robots.filter(givesWay).length;
  const parts = [t('happening.robots', { count: robots.length, stations: mirror.stations.rows.length })];
  if (people.length > 0) parts.push(t('happening.people', { count: people.length }));
  if (lost[0]) parts.push(t('happening.lost', { name: lost[0].name, count: lost.length }));
  else if (off > 0) parts.push(t('happening.off', { count: off }));
  if (giving > 0) parts.push(t('happening.giving', { count: giving }));
  return parts.join(' ');
}
