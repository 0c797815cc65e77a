// Scales of charts: round numbers on the axes, whole minutes below them. Pure.

/** Round numbers from zero to at least `most`, about `count` of them. */
export function ticks(most: number, count = 3): number[] {
  if (!(most > 0) || !Number.isFinite(most)) return [0, 1];
  const rough = most / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999) ?? 10 * power;
  const n = Math.max(1, Math.ceil(most / step - 1e-9));
  return Array.from({ length: n + 1 }, (_, i) => round(i * step));
}

/** Powers of ten around everything from `least` to `most`. */
export function logTicks(least: number, most: number): number[] {
  if (!(least > 0) || !(most >= least)) return [1, 10];
  const from = Math.floor(Math.log10(least) + 1e-9);
  const to = Math.max(from + 1, Math.ceil(Math.log10(most) - 1e-9));
  return Array.from({ length: to - from + 1 }, (_, i) => 10 ** (from + i));
}

/** A scale from the first tick to the last onto 0 to 1. */
export function scaleOf(marks: readonly number[], kind: 'linear' | 'log'): (value: number) => number {
  const [low, high] = [marks[0]!, marks.at(-1)!];
  if (kind === 'linear') return (value) => (value - low) / (high - low);
  const [a, b] = [Math.log(low), Math.log(high)];
  return (value) => (Math.log(Math.max(value, low)) - a) / (b - a);
}

const TIME_STEPS_S = [15, 30, 60, 120, 300, 600, 900, 1_800, 3_600, 7_200, 10_800, 21_600, 43_200, 86_400];

/** Round times between two, in milliseconds, at most `most` of them; local, so that midnight is one. */
export function timeTicks(
  from: number,
  to: number,
  most = 4,
  zoneMs = -60_000 * new Date(from).getTimezoneOffset(),
): number[] {
  const step = 1_000 * (TIME_STEPS_S.find((s) => (to - from) / (1_000 * s) <= most) ?? 86_400);
  const first = Math.ceil((from + zoneMs) / step) * step - zoneMs;
  const found: number[] = [];
  for (let t = first; t < to; t += step) found.push(t);
  return found;
}

const round = (n: number): number => Number(n.toPrecision(12));
