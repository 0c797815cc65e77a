// From when to when there are frames of a recording.

export interface Span {
  from_s: number;
  to_s: number;
}
type Spanned = { readonly spans: readonly Span[] };
export const begins = (recording: Spanned): number => recording.spans[0]?.from_s ?? 0;
export const ends = (recording: Spanned): number => recording.spans.at(-1)?.to_s ?? 0;

/** The moment itself, or the next one of which there is a frame. */
export function snap(recording: Spanned, t: number): number {
  for (const span of recording.spans) if (t <= span.to_s) return Math.max(t, span.from_s);
  return ends(recording);
}
