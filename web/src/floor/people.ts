// People as a painter draws them: where each is shown now, and the lines around and ahead. There are few
// of them, so they are plain objects where robots are typed arrays.
import type { Worker } from '../wire';
import { shortTurn } from './turn';

export interface Person extends Place {
  id: string;
  /** The name, with a word where the place is not to be trusted. */
  title: string;
  presence: Worker['presence'];
  /** Radii of the regions where robots stop and keep out. */
  regions: readonly number[];
  /** Dashes of the path ahead as x0, y0, x1, y1 … */
  ahead: readonly number[];
}

/** How far the mark of a person reaches forward, in radii. */
export const PERSON_REACH = 1.35;
const DASH_M = 0.35;
const GAP_M = 0.25;
/** Further than anybody walks between two patches. */
const JUMP_M = 2;

interface Place {
  x: number;
  y: number;
  heading: number;
}

export class People {
  /** Those whom somebody has seen and who are here. */
  list: Person[] = [];
  #paths = new Map<string, Worker['path']>();
  #from: Place[] = [];
  #to: Place[] = [];

  take(all: readonly Worker[], how: 'glide' | 'jump'): void {
    const rows = all.filter(isSeen);
    const before = new Map(this.list.map((p) => [p.id, p]));
    this.#to = rows.map((w) => ({ x: w.x, y: w.y, heading: w.heading ?? 0 }));
    this.#from = this.#to.map((to, i) => {
      const p = before.get(rows[i]!.id);
      const near = p !== undefined && Math.hypot(p.x - to.x, p.y - to.y) < JUMP_M;
      return how === 'glide' && near ? { x: p.x, y: p.y, heading: p.heading } : to;
    });
    this.list = rows.map((w, i) => {
      const p = before.get(w.id);
      const same = p !== undefined && this.#paths.get(w.id) === w.path;
      return {
        id: w.id, title: titleOf(w), ...this.#from[i]!, presence: w.presence,
        regions: w.regions.slice(0, 2), ahead: same ? p.ahead : dashes(w.path),
      };
    });
    this.#paths = new Map(rows.map((w) => [w.id, w.path]));
  }

  /** Shows everybody `part` of the way from where they were shown to where they are. */
  at(part: number): void {
    this.list.forEach((p, i) => {
      const from = this.#from[i]!;
      const to = this.#to[i]!;
      p.x = from.x + (to.x - from.x) * part;
      p.y = from.y + (to.y - from.y) * part;
      p.heading = from.heading + shortTurn(from.heading, to.heading) * part;
    });
  }
}

/** The person nearest to a point, or -1 when nobody is within reach. */
export function personNear(people: readonly Person[], x: number, y: number, reach: number): number {
  let best = -1;
  let least = reach;
  people.forEach((p, i) => {
    const far = Math.hypot(p.x - x, p.y - y);
    if (far <= least) { best = i; least = far; }
  });
  return best;
}

/** Cuts a line into dashes that run on around its corners. */
export function dashes(line: readonly (readonly [number, number])[]): number[] {
  const out: number[] = [];
  let along = 0;
  for (let k = 1; k < line.length; k++) {
    const [[ax, ay], [bx, by]] = [line[k - 1]!, line[k]!];
    const length = Math.hypot(bx - ax, by - ay);
    for (let s = 0; s < length;) {
      const phase = (along + s) % (DASH_M + GAP_M);
      // Never less than a millimetre, or rounding could stop the march.
      const end = Math.min(length, s + Math.max(0.001, (phase < DASH_M ? DASH_M : DASH_M + GAP_M) - phase));
      const at = (d: number): [number, number] => [ax + (bx - ax) * d / length, ay + (by - ay) * d / length];
      if (phase < DASH_M) out.push(...at(s), ...at(end));
      s = end;
    }
    along += length;
  }
  return out;
}

/** The mark of a person, of radius `r`, facing along x: a disc with a beak, unlike any robot. */
export function outlinePerson(ink: CanvasPath, r: number): void {
  ink.moveTo(PERSON_REACH * r, 0);
  ink.arc(0, 0, 0.85 * r, 0.75, 2 * Math.PI - 0.75);
  ink.closePath();
}

const isSeen = (w: Worker): w is Worker & { x: number; y: number } =>
  w.presence !== 'absent' && w.x !== null && w.y !== null;

const titleOf = (w: Worker): string =>
  (w.presence === 'stale' || w.presence === 'lost' ? `${w.name} (${w.presence})` : w.name);
