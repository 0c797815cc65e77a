// Outlines of the map: whether a point lies inside, the triangles of one, and where a person can stand. Pure.
import type { Vec2 } from './frame';
import type { FloorMap, Point } from '../wire';

type Outline = readonly (Vec2 | Point)[];

export function isInside(outline: Outline, [x, y]: Vec2): boolean {
  let inside = false;
  outline.forEach((a, i) => {
    const b = outline[(i + 1) % outline.length]!;
    if (a[1] > y !== b[1] > y && x < a[0] + ((y - a[1]) * (b[0] - a[0])) / (b[1] - a[1])) inside = !inside;
  });
  return inside;
}

const cross = (a: Vec2 | Point, b: Vec2 | Point, c: Vec2 | Point): number =>
  (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

/** An outline as triangles, by cutting ears; one that crosses itself gives up where there is no ear left. */
export function triangles(outline: Outline): [Vec2, Vec2, Vec2][] {
  const area = outline.reduce((sum, a, i) => sum + cross([0, 0], a, outline[(i + 1) % outline.length]!), 0);
  const left: Vec2[] = outline.map((p) => [p[0], p[1]]);
  if (area < 0) left.reverse();
  const found: [Vec2, Vec2, Vec2][] = [];
  while (left.length > 3) {
    const n = left.length;
    const ear = left.findIndex((b, i) => {
      const [a, c] = [left[(i + n - 1) % n]!, left[(i + 1) % n]!];
      if (cross(a, b, c) <= 0) return false;
      return left.every(
        (p) => p === a || p === b || p === c || cross(a, b, p) < 0 || cross(b, c, p) < 0 || cross(c, a, p) < 0,
      );
    });
    if (ear < 0) return found;
    found.push([left[(ear + n - 1) % n]!, left[ear]!, left[(ear + 1) % n]!]);
    left.splice(ear, 1);
  }
  if (left.length === 3) found.push([left[0]!, left[1]!, left[2]!]);
  return found;
}

/** Half the width of a person, metres. */
const BODY_M = 0.2;
const AROUND: readonly Vec2[] = [
  [0, 0],
  ...Array.from({ length: 8 }, (_, i): Vec2 => [
    BODY_M * Math.cos((i * Math.PI) / 4),
    BODY_M * Math.sin((i * Math.PI) / 4),
  ]),
];

/** Whether a person has room there: on the floor, clear of what stands on it. Racks that robots carry are no
 *  obstacle. */
export function canStand(map: Pick<FloorMap, 'walkable' | 'obstacles' | 'bounds'>, [x, y]: Vec2): boolean {
  const [x0, y0, x1, y1] = map.bounds;
  return AROUND.every(([dx, dy]) => {
    const p: Vec2 = [x + dx, y + dy];
    if (
      map.walkable.length === 0
        ? p[0] < x0 || p[0] > x1 || p[1] < y0 || p[1] > y1
        : !map.walkable.some((o) => isInside(o, p))
    )
      return false;
    return !map.obstacles.some((o) => isInside(o, p));
  });
}
