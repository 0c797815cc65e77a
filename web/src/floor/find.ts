// Finding things on the floor by a part of their name: without case, and with the parts of a name in any order. Pure:
// it is given all that there is.
import { onFloor, type FloorMap, type Job, type MapNode, type Mirror } from '../wire';
import { STATE_WORDS, t, wordsBy } from '../words';
import type { Picked } from './scene/picked';

export type FoundKind = Picked['kind'] | 'job';
export interface Found {
  readonly kind: FoundKind;
  readonly id: string;
  /** What is looked for and shown. */
  readonly name: string;
  /** The kind in a word. */
  readonly word: string;
  /** What else there is to say of it; it is looked for, too. */
  readonly more: string;
}

const MOST = 12;
/** Of one kind, while others match as well. */
const MOST_OF_KIND = 5;
const NODE_WORDS = wordsBy<MapNode['kind']>({
  storage: 'place.storage',
  charger: 'place.charger',
  parking: 'place.parking',
  exit: 'place.exit',
  queue: 'place.queue',
  station: 'station',
  aisle: 'place.aisle',
});

/** Everything that has a name, what moves first. A job is known if a robot has it; the server knows the others. */
export function namesOn(mirror: Mirror, map: FloorMap | null): Found[] {
  const all: Found[] = [];
  const robots = onFloor(mirror);
  for (const r of robots) all.push({ kind: 'robot', id: r.id, name: r.id, word: t('robot'), more: '' });
  for (const { id, name } of mirror.workers.rows)
    if (name !== '') all.push({ kind: 'worker', id, name, word: t('person'), more: name === id ? '' : id });
  for (const s of mirror.stations.rows)
    all.push({ kind: 'station', id: s.id, name: s.id, word: t('station'), more: '' });
  for (const { id, robot } of mirror.racks.rows) {
    all.push({ kind: 'rack', id, name: id, word: t('job.rack'), more: robot === null ? '' : t('rack.on', { robot }) });
  }
  for (const r of robots)
    if (r.job !== null) all.push({ kind: 'job', id: r.job, name: r.job, word: t('job'), more: r.id });
  for (const { id, reason } of mirror.closures)
    all.push({ kind: 'closure', id, name: id, word: t('happened.closure'), more: reason });
  for (const n of map?.nodes ?? [])
    if (n.kind !== 'station') all.push({ kind: 'place', id: n.id, name: n.id, word: NODE_WORDS[n.kind], more: '' });
  return all;
}

export function foundJob({ id, reference, state }: Job): Found {
  return { kind: 'job', id, name: id, word: t('job'), more: reference ?? STATE_WORDS[state] ?? state };
}

/** The best matches first: the whole name, its beginning, a part of it, its parts. */
export function matching(all: readonly Found[], text: string): Found[] {
  const wanted = text.trim().toLowerCase();
  if (wanted === '') return [];
  const parts = wanted.split(/[\s-]+/).filter((part) => part !== '');
  const ranks: Found[][] = [[], [], [], []];
  const seen = new Set<string>();
  for (const one of all) {
    const rank = rankOf(one, wanted, parts);
    const key = `${one.kind} ${one.id}`;
    if (rank < 0 || seen.has(key)) continue;
    seen.add(key);
    ranks[rank]!.push(one);
  }
  const found = ranks.flat();
  const counts = new Map<FoundKind, number>();
  const few = found.filter(({ kind }) => {
    const count = (counts.get(kind) ?? 0) + 1;
    counts.set(kind, count);
    return count <= MOST_OF_KIND;
  });
  return (counts.size > 1 ? few : found).slice(0, MOST);
}

function rankOf({ name, more }: Found, wanted: string, parts: readonly string[]): number {
  const [short, rest] = [name.toLowerCase(), more.toLowerCase()];
  if (short === wanted || rest === wanted) return 0;
  if (short.startsWith(wanted)) return 1;
  if (short.includes(wanted)) return 2;
  const whole = `${short} ${rest}`;
  return parts.every((part) => whole.includes(part)) ? 3 : -1;
}
