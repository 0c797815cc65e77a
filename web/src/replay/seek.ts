// From frames to the mirror of a moment: on from what is shown if the patches lead there, else from the last
// key frame. Both ways come to the same; playing is cheap, and seeking costs some dozens of patches.
import { EMPTY, parseMessage, reduce, type Mirror } from '../wire';
import type { Shot } from './reel';

export interface Shown {
  at: number;
  mirror: Mirror;
  how: 'glide' | 'jump';
}
/** So many patches are played; further on, key frames are the shorter way. */
const MOST_PLAYED = 60;

/** What is to be seen at `t`; before the first frame, that one. Null if there is no key frame. */
export function seek(shots: readonly Shot[], t: number, shown: Shown | null): Shown | null {
  const first = shots.findIndex((shot) => shot.kind === 'key');
  if (first < 0) return null;
  const last = Math.max(first, after(shots, t) - 1);
  if (shown && shown.at <= t) {
    const next = after(shots, shown.at);
    if (next > last) return shown;
    const mirror = last - next < MOST_PLAYED ? play(shots, next, last, shown.mirror) : null;
    if (mirror) return { at: shots[last]!.at, mirror, how: 'glide' };
  }
  let key = last;
  while (shots[key]!.kind !== 'key') key -= 1;
  const whole = play(shots, key, key, EMPTY);
  const mirror = whole && play(shots, key + 1, last, whole);
  return mirror && { at: shots[last]!.at, mirror, how: 'jump' };
}

/** The number of the first frame after `t`. */
export function after(shots: readonly Shot[], t: number): number {
  let [low, high] = [0, shots.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (shots[middle]!.at <= t) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Null where a patch does not fit onto what was there. */
function play(shots: readonly Shot[], from: number, to: number, mirror: Mirror): Mirror | null {
  for (let i = from; i <= to; i++) {
    const shot = shots[i]!;
    // After the frame before, no key frame is needed: rows keep their identity, and motion goes on.
    if (shot.kind === 'key' && mirror !== EMPTY) continue;
    const message = parseMessage(shot.text);
    const reduced = message && reduce(mirror, message);
    if (!reduced || reduced.kind === 'gap') return null;
    mirror = reduced.mirror;
  }
  return mirror;
}
