// What is where: from a point on the floor to the thing there, and from a thing to its point.
import type { FloorMap, Mirror, Point } from '../../wire';
import type { Picked } from './picked';
import { personNear } from './people';
import { robotNear, type Scene } from './scene';
import { inSight, type View } from './view';

/** The thing at a point: people before robots, what moves before what stands, small before large. */
export function thingAt(
  map: FloorMap,
  mirror: Mirror | null,
  scene: Scene,
  x: number,
  y: number,
  pixel: number,
): Picked | null {
  const reach = Math.max(0.6, 12 * pixel);
  const person = scene.people[personNear(scene.people, x, y, reach)];
  if (person) return { kind: 'worker', id: person.id };
  const robot = robotNear(scene, x, y, reach);
  if (robot >= 0) return { kind: 'robot', id: scene.ids[robot]! };
  const near = nodeNear(map, x, y, Math.max(0.55, 8 * pixel));
  const node = map.nodes[near];
  if (node) {
    for (let i = 0; i < scene.racks; i++) {
      if (scene.rackOn[i]! < 0 && scene.rackX[i] === Math.fround(node.x) && scene.rackY[i] === Math.fround(node.y)) {
        return { kind: 'rack', id: scene.rackIds[i]! };
      }
    }
    const station = map.stations.find((s) => s.node === near || s.queue.includes(near));
    if (station) return { kind: 'station', id: station.id };
    if (node.kind !== 'aisle') return { kind: 'place', id: node.id };
  }
  const closure = mirror?.closures.find(({ outline }) => isInside(outline, x, y));
  return closure ? { kind: 'closure', id: closure.id } : null;
}

/** Where a thing is shown, if it is on the floor. */
export function placeOf(map: FloorMap, mirror: Mirror | null, scene: Scene, { kind, id }: Picked): Point | null {
  const nodeAt = (i: number | undefined): Point | null => {
    const node = i === undefined ? undefined : map.nodes[i];
    return node ? [node.x, node.y] : null;
  };
  const inScene = (i: number, xs: Float32Array, ys: Float32Array): Point | null =>
    i < 0 || Number.isNaN(xs[i]!) ? null : [xs[i]!, ys[i]!];
  switch (kind) {
    case 'robot':
      return inScene(scene.ids.indexOf(id), scene.x, scene.y);
    case 'rack':
      return inScene(scene.rackIds.indexOf(id), scene.rackX, scene.rackY);
    case 'station':
      return nodeAt(map.stations.find((s) => s.id === id)?.node);
    case 'place':
      return nodeAt(map.nodes.findIndex((n) => n.id === id));
    case 'worker': {
      const person = scene.people.find((p) => p.id === id);
      return person ? [person.x, person.y] : null;
    }
    case 'closure': {
      const outline = mirror?.closures.find((c) => c.id === id)?.outline ?? [];
      const mean = (k: 0 | 1): number => outline.reduce((sum, p) => sum + p[k], 0) / outline.length;
      return outline.length === 0 ? null : [mean(0), mean(1)];
    }
  }
}

/** The next thing in sight after `from`, or the one before it: people, stations, robots, in their order. */
export function thingBeside(map: FloorMap, scene: Scene, view: View, from: Picked | null, step: 1 | -1): Picked | null {
  const seen = (x: number, y: number): boolean => inSight(view, x, y);
  const all: Picked[] = [];
  for (const p of scene.people) if (seen(p.x, p.y)) all.push({ kind: 'worker', id: p.id });
  for (const { id, node } of map.stations) {
    const at = map.nodes[node];
    if (at && seen(at.x, at.y)) all.push({ kind: 'station', id });
  }
  for (let i = 0; i < scene.robots; i++)
    if (seen(scene.x[i]!, scene.y[i]!)) all.push({ kind: 'robot', id: scene.ids[i]! });
  if (all.length === 0) return null;
  const at = all.findIndex((one) => one.kind === from?.kind && one.id === from.id);
  return all[at < 0 ? (step > 0 ? 0 : all.length - 1) : (at + step + all.length) % all.length] ?? null;
}

function nodeNear(map: FloorMap, x: number, y: number, reach: number): number {
  let best = -1;
  let least = reach * reach;
  for (let i = 0; i < map.nodes.length; i++) {
    const n = map.nodes[i]!;
    const far = (n.x - x) ** 2 + (n.y - y) ** 2;
    if (far < least) {
      best = i;
      least = far;
    }
  }
  return best;
}

/** By how often a line to the right crosses the outline. */
export function isInside(outline: readonly Point[], x: number, y: number): boolean {
  let inside = false;
  outline.forEach(([ax, ay], i) => {
    const [bx, by] = outline[(i + 1) % outline.length]!;
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
  });
  return inside;
}
