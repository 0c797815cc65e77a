// From frames to the mirror of a moment: on from what is shown if the patches lead there, else from the last
// key frame. Both ways come to the same; playing is cheap, and seeking costs some dozens of patches.
import { EMPTY, parseMessage, reduce, type Mirror } from '../wire';
import type { Frame } from './frames';

export interface Shown {
  at: number;
  mirror: Mirror;
  how: 'glide' | 'jump';
}
/** So many patches are played; further on, key frames are the shorter way. */
const MOST_PLAYED = 60;

/** What is to be seen at `t`; before the first frame, that one. Null if there is no key frame. */
export function seek(frames: readonly Frame[], t: number, shown: Shown | null): Shown | null {
  const first = frames.findIndex((frame) => frame.kind === 'key');
  if (first < 0) return null;
  const last = Math.max(first, after(frames, t) - 1);
  if (shown && shown.at <= t) {
    const next = after(frames, shown.at);
    if (next > last) return shown;
    const mirror = last - next < MOST_PLAYED ? play(frames, next, last, shown.mirror) : null;
    if (mirror) return { at: frames[last]!.at, mirror, how: 'glide' };
  }
  let key = last;
  while (frames[key]!.kind !== 'key') key -= 1;
  const whole = play(frames, key, key, EMPTY);
  const mirror = whole && play(frames, key + 1, last, whole);
  return mirror && { at: frames[last]!.at, mirror, how: 'jump' };
}

/** The number of the first frame after `t`. */
export function after(frames: readonly Frame[], t: number): number {
  let [low, high] = [0, frames.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (frames[middle]!.at <= t) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Null where a patch does not fit onto what was there. */
function play(frames: readonly Frame[], from: number, to: number, mirror: Mirror): Mirror | null {
  for (let i = from; i <= to; i++) {
    const frame = frames[i]!;
    // After the frame before, no key frame is needed: rows keep their identity, and motion goes on.
    if (frame.kind === 'key' && mirror !== EMPTY) continue;
    const message = parseMessage(frame.text);
    const reduced = message && reduce(mirror, message);
    if (!reduced || reduced.kind === 'gap') return null;
    mirror = reduced.mirror;
  }
  return mirror;
}
