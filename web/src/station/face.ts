// Where slots and totes are drawn: metres, to scale, x to the picker's right from the middle of the rack, y down. Pure.
import type { Face, Tote } from './state';

export interface Box {
  name: string;
  x: number;
  y: number;
  width: number;
  height: number;
}
export interface Drawing {
  /** The outline of the whole face. */
  body: Box;
  slots: readonly Box[];
  totes: readonly Box[];
  /** The part that is to be seen: x, y, width, height. */
  view: readonly [number, number, number, number];
}

/** How high the bins of a rack with a single row are drawn. */
const ONE_ROW_M = 0.3;
/** A tote is drawn as large as a usual one is, 600 × 400 × 300 mm seen from its narrow side. */
const [TOTE_WIDE_M, TOTE_HIGH_M] = [0.4, 0.27];
const GAP_M = 0.05;

/** The upper and the lower edge of each row, the lowest row first: halfway to the next one. */
export function rowEdges(heights_m: readonly number[]): readonly (readonly [bottom: number, top: number])[] {
  return heights_m.map((middle, i) => {
    const [below, above] = [heights_m[i - 1], heights_m[i + 1]];
    const half = ((above ?? 2 * middle - (below ?? middle - ONE_ROW_M)) - middle) / 2;
    const bottom = below === undefined ? middle - half : (below + middle) / 2;
    return [Math.max(0, bottom), above === undefined ? middle + half : (above + middle) / 2];
  });
}

function slotsOf({ columns, heights_m, width_m }: Face): Box[] {
  const wide = width_m / columns;
  return rowEdges(heights_m).flatMap(([bottom, top], row) =>
    Array.from({ length: columns }, (_, column) => ({
      name: `${String.fromCharCode(65 + column)}${row + 1}`,
      x: column * wide - width_m / 2,
      y: -top,
      width: wide,
      height: top - bottom,
    })),
  );
}

/** Totes below the rack, left and right as they stand; one that stands behind another is drawn below it. */
function totesOf(totes: readonly Tote[], top: number): Box[] {
  const rows: number[][] = [];
  return [...totes]
    .sort((a, b) => a.out_m - b.out_m || a.right_m - b.right_m)
    .map(({ id, right_m }) => {
      let row = rows.findIndex((taken) => taken.every((x) => Math.abs(x - right_m) >= TOTE_WIDE_M + GAP_M / 2));
      if (row < 0) row = rows.push([]) - 1;
      rows[row]!.push(right_m);
      const y = top + row * (TOTE_HIGH_M + GAP_M);
      return { name: id, x: right_m - TOTE_WIDE_M / 2, y, width: TOTE_WIDE_M, height: TOTE_HIGH_M };
    });
}

/** A rack of which no slots are known is as large as a usual one. */
const PLAIN: Face = { columns: 1, heights_m: [0.4, 0.8, 1.2, 1.6], width_m: 0.9 };

export function draw(face: Face | null, totes: readonly Tote[]): Drawing {
  const slots = slotsOf(face ?? PLAIN);
  const bottom = Math.max(...slots.map(({ y, height }) => y + height));
  const below = totesOf(totes, bottom + GAP_M);
  const all = [...slots, ...below];
  const [left, right] = [Math.min(...all.map(({ x }) => x)), Math.max(...all.map(({ x, width }) => x + width))];
  const [top, end] = [Math.min(...slots.map(({ y }) => y)), Math.max(...all.map(({ y, height }) => y + height))];
  const body = { name: '', x: slots[0]!.x, y: top, width: (face ?? PLAIN).width_m, height: bottom - top };
  return {
    body,
    slots: face ? slots : [],
    totes: below,
    view: [left - GAP_M, top - GAP_M, right - left + 2 * GAP_M, end - top + 2 * GAP_M],
  };
}

/** How wide the outline of a slot is to which the hand goes with this probability, metres; none if it hardly does. */
export const reachWidth = (probability: number): number =>
  probability < 0.05 ? 0 : 0.006 + 0.016 * Math.min(1, probability);
