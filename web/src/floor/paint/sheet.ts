// What a painter draws: lists of marks and of words. Everything on the floor is composed of these once
// (compose.ts), so that the painters agree by construction. Lists are kept and filled anew, not made anew.

/** What a mark is. Sizes are metres; `more` depends on the kind. */
export const KIND = {
  /** A filled rectangle. */
  box: 0,
  /** Its outline; `more` is the width of the line. */
  frame: 1,
  disc: 2,
  /** A circle; `more` is the width of the line. */
  ring: 3,
  /** An x; `more` is the width of its bars. */
  cross: 4,
  /** Somebody who faces along the mark's x axis; `more` is the width of the line, 0 for a filled one. */
  person: 5,
  /** A line along the x axis in dashes; `more` is the length of a dash and its gap. */
  dashes: 6,
  /** A circle in dashes; `more` is the width of the line. */
  dashring: 7,
  /** A disc with slanting lines; `more` is the distance from one to the next. */
  hatch: 8,
  /** The first part of a circle, clockwise from the top; `more` is the part, 0 to 1. */
  arc: 9,
  /** A flash of lightning. */
  bolt: 10,
  /** A bell curve that ends at three standard deviations, which are half the mark's sides. */
  heat: 11,
} as const;
export type Kind = (typeof KIND)[keyof typeof KIND];

/** Numbers per mark: x, y, width, height, turn, kind, more, ink. */
export const STRIDE = 8;
/** Width of an arc's line as a part of its radius. */
export const ARC_WIDTH = 0.14;
/** Share of a dash in its period. */
export const DASH = 0.58;
/** Dashes around a circle. */
export const RING_DASHES = 28;

export class Sheet {
  /** Counts the times that the sheet was filled. */
  turn = 0;
  count = 0;
  marks = new Float32Array(64 * STRIDE);
  /** The same memory: ink is four bytes, red first. */
  inks = new Uint32Array(this.marks.buffer);

  begin(): void {
    this.count = 0;
    this.turn += 1;
  }

  put(kind: Kind, x: number, y: number, width: number, height: number, ink: number, turn = 0, more = 0): void {
    const at = this.count * STRIDE;
    if (at === this.marks.length) this.#grow();
    const { marks } = this;
    marks[at] = x;
    marks[at + 1] = y;
    marks[at + 2] = width;
    marks[at + 3] = height;
    marks[at + 4] = turn;
    marks[at + 5] = kind;
    marks[at + 6] = more;
    this.inks[at + 7] = ink;
    this.count += 1;
  }

  line(kind: Kind, x0: number, y0: number, x1: number, y1: number, width: number, ink: number, more = 0): void {
    const [dx, dy] = [x1 - x0, y1 - y0];
    this.put(kind, (x0 + x1) / 2, (y0 + y1) / 2, Math.hypot(dx, dy) + width, width, ink, Math.atan2(dy, dx), more);
  }

  #grow(): void {
    const marks = new Float32Array(2 * this.marks.length);
    marks.set(this.marks);
    this.marks = marks;
    this.inks = new Uint32Array(marks.buffer);
    // The ink of what is kept went along, as it is the same memory.
  }
}

export interface Word {
  text: string;
  x: number;
  y: number;
  /** Pixels below (x, y). */
  below: number;
  /** Height of the letters, pixels. */
  px: number;
  /** Of what there is much and matters least. */
  pale: boolean;
}

export class Words {
  count = 0;
  list: Word[] = [];

  begin(): void {
    this.count = 0;
  }

  put(text: string, x: number, y: number, below: number, px: number, pale = false): void {
    const word = this.list[this.count];
    if (word === undefined) this.list.push({ text, x, y, below, px, pale });
    else Object.assign(word, { text, x, y, below, px, pale });
    this.count += 1;
  }
}

/** A CSS colour as computed ("rgb(…)" or "rgba(…)") as four bytes, red first. */
export function inkOf(css: string, opacity = 1): number {
  const [r = 0, g = 0, b = 0, a = 1] = (css.match(/[\d.]+/g) ?? []).map(Number);
  return ((Math.round(a * opacity * 255) << 24) | (b << 16) | (g << 8) | r) >>> 0;
}

/** And back, for a canvas. */
export function cssOf(ink: number): string {
  return `rgb(${ink & 255} ${(ink >> 8) & 255} ${(ink >> 16) & 255} / ${((ink >>> 24) / 255).toFixed(3)})`;
}
