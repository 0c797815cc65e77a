// A work cell at a moment of a recording. Pure.
import type { Listed } from '../replay';
import type { StationDetail } from '../wire';

/** A work cell as recordings have it. */
interface Recorded extends Pick<StationDetail, 'warnings' | 'arm' | 'ends'> {
  lines: NonNullable<StationDetail['visit']>['lines'];
  /** When the visit was expected to end, seconds of the recording. */
  ends_s: [p10: number, p50: number, p90: number] | null;
}

const read = new WeakMap<Listed, Record<string, Recorded>>();

function rowsOf(list: Listed): Record<string, Recorded> {
  const known = read.get(list) ?? (JSON.parse(list.text) as Record<string, Recorded>);
  read.set(list, known);
  return known;
}

/** A station's cell at `t`: as it was when it had changed last by then. Null where nothing is known of it. */
export function cellAt(lists: readonly Listed[], t: number, id: string): StationDetail | null {
  const seen = lists.findLast((list) => list.at <= t && id in rowsOf(list));
  if (!seen) return null;
  const { lines, ends_s, ...rest } = rowsOf(seen)[id]!;
  const left = lines
    .filter(({ state }) => state !== 'done' && state !== 'short')
    .reduce((sum, { quantity, done }) => sum + quantity - done, 0);
  const [p10, p50, p90] = (ends_s ?? [0, 0, 0]).map((s) => Math.max(0, s - t)) as [number, number, number];
  const visit = lines.length === 0 ? null : { lines, pieces_left: left, expected_end: ends_s && { p10, p50, p90 } };
  return { ...rest, has_cell: true, visit };
}
