// What was before, to go back to it: maps are never changed, so each state is kept as it was.
const MOST = 200;

export interface Steps<T> {
  readonly past: readonly T[];
  readonly now: T;
  readonly future: readonly T[];
}

export const begin = <T>(now: T): Steps<T> => ({ past: [], now, future: [] });

/** A new state; the same one again is none. */
export function put<T>(steps: Steps<T>, now: T): Steps<T> {
  return now === steps.now ? steps : { past: [...steps.past, steps.now].slice(-MOST), now, future: [] };
}

export function undo<T>({ past, now, future }: Steps<T>): Steps<T> {
  const before = past[past.length - 1];
  return before === undefined
    ? { past, now, future }
    : { past: past.slice(0, -1), now: before, future: [now, ...future] };
}

export function redo<T>({ past, now, future }: Steps<T>): Steps<T> {
  const [next, ...rest] = future;
  return next === undefined ? { past, now, future } : { past: [...past, now], now: next, future: rest };
}
