// People as they are drawn: where each is shown now, the regions around and the path ahead. There are few
// of them, so they are plain objects where robots are typed arrays.
import { t } from '../../words';
import type { Worker } from '../../wire';
import { shortTurn } from './turn';

export interface Person extends Place {
  id: string;
  /** The name, with a word where the place is not to be trusted. */
  title: string;
  /** What they drive; null on foot. */
  vehicle: Worker['vehicle'];
  presence: Worker['presence'];
  state: Worker['state'];
  /** Where a person who is lost may be. */
  area: Worker['area'];
  /** Radii of the regions where robots stop, keep out and go slowly. */
  regions: Worker['regions'];
  /** The path ahead, metres. */
  path: Worker['path'];
}

/** How far the mark of a person reaches forward, in radii. */
export const PERSON_REACH = 1.35;
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
      return {
        id: w.id,
        title: titleOf(w),
        ...this.#from[i]!,
        // Recordings from before there were vehicles say nothing of them.
        vehicle: w.vehicle ?? null,
        presence: w.presence,
        state: w.state,
        area: w.area,
        regions: w.regions,
        path: w.path,
      };
    });
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
    if (far <= least) {
      best = i;
      least = far;
    }
  });
  return best;
}

/** The mark of a person, of radius `r`, facing along x: a disc with a beak, unlike any robot. */
export function outlinePerson(ink: CanvasPath, r: number): void {
  ink.moveTo(PERSON_REACH * r, 0);
  ink.arc(0, 0, 0.85 * r, 0.75, 2 * Math.PI - 0.75);
  ink.closePath();
}

const isSeen = (w: Worker): w is Worker & { x: number; y: number } =>
  w.presence !== 'absent' && w.x !== null && w.y !== null;

/** The name, and what is the matter, in words as well as in colour. */
const titleOf = ({ name, presence, state }: Worker): string => t('person.title', { name, presence, state });
