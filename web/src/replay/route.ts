// The part of the address behind #: `#replay?from=120&to=180` shows these seconds of the past.

export interface Route {
  from: number | null;
  to: number | null;
}

export function replayRoute(hash: string): Route | null {
  const found = /^#replay(?:\?(.*))?$/.exec(hash);
  if (!found) return null;
  const query = new URLSearchParams(found[1] ?? '');
  const seconds = (name: string): number | null => {
    const text = query.get(name);
    const value = text === null || text.trim() === '' ? NaN : Number(text);
    return Number.isFinite(value) ? value : null;
  };
  return { from: seconds('from'), to: seconds('to') };
}
