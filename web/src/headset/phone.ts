// The map for a phone: the path, the next point, the wearer, robots nearby. Drawn when something changed.
import { distance, type Vec2 } from './frame';
import type { Shown } from './guide';
import { around, placed, type Box } from './labels';
import { fromFeet, robotAt } from './shapes';
import { metres } from './words';
import type { FloorMap, Point } from '../wire';

/** The wearer, as the server or the wearer says. */
export interface Self {
  at: Vec2;
  heading: number | null;
}

/** So much of the floor around the wearer is shown: metres. */
const AROUND_M = 7;
/** Robots closer than this are shown in another colour, metres. */
const CLOSE_M = 2;
/** The wearer's own mark, and how high a name is: pixels. */
const [SELF_PX, NAME_PX] = [12, 18] as const;

/** The part of the map that is shown, and how it lies on the canvas. */
export interface Lens {
  centre: Vec2;
  /** Pixels per metre. */
  scale: number;
}

/** Around the wearer with the path ahead; the whole floor while nobody knows where that is. */
export function lens(map: FloorMap, self: Self | null, width: number, height: number): Lens {
  const [x0, y0, x1, y1] = map.bounds;
  const whole = Math.min(width / (x1 - x0 + 1), height / (y1 - y0 + 1));
  if (!self) return { centre: [(x0 + x1) / 2, (y0 + y1) / 2], scale: whole };
  const scale = Math.max(whole, Math.min(width, height) / (2 * AROUND_M));
  const within = (v: number, low: number, high: number, half: number): number =>
    high - low <= 2 * half ? (low + high) / 2 : Math.min(high - half, Math.max(low + half, v));
  return {
    centre: [within(self.at[0], x0, x1, width / 2 / scale), within(self.at[1], y0, y1, height / 2 / scale)],
    scale,
  };
}

export const onCanvas = (l: Lens, p: Vec2 | Point, width: number, height: number): Vec2 => [
  width / 2 + (p[0] - l.centre[0]) * l.scale,
  height / 2 - (p[1] - l.centre[1]) * l.scale,
];
export const onMap = (l: Lens, p: Vec2, width: number, height: number): Vec2 => [
  l.centre[0] + (p[0] - width / 2) / l.scale,
  l.centre[1] - (p[1] - height / 2) / l.scale,
];

/** Which way to go from here, on the map: radians; none where there is no path. */
export function wayAhead(self: Vec2, shown: Shown): number | null {
  const ahead = [shown.next, ...shown.path].find((p) => p !== null && p !== undefined && distance(p, self) > 0.3);
  return ahead ? Math.atan2(ahead[1] - self[1], ahead[0] - self[0]) : null;
}

export function drawMap(
  canvas: HTMLCanvasElement,
  map: FloorMap,
  self: Self | null,
  shown: Shown,
  ink: (name: string) => string,
): Lens {
  const ratio = Math.min(3, devicePixelRatio || 1);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const l = lens(map, self, width, height);
  const c = canvas.getContext('2d');
  if (!c) return l;
  const at = (p: Vec2 | Point): Vec2 => onCanvas(l, p, width, height);
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.fillStyle = ink('map-void');
  c.fillRect(0, 0, width, height);
  ground(c, map, at, l.scale, ink);
  way(c, shown, self ? fromFeet(shown, self.at) : shown.path, at, ink);
  const named = (robot: Shown['near'][number], from: Vec2): Named => ({
    at: at(robotAt(from, robot)),
    text: `${robot.id} ${metres(robot.distance)}`,
    close: robot.distance < CLOSE_M,
  });
  const robots = self ? shown.near.map((robot) => named(robot, self.at)) : [];
  const radius = Math.max(10, 0.5 * l.scale);
  for (const robot of robots) ring(c, robot.at, radius, ink(robot.close ? 'map-stop' : 'map-granted'));
  if (self) selfMark(c, at(self.at), self.heading, wayAhead(self.at, shown), ink);
  const places = map.stations.flatMap(({ id, node }): Named[] => {
    const n = map.nodes[node];
    return n ? [{ at: at([n.x, n.y]), text: id, close: false }] : [];
  });
  names(c, robots, places, radius, self ? at(self.at) : null, ink);
  return l;
}

type Ink = (name: string) => string;
type At = (p: Vec2 | Point) => Vec2;

