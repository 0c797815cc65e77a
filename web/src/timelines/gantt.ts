// The picture of what the planner sees, without its looks: bars with places in percent, and what each means in words.
import type { Condition, Hold, RegionStay, Strip } from '../wire';
import { listed, quantity, t, wordsBy, personName } from '../words';

/** What a holder is called by whoever looks. */
const called = (kind: string, by: string): string => (kind === 'worker' ? personName(by) : by);

/** A moment ago is shown, too, so that the line of now stands a little inside. */
export const BACK_S = 5;

export interface Bar {
  readonly by: string;
  readonly kind: 'robot' | 'worker' | 'closure' | 'obstruction';
  readonly look: 'granted' | 'held' | 'conflict' | 'closed' | 'still' | 'slow' | 'price' | 'region2' | 'region3';
  readonly from_s: number;
  readonly to_s: number | null;
  /** Percent of the width. */
  readonly left: number;
  readonly width: number;
  readonly words: string;
}
export interface Row {
  readonly id: string;
  readonly bars: readonly Bar[];
}

export const place = (s: number, ahead: number): number =>
  Math.min(100, Math.max(0, ((s + BACK_S) / (ahead + BACK_S)) * 100));

const EFFECT_WORDS = wordsBy<Condition['effect']>({
  closed: 'timelines.closed',
  still: 'timelines.still',
  slow: 'timelines.slow',
  price: 'timelines.price',
});

export function when(from: number, to: number | null): string {
  const said = (s: number): string => (s <= 0 ? t('now') : `+${quantity(s, 's', 1)}`);
  return to === null
    ? t('timelines.from', { from: said(from) })
    : t('timelines.from-to', { from: said(from), to: said(to) });
}

export function holdWords(node: string, hold: Hold): string {
  const how = hold.conflict
    ? 'timelines.hold.conflict'
    : hold.granted
      ? 'timelines.hold.granted'
      : 'timelines.hold.held';
  return t(how, { node, by: called(hold.kind, hold.by), when: when(hold.from_s, hold.to_s) });
}

export function conditionWords(node: string, c: Condition): string {
  const speed = (mps: number): string => quantity(mps, 'm/s', 1);
  const effect = EFFECT_WORDS[c.effect] ?? c.effect;
  const parts = [
    c.kind === 'obstruction'
      ? t('timelines.because.obstruction', { effect })
      : t('timelines.because', { effect, by: called(c.kind, c.by) }),
    c.effect === 'slow' && c.limit_mps
      ? t('timelines.limit', { bare: speed(c.limit_mps[0]), loaded: speed(c.limit_mps[1]) })
      : '',
    c.effect === 'price' && c.price_s !== null ? t('timelines.costs', { time: quantity(c.price_s, 's', 1) }) : '',
    when(c.from_s, c.to_s),
  ];
  return t('timelines.node', { node, what: listed(parts.filter((part) => part !== '')) });
}

export function regionWords(node: string, stay: RegionStay): string {
  const how = stay.region === 2 ? 'timelines.region.out' : 'timelines.region.slow';
  return t(how, { node, region: stay.region, by: called(stay.kind, stay.of), when: when(stay.from_s, stay.to_s) });
}

/** One row for each node, conditions below holds; safety regions, if they are wanted, below all. */
export function rows(strips: readonly Strip[], ahead: number, regions = false): Row[] {
  const at = (from: number, to: number | null) => {
    const left = place(from, ahead);
    return { left, width: Math.max(0, place(to ?? Infinity, ahead) - left) };
  };
  return strips.map((strip) => {
    const conditions = strip.conditions.map((c): Bar => ({
      by: c.by,
      kind: c.kind,
      look: c.effect,
      from_s: c.from_s,
      to_s: c.to_s,
      ...at(c.from_s, c.to_s),
      words: conditionWords(strip.id, c),
    }));
    // Region 3 is wider, so that region 2 lies on it.
    const stays = (regions ? strip.regions : [])
      .toSorted((a, b) => b.region - a.region)
      .map((s): Bar => ({
        by: s.of,
        kind: s.kind,
        look: `region${s.region}`,
        from_s: s.from_s,
        to_s: s.to_s,
        ...at(s.from_s, s.to_s),
        words: regionWords(strip.id, s),
      }));
    const holds = strip.holds.map((h): Bar => ({
      by: h.by,
      kind: h.kind,
      look: h.conflict ? 'conflict' : h.granted ? 'granted' : 'held',
      from_s: h.from_s,
      to_s: h.to_s,
      ...at(h.from_s, h.to_s),
      words: holdWords(strip.id, h),
    }));
    // What is only in conflict goes below what is held itself.
    const bars = [
      ...stays,
      ...conditions,
      ...holds.filter((b) => b.look === 'conflict'),
      ...holds.filter((b) => b.look !== 'conflict'),
    ];
    return { id: strip.id, bars: bars.filter((b) => b.width > 0) };
  });
}

/** Where somebody looks: a place, and a bar of it, if it has any. */
export interface Look {
  readonly row: string;
  readonly index: number;
  readonly bar: Bar | null;
}

/** A look at the bar of this number of a row, or at the nearest there is. */
export function lookAt(row: Row, index: number): Look {
  const nearest = Math.min(row.bars.length - 1, Math.max(0, index));
  return { row: row.id, index: Math.max(0, nearest), bar: row.bars[nearest] ?? null };
}

/** The same look after a while: at the bar of the same holder, wherever it is by now, else at what took its place. */
export function lookAgain(all: readonly Row[], look: Look): Look | null {
  const row = all.find((r) => r.id === look.row);
  if (!row) return null;
  const { bar } = look;
  const theirs = bar ? row.bars.flatMap((b, i) => (b.by === bar.by && b.kind === bar.kind ? [i] : [])) : [];
  const away = (i: number): number => Math.abs(i - look.index);
  return lookAt(
    row,
    theirs.reduce((best, i) => (away(i) < away(best) ? i : best), theirs[0] ?? look.index),
  );
}

export const lookWords = (look: Look): string => look.bar?.words ?? t('timelines.free', { node: look.row });

/** Seconds at which the axis has marks: four to eight of them. */
export function marks(ahead: number): number[] {
  const step = [2, 5, 10, 15, 20, 30].find((s) => ahead / s <= 8) ?? 30;
  const all: number[] = [];
  for (let s = 0; s <= ahead; s += step) all.push(s);
  return all;
}
