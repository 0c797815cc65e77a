// What `giveway experiment table-4-1 --json` wrote, read with care: somebody picked the file. Pure.

export interface Figure {
  mean: number | null;
  sd: number | null;
}
export interface Difference {
  mean: number | null;
  ci95: [low: number, high: number] | null;
}
export interface Comparison {
  workers: number;
  /** By arm, then by figure. */
  arms: [arm: string, figures: Record<string, Figure>][];
  /** By pair of arms, "ours-theirs". */
  paired: [pair: string, figures: Record<string, Difference>][];
}
export type Read =
  | { kind: 'ok'; comparisons: Comparison[]; figures: string[] }
  | { kind: 'wrong'; why: 'experiment.no-json' | 'experiment.no-scenarios' | 'experiment.no-arms' };

export function readExperiment(text: string): Read {
  let raw: unknown;
  try {
    raw = JSON.parse(text);
  } catch {
    return { kind: 'wrong', why: 'experiment.no-json' };
  }
  const scenarios = isObject(raw) ? raw['scenarios'] : undefined;
  if (!Array.isArray(scenarios) || scenarios.length === 0) {
    return { kind: 'wrong', why: 'experiment.no-scenarios' };
  }
  const comparisons: Comparison[] = [];
  for (const one of scenarios) {
    if (!isObject(one) || !isObject(one['arms'])) return { kind: 'wrong', why: 'experiment.no-arms' };
    const paired = isObject(one['paired']) ? one['paired'] : {};
    comparisons.push({
      workers: number(one['workers']) ?? 0,
      arms: entries(one['arms'], (f) => ({ mean: number(f['mean']), sd: number(f['sd']) })),
      paired: entries(paired, (f) => ({ mean: number(f['mean']), ci95: interval(f['ci95']) })),
    });
  }
  const figures = [...new Set(comparisons.flatMap((c) => c.arms.flatMap(([, f]) => Object.keys(f))))];
  return { kind: 'ok', comparisons, figures };
}

/** Ends of an axis around intervals, with some room; around zero where there are none. */
export function reach(values: readonly number[]): [low: number, high: number] {
  const [low, high] = [Math.min(0, ...values), Math.max(0, ...values)];
  const room = (high - low || 1) * 0.06;
  return [low < 0 ? low - room : 0, high + room];
}

const isObject = (x: unknown): x is Record<string, unknown> => typeof x === 'object' && x !== null && !Array.isArray(x);
const number = (x: unknown): number | null => (typeof x === 'number' && Number.isFinite(x) ? x : null);

function interval(x: unknown): [number, number] | null {
  const [low, high] = Array.isArray(x) ? x.map(number) : [];
  return low === undefined || low === null || high === undefined || high === null ? null : [low, high];
}

function entries<T>(
  of: Record<string, unknown>,
  make: (figure: Record<string, unknown>) => T,
): [string, Record<string, T>][] {
  return Object.entries(of).map(([name, figures]) => [
    name,
    Object.fromEntries(
      Object.entries(isObject(figures) ? figures : {}).flatMap(([key, f]) => (isObject(f) ? [[key, make(f)]] : [])),
    ),
  ]);
}
