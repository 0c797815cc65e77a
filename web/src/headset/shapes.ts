// What is drawn into the room, as coloured triangles in the device's frame: the path on the floor, the next point,
// robots nearby, the mark that is due; and, before the eyes, the arrow and the full-view STOP. Pure.
import type { Aim } from './arrow';
import { toDevice, type Alignment, type Vec2, type Vec3 } from './frame';
import type { NearRobot, Shown } from './guide';
import type { Point } from '../wire';

export type Colour = readonly [r: number, g: number, b: number, a: number];
export interface Ink {
  path: Colour;
  chevron: Colour;
  next: Colour;
  robot: Colour;
  close: Colour;
  mark: Colour;
  stop: Colour;
  /** What the narrow view masks. */
  outside: Colour;
}

/** Numbers of one corner: x, y, z, red, green, blue, alpha. */
export const STRIDE = 7;
/** Above the floor, so that the two do not flicker; metres. */
const LIFT_M = 0.012;
const RIBBON_M = 0.26;
/** The height of the post at the next point, which is what the wearer looks for. */
export const POST_M = 1.2;
const CHEVRON_EVERY_M = 0.9;
const ROBOT_RING_M = 0.7;
const MARK_RING_M = 0.16;
/** A robot this close is drawn in the colour of alarm: metres. */
const CLOSE_M = 2;
/** The path begins at the next point; up to so far from it, it is drawn from the feet: metres. */
const FEET_M = 2.5;
const ROUND = 28;
/** How large the arrow at the edge of a small view is, by half the height of that view. */
const ARROW_SHARE = 3;

export class Shapes {
  #numbers: number[] = [];

