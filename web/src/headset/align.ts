// Marks on the floor, and the alignment that they make. The server decides; this fit is shown to the wearer while
// marks are taken, so that a wrong one is seen at once. Fit: Arun, Huang and Blostein 1987 in the plane.
import { distance, planOf, toMap, type Alignment, type Vec2, type Vec3 } from './frame';
import { metres, t } from './words';

/** A mark that the wearer confirmed: where the device has it, and where the map has it. */
export interface Mark {
  name: string;
  device: Vec3;
  map: Vec2;
}

export type Fit =
  | { kind: 'fits'; alignment: Alignment; rms_m: number }
  | { kind: 'more'; text: string }
  | { kind: 'misfit'; text: string };

/** The limits of the server, src/api/feed/intake/align.rs. */
const BASELINE_MIN_M = 1;
const SCALE_TOLERANCE = 0.03;
const RMS_MAX_M = 0.15;
const FLOOR_M = 0.25;

/** What these marks say. */
export function fit(marks: readonly Mark[]): Fit {
  if (marks.length < 2) return { kind: 'more', text: t('mark.more') };
  const heights = marks.map((m) => m.device[1]);
  const apart_m = Math.max(...heights) - Math.min(...heights);
  if (apart_m > FLOOR_M) return { kind: 'misfit', text: t('mark.heights', { distance: metres(apart_m) }) };
  const [a, b] = [marks.map((m) => planOf(m.device)), marks.map((m) => m.map)];
  const [ca, cb] = [middle(a), middle(b)];
  const [spreadA, spreadB] = [spread(a, ca), spread(b, cb)];
  const apart = Math.max(...b.map((p) => Math.max(...b.map((q) => distance(p, q)))));
  if (apart < BASELINE_MIN_M) return { kind: 'misfit', text: t('mark.close', { distance: metres(apart) }) };
  const scale = spreadA / spreadB;
  if (Math.abs(scale - 1) > SCALE_TOLERANCE) {
    return { kind: 'misfit', text: t('mark.scale', { distance: metres(apart), walked: metres(apart * scale) }) };
  }
  let [sine, cosine] = [0, 0];
  a.forEach((p, i) => {
    const q = b[i]!;
    const [ax, ay, bx, by] = [p[0] - ca[0], p[1] - ca[1], q[0] - cb[0], q[1] - cb[1]];
    sine += ax * by - ay * bx;
    cosine += ax * bx + ay * by;
  });
  const theta = Math.atan2(sine, cosine);
  const [c, s] = [Math.cos(theta), Math.sin(theta)];
  const alignment: Alignment = { theta, shift: [cb[0] - c * ca[0] + s * ca[1], cb[1] - s * ca[0] - c * ca[1]] };
  const rms_m = Math.sqrt(
    marks.reduce((sum, m) => sum + distance(toMap(alignment, m.device), m.map) ** 2, 0) / marks.length,
  );
  if (rms_m > RMS_MAX_M) return { kind: 'misfit', text: t('mark.off', { distance: metres(rms_m) }) };
  return { kind: 'fits', alignment, rms_m };
}

const middle = (points: readonly Vec2[]): Vec2 => [
  points.reduce((sum, p) => sum + p[0], 0) / points.length,
  points.reduce((sum, p) => sum + p[1], 0) / points.length,
];
const spread = (points: readonly Vec2[], centre: Vec2): number =>
  Math.sqrt(points.reduce((sum, p) => sum + distance(p, centre) ** 2, 0));

/** A place on the map that can be a mark. */
export interface Place {
  name: string;
  at: Vec2;
}

/** Further apart is better for the direction, but a longer walk before the work: metres. */
const GOOD_BASELINE_M = 12;

/** Two marks to begin with: as far apart as does good, no further. */
export function suggest(places: readonly Place[]): [Place, Place] | null {
  let best: [Place, Place] | null = null;
  let worth = -1;
  for (const [i, a] of places.entries()) {
    for (const b of places.slice(i + 1)) {
      const d = distance(a.at, b.at);
      const w = d <= GOOD_BASELINE_M ? d : 2 * GOOD_BASELINE_M - d;
      if (d >= BASELINE_MIN_M && w > worth) [best, worth] = [[a, b], w];
    }
  }
  return best;
}

/** A third mark, as far beside the line of two as does good: on one line left and right could be exchanged. */
export function beside(places: readonly Place[], [a, b]: readonly [Place, Place]): Place | null {
  const [dx, dy] = [b.at[0] - a.at[0], b.at[1] - a.at[1]];
  const off = (p: Place): number => Math.abs(dx * (p.at[1] - a.at[1]) - dy * (p.at[0] - a.at[0])) / Math.hypot(dx, dy);
  const worth = (p: Place): number =>
    Math.min(off(p), GOOD_BASELINE_M / 2) - Math.max(distance(p.at, a.at), distance(p.at, b.at)) / 4;
  const fit = places.filter((p) => off(p) >= BASELINE_MIN_M);
  return fit.reduce<Place | null>((best, p) => (best === null || worth(p) > worth(best) ? p : best), null);
}

export type Marking =
  /** The wearer is to stand on `names[taken.length]` and confirm. */
  | { kind: 'taking'; names: readonly string[]; taken: readonly Mark[] }
  | { kind: 'asking'; names: readonly string[]; taken: readonly Mark[] }
  | { kind: 'refused'; names: readonly string[]; taken: readonly Mark[]; text: string }
  | { kind: 'done'; names: readonly string[]; taken: readonly Mark[]; rms_m: number };

export type MarkEvent =
  | { kind: 'begin' }
  | { kind: 'confirm'; at: Vec3; map: Vec2 }
  | { kind: 'aligned'; rms_m: number }
  | { kind: 'refused'; text: string }
  /** The device's frame jumped: what was taken means nothing any more. */
  | { kind: 'reset' }
  /** A new connection does not know the marks. */
  | { kind: 'again' };

/** One step of taking marks. `asking` means: send `taken` to the server. */
export function mark(now: Marking, event: MarkEvent): Marking {
  const { names, taken } = now;
  switch (event.kind) {
    case 'begin':
    case 'reset':
      return { kind: 'taking', names, taken: [] };
    case 'confirm': {
      if (now.kind === 'refused') return { kind: 'taking', names, taken: [] };
      const name = names[taken.length];
      if (now.kind !== 'taking' || name === undefined) return now;
      const all = [...taken, { name, device: event.at, map: event.map }];
      if (all.length < names.length) return { ...now, taken: all };
      const fitted = fit(all);
      return fitted.kind === 'fits'
        ? { kind: 'asking', names, taken: all }
        : { kind: 'refused', names, taken: all, text: fitted.text };
    }
    case 'aligned':
      return now.kind === 'asking' || now.kind === 'done' ? { kind: 'done', names, taken, rms_m: event.rms_m } : now;
    case 'refused':
      return now.kind === 'asking' ? { kind: 'refused', names, taken, text: event.text } : now;
    case 'again':
      return taken.length === names.length && now.kind !== 'refused' ? { kind: 'asking', names, taken } : now;
  }
}