function ground(c: CanvasRenderingContext2D, map: FloorMap, at: At, scale: number, ink: Ink): void {
  const area = (outline: readonly Point[], fill: string): void => {
    c.beginPath();
    outline.forEach((p) => c.lineTo(...at(p)));
    c.closePath();
    c.fillStyle = fill;
    c.fill();
  };
  map.walkable.forEach((outline) => area(outline, ink('map-floor')));
  c.strokeStyle = ink('map-lane');
  c.lineWidth = 2;
  c.beginPath();
  for (const lane of map.lanes) {
    const [a, b] = [map.nodes[lane.from], map.nodes[lane.to]];
    if (a && b) {
      c.moveTo(...at([a.x, a.y]));
      c.lineTo(...at([b.x, b.y]));
    }
  }
  c.stroke();
  map.obstacles.forEach((outline) => area(outline, ink('map-wall')));
  for (const station of map.stations) {
    const node = map.nodes[station.node];
    if (!node) continue;
    const [x, y] = at([node.x, node.y]);
    c.fillStyle = ink('map-station');
    c.fillRect(x - 0.3 * scale, y - 0.3 * scale, 0.6 * scale, 0.6 * scale);
  }
}

function way(c: CanvasRenderingContext2D, shown: Shown, path: readonly (Point | Vec2)[], at: At, ink: Ink): void {
  if (path.length > 1) {
    c.beginPath();
    path.forEach((p) => c.lineTo(...at(p)));
    [c.lineJoin, c.lineCap, c.lineWidth, c.strokeStyle] = ['round', 'round', 9, ink('map-chosen')];
    c.stroke();
  }
  if (shown.next) {
    c.beginPath();
    c.arc(...at(shown.next), 9, 0, 7);
    [c.fillStyle, c.lineWidth, c.strokeStyle] = [ink('map-halo'), 4, ink('map-chosen')];
    c.fill();
    c.stroke();
  }
}

interface Named {
  at: Vec2;
  text: string;
  /** So close that it matters. */
  close: boolean;
}

function ring(c: CanvasRenderingContext2D, [x, y]: Vec2, radius: number, colour: string): void {
  c.beginPath();
  c.arc(x, y, radius, 0, 7);
  [c.lineWidth, c.strokeStyle] = [3, colour];
  c.stroke();
}

/** Names of robots, the nearest first, then of stations; a name that finds no room is left out. */
function names(
  c: CanvasRenderingContext2D,
  robots: readonly Named[],
  places: readonly Named[],
  radius: number,
  self: Vec2 | null,
  ink: Ink,
): void {
  c.font = '600 13px system-ui, sans-serif';
  [c.textAlign, c.textBaseline, c.lineWidth, c.strokeStyle, c.fillStyle] = [
    'center',
    'middle',
    4,
    ink('map-halo'),
    ink('map-label'),
  ];
  const wide = (text: string): number => c.measureText(text).width + 6;
  const square = ([x, y]: Vec2, half: number): Box => ({ x: x - half, y: y - half, width: 2 * half, height: 2 * half });
  const taken = self ? [square(self, SELF_PX)] : [];
  const all = [...robots, ...places];
  const wishes = all.map(({ at, text }, i): Box[] => {
    const width = wide(text);
    const middle: Box = { x: at[0] - width / 2, y: at[1] - NAME_PX / 2, width, height: NAME_PX };
    return i < robots.length
      ? around(at, radius + 2, width, NAME_PX)
      : [middle, ...around(at, NAME_PX, width, NAME_PX)];
  });
  placed(wishes, taken).forEach((box, i) => {
    const text = all[i]?.text ?? '';
    if (!box) return;
    c.strokeText(text, box.x + box.width / 2, box.y + box.height / 2);
    c.fillText(text, box.x + box.width / 2, box.y + box.height / 2);
  });
}

function selfMark(
  c: CanvasRenderingContext2D,
  [x, y]: Vec2,
  heading: number | null,
  way: number | null,
  ink: Ink,
): void {
  const wedge = (angle: number, from: number, to: number, half: number, fill: string): void => {
    c.save();
    c.translate(x, y);
    c.rotate(-angle);
    c.beginPath();
    c.moveTo(to, 0);
    c.lineTo(from, half);
    c.lineTo(from, -half);
    c.closePath();
    c.fillStyle = fill;
    c.fill();
    c.restore();
  };
  if (way !== null) wedge(way, 24, 42, 12, ink('map-chosen'));
  if (heading !== null) wedge(heading, 8, 22, 9, ink('map-person'));
  c.beginPath();
  c.arc(x, y, SELF_PX, 0, 7);
  [c.fillStyle, c.lineWidth, c.strokeStyle] = [ink('map-person'), 3, ink('map-halo')];
  c.fill();
  c.stroke();
}