  get corners(): Float32Array {
    return new Float32Array(this.#numbers);
  }
  get isEmpty(): boolean {
    return this.#numbers.length === 0;
  }

  triangle(a: Vec3, b: Vec3, c: Vec3, ink: Colour): void {
    this.#numbers.push(...a, ...ink, ...b, ...ink, ...c, ...ink);
  }
  quad(a: Vec3, b: Vec3, c: Vec3, d: Vec3, ink: Colour): void {
    this.triangle(a, b, c, ink);
    this.triangle(a, c, d, ink);
  }

  /** A ring on the floor. */
  ring(at: Vec3, inner: number, outer: number, ink: Colour): void {
    const on = (i: number, r: number): Vec3 => {
      const angle = (2 * Math.PI * i) / ROUND;
      return [at[0] + r * Math.cos(angle), at[1], at[2] + r * Math.sin(angle)];
    };
    for (let i = 0; i < ROUND; i += 1) this.quad(on(i, inner), on(i, outer), on(i + 1, outer), on(i + 1, inner), ink);
  }

  /** A post with a diamond on top, seen from everywhere. */
  post(foot: Vec3, height: number, ink: Colour): void {
    const [x, y, z] = foot;
    const [thin, wide, top] = [0.012, 0.09, y + height];
    for (const [dx, dz] of [
      [1, 0],
      [0, 1],
    ] as const) {
      const side = (w: number, h: number): Vec3 => [x + w * dx, h, z + w * dz];
      this.quad(side(-thin, y), side(thin, y), side(thin, top), side(-thin, top), ink);
      this.quad(side(-wide, top), side(0, top - wide * 1.4), side(wide, top), side(0, top + wide * 1.4), ink);
    }
  }
}

/** The path as a ribbon with chevrons that point ahead. */
export function ribbon(shapes: Shapes, path: readonly Vec3[], ink: Pick<Ink, 'path' | 'chevron'>): void {
  let walked = CHEVRON_EVERY_M / 2;
  for (const [i, b] of path.slice(1).entries()) {
    const a = path[i]!;
    const [dx, dz] = [b[0] - a[0], b[2] - a[2]];
    const length = Math.hypot(dx, dz);
    if (length < 1e-3) continue;
    const [ux, uz] = [dx / length, dz / length];
    const h = RIBBON_M / 2;
    const at = (along: number, across: number, lift = 0): Vec3 => [
      a[0] + ux * along - uz * across,
      a[1] + ((b[1] - a[1]) * along) / length + lift,
      a[2] + uz * along + ux * across,
    ];
    // Each piece reaches half a width over its end, so that corners are closed.
    const end = i + 2 < path.length ? length + h : length;
    shapes.quad(at(i === 0 ? 0 : -h, -h), at(end, -h), at(end, h), at(i === 0 ? 0 : -h, h), ink.path);
    for (; walked < length; walked += CHEVRON_EVERY_M) {
      const [tip, back, wing, lift] = [walked + 0.1, walked - 0.04, h * 0.7, 0.004];
      shapes.quad(
        at(tip, 0, lift),
        at(back, wing, lift),
        at(back - 0.07, wing, lift),
        at(tip - 0.07, 0, lift),
        ink.chevron,
      );
      shapes.quad(
        at(tip, 0, lift),
        at(back, -wing, lift),
        at(back - 0.07, -wing, lift),
        at(tip - 0.07, 0, lift),
        ink.chevron,
      );
    }
    walked -= length;
  }
}

/** Where a robot nearby is on the map, as seen by somebody at `from`. */
export const robotAt = (from: Vec2, robot: NearRobot): Vec2 => [
  from[0] + robot.distance * Math.cos(robot.bearing_map),
  from[1] + robot.distance * Math.sin(robot.bearing_map),
];

/** The path from the wearer's feet on. Far from it no line is drawn to it, which could lead through a rack. */
export function fromFeet(shown: Shown, from: Vec2): readonly (Point | Vec2)[] {
  const first = shown.path[0];
  const near = first !== undefined && Math.hypot(first[0] - from[0], first[1] - from[1]) < FEET_M;
  return near && shown.kind !== 'deviating' ? [from, ...shown.path] : shown.path;
}

/** Path, next point and robots, in the room. */
export function room(shown: Shown, alignment: Alignment, floor: number, from: Vec2, ink: Ink): Shapes {
  const shapes = new Shapes();
  const place = (p: Point | Vec2): Vec3 => toDevice(alignment, p, floor + LIFT_M);
  ribbon(shapes, fromFeet(shown, from).map(place), ink);
  if (shown.next) {
    const next = place(shown.next);
    shapes.ring(next, 0.17, 0.24, ink.next);
    shapes.post(next, POST_M, ink.next);
  }
  for (const robot of shown.near) {
    const at = place(robotAt(from, robot));
    const colour = robot.distance < CLOSE_M ? ink.close : ink.robot;
    shapes.ring(at, ROBOT_RING_M - 0.09, ROBOT_RING_M, colour);
    shapes.post(at, 1, colour);
  }
  return shapes;
}

/** The mark that a confirmation now would take. */
export function reticle(at: Vec3, ink: Ink): Shapes {
  const shapes = new Shapes();
  const up: Vec3 = [at[0], at[1] + LIFT_M, at[2]];
  shapes.ring(up, MARK_RING_M - 0.03, MARK_RING_M, ink.mark);
  shapes.ring(up, 0, 0.02, ink.mark);
  return shapes;
}

/** Before the eyes, one metre away in the viewer's own frame: the arrow, and STOP over everything. */
export function eyes(shown: Shown, target: Aim | null, half: Vec2, ink: Ink): Shapes {
  const shapes = new Shapes();
  if (shown.kind === 'stop') shapes.quad([-9, -9, -1], [9, -9, -1], [9, 9, -1], [-9, 9, -1], ink.stop);
  if (target?.kind !== 'off view' || shown.kind === 'stop') return shapes;
  const [x, y] = [target.x * half[0], target.y * half[1]];
  // In a narrow view it is smaller, so that all of it is seen.
  const size = Math.min(1, ARROW_SHARE * half[1]);
  const [c, s] = [size * Math.cos(target.angle), size * Math.sin(target.angle)];
  const at = (along: number, across: number): Vec3 => [x + c * along - s * across, y + s * along + c * across, -1];
  shapes.triangle(at(0.09, 0), at(-0.04, 0.07), at(-0.04, -0.07), ink.next);
  shapes.quad(at(-0.04, 0.025), at(-0.12, 0.025), at(-0.12, -0.025), at(-0.04, -0.025), ink.next);
  return shapes;
}
