// Between two messages of the live feed: what moves glides to where it was last seen, rather than jump there. Pure.
import type { Mover } from './hall';
import type { Mirror } from '../wire';

/** A pause in the feed is no slow motion. */
const LONGEST_MS = 400;
/** What moved further than people and robots can between two messages is shown where it is: metres. */
const JUMP_M = 2;

interface Row {
  from: Mover;
  to: Mover;
}

export class Glide {
  #rows = new Map<string, Row>();
  #at = -Infinity;
  #lasts = 1;

  /** A newer picture, which came now. */
  take(mirror: Mirror, now: number): void {
    const next = new Map<string, Row>();
    for (const { id, x, y, heading } of [...mirror.robots.rows, ...mirror.workers.rows]) {
      if (x === null || y === null) continue;
      const before = this.where(id, now);
      const to: Mover = { at: [x, y], heading: heading ?? before?.heading ?? 0 };
      const far = before ? Math.hypot(before.at[0] - x, before.at[1] - y) : Infinity;
      next.set(id, { from: before && far < JUMP_M ? before : to, to });
    }
    this.#lasts = Math.max(1, Math.min(LONGEST_MS, now - this.#at));
    [this.#rows, this.#at] = [next, now];
  }

  /** Where something is now. */
  where(id: string, now: number): Mover | undefined {
    const row = this.#rows.get(id);
    if (!row) return undefined;
    const share = Math.min(1, Math.max(0, (now - this.#at) / this.#lasts));
    const { from, to } = row;
    const turn = Math.atan2(Math.sin(to.heading - from.heading), Math.cos(to.heading - from.heading));
    return {
      at: [from.at[0] + share * (to.at[0] - from.at[0]), from.at[1] + share * (to.at[1] - from.at[1])],
      heading: from.heading + share * turn,
    };
  }
}
