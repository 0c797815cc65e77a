// The encounters that a reel knows, from its bookmarks. Pure.
import type { Encounter, Mark } from '../wire';

/** The encounters among bookmarks, as they are listed, with the bookmark of each by its number; and how many bookmarks
 *  say too little, which older versions wrote. */
export function metIn(
  marks: readonly Mark[],
  start: number | null,
): { items: Encounter[]; marks: readonly Mark[]; bare: number } {
  const met = marks.filter((mark) => mark.kind === 'encounter');
  const known = met.filter((mark) => mark.encounter !== undefined);
  const items = known.map((mark, id): Encounter => {
    const { ended_s, ...rest } = mark.encounter!;
    const began = new Date(1_000 * ((start ?? 0) + mark.at_s)).toISOString();
    // Fleets note who comes into region 1, and no other.
    return { ...rest, id, began, lasted_s: ended_s - mark.at_s, region: 1 };
  });
  return { items, marks: known, bare: met.length - known.length };
}
