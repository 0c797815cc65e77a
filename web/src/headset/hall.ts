// The floor as the server sees it, as triangles: ground, closed areas, racks, robots, people. Pure.
import type { Vec2 } from './frame';
import { isInside } from './polygon';
import { Shapes, type Colour } from './shapes';
import { area, beside, box, column, edge, line, placeAt } from './solids';
import {
  activityOf,
  type Activity,
  type Closure,
  type FloorMap,
  type Footprint,
  type Mirror,
  type NodeKind,
  type Robot,
  type RobotKind,
  type Worker,
} from '../wire';

export interface HallInk {
  /** Around and above the floor, and in the distance. */
  sky: Colour;
  floor: Colour;
  edge: Colour;
  lane: Colour;
  /** Where racks stand and people do not walk. */
  blocked: Colour;
  closed: Colour;
  places: Partial<Record<NodeKind, Colour>>;
  frame: Colour;
  goods: readonly Colour[];
  states: Record<Activity, Colour>;
  nose: Colour;
  person: Colour;
  region: Colour;
}

/** A thing that moves, where it is now. */
export interface Mover {
  at: Vec2;
  heading: number;
}

/** Further away, nothing but the ground is drawn, and near by racks have shelves: metres. */
export const SEEN_M = 60;
const SHELVES_M = 22;
const LANE_M = 0.06;
/** Robots drive under what stands on shelves from this height on; a carried rack is lifted a little. */
const [DECK_M, RACK_M, LIFTED_M] = [0.36, 1.95, 0.06];
const SHELF_HEIGHTS = [DECK_M, 0.92, 1.46] as const;
const BOARD_M = 0.04;

const away = (a: Vec2, b: Vec2): number => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** What lies on the ground, in the order in which it is painted. */
export function ground(map: FloorMap, closures: readonly Closure[], ink: HallInk): Shapes {
  const shapes = new Shapes();
  const r = map.footprint_m / 2 + 0.05;
  const square = (x: number, y: number): Vec2[] => [
    [x - r, y - r],
    [x + r, y - r],
    [x + r, y + r],
    [x - r, y + r],
  ];
  for (const outline of map.walkable) area(shapes, outline, ink.floor);
  // Places where only robots go lie outside of what people can walk on.
  for (const n of map.nodes)
    if (!map.walkable.some((o) => isInside(o, [n.x, n.y]))) area(shapes, square(n.x, n.y), ink.floor);
  for (const outline of map.walkable) edge(shapes, outline, 0.05, ink.edge);
  for (const outline of map.obstacles) area(shapes, outline, ink.blocked);
  for (const n of map.nodes) {
    const place = ink.places[n.kind];
    if (place) area(shapes, square(n.x, n.y), place);
  }
  for (const lane of map.lanes) {
    const [a, b] = [map.nodes[lane.from], map.nodes[lane.to]];
    if (a && b) line(shapes, [a.x, a.y], [b.x, b.y], LANE_M, ink.lane);
  }
  for (const { outline, state } of closures) {
    if (state === 'announced') continue;
    const [red, green, blue] = ink.closed;
    area(shapes, outline, [red, green, blue, 0.35]);
    edge(shapes, outline, 0.12, ink.closed);
  }
  return shapes;
}

/** A number of a name, so that each rack has goods of its own. */
const numberOf = (name: string): number =>
  [...name].reduce((sum, letter) => (sum * 31 + letter.charCodeAt(0)) % 9973, 7);

function rack(
  shapes: Shapes,
  id: string,
  { at, heading }: Mover,
  half: number,
  lift: number,
  near: boolean,
  ink: HallInk,
): void {
  const part = (along: number, left: number, l: number, w: number, from: number, to: number, colour: Colour): void =>
    box(
      shapes,
      { at: beside(at, heading, along, left), heading, half: [l, w], from: from + lift, to: to + lift },
      colour,
    );
  const seed = numberOf(id);
  const goods = (i: number): Colour => ink.goods[(seed + i) % ink.goods.length] ?? ink.frame;
  if (!near) return part(0, 0, half, half, DECK_M, RACK_M, goods(0));
  for (const side of [-1, 1])
    for (const end of [-1, 1]) part(end * (half - 0.03), side * (half - 0.03), 0.03, 0.03, 0, RACK_M, ink.frame);
  SHELF_HEIGHTS.forEach((height, i) => {
    part(0, 0, half, half, height - BOARD_M, height, ink.frame);
    // One wide carton, or two; not all are full.
    const tall = 0.28 + 0.05 * ((seed >> i) % 4);
    if ((seed + i) % 3 === 0) part(0, 0, half - 0.1, half - 0.1, height, height + tall, goods(i));
    else
      for (const end of [-1, 1])
        part(end * half * 0.48, 0, half * 0.4, half - 0.1, height, height + tall + 0.04 * end, goods(i + end));
  });
  part(0, 0, half, half, RACK_M - BOARD_M, RACK_M, ink.frame);
}

