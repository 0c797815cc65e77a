// The form for a closed area without its looks: the request made of what somebody typed.
import type { NewClosure, Point } from '../wire';

export interface ClosureValues {
  reason: string;
  /** Minutes from now; empty for at once. */
  begins: string;
  /** Minutes; empty until somebody opens it. */
  lasts: string;
}
export type ClosureErrors = Partial<Record<keyof ClosureValues, string>>;
export type BuiltClosure = { kind: 'ready'; area: NewClosure } | { kind: 'wrong'; errors: ClosureErrors };

const WEEK = 7 * 24 * 60;

export function buildClosure(values: ClosureValues, outline: readonly Point[], now: Date): BuiltClosure {
  const errors: ClosureErrors = {};
  const area: NewClosure = { outline: [...outline], reason: values.reason.trim() };
  if (area.reason === '') errors.reason = 'Say why, so that people who see the area know the reason.';
  const minutes = (field: 'begins' | 'lasts', least: number): number | null => {
    if (values[field].trim() === '') return null;
    const n = Number(values[field]);
    if (Number.isFinite(n) && n >= least && n <= WEEK) return n;
    errors[field] = 'Enter a number of minutes, at most a week.';
    return null;
  };
  const begins = minutes('begins', 0);
  const lasts = minutes('lasts', 0.1);
  const at = (m: number) => new Date(now.getTime() + m * 60_000).toISOString();
  if (begins !== null && begins > 0) area.from = at(begins);
  if (lasts !== null) area.until = at((begins ?? 0) + lasts);
  return Object.keys(errors).length > 0 ? { kind: 'wrong', errors } : { kind: 'ready', area };
}
