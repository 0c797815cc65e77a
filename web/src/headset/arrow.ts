// The arrow to something outside the view: where at the edge it stands, and which way it points. Pure.
import type { Vec3 } from './frame';

export type Mat4 = ArrayLike<number>;

export type Aim =
  | { kind: 'in view'; x: number; y: number }
  /** `x` and `y` at the edge, -1 to 1 with y up; `angle` from the right, counter-clockwise, radians. */
  | { kind: 'off view'; x: number; y: number; angle: number };

/** Arrows keep this far from the edge of the view, as a share of its half. */
const EDGE = 0.72;
/** A point closer to the edge than this is hard to see. */
const SEEN = 0.92;

/** Where a point is in the view; matrices are column by column, as in WebGL. */
export function aim(point: Vec3, view: Mat4, projection: Mat4): Aim {
  const eye = apply(view, [...point, 1]);
  const clip = apply(projection, eye);
  const w = clip[3];
  if (w > 0) {
    const [x, y] = [clip[0] / w, clip[1] / w];
    if (Math.abs(x) <= SEEN && Math.abs(y) <= SEEN) return { kind: 'in view', x, y };
  }
  // In the eye's frame the direction across the view is true in front and behind; what is behind is shown to the
  // side that is the shorter turn, never above or below the head.
  const behind = eye[2] > 0;
  const [right, up] = behind ? [eye[0] === 0 ? 1 : eye[0], 0] : [eye[0], eye[1]];
  const angle = Math.atan2(up, right);
  const reach = EDGE / Math.max(Math.abs(Math.cos(angle)), Math.abs(Math.sin(angle)));
  return { kind: 'off view', x: reach * Math.cos(angle), y: reach * Math.sin(angle), angle };
}

type Vec4 = [number, number, number, number];

function apply(m: Mat4, v: readonly number[]): Vec4 {
  const row = (i: number): number => m[i]! * v[0]! + m[i + 4]! * v[1]! + m[i + 8]! * v[2]! + m[i + 12]! * v[3]!;
  return [row(0), row(1), row(2), row(3)];
}

export function multiply(a: Mat4, b: Mat4): Float32Array {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; c += 1) {
    for (let r = 0; r < 4; r += 1) {
      out[c * 4 + r] =
        a[r]! * b[c * 4]! + a[r + 4]! * b[c * 4 + 1]! + a[r + 8]! * b[c * 4 + 2]! + a[r + 12]! * b[c * 4 + 3]!;
    }
  }
  return out;
}
