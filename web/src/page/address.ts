// The part of the address behind #, of the present: what is chosen on the floor, the job whose card is open, the tab
// below the floor, or the view for a screen on the wall. `#robot/robot-17&tab/robots` says two of these. The past has
// addresses of its own (replay/route.ts).
import { PICKED_KINDS, type Picked } from '../floor';
import { BELOW_KEYS } from '../replay';
import { onFloor, row, type FloorMap, type Mirror } from '../wire';
import { wordsBy } from '../words';

/** What can be shown below the floor. What the server alone keeps is in no recording. */
export const TABS = wordsBy({ ...BELOW_KEYS, alarms: 'alarms', report: 'report', system: 'system', audit: 'audit' });
export type Tab = keyof typeof TABS;

export interface Address {
  readonly picked: Picked | null;
  readonly job: string | null;
  readonly tab: Tab;
  readonly wall: boolean;
}
export const HOME: Address = { picked: null, job: null, tab: 'jobs', wall: false };

/** What an address says, and the parts of it that say nothing. */
export function addressOf(hash: string): { address: Address; unknown: string[] } {
  const unknown: string[] = [];
  let address = HOME;
  for (const part of hash
    .replace(/^#/, '')
    .split('&')
    .filter((one) => one !== '')) {
    const next = withPart(address, part);
    if (next === null) unknown.push(part);
    else address = next;
  }
  return { address, unknown };
}

function withPart(address: Address, part: string): Address | null {
  if (part === 'wall') return { ...address, wall: true };
  const slash = part.indexOf('/');
  const [word, id] = [part.slice(0, Math.max(0, slash)), decoded(part.slice(slash + 1))];
  if (slash < 0 || id === null || id === '') return null;
  if (word === 'job') return { ...address, job: id };
  if (word === 'tab') return Object.hasOwn(TABS, id) ? { ...address, tab: id as Tab } : null;
  const kind = PICKED_KINDS.find((one) => one === word);
  return kind === undefined ? null : { ...address, picked: { kind, id } };
}

/** With its #; empty where nothing is to be said. The view on a wall shows nothing else. */
export function hashOf({ picked, job, tab, wall }: Address): string {
  if (wall) return '#wall';
  const parts = [
    picked === null ? '' : `${picked.kind}/${encodeURIComponent(picked.id)}`,
    job === null ? '' : `job/${encodeURIComponent(job)}`,
    tab === HOME.tab ? '' : `tab/${tab}`,
  ].filter((part) => part !== '');
  return parts.length === 0 ? '' : `#${parts.join('&')}`;
}

/** Whether there is such a thing on the floor. */
export function isThere({ kind, id }: Picked, mirror: Mirror, map: FloorMap): boolean {
  switch (kind) {
    case 'robot':
      return onFloor(mirror).some((r) => r.id === id);
    case 'worker':
      return row(mirror.workers, id) !== undefined;
    case 'station':
      return row(mirror.stations, id) !== undefined;
    case 'rack':
      return row(mirror.racks, id) !== undefined;
    case 'closure':
      return mirror.closures.some((c) => c.id === id);
    case 'place':
      return map.nodes.some((n) => n.id === id);
  }
}

function decoded(text: string): string | null {
  try {
    return decodeURIComponent(text);
  } catch {
    return null;
  }
}
