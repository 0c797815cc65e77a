// Where things are: the device's frame (WebXR: metres, x right, y up, z backwards), its floor plan
// a = (x, -z), and the map. Quaternions are (x, y, z, w). Pure.
export type Vec2 = readonly [x: number, y: number];
export type Vec3 = readonly [x: number, y: number, z: number];
export type Quat = readonly [x: number, y: number, z: number, w: number];

/** Where the device's frame lies in the map: map point = R(theta) a + shift. */
export interface Alignment {
  theta: number;
  shift: Vec2;
}

export const planOf = (p: Vec3): Vec2 => [p[0], -p[2]];

export function toMap(a: Alignment, p: Vec3): Vec2 {
  const [x, y] = planOf(p);
  const [c, s] = [Math.cos(a.theta), Math.sin(a.theta)];
  return [c * x - s * y + a.shift[0], s * x + c * y + a.shift[1]];
}

/** A point of the map in the device's frame, at a height. */
export function toDevice(a: Alignment, p: Vec2, height: number): Vec3 {
  const [x, y] = [p[0] - a.shift[0], p[1] - a.shift[1]];
  const [c, s] = [Math.cos(a.theta), Math.sin(a.theta)];
  return [c * x + s * y, height, -(c * y - s * x)];
}

export function rotate(q: Quat, v: Vec3): Vec3 {
  const [x, y, z, w] = q;
  const t: Vec3 = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
  return [
    v[0] + w * t[0] + y * t[2] - z * t[1],
    v[1] + w * t[1] + z * t[0] - x * t[2],
    v[2] + w * t[2] + x * t[1] - y * t[0],
  ];
}

export const distance = (a: Vec2, b: Vec2): number => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** Below this slope a ray does not point at the floor, but ahead. */
const POINTS_DOWN = -0.25;
/** Nobody points at a mark further away than this: the error would be too large. Metres. */
const REACH_M = 3;

/** Where a ray meets the floor, if it points there and not too far away. */
export function floorHit(origin: Vec3, direction: Vec3, floor: number): Vec3 | null {
  if (direction[1] > POINTS_DOWN * Math.hypot(...direction)) return null;
  const t = (floor - origin[1]) / direction[1];
  const hit: Vec3 = [origin[0] + t * direction[0], floor, origin[2] + t * direction[2]];
  const near = Math.hypot(hit[0] - origin[0], hit[2] - origin[2]) <= REACH_M;
  return t > 0 && near ? hit : null;
}
