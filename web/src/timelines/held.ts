// Which robots held which places when, from frames of the past. What was read is kept from one moment to the next, and
// a large floor is read in slices, so that the page goes on meanwhile.
import { after, seek, type Frame, type Shown } from '../replay';
import type { FloorMap, Hold, Strip } from '../wire';
import { BACK_S } from './gantt';

/** A longer time without a frame is no hold. */
const GAP_S = 1;
/** So long is read before other work gets a turn, milliseconds. */
const SLICE_MS = 40;

/** A hold, in seconds of the recording. */
interface Held {
  readonly node: number;
  readonly by: string;
  readonly granted: boolean;
  readonly from: number;
  to: number;
}
/** What is known of an area. */
export interface Around {
  nodes: Strip[];
  /** Whether all frames of the time asked for were read. */
  whole: boolean;
}

export class HeldThen {
  #of: { frames: readonly Frame[]; map: FloorMap; area: string } | null = null;
  #places = new Map<number, { id: string; x: number; y: number }>();
  #holds: Held[] = [];
  /** The last hold of a place by a robot, granted or not. */
  #last = new Map<string, Held>();
  #from = 0;
  /** The frame that was read last, and what it showed. */
  #read = -Infinity;
  #shown: Shown | null = null;

  /** What held the places of an area from a little before `t` to `ahead` seconds after it, as far as that is read. */
  around(
    frames: readonly Frame[],
    map: FloorMap,
    area: readonly number[],
    t: number,
    ahead: number,
    now = () => performance.now(),
  ): Around {
    const from = t - BACK_S;
    const of = this.#of;
    const same = of?.frames === frames && of.map === map && of.area === area.join();
    // Back in time, or past what was read: it begins anew.
    if (!same || from < this.#from || from > this.#read) this.#begin(frames, map, area, from);
    this.#from = from;
    this.#holds = this.#holds.filter((hold) => hold.to >= from);
    return { whole: this.#readOn(frames, t + ahead, now), nodes: this.#strips(t, t + ahead) };
  }

  #begin(frames: readonly Frame[], map: FloorMap, area: readonly number[], from: number): void {
    const [x0 = 0, y0 = 0, x1 = 0, y1 = 0] = area;
    this.#of = { frames, map, area: area.join() };
    this.#places.clear();
    map.nodes.forEach(({ id, x, y }, i) => {
      if (x >= x0 && x <= x1 && y >= y0 && y <= y1) this.#places.set(i, { id, x, y });
    });
    [this.#holds, this.#read, this.#shown] = [[], from, seek(frames, from, null)];
    this.#last.clear();
    if (this.#shown && this.#shown.at <= from && from - this.#shown.at <= GAP_S) this.#take(from);
  }

  #readOn(frames: readonly Frame[], to: number, now: () => number): boolean {
    const until = now() + SLICE_MS;
    for (let i = after(frames, this.#read); i < frames.length && frames[i]!.at <= to; i++) {
      const frame = frames[i]!;
      if (frame.kind === 'key') continue;
      if (now() > until) return false;
      this.#read = frame.at;
      this.#shown = seek(frames, frame.at, this.#shown);
      this.#take(frame.at);
    }
    return true;
  }

  /** Notes which robot holds what in the frame that was read last. */
  #take(at: number): void {
    for (const robot of this.#shown?.mirror.robots.rows ?? []) {
      robot.granted.forEach((node) => this.#note(node, robot.id, true, at));
      robot.held.forEach((node) => {
        if (!robot.granted.includes(node)) this.#note(node, robot.id, false, at);
      });
    }
  }

  #note(node: number, by: string, granted: boolean, at: number): void {
    if (!this.#places.has(node)) return;
    const key = `${node} ${by} ${granted}`;
    const known = this.#last.get(key);
    if (known && at - known.to <= GAP_S) {
      known.to = at;
      return;
    }
    const held: Held = { node, by, granted, from: at, to: at };
    this.#last.set(key, held);
    this.#holds.push(held);
  }

  #strips(t: number, to: number): Strip[] {
    const strips = new Map(
      [...this.#places].map(([node, place]): [number, Strip] => [
        node,
        { ...place, holds: [], conditions: [], regions: [] },
      ]),
    );
    // What was only announced, to one robot after the other, lies below what was granted.
    const inOrder = this.#holds.toSorted(
      (a, b) => Math.max(a.from, this.#from) - Math.max(b.from, this.#from) || (a.by < b.by ? -1 : 1),
    );
    for (const granted of [false, true]) {
      for (const held of inOrder) {
        if (held.granted !== granted || held.from > to) continue;
        const hold: Hold = {
          by: held.by,
          kind: 'robot',
          from_s: Math.max(held.from, this.#from) - t,
          to_s: Math.min(held.to, to) - t,
          granted,
          conflict: false,
        };
        strips.get(held.node)?.holds.push(hold);
      }
    }
    return [...strips.values()];
  }
}
