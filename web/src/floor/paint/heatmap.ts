// Amounts by place as colours: a few classes with round borders, the same for both painters and the legend. Pure.
import { count, roundSpan, t } from '../../words';
import type { HeatKind, HeatPage } from '../../wire';

/** A square of the floor in one of the classes. */
export interface Cell {
  x: number;
  y: number;
  size: number;
  /** From 0, the least, to 4. */
  level: number;
}
export const LEVELS = 5;

/** Borders that people would name: seconds of waiting, or how often. */
const BORDERS: Record<HeatKind, readonly number[]> = {
  waiting: [1, 2, 5, 10, 30, 60, 120, 300, 600, 1_200, 1_800, 3_600, 7_200, 14_400, 28_800, 86_400],
  encounters: [1, 2, 3, 4, 5, 10, 20, 50, 100, 200, 500, 1_000, 2_000, 5_000],
};

/** The lower ends of the classes: the largest amount is in the last one. */
export function borders(kind: HeatKind, most: number): number[] {
  const all = BORDERS[kind];
  const last = Math.max(
    LEVELS - 1,
    all.findLastIndex((b) => b <= most),
  );
  return all.slice(last - LEVELS + 1, last + 1);
}

export function cellsOf({ kind, size, cells }: HeatPage): { cells: Cell[]; borders: number[] } {
  const lower = borders(kind, Math.max(0, ...cells.map((c) => c.amount)));
  const level = (amount: number): number => lower.findLastIndex((b) => b <= amount);
  const found = cells.map(({ x, y, amount }) => ({ x, y, size, level: level(amount) }));
  return { cells: found.filter((c) => c.level >= 0), borders: lower };
}

/** Less than this is not worth a look, and of so little nothing can be called usual, seconds. */
const LEAST_EXCESS_S = 30;
const LEAST_BEFORE_S = 300;
/** A place is unusual where it has this many times its usual share of all waiting. */
const TIMES = 2;

/** Where robots waited beyond what is usual there: its share of all waiting is compared with its share before, so that
 *  it does not matter how much was going on. Null where too little is known of before. */
export function unusual(now: HeatPage, before: HeatPage): HeatPage | null {
  const sum = ({ cells }: HeatPage): number => cells.reduce((all, cell) => all + cell.amount, 0);
  const [total, earlier] = [sum(now), sum(before)];
  if (earlier < LEAST_BEFORE_S) return null;
  const usual = new Map(before.cells.map(({ x, y, amount }) => [`${x} ${y}`, amount / earlier]));
  const cells = now.cells.flatMap((cell) => {
    const expected = total * (usual.get(`${cell.x} ${cell.y}`) ?? 0);
    const excess = cell.amount - expected;
    return excess >= LEAST_EXCESS_S && cell.amount >= TIMES * expected ? [{ ...cell, amount: excess }] : [];
  });
  return { ...now, cells };
}

/** Places of encounters, by square metre. */
export function heatOfPlaces(places: readonly (readonly [number, number])[]): HeatPage['cells'] {
  const cells = new Map<string, HeatPage['cells'][number]>();
  for (const place of places) {
    const [x, y] = [Math.floor(place[0]) + 0.5, Math.floor(place[1]) + 0.5];
    const cell = cells.get(`${x} ${y}`) ?? { x, y, node: null, amount: 0 };
    cell.amount += 1;
    cells.set(`${x} ${y}`, cell);
  }
  return [...cells.values()];
}

/** A class in words: from one border up to the next. */
export function words(kind: HeatKind, lower: readonly number[], level: number): string {
  const [from, to] = [lower[level]!, lower[level + 1]];
  const said = kind === 'encounters' ? count : roundSpan;
  if (to === undefined) return t('layers.or-more', { from: said(from) });
  const last = kind === 'encounters' ? to - 1 : to;
  return last === from ? said(from) : t('layers.from-to', { from: said(from), to: said(last) });
}
