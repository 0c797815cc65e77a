// Where each worker was thought to be going, second by second over the last two minutes; how well the worker was
// seen, and since when things stand as they do. Bounded: so many seconds, so many goals, for each worker.
import type { Mirror, Worker } from '../wire';

export const SPAN_S = 120;
const GOALS = 5;

export interface Sample {
  /** Whole seconds of the floor's clock. */
  t: number;
  presence: Worker['presence'];
  goals: readonly { key: string; x: number; y: number; p: number }[];
  elsewhere: number;
  undecided: number;
}
/** One band of the chart: its share in each of the seconds shown, nothing where the worker was not here. */
export interface Band {
  key: string;
  /** A place, or one of the two that are none. */
  kind: 'goal' | 'others' | 'elsewhere' | 'undecided';
  x: number;
  y: number;
  values: (number | null)[];
}

export class Chances {
  #samples = new Map<string, Sample[]>();
  #since = new Map<string, { state: Worker['state']; at: number }>();
  #last = -Infinity;

  note({ time_s, workers }: Mirror): void {
    const t = Math.floor(time_s);
    // A clock that runs backwards means another run, or a recording that was wound back.
    if (t < Math.floor(this.#last)) {
      this.#samples.clear();
      this.#since.clear();
    }
    for (const w of workers.rows) {
      if (this.#since.get(w.id)?.state !== w.state) this.#since.set(w.id, { state: w.state, at: time_s });
    }
    if (t === Math.floor(this.#last)) return;
    this.#last = time_s;
    for (const w of workers.rows) {
      const all = this.#samples.get(w.id) ?? [];
      const goals = w.goals.slice(0, GOALS).map(({ x, y, p }) => ({ key: `${x},${y}`, x, y, p }));
      all.push({ t, presence: w.presence, goals, elsewhere: w.elsewhere, undecided: w.undecided });
      while (all[0] && all[0].t <= t - SPAN_S) all.shift();
      this.#samples.set(w.id, all);
    }
  }

  /** Since when a worker is told the same, seconds of the floor's clock. */
  since(worker: string): number | null {
    return this.#since.get(worker)?.at ?? null;
  }

  /** In order of time. */
  of(worker: string): readonly Sample[] {
    return this.#samples.get(worker) ?? [];
  }
}

/** Bands from the bottom up, each with a value for every second of the last two minutes. */
export function bands(samples: readonly Sample[], most = 4): Band[] {
  const last = samples.at(-1)?.t ?? 0;
  const by = new Map(samples.filter((s) => s.presence !== 'absent').map((s) => [s.t, s]));
  const seconds = Array.from({ length: SPAN_S }, (_, i) => by.get(last - SPAN_S + 1 + i) ?? null);
  const sums = new Map<string, { x: number; y: number; sum: number }>();
  for (const s of seconds) {
    for (const { key, x, y, p } of s?.goals ?? []) sums.set(key, { x, y, sum: (sums.get(key)?.sum ?? 0) + p });
  }
  const top = [...sums].sort((a, b) => b[1].sum - a[1].sum).slice(0, most);
  const value = (s: Sample, key: string): number => s.goals.find((g) => g.key === key)?.p ?? 0;
  const each = (of: (s: Sample) => number): (number | null)[] => seconds.map((s) => (s === null ? null : of(s)));
  const known = (s: Sample): number => top.reduce((sum, [key]) => sum + value(s, key), 0);
  // What the goals that are not listed have is what is missing to one.
  const others = (s: Sample): number => Math.max(0, 1 - s.elsewhere - s.undecided - known(s));
  const bare = { x: 0, y: 0 };
  return [
    ...top.map(([key, { x, y }]): Band => ({ key, kind: 'goal', x, y, values: each((s) => value(s, key)) })),
    { key: 'others', kind: 'others', ...bare, values: each(others) },
    { key: 'elsewhere', kind: 'elsewhere', ...bare, values: each((s) => s.elsewhere) },
    { key: 'undecided', kind: 'undecided', ...bare, values: each((s) => s.undecided) },
  ];
}

/** The share of the last two minutes in which the worker was here but not seen well, 0 to 1; null where never here. */
export function lostShare(samples: readonly Sample[]): number | null {
  const here = samples.filter((s) => s.presence !== 'absent');
  return here.length === 0 ? null : here.filter((s) => s.presence !== 'tracked').length / here.length;
}

/** Stacked areas: for each band the outlines of its runs, in a box of `SPAN_S` by 1, y up. */
export function areas(all: readonly Band[]): { band: Band; outlines: [x: number, y: number][][] }[] {
  const floor = new Array<number>(SPAN_S).fill(0);
  return all.map((band) => {
    const outlines: [number, number][][] = [];
    let upper: [number, number][] = [];
    let lower: [number, number][] = [];
    const close = (): void => {
      if (upper.length > 0) outlines.push([...upper, ...lower.toReversed()]);
      [upper, lower] = [[], []];
    };
    band.values.forEach((value, i) => {
      if (value === null) return close();
      const from = floor[i]!;
      const to = Math.min(1, from + value);
      floor[i] = to;
      // A second is as wide as a second: steps, since between two of them nothing was said.
      upper.push([i, to], [i + 1, to]);
      lower.push([i, from], [i + 1, from]);
    });
    close();
    return { band, outlines };
  });
}
