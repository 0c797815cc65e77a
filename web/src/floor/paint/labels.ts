// Names on the floor that keep clear of each other: a name that would cover one put before it is left out. The order in
// which a composer puts them is therefore their precedence. No canvas measures here: a name is taken to be a little
// wider than it is.
import type { FloorMap } from '../../wire';
import { toScreen, type FixedName, type View } from '../scene/view';
import type { Words } from './sheet';

/** Width of a letter as a share of its height, on average and rounded up. */
const LETTER = 0.6;
const GAP_PX = 2;
const ROW_PX = 24;
/** Names just outside of the picture still reach into it. */
const BEYOND_PX = 50;
/** Of stations: least and largest height of the letters, and their share of a metre. */
const STATION_PX = [10, 15, 0.5] as const;
/** Half a station, and from its edge to its title. */
const STATION_M = 0.62;
const STATION_GAP_PX = 8;

/** Below, or above. */
type Side = 1 | -1;

export class Labels {
  #words: Words;
  #view: View = { x: 0, y: 0, scale: 1, width: 0, height: 0 };
  /** On which side of its mark a name was put last: names that jump cannot be read. */
  #sides = new Map<string, Side>();
  /** Boxes of what is put, as left, top, right, bottom, by rows of the picture. Kept and filled anew. */
  #rows: (number[] | undefined)[] = [];

  constructor(words: Words) {
    this.#words = words;
  }

  begin(view: View): void {
    this.#view = view;
    this.#words.begin();
    for (const boxes of this.#rows) if (boxes) boxes.length = 0;
  }

  /** Puts a name `below` pixels below (x, y), unless it is out of sight or would cover another one. Says whether it
   *  did. */
  put(text: string, x: number, y: number, below: number, px: number, pale = false): boolean {
    const { width, height } = this.#view;
    const [cx, cy] = toScreen(this.#view, x, y);
    // False too for a place that is not a number.
    const inSight = cx > -BEYOND_PX && cx < width + BEYOND_PX && cy > -BEYOND_PX && cy < height + BEYOND_PX;
    if (!inSight) return false;
    const [halfX, halfY] = [(text.length * px * LETTER) / 2 + GAP_PX, px / 2 + GAP_PX];
    const [left, top, right, bottom] = [cx - halfX, cy + below - halfY, cx + halfX, cy + below + halfY];
    const [first, last] = [this.#row(top), this.#row(bottom)];
    for (let row = first; row <= last; row++) {
      const boxes = this.#rows[row] ?? [];
      for (let k = 0; k < boxes.length; k += 4) {
        if (left < boxes[k + 2]! && right > boxes[k]! && top < boxes[k + 3]! && bottom > boxes[k + 1]!) return false;
      }
    }
    for (let row = first; row <= last; row++) (this.#rows[row] ??= []).push(left, top, right, bottom);
    this.#words.put(text, x, y, below, px, pale);
    return true;
  }

  /** Puts a name below a mark or, if there is no room, above it; and leaves it on that side as long as there is
   *  room. */
  beside(text: string, x: number, y: number, apart: number, px: number): boolean {
    const side = this.#sides.get(text) ?? 1;
    if (this.put(text, x, y, side * apart, px)) return true;
    if (!this.put(text, x, y, -side * apart, px)) return false;
    this.#sides.set(text, -side as Side);
    return true;
  }

  #row = (y: number): number => Math.max(0, Math.floor((y + 4 * BEYOND_PX) / ROW_PX));
}

/** Where the title of a station is, and how large. */
export function stationTitle(scale: number): { below: number; px: number } {
  const [least, most, share] = STATION_PX;
  return { below: -scale * STATION_M - STATION_GAP_PX, px: Math.max(least, Math.min(most, scale * share)) };
}

/** What the titles of stations need, for a view that is to show them whole. */
export function titlesOf(map: FloorMap): FixedName[] {
  const [, most] = STATION_PX;
  return map.stations.flatMap(({ id, node, queue }) => {
    const at = map.nodes[node];
    const half_px = (`${id}  0/${queue.length}`.length * most * LETTER) / 2 + GAP_PX;
    return at ? [{ x: at.x, y: at.y, half_px, up_m: STATION_M, up_px: STATION_GAP_PX + most / 2 }] : [];
  });
}
