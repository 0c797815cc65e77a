// Draws what does not move (floor, walls, lanes, places) into any 2D context. It is slow on purpose: it
// runs once per view that comes to rest, and the result is kept as a picture.
import type { Closure, FloorMap, Point } from '../../wire';
import type { Palette } from './palette';
import { toScreen, type View } from '../scene/view';

type Ink = CanvasRenderingContext2D;

const HATCH_PX = 8;

export function drawGround(ink: Ink, map: FloorMap, closures: readonly Closure[], view: View, palette: Palette): void {
  const c = palette.of;
  ink.fillStyle = c.void;
  ink.fillRect(0, 0, view.width, view.height);
  const [x0, y0, x1, y1] = map.bounds;
  const floors: Point[][] =
    map.walkable.length > 0
      ? map.walkable
      : [
          [
            [x0, y0],
            [x1, y0],
            [x1, y1],
            [x0, y1],
          ],
        ];
  fillShapes(ink, floors, view, c.floor, c.edge);
  fillShapes(ink, map.obstacles, view, c.wall, c.edge);
  drawLanes(ink, map, view, palette);
  drawPlaces(ink, map, view, palette);
  drawClosures(ink, closures, view, palette);
  drawStations(ink, map, view, palette);
}

function fillShapes(ink: Ink, shapes: Point[][], view: View, fill: string, edge: string): void {
  trace(ink, shapes, view);
  ink.fillStyle = fill;
  ink.fill();
  ink.strokeStyle = edge;
  ink.lineWidth = 1;
  ink.stroke();
}

function trace(ink: Ink, shapes: Point[][], view: View): void {
  ink.beginPath();
  for (const shape of shapes) {
    shape.forEach(([x, y], i) => {
      const [px, py] = toScreen(view, x, y);
      if (i === 0) ink.moveTo(px, py);
      else ink.lineTo(px, py);
    });
    ink.closePath();
  }
}

/** Where robots will have to keep out: an outline in dashes. From when on is written above everything (compose.ts). */
function drawAnnounced(ink: Ink, { outline }: Closure, view: View, palette: Palette): void {
  ink.save();
  trace(ink, [outline], view);
  ink.strokeStyle = ink.fillStyle = palette.of.closed;
  ink.globalAlpha = 0.05;
  ink.fill();
  ink.globalAlpha = 1;
  ink.lineWidth = 2;
  ink.setLineDash([7, 5]);
  ink.stroke();
  ink.restore();
}

/** Areas that robots keep out of: hatched, so that what lies below stays readable. */
function drawClosures(ink: Ink, closures: readonly Closure[], view: View, palette: Palette): void {
  for (const closure of closures) {
    const { outline } = closure;
    if (closure.state === 'announced') {
      drawAnnounced(ink, closure, view, palette);
      continue;
    }
    ink.save();
    trace(ink, [outline], view);
    ink.strokeStyle = ink.fillStyle = palette.of.closed;
    ink.lineWidth = 2;
    ink.stroke();
    ink.globalAlpha = 0.12;
    ink.fill();
    ink.clip();
    const at = outline.map(([x, y]) => toScreen(view, x, y));
    const [xs, ys] = [at.map((p) => p[0]), at.map((p) => p[1])];
    const [left, right, top, foot] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    ink.beginPath();
    for (let x = left - (foot - top); x < right; x += HATCH_PX) {
      ink.moveTo(x, foot);
      ink.lineTo(x + foot - top, top);
    }
    ink.globalAlpha = 0.5;
    ink.lineWidth = 1;
    ink.stroke();
    ink.restore();
  }
}

function drawLanes(ink: Ink, map: FloorMap, view: View, palette: Palette): void {
  const forPeople = new Path2D();
  const forRobots = new Path2D();
  const arrows = new Path2D();
  for (const lane of map.lanes) {
    const a = map.nodes[lane.from];
    const b = map.nodes[lane.to];
    if (!a || !b) continue;
    const [ax, ay] = toScreen(view, a.x, a.y);
    const [bx, by] = toScreen(view, b.x, b.y);
    const onlyPeople = lane.for.length === 1 && lane.for[0] === 'people';
    const path = onlyPeople ? forPeople : forRobots;
    path.moveTo(ax, ay);
    path.lineTo(bx, by);
    if (!lane.both && view.scale > 16) arrow(arrows, ax, ay, bx, by, view.scale * 0.13);
  }
  ink.strokeStyle = palette.of.lane;
  ink.lineWidth = Math.max(0.6, view.scale * 0.035);
  ink.stroke(forRobots);
  ink.lineWidth = Math.max(0.8, view.scale * 0.05);
  ink.stroke(arrows);
  ink.strokeStyle = palette.of.walkway;
  ink.setLineDash([view.scale * 0.14, view.scale * 0.14]);
  ink.stroke(forPeople);
  ink.setLineDash([]);
}

