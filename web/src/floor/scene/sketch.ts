// Drawing on the floor without its looks: corners come in one by one, by pointer or by keys, and a shape comes out.
import type { Point } from '../../wire';

export interface Drawing {
  readonly kind: 'rectangle' | 'polygon' | 'point' | 'pose';
  /** What to do, for those who draw. */
  readonly prompt: string;
  /** Corners in order. A point is one; a pose is two: the place, and a point in the direction of the heading. */
  readonly onDone: (outline: Point[]) => void;
}

/** Corners nearer than this are one, metres. */
const SAME_M = 0.05;

const near = (a: Point, b: Point): boolean => Math.hypot(a[0] - b[0], a[1] - b[1]) < SAME_M;
const round = (n: number): number => Math.round(n * 100) / 100;

export function rectangle(a: Point, b: Point): Point[] {
  const [x0, x1] = [Math.min(a[0], b[0]), Math.max(a[0], b[0])].map(round) as [number, number];
  const [y0, y1] = [Math.min(a[1], b[1]), Math.max(a[1], b[1])].map(round) as [number, number];
  return [
    [x0, y0],
    [x1, y0],
    [x1, y1],
    [x0, y1],
  ];
}

/** The heading from one point to another, radians, anticlockwise from the x axis. */
export const headingOf = (from: Point, to: Point): number => Math.atan2(to[1] - from[1], to[0] - from[0]);

/** The upright rectangle around an outline: x0, y0, x1, y1. */
export function around(outline: readonly Point[]): [number, number, number, number] {
  const xs = outline.map((p) => p[0]);
  const ys = outline.map((p) => p[1]);
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

/** What another corner makes of a drawing: more corners, or the finished shape. */
export function corner(
  kind: Drawing['kind'],
  so: readonly Point[],
  at: Point,
): { kind: 'more'; corners: Point[] } | { kind: 'done'; outline: Point[] } {
  const [first] = so;
  if (kind === 'point') return { kind: 'done', outline: [[round(at[0]), round(at[1])]] };
  if (kind === 'rectangle') {
    if (!first) return { kind: 'more', corners: [at] };
    // A rectangle without area is a slip of the hand: begin again.
    const flat = Math.abs(first[0] - at[0]) < SAME_M || Math.abs(first[1] - at[1]) < SAME_M;
    return flat ? { kind: 'more', corners: [at] } : { kind: 'done', outline: rectangle(first, at) };
  }
  if (kind === 'pose') {
    // Without a direction there is no heading.
    if (!first || near(first, at)) return { kind: 'more', corners: [first ?? at] };
    return { kind: 'done', outline: [first, at].map(([x, y]) => [round(x), round(y)]) };
  }
  const last = so.at(-1);
  const closes = (first !== undefined && near(first, at)) || (last !== undefined && near(last, at));
  if (closes && so.length >= 3) return { kind: 'done', outline: so.map((p) => [round(p[0]), round(p[1])]) };
  return { kind: 'more', corners: closes ? [...so] : [...so, at] };
}
