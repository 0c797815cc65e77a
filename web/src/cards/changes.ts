// What happened to each thing since the page was opened, in a few lines: what a mirror says now that the
// one before did not. It remembers only what changed, and no more than the last lines of it.
import { sameSaid } from '../language';
import {
  activityWords,
  clock,
  doing,
  GUIDANCE_WORDS,
  number,
  percent,
  PRESENCE_WORDS,
  replanCause,
  said,
  t,
  within,
} from '../words';
import {
  activityOf,
  type Goal,
  type MapNode,
  type Mirror,
  type Rack,
  type Robot,
  row,
  type Station,
  type Table,
  type Worker,
} from '../wire';
import type { Picked } from '../floor';

export interface Line {
  at: string;
  text: string;
}
const MOST_LINES = 7;
/** A goal less probable than this is none yet, and a node so near to one is where it is: metres. */
const [PROBABLE, AT_M] = [0.6, 1] as const;

export class Story {
  /** Names of places, once the map is there. */
  places: readonly MapNode[] = [];
  #before: Mirror | null = null;
  #lines = new Map<string, Line[]>();

  /** Newest first. */
  of({ kind, id }: Picked): readonly Line[] {
    return this.#lines.get(`${kind} ${id}`) ?? [];
  }

  note(now: Mirror): void {
    const old = this.#before;
    this.#before = now;
    if (old === null || old.version === null || old === now) return;
    const note = (kind: Picked['kind'], id: string, texts: readonly (string | null)[]): void => {
      for (const text of texts) if (text !== null) this.#add(kind, id, { at: clock(now.time_s), text });
    };
    changed(old.robots, now.robots, (a, b) => note('robot', b.id, robotLines(a, b)));
    changed(old.workers, now.workers, (a, b) => note('worker', b.id, [...workerLines(a, b), this.#goalLine(a, b)]));
    changed(old.stations, now.stations, (a, b) => note('station', b.id, stationLines(a, b)));
    changed(old.racks, now.racks, (a, b) => note('rack', b.id, [this.#rackLine(a, b)]));
  }

  #rackLine(a: Rack, b: Rack): string | null {
    if (a.robot === b.robot) return null;
    if (b.robot !== null) return t('story.rack.lifted', { robot: b.robot });
    if (b.node === null) return t('story.rack.down.unknown');
    return t('story.rack.down', { place: this.places[b.node]?.id ?? '?' });
  }

  #goalLine(a: Worker, b: Worker): string | null {
    const goal = ({ goals }: Worker): Goal | undefined => goals.find((g) => g.p >= PROBABLE);
    const [before, now] = [goal(a), goal(b)];
    if (now === undefined || (before && before.x === now.x && before.y === now.y)) return null;
    const off = (n: MapNode): number => Math.hypot(n.x - now.x, n.y - now.y);
    const near = this.places.filter((n) => off(n) < AT_M).sort((m, n) => off(m) - off(n))[0];
    return t('story.goal', { place: near?.id ?? `${number(now.x, 1)}, ${number(now.y, 1)}`, share: percent(now.p) });
  }

  #add(kind: Picked['kind'], id: string, line: Line): void {
    const key = `${kind} ${id}`;
    const lines = this.#lines.get(key) ?? [];
    this.#lines.set(key, [line, ...lines].slice(0, MOST_LINES));
  }
}

function changed<T extends { id: string }>(old: Table<T>, now: Table<T>, see: (before: T, after: T) => void): void {
  if (old === now) return;
  for (let i = 0; i < now.rows.length; i++) {
    const after = now.rows[i]!;
    // Rows that did not change keep their identity, and rows seldom change places.
    const before = old.rows[i]?.id === after.id ? old.rows[i]! : row(old, after.id);
    if (before !== undefined && before !== after) see(before, after);
  }
}

function robotLines(a: Robot, b: Robot): (string | null)[] {
  return [
    activityOf(a) === activityOf(b) ? null : within(activityWords(activityOf(b))),
    a.doing === b.doing ? null : doing(b.doing),
    a.job === b.job || b.job === null ? null : t('story.job', { job: b.job }),
    sameSaid(a.why, b.why) ? null : b.why === null ? t('story.continues') : said(b.why),
    b.replanned === null || a.replanned?.at === b.replanned.at
      ? null
      : t('story.replanned', { cause: replanCause(b.replanned) }),
  ];
}

function workerLines(a: Worker, b: Worker): (string | null)[] {
  const state = within(GUIDANCE_WORDS[b.state] ?? b.state);
  return [
    a.presence === b.presence ? null : t('story.seen', { presence: PRESENCE_WORDS[b.presence] ?? b.presence }),
    a.state === b.state ? null : b.reason === null ? state : t('story.told', { state, reason: said(b.reason) }),
    a.assignment === b.assignment || b.assignment === null ? null : t('story.assignment', { assignment: b.assignment }),
  ];
}

function stationLines(a: Station, b: Station): (string | null)[] {
  return [
    a.robot === b.robot
      ? null
      : b.robot === null
        ? t('story.station.left', { robot: a.robot ?? '?' })
        : t('story.station.arrived', { robot: b.robot }),
    a.queue.length === b.queue.length ? null : t('story.station.queue', { count: b.queue.length }),
  ];
}