function arrow(path: Path2D, ax: number, ay: number, bx: number, by: number, size: number): void {
  const turn = Math.atan2(by - ay, bx - ax);
  const mx = (ax + bx) / 2;
  const my = (ay + by) / 2;
  for (const side of [2.5, -2.5]) {
    path.moveTo(mx, my);
    path.lineTo(mx + Math.cos(turn + side) * size, my + Math.sin(turn + side) * size);
  }
}

function drawPlaces(ink: Ink, map: FloorMap, view: View, palette: Palette): void {
  const c = palette.of;
  const s = view.scale;
  ink.lineWidth = Math.max(0.7, s * 0.04);
  for (const node of map.nodes) {
    const [px, py] = toScreen(view, node.x, node.y);
    if (px < -s || py < -s || px > view.width + s || py > view.height + s) continue;
    switch (node.kind) {
      case 'storage':
        box(ink, px, py, s * 0.43, s * 0.08, null, c.slot);
        break;
      case 'queue':
        disc(ink, px, py, s * 0.3, c.queue);
        break;
      case 'charger':
        box(ink, px, py, s * 0.4, s * 0.1, null, c.charger);
        bolt(ink, px, py, s * 0.3, c.charger);
        break;
      case 'parking':
        box(ink, px, py, s * 0.4, s * 0.1, null, c.parking);
        word(ink, 'P', px, py, s * 0.42, c.parking);
        break;
      case 'exit':
        box(ink, px, py, s * 0.4, s * 0.1, null, c.exit);
        word(ink, '⇥', px, py, s * 0.42, c.exit);
        break;
      case 'aisle':
        if (s > 12) box(ink, px, py, s * 0.035, 0, c.lane, null);
        break;
      case 'station':
        break;
    }
  }
}

function drawStations(ink: Ink, map: FloorMap, view: View, palette: Palette): void {
  const c = palette.of;
  const s = view.scale;
  for (const station of map.stations) {
    const at = map.nodes[station.node];
    if (!at) continue;
    const [px, py] = toScreen(view, at.x, at.y);
    box(ink, px, py, s * 0.62, s * 0.14, c.station, null);
    box(ink, px, py, s * 0.46, s * 0.08, c.floor, null);
    if (s > 14) {
      station.queue.forEach((node, i) => {
        const slot = map.nodes[node];
        if (!slot) return;
        const [qx, qy] = toScreen(view, slot.x, slot.y);
        word(ink, String(i + 1), qx, qy, s * 0.3, c.queue);
      });
    }
  }
}

function box(
  ink: Ink,
  x: number,
  y: number,
  half: number,
  round: number,
  fill: string | null,
  line: string | null,
): void {
  ink.beginPath();
  ink.roundRect(x - half, y - half, 2 * half, 2 * half, round);
  if (fill) {
    ink.fillStyle = fill;
    ink.fill();
  }
  if (line) {
    ink.strokeStyle = line;
    ink.stroke();
  }
}

function disc(ink: Ink, x: number, y: number, r: number, line: string): void {
  ink.beginPath();
  ink.arc(x, y, r, 0, 2 * Math.PI);
  ink.strokeStyle = line;
  ink.stroke();
}

function bolt(ink: Ink, x: number, y: number, r: number, fill: string): void {
  ink.beginPath();
  ink.moveTo(x + r * 0.25, y - r);
  ink.lineTo(x - r * 0.6, y + r * 0.15);
  ink.lineTo(x - r * 0.05, y + r * 0.15);
  ink.lineTo(x - r * 0.25, y + r);
  ink.lineTo(x + r * 0.6, y - r * 0.15);
  ink.lineTo(x + r * 0.05, y - r * 0.15);
  ink.closePath();
  ink.fillStyle = fill;
  ink.fill();
}

function word(ink: Ink, text: string, x: number, y: number, px: number, fill: string): void {
  if (px < 4) return;
  ink.font = `600 ${px}px system-ui, sans-serif`;
  ink.textAlign = 'center';
  ink.textBaseline = 'middle';
  ink.fillStyle = fill;
  ink.fillText(text, x, y);
}

export function label(ink: Ink, text: string, x: number, y: number, px: number, halo: string, fill: string): void {
  ink.font = `600 ${px}px system-ui, sans-serif`;
  ink.textAlign = 'center';
  ink.textBaseline = 'middle';
  ink.lineJoin = 'round';
  ink.lineWidth = 3;
  ink.strokeStyle = halo;
  ink.strokeText(text, x, y);
  ink.fillStyle = fill;
  ink.fillText(text, x, y);
}
