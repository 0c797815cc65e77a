// What of a map is drawn as pixels: lanes and places, thousands in a large hall. They are put in order once for each
// map, and painted as far as they are in sight.
import { kindsOf, type Kind, type MapFile } from './file';
import type { Sight } from './view';

/** Who drives or walks a lane, as far as it is drawn differently. */
type LaneLook = 'road' | 'under' | 'foot';
type PlaceLook = Kind | 'rack';

/** The ends of lanes, x and y of one and then of the other. */
export interface Plan {
  readonly lanes: Readonly<Record<LaneLook, Float64Array>>;
  /** Lanes with one direction, from which to which. */
  readonly arrows: Float64Array;
  /** x and y of each place. */
  readonly places: ReadonlyMap<PlaceLook, Float64Array>;
}

const isUnder = (users: readonly string[] | undefined): boolean =>
  users !== undefined && !users.includes('loaded') && users.includes('unloaded');
const isFoot = (users: readonly string[] | undefined): boolean =>
  users !== undefined && users.length === 1 && users[0] === 'people';

export function planOf(map: MapFile, kinds = kindsOf(map)): Plan {
  const at = new Map(map.nodes.map((n) => [n.id, n]));
  const lanes: Record<LaneLook, number[]> = { road: [], under: [], foot: [] };
  const arrows: number[] = [];
  for (const lane of map.lanes) {
    const [a, b] = [at.get(lane.from), at.get(lane.to)];
    if (!a || !b) continue;
    lanes[isUnder(lane.for) ? 'under' : isFoot(lane.for) ? 'foot' : 'road'].push(a.x, a.y, b.x, b.y);
    if (!lane.both) arrows.push(a.x, a.y, b.x, b.y);
  }
  const racks = new Set(map.racks.map((r) => r.node));
  const places = new Map<PlaceLook, number[]>();
  for (const node of map.nodes) {
    const look = racks.has(node.id) ? 'rack' : kinds.get(node.id)!;
    const list = places.get(look);
    if (list) list.push(node.x, node.y);
    else places.set(look, [node.x, node.y]);
  }
  const packed = (list: number[]): Float64Array => Float64Array.from(list);
  return {
    lanes: { road: packed(lanes.road), under: packed(lanes.under), foot: packed(lanes.foot) },
    arrows: packed(arrows),
    places: new Map([...places].map(([look, list]) => [look, packed(list)])),
  };
}

/** The colours, by the names of their variables without `--map-`. */
export type Inks = (name: string) => string;

/** How a place looks: its filling, its edge. */
const PLACES: Record<PlaceLook, readonly [fill: string, edge: string | null]> = {
  aisle: ['parking', null],
  storage: ['slot', 'rack-edge'],
  rack: ['rack', 'rack-edge'],
  station: ['station', null],
  queue: ['floor', 'queue'],
  charger: ['charger', null],
  parking: ['floor', 'parking'],
  exit: ['exit', null],
};

/** Paints what is in sight. One unit of the canvas is a pixel; `size` is the side of a place, metres. */
export function paint(
  ink: CanvasRenderingContext2D,
  plan: Plan,
  sight: Sight,
  width: number,
  size: number,
  inks: Inks,
): void {
  const scale = width / sight.w;
  const [x0, x1, y0, y1] = [sight.x - size, sight.x + sight.w + size, -sight.y - sight.h - size, -sight.y + size];
  const [px, py] = [(x: number): number => (x - sight.x) * scale, (y: number): number => (-y - sight.y) * scale];
  /** Calls with the ends of each segment that may be in sight, in pixels. */
  const segments = (list: Float64Array, draw: (ax: number, ay: number, bx: number, by: number) => void): void => {
    for (let i = 0; i < list.length; i += 4) {
      const [ax, ay, bx, by] = [list[i]!, list[i + 1]!, list[i + 2]!, list[i + 3]!];
      if ((ax < x0 && bx < x0) || (ax > x1 && bx > x1) || (ay < y0 && by < y0) || (ay > y1 && by > y1)) continue;
      draw(px(ax), py(ay), px(bx), py(by));
    }
  };
  const lines = (look: LaneLook, colour: string, metres: number, least: number, dash: readonly number[]): void => {
    if (plan.lanes[look].length === 0) return;
    ink.beginPath();
    segments(plan.lanes[look], (ax, ay, bx, by) => {
      ink.moveTo(ax, ay);
      ink.lineTo(bx, by);
    });
    ink.strokeStyle = inks(colour);
    ink.lineWidth = Math.max(size * metres * scale, least);
    // Dashes shorter than a pixel or two are a line, and take long to paint.
    ink.setLineDash((dash[0] ?? 0) * scale < 1.5 ? [] : dash.map((d) => d * scale));
    ink.stroke();
  };
  ink.lineCap = 'round';
  lines('road', 'parking', 0.09, 1, []);
  ink.lineCap = 'butt';
  lines('under', 'rack-edge', 0.05, 0.8, [0.12, 0.12]);
  lines('foot', 'exit', 0.05, 0.8, [0.06, 0.14]);
  ink.setLineDash([]);
  if (size * scale > 5) arrowheads(ink, plan, segments, size * scale, inks);
  for (const [look, list] of plan.places) {
    const [fill, edge] = PLACES[look];
    const half = size * (look === 'aisle' ? 0.1 : 0.42) * scale;
    // Open floor is where lanes meet: from afar these are enough.
    if (look === 'aisle' && half < 0.7) continue;
    ink.beginPath();
    for (let i = 0; i < list.length; i += 2) {
      const [x, y] = [list[i]!, list[i + 1]!];
      if (x < x0 || x > x1 || y < y0 || y > y1) continue;
      if (look === 'aisle' && half > 1.5) {
        ink.moveTo(px(x) + half, py(y));
        ink.arc(px(x), py(y), half, 0, 2 * Math.PI);
      } else ink.rect(px(x) - half, py(y) - half, 2 * half, 2 * half);
    }
    ink.fillStyle = inks(fill);
    ink.fill();
    if (edge === null || size * scale < 4) continue;
    ink.strokeStyle = inks(edge);
    ink.lineWidth = size * 0.05 * scale;
    ink.stroke();
  }
}

/** A head in the middle of each lane that has one direction. */
function arrowheads(
  ink: CanvasRenderingContext2D,
  plan: Plan,
  segments: (list: Float64Array, draw: (ax: number, ay: number, bx: number, by: number) => void) => void,
  side: number,
  inks: Inks,
): void {
  ink.beginPath();
  segments(plan.arrows, (ax, ay, bx, by) => {
    const length = Math.hypot(bx - ax, by - ay) || 1;
    const [ux, uy] = [((bx - ax) / length) * side * 0.11, ((by - ay) / length) * side * 0.11];
    const [mx, my] = [(ax + bx) / 2, (ay + by) / 2];
    ink.moveTo(mx - ux - uy, my - uy + ux);
    ink.lineTo(mx + ux, my + uy);
    ink.lineTo(mx - ux + uy, my - uy - ux);
  });
  ink.strokeStyle = inks('label');
  ink.lineWidth = Math.max(side * 0.08, 1);
  ink.lineJoin = 'round';
  ink.stroke();
}