/** Racks that stand, as far as somebody at `from` sees them. */
export function racks(map: FloorMap, mirror: Mirror, from: Vec2, ink: HallInk): Shapes {
  const shapes = new Shapes();
  for (const { id, node, robot } of mirror.racks.rows) {
    const place = node === null || robot !== null ? undefined : map.nodes[node];
    if (!place) continue;
    const at: Vec2 = [place.x, place.y];
    const far = away(at, from);
    if (far < SEEN_M) rack(shapes, id, { at, heading: 0 }, map.footprint_m / 2 - 0.03, 0, far < SHELVES_M, ink);
  }
  return shapes;
}

/** Half the length and width of what a kind of robot covers. */
export function halfOf(footprint: Footprint | null | undefined, usual: number): Vec2 {
  if (!footprint) return [usual / 2, usual / 2];
  if ('square_m' in footprint) return [footprint.square_m / 2, footprint.square_m / 2];
  if ('circle_m' in footprint) return [footprint.circle_m, footprint.circle_m];
  const most = (i: 0 | 1): number => Math.max(...footprint.polygon_m.map((p) => Math.abs(p[i])));
  return [most(0), most(1)];
}

/** A robot, with the rack that it carries. */
export function robot(
  shapes: Shapes,
  it: Robot,
  mover: Mover,
  near: boolean,
  sizes: { kinds: readonly RobotKind[]; usual: number },
  ink: HallInk,
): void {
  const { at, heading } = mover;
  const [l, w] = halfOf(sizes.kinds.find((k) => k.name === it.kind)?.footprint, sizes.usual).map(
    (half) => half * 0.92,
  ) as [number, number];
  const colour = ink.states[activityOf(it)];
  box(shapes, { at, heading, half: [l, w], from: 0.04, to: 0.27 }, colour);
  box(shapes, { at, heading, half: [l * 0.6, w * 0.6], from: 0.27, to: 0.31 }, ink.frame);
  // The nose says where it faces.
  const tip = (along: number, left: number) => placeAt(beside(at, heading, along * l, left * w), 0.275);
  shapes.triangle(tip(0.95, 0), tip(0.66, 0.42), tip(0.66, -0.42), ink.nose);
  if (it.rack !== null) rack(shapes, it.rack, mover, sizes.usual / 2 - 0.03, LIFTED_M, near, ink);
}

/** A person, with the region in which robots stop. */
export function person(shapes: Shapes, it: Pick<Worker, 'regions'>, { at, heading }: Mover, ink: HallInk): void {
  const [stop] = it.regions;
  if (stop > 0) shapes.ring(placeAt(at, 0.01), stop - 0.04, stop, ink.region);
  for (const side of [-1, 1])
    column(shapes, beside(at, heading, 0, side * 0.1), { foot: 0.07, top: 0.09, from: 0, to: 0.82 }, ink.frame);
  column(shapes, at, { foot: 0.2, top: 0.24, from: 0.8, to: 1.42 }, ink.person);
  column(shapes, at, { foot: 0.07, top: 0.07, from: 1.42, to: 1.5 }, ink.nose);
  column(shapes, at, { foot: 0.12, top: 0.12, from: 1.5, to: 1.72 }, ink.nose);
  column(shapes, at, { foot: 0.14, top: 0.08, from: 1.66, to: 1.78 }, ink.person);
  // The peak of the helmet points ahead.
  box(shapes, { at: beside(at, heading, 0.16, 0), heading, half: [0.06, 0.08], from: 1.66, to: 1.69 }, ink.person);
}

/** What moves, as far as somebody at `from` sees it. */
export function movers(
  map: FloorMap,
  mirror: Mirror,
  where: (id: string) => Mover | undefined,
  from: Vec2,
  self: string,
  ink: HallInk,
): { shapes: Shapes; robots: number; people: number } {
  const shapes = new Shapes();
  const sizes = { kinds: map.kinds ?? [], usual: map.footprint_m };
  let [robots, people] = [0, 0];
  for (const it of mirror.robots.rows) {
    const mover = where(it.id);
    if (it.state === 'gone' || !mover) continue;
    const far = away(mover.at, from);
    if (far > SEEN_M) continue;
    robot(shapes, it, mover, far < SHELVES_M, sizes, ink);
    robots += 1;
  }
  for (const it of mirror.workers.rows) {
    const mover = where(it.id);
    if (it.id === self || it.presence === 'absent' || !mover || away(mover.at, from) > SEEN_M) continue;
    person(shapes, it, mover, ink);
    people += 1;
  }
  return { shapes, robots, people };
}
