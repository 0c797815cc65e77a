// Solid things of the twin as coloured triangles: boxes, columns, areas of the floor. Light comes from above, so that
// edges can be seen. The frame is the map's with WebXR's axes: x, height, -y. Pure.
import type { Vec2, Vec3 } from './frame';
import { triangles } from './polygon';
import type { Colour, Shapes } from './shapes';
import type { Point } from '../wire';

export const placeAt = ([x, y]: Vec2 | Point, height: number): Vec3 => [x, height, -y];
/** What faces sideways is darker than what faces up. */
const [SIDE, END] = [0.8, 0.66];
const shade = ([r, g, b, a]: Colour, by: number): Colour => [r * by, g * by, b * by, a];

export interface Box {
  at: Vec2;
  heading: number;
  /** Half along the heading, and half across. */
  half: Vec2;
  /** From and to which height. */
  from: number;
  to: number;
}

/** The point of a thing that lies so far along and to the left of it. */
export const beside = (at: Vec2, heading: number, along: number, left: number): Vec2 => {
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  return [at[0] + c * along - s * left, at[1] + s * along + c * left];
};

/** A box without a bottom. */
export function box(shapes: Shapes, { at, heading, half: [l, w], from, to }: Box, ink: Colour): void {
  const corners = (
    [
      [l, w],
      [-l, w],
      [-l, -w],
      [l, -w],
    ] as const
  ).map(([a, b]) => beside(at, heading, a, b));
  corners.forEach((a, i) => {
    const b = corners[(i + 1) % 4]!;
    shapes.quad(
      placeAt(a, from),
      placeAt(b, from),
      placeAt(b, to),
      placeAt(a, to),
      shade(ink, i % 2 === 0 ? SIDE : END),
    );
  });
  const [p, q, r, s] = corners.map((c) => placeAt(c, to)) as [Vec3, Vec3, Vec3, Vec3];
  shapes.quad(p, q, r, s, ink);
}

/** A round column, narrower at the top where `top` is less than `foot`. */
export function column(
  shapes: Shapes,
  at: Vec2,
  { foot, top, from, to }: { foot: number; top: number; from: number; to: number },
  ink: Colour,
): void {
  const sides = 10;
  const on = (i: number, r: number, height: number): Vec3 => {
    const angle = (2 * Math.PI * i) / sides;
    return placeAt([at[0] + r * Math.cos(angle), at[1] + r * Math.sin(angle)], height);
  };
  for (let i = 0; i < sides; i += 1) {
    const lit = shade(ink, END + (1 - END) * Math.abs(Math.cos((Math.PI * i) / sides)));
    shapes.quad(on(i, foot, from), on(i + 1, foot, from), on(i + 1, top, to), on(i, top, to), lit);
    shapes.triangle(placeAt(at, to), on(i, top, to), on(i + 1, top, to), ink);
  }
}

/** An area of the floor. */
export function area(shapes: Shapes, outline: readonly (Vec2 | Point)[], ink: Colour): void {
  for (const [a, b, c] of triangles(outline)) shapes.triangle(placeAt(a, 0), placeAt(b, 0), placeAt(c, 0), ink);
}

/** A line on the floor. */
export function line(shapes: Shapes, a: Vec2 | Point, b: Vec2 | Point, width: number, ink: Colour): void {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  if (length === 0) return;
  const [x, y] = [((a[1] - b[1]) / length) * (width / 2), ((b[0] - a[0]) / length) * (width / 2)];
  shapes.quad(
    placeAt([a[0] + x, a[1] + y], 0),
    placeAt([b[0] + x, b[1] + y], 0),
    placeAt([b[0] - x, b[1] - y], 0),
    placeAt([a[0] - x, a[1] - y], 0),
    ink,
  );
}

/** A line along an outline. */
export const edge = (shapes: Shapes, outline: readonly (Vec2 | Point)[], width: number, ink: Colour): void =>
  outline.forEach((a, i) => line(shapes, a, outline[(i + 1) % outline.length]!, width, ink));
