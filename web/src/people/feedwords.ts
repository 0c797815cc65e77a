// How well somebody is seen, in words: what the server counted of the poses, and how the rest of it stands. Pure.
import { count, percent } from '../words';
import type { WorkerDetail } from '../wire';

/** Two looks at the same worker, and the time between them. */
export interface Looks {
  before: WorkerDetail | null;
  now: WorkerDetail;
  apart_s: number;
}
export interface Word {
  name: string;
  text: string;
  /** Whether it is as it should be. */
  well: boolean;
}

/** A feed slower than this is too slow to follow somebody who walks, poses a second. */
const SLOW_HZ = 4;
const OLD_S = 0.5;
const UNSURE_M = 0.3;

export function feedWords({ before, now, apart_s }: Looks, lost: number | null): Word[] {
  const words: Word[] = [];
  if (before && apart_s > 0.2) {
    const hz = Math.max(0, now.feed.taken - before.feed.taken) / apart_s;
    words.push({ name: 'Rate', text: `${hz < 10 ? hz.toFixed(1) : Math.round(hz)} poses a second`, well: hz >= SLOW_HZ });
  }
  if (now.age_s !== null) words.push({ name: 'Latest', text: `${now.age_s < 10 ? now.age_s.toFixed(2) : Math.round(now.age_s)} s old`, well: now.age_s <= OLD_S });
  words.push({ name: 'Accuracy', text: `± ${now.accuracy.toFixed(2)} m`, well: now.accuracy <= UNSURE_M });
  if (now.clock_error_ms !== null) {
    words.push({ name: 'Clock', text: `accurate to ± ${now.clock_error_ms < 10 ? now.clock_error_ms.toFixed(1) : Math.round(now.clock_error_ms)} ms`, well: now.clock_error_ms < 100 });
  } else {
    words.push({ name: 'Clock', text: now.connected ? 'not known yet' : 'the server’s own, as no headset is connected', well: true });
  }
  const { taken, late, jumps, absurd } = now.feed;
  const refused = late + jumps + absurd;
  const parts = [late > 0 ? `${count(late)} late` : '', jumps > 0 ? `${count(jumps)} jumps` : '', absurd > 0 ? `${count(absurd)} implausible` : ''].filter(Boolean);
  const share = refused / Math.max(1, taken + refused);
  words.push({
    name: 'Refused', well: share < 0.1,
    text: refused === 0 ? `none of ${count(taken)}` : `${share < 0.01 ? 'under 1 %' : percent(share)} of ${count(taken + refused)}: ${parts.join(', ')}`,
  });
  if (lost !== null) words.push({ name: 'Not seen', text: `${percent(lost)} of the last two minutes`, well: lost < 0.05 });
  return words;
}
