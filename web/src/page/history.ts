// Deliveries per hour over the last ten minutes: of the present from what the server kept, of the past from what was
// shown.
import type { Bucket } from '../wire';

export const SPAN_S = 600;
const STEP_S = 5;
const SLOTS = SPAN_S / STEP_S;

export class History {
  #values: { slot: number; value: number }[] = [];

  add(time_s: number, value: number): void {
    const slot = Math.floor(time_s / STEP_S);
    const last = this.#values.at(-1);
    if (last?.slot === slot) {
      last.value = value;
      return;
    }
    // A clock that runs backwards means another run: its past is not ours.
    if (last && slot < last.slot) this.#values = [];
    this.#values.push({ slot, value });
    while (this.#values[0] && this.#values[0].slot <= slot - SLOTS) this.#values.shift();
  }

  /** Points in a box of 1 by 1, y down, newest at the right edge; empty until there are two. */
  points(): [x: number, y: number][] {
    const last = this.#values.at(-1);
    if (!last || this.#values.length < 2) return [];
    const top = Math.max(...this.#values.map((v) => v.value)) || 1;
    return this.#values.map((v) => [1 - (last.slot - v.slot) / (SLOTS - 1), 1 - v.value / top]);
  }
}

/** Deliveries per hour in each bucket, as points in the same box; a bucket that has just begun says nothing yet. */
export function trend(buckets: readonly Bucket[]): [x: number, y: number][] {
  const rates = buckets.filter((b) => b.covered_s >= 20).map((b) => (3_600 * b.robot_deliveries) / b.covered_s);
  if (rates.length < 2) return [];
  const top = Math.max(...rates) || 1;
  return rates.map((rate, i) => [i / (rates.length - 1), 1 - rate / top]);
}
