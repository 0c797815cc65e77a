// Where people may be in the coming seconds: bell curves, drawn as heat below everything that moves. It
// takes what it is given; what forecasts, and how far ahead, is decided elsewhere.
import type { WorkerForecast } from '../../wire';
import { KIND, type Sheet } from './sheet';

/** One bell curve: its middle in metres, its covariance in square metres, its share of the probability. */
export interface Gaussian {
  x: number;
  y: number;
  sxx: number;
  sxy: number;
  syy: number;
  weight: number;
}
/** What is forecast of one worker. */
export interface Forecast {
  worker: string;
  parts: readonly Gaussian[];
}

/** Probability per square metre at which heat is as good as full. */
const FULL = 0.5;
const MOST = 0.8;
/** Standard deviations to each side; the rest would not be seen. */
const REACH = 3;
/** Less than this can be said of nobody's place, metres. */
const LEAST = 0.05;

/** What is drawn of what the server expects: one moment ahead, in seconds, or all of them, one over the other. */
export function forecastsOf(workerForecasts: readonly WorkerForecast[], ahead: number | 'all' | 'none'): Forecast[] {
  if (ahead === 'none') return [];
  return workerForecasts.map(({ worker, parts }) => ({
    worker,
    // The farthest first: what comes soonest is narrow and lies on top.
    parts: parts
      .filter((c) => ahead === 'all' || c.after_s === ahead)
      .toSorted((a, b) => b.after_s - a.after_s)
      .map(({ x, y, sx, sy, tilt, p }) => ({ x, y, sxx: sx * sx, sxy: tilt * sx * sy, syy: sy * sy, weight: p })),
  }));
}

/** The axes of a bell curve: standard deviations along and across, and the turn of the long one. */
export function axes({ sxx, sxy, syy }: Gaussian): { long: number; short: number; turn: number } {
  const half = (sxx + syy) / 2;
  const off = Math.hypot((sxx - syy) / 2, sxy);
  return {
    long: Math.sqrt(Math.max(LEAST * LEAST, half + off)),
    short: Math.sqrt(Math.max(LEAST * LEAST, half - off)),
    turn: 0.5 * Math.atan2(2 * sxy, sxx - syy),
  };
}

/** How opaque the middle of a bell curve is: by its density, not by its size. */
export function strength(part: Gaussian): number {
  const { long, short } = axes(part);
  const density = part.weight / (2 * Math.PI * long * short);
  return MOST * (1 - Math.exp(-density / FULL));
}

/** Puts all of it on a sheet in colour `ink`, whose own opacity is not used. */
export function putHeat(sheet: Sheet, forecasts: readonly Forecast[], ink: number): void {
  for (const { parts } of forecasts) {
    for (const part of parts) {
      const { long, short, turn } = axes(part);
      const byte = Math.round(255 * strength(part));
      if (byte < 2 || !Number.isFinite(part.x + part.y + turn)) continue;
      sheet.put(
        KIND.heat,
        part.x,
        part.y,
        2 * REACH * long,
        2 * REACH * short,
        ((byte << 24) | (ink & 0xffffff)) >>> 0,
        turn,
      );
    }
  }
}
