// Charts of the past: from running sums to what happened between them. Pure.
import type { Sum } from '../wire';
import { CHARTS, PICKING, type Chart, type Figures, type Grid } from './series';

/** What frames say nothing of. */
const UNKNOWN = ['steps', ...PICKING];
/** The charts of the present, but that frames say of searches how long 99 % of them took at most, and of some
 *  nothing. */
export const CHARTS_THEN: readonly Chart[] = CHARTS.filter(({ id }) => !UNKNOWN.includes(id)).map((chart) => {
  if (chart.id !== 'plans') return chart;
  const [median, most] = chart.lines;
  return {
    ...chart,
    lines: [median!, { ...most!, id: '99 %', name: 'charts.line.p99', of: (b) => b.plan_us_p99 ?? null }],
  };
});

/** Up to how many seconds are shown in which steps, about as the present does it: finer ones have too little in them to
 *  be a rate, and more of them nobody can tell apart. */
const STEPS_S = [
  [300, 10],
  [1_800, 30],
  [7_200, 60],
  [36_000, 300],
  [100_000, 600],
] as const;

/** Steps in which so many seconds are shown. */
export const stepOf = (span_s: number): number => STEPS_S.find(([most]) => span_s <= most)?.[1] ?? 3_600;

/** Less of the time between two sums was seen: there is a gap. */
const LEAST_SEEN = 0.5;
const COUNTS = [
  'robot_deliveries',
  'human_deliveries',
  'encounters',
  'interruptions',
  'replans',
  'covered_s',
  'waiting_s',
  'worker_s',
] as const;

/** An even grid over the seconds from `left` to `right`. Sums do not lie on its lines: what happened between two of
 *  them is shared out by time. Where they fall, another run began; that is a gap, never less than nothing. */
export function gridOfSums(sums: readonly Sum[], left: number, right: number, start: number | null): Grid {
  const step = stepOf(right - left);
  const from = Math.floor(left / step) * step;
  const n = Math.max(1, Math.ceil((right - from) / step));
  const buckets: (Figures | null)[] = new Array<Figures | null>(n).fill(null);
  sums.forEach((b, i) => {
    const a = sums[i - 1];
    if (!a) return;
    const span = b.at_s - a.at_s;
    const isGap = COUNTS.some((key) => b[key] < a[key]) || b.covered_s - a.covered_s < LEAST_SEEN * span;
    if (span <= 0 || isGap) return;
    for (let k = Math.max(0, Math.floor((a.at_s - from) / step)); k < n && from + k * step < b.at_s; k++) {
      const shared = Math.min(b.at_s, from + (k + 1) * step) - Math.max(a.at_s, from + k * step);
      if (shared <= 0) continue;
      const bucket = (buckets[k] ??= nothing());
      for (const key of COUNTS) bucket[key] += ((b[key] - a[key]) * shared) / span;
      bucket.plan_us_p50 = b.plan_us_p50 || null;
      bucket.plan_us_p99 = b.plan_us_p99 || null;
    }
  });
  const ms = (s: number): number => 1_000 * ((start ?? 0) + s);
  const at = buckets.map((_, k) => ms(from + k * step));
  return { from: ms(from), to: ms(from + n * step), step: 1_000 * step, at, buckets, ofDay: start !== null };
}

const nothing = (): Figures => ({
  covered_s: 0,
  robot_deliveries: 0,
  human_deliveries: 0,
  encounters: 0,
  interruptions: 0,
  replans: 0,
  worker_s: 0,
  waiting_s: 0,
  lines: 0,
  wrong_reaches: 0,
  idle_s: 0,
  plan_us_p50: null,
  plan_us_p95: null,
  plan_us_max: null,
  step_us_max: null,
  plan_us_p99: null,
});
