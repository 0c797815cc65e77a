// What a scan means. The lit slot confirms one piece; a tote is compared with where that piece belongs; any other slot
// or tote is a mistake. Pure.
import { litOf } from './lines';
import type { Line, Station, Warning } from './state';

export type Verdict =
  | { kind: 'piece'; line: Line }
  | { kind: 'right tote'; tote: string }
  | { kind: 'mistake'; mistake: Mistake }
  /** It names nothing here. */
  | { kind: 'unknown'; text: string }
  /** No line is lit. */
  | { kind: 'nothing' };

/** What went wrong, and what would be right. */
export interface Mistake {
  kind: Warning['kind'];
  is: string | null;
  right: string | null;
}

const SLOT = /^[A-Z][1-9]\d?$/;

/**
 * Judges a scan. `expected` is the tote of the piece that was scanned last, since its line may be over by now; null
 * where none was. Null for a single character that names nothing: that was a key, and Enter soon after it.
 */
export function judge(scanned: string, { totes, visit }: Station, expected: string | null): Verdict | null {
  const text = scanned.trim();
  const upper = text.toUpperCase();
  const tote = totes.find(({ id }) => id === text) ?? totes.find(({ id }) => id.toUpperCase() === upper);
  const lit = litOf(visit);
  if (tote === undefined && text.length < 2) return null;
  if (lit?.slot === upper) return { kind: 'piece', line: lit };
  if (tote && expected === null && lit === null) return { kind: 'nothing' };
  const right = expected ?? lit?.tote ?? null;
  if (tote && tote.id === right) return { kind: 'right tote', tote: tote.id };
  if (tote) return { kind: 'mistake', mistake: { kind: 'wrong_tote', is: tote.id, right } };
  if (!SLOT.test(upper)) return { kind: 'unknown', text };
  return lit ? { kind: 'mistake', mistake: { kind: 'wrong_slot', is: upper, right: lit.slot } } : { kind: 'nothing' };
}

/** The mistake that the server warns of, if it does. */
export function warned({ warnings, visit }: Station): Mistake | null {
  const [first] = warnings;
  const lit = litOf(visit);
  if (!first) return null;
  const isSlot = first.kind === 'wrong_slot';
  return { kind: first.kind, is: isSlot ? first.slot : first.tote, right: (isSlot ? lit?.slot : lit?.tote) ?? null };
}
