// What the tools do to a map file: each takes one and gives another, so that undoing is going back to the one before.
import {
  kindsOf,
  type Corner,
  type FileCell,
  type FileLane,
  type FileNode,
  type Kind,
  type MapFile,
  type Place,
  type User,
} from './file';

export interface Spot {
  readonly x: number;
  readonly y: number;
}

const ROBOTS: readonly User[] = ['loaded', 'unloaded'];
const NEAR_M = 0.02;
const round = (v: number): number => Math.round(v * 1000) / 1000 + 0;

/** The nearest point of the grid; the point itself, to the centimetre, where there is none. */
export function snapped({ x, y }: Spot, pitch: number | null): Spot {
  const grid = pitch ?? 0.01;
  return { x: round(Math.round(x / grid) * grid), y: round(Math.round(y / grid) * grid) };
}

/** The node at a place, or the nearest one no farther than `within` metres. */
export function nodeAt(map: MapFile, at: Spot, within = NEAR_M): FileNode | null {
  let [best, least]: [FileNode | null, number] = [null, within];
  for (const node of map.nodes) {
    const far = Math.hypot(node.x - at.x, node.y - at.y);
    if (far <= least) [best, least] = [node, far];
  }
  return best;
}

/** A name that nothing has yet: `prefix` with the first number that is free. */
function freeName(taken: ReadonlySet<string>, prefix: string, from: number): string {
  let n = from;
  while (taken.has(`${prefix}${n}`)) n += 1;
  return `${prefix}${n}`;
}

/** The map with a node at each of these places, and the names of them; nodes that are there stay. */
function withNodes(map: MapFile, spots: readonly Spot[]): [MapFile, string[]] {
  const taken = new Set(map.nodes.map((n) => n.id));
  const fresh: FileNode[] = [];
  let next = map.nodes.length + 1;
  const ids = spots.map((at) => {
    const known = nodeAt(map, at) ?? nodeAt({ ...map, nodes: fresh }, at);
    if (known) return known.id;
    const id = freeName(taken, 'n', next);
    next += 1;
    taken.add(id);
    fresh.push({ id, x: at.x, y: at.y });
    return id;
  });
  return [fresh.length > 0 ? { ...map, nodes: [...map.nodes, ...fresh] } : map, ids];
}

const joins = (lane: FileLane, a: string, b: string): boolean =>
  (lane.from === a && lane.to === b) || (lane.from === b && lane.to === a);

/** Lanes in place of what was between the same nodes. */
function withLanes(map: MapFile, lanes: readonly FileLane[]): MapFile {
  const key = (l: FileLane): string => [l.from, l.to].sort().join('\n');
  const drawn = new Map(lanes.filter((l) => l.from !== l.to).map((l) => [key(l), l]));
  return { ...map, lanes: [...map.lanes.filter((l) => !drawn.has(key(l))), ...drawn.values()] };
}

/** The places along a straight line, a pitch apart; only its ends where there is no grid, or where it leaves the
 *  grid. */
export function along(a: Spot, b: Spot, pitch: number | null): Spot[] {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  if (pitch === null || (Math.abs(dx) > NEAR_M && Math.abs(dy) > NEAR_M)) return [a, b];
  const steps = Math.max(1, Math.round(Math.hypot(dx, dy) / pitch));
  return Array.from({ length: steps + 1 }, (_, i) => ({
    x: round(a.x + (dx * i) / steps),
    y: round(a.y + (dy * i) / steps),
  }));
}

/** How far two places may be apart to be neighbours, metres. */
const reach = (pitch: number | null): number => (pitch ?? 1) * 1.05;

/** Joins places to the open floor beside them: storage for robots alone, and storage to storage for those without a
 *  rack. */
function joined(map: MapFile, ids: readonly string[], pitch: number | null): MapFile {
  const kinds = kindsOf(map);
  const at = new Map(map.nodes.map((n) => [n.id, n]));
  const known = new Set(map.lanes.map((l) => [l.from, l.to].sort().join('\n')));
  const lanes: FileLane[] = [];
  const far = reach(pitch);
  for (const id of ids) {
    const here = at.get(id);
    if (!here) continue;
    for (const other of map.nodes) {
      // Distance first: in a large hall nearly all are far away, and names take longer than numbers.
      if (other.id === id || Math.abs(other.x - here.x) > far || Math.abs(other.y - here.y) > far) continue;
      const key = [id, other.id].sort().join('\n');
      if (known.has(key) || Math.hypot(other.x - here.x, other.y - here.y) > far) continue;
      const both = [kinds.get(id)!, kinds.get(other.id)!];
      const users = usersBetween(both[0]!, both[1]!);
      if (users === null) continue;
      known.add(key);
      lanes.push({ from: id, to: other.id, both: true, ...(users === 'all' ? {} : { for: users }) });
    }
  }
  return lanes.length > 0 ? withLanes(map, lanes) : map;
}

/** Who may drive between two neighbours of which one is no open floor; nothing where no lane belongs. */
function usersBetween(a: Kind, b: Kind): readonly User[] | 'all' | null {
  const open = (k: Kind): boolean => k === 'aisle' || k === 'exit';
  if (a === 'queue' || b === 'queue') return null;
  if (a === 'storage' && b === 'storage') return ['unloaded'];
  if (open(a) === open(b)) return a === 'exit' || b === 'exit' ? 'all' : null;
  return a === 'storage' || b === 'storage' || a === 'station' || b === 'station' ? ROBOTS : 'all';
}

/** Storage, chargers and stations that lie beside new open floor get a lane to it. */
function joinedBeside(map: MapFile, ids: readonly string[], pitch: number | null): MapFile {
  const kinds = kindsOf(map);
  const open = ids.filter((id) => kinds.get(id) === 'aisle' || kinds.get(id) === 'exit');
  const spots = new Map(map.nodes.map((n) => [n.id, n]));
  const beside = map.nodes.filter(
    (n) =>
      !['aisle', 'queue', 'exit'].includes(kinds.get(n.id)!) &&
      open.some((id) => Math.hypot(n.x - spots.get(id)!.x, n.y - spots.get(id)!.y) <= reach(pitch)),
  );
  return joined(
    map,
    beside.map((n) => n.id),
    pitch,
  );
}

/** A lane, two-way or in the direction in which it was drawn, with a node at every pitch. */
export function drawLane(map: MapFile, a: Spot, b: Spot, both: boolean, pitch: number | null): MapFile {
  const [wider, ids] = withNodes(map, along(a, b, pitch));
  const lanes = ids.slice(1).map((to, i): FileLane => ({ from: ids[i]!, to, ...(both ? { both: true } : {}) }));
  return joinedBeside(withLanes(wider, lanes), ids, pitch);
}

/** A rectangle of storage places with a rack on each. */
export function drawBlock(map: MapFile, a: Spot, b: Spot, pitch: number | null): MapFile {
  const step = pitch ?? 1;
  const [x0, y0] = [Math.min(a.x, b.x), Math.min(a.y, b.y)];
  const [columns, rows] = [Math.round(Math.abs(a.x - b.x) / step), Math.round(Math.abs(a.y - b.y) / step)];
  const spots: Spot[] = [];
  for (let j = 0; j <= rows; j++)
    for (let i = 0; i <= columns; i++) spots.push({ x: round(x0 + i * step), y: round(y0 + j * step) });
  const [wider, ids] = withNodes(map, spots);
  // Lanes of open floor that was there do not belong between racks.
  const inside = new Set(ids);
  let next = withoutRoles(wider, inside);
  next = { ...next, lanes: next.lanes.filter((l) => !inside.has(l.from) && !inside.has(l.to)) };
  const taken = new Set(next.racks.map((r) => r.id));
  const racks = ids.map((node) => {
    const id = freeName(taken, 'R', taken.size + 1);
    taken.add(id);
    return { id, node };
  });
  next = { ...next, storage: [...next.storage, ...ids], racks: [...next.racks, ...racks] };
  return joined(next, ids, pitch);
}

/** Nodes lose what they are for; a station goes with its queue. */
function withoutRoles(map: MapFile, ids: ReadonlySet<string>): MapFile {
  const rest = (list: readonly string[]): string[] => list.filter((id) => !ids.has(id));
  return {
    ...map,
    storage: rest(map.storage),
    chargers: rest(map.chargers),
    parking: rest(map.parking),
    exits: rest(map.exits),
    racks: map.racks.filter((r) => !ids.has(r.node)),
    stations: map.stations.filter((s) => !ids.has(s.node)).map((s) => (s.queue ? { ...s, queue: rest(s.queue) } : s)),
  };
}

/** A node for something: a charger, a parking place, a door, a storage place, or open floor again. */
export function setKind(map: MapFile, id: string, kind: Exclude<Kind, 'queue'>, pitch: number | null): MapFile {
  const plain = withoutRoles(map, new Set([id]));
  const add = (key: 'storage' | 'chargers' | 'parking' | 'exits'): MapFile => ({
    ...plain,
    [key]: [...plain[key], id],
  });
  const made = (): MapFile => {
    switch (kind) {
      case 'storage':
        return add('storage');
      case 'charger':
        return add('chargers');
      case 'parking':
        return add('parking');
      case 'exit':
        return add('exits');
      case 'station':
        return { ...plain, stations: [...plain.stations, { id: stationName(plain), node: id, pick_s: 8 }] };
      case 'aisle':
        return plain;
    }
  };
  return joined(made(), [id], pitch);
}

const stationName = (map: MapFile): string =>
  freeName(new Set(map.stations.map((s) => s.id)), 'W', map.stations.length + 1);

/** A place of a kind where there may be no node yet. */
export function drawPlace(map: MapFile, at: Spot, kind: Exclude<Kind, 'queue'>, pitch: number | null): MapFile {
  const [wider, [id]] = withNodes(map, [at]);
  return setKind(wider, id!, kind, pitch);
}

/**
 * A station at `a` with a queue that ends at `b`: robots enter the queue at its end, move up, and leave the station by
 * its own way out. Without a queue where both are one place.
 */
export function drawStation(map: MapFile, a: Spot, b: Spot, pitch: number | null): MapFile {
  const spots = along(a, b, pitch);
  if (Math.hypot(a.x - b.x, a.y - b.y) < NEAR_M) return drawPlace(map, a, 'station', pitch);
  const [wider, ids] = withNodes(map, spots);
  const line = new Set(ids);
  let next = withoutRoles(wider, line);
  next = { ...next, lanes: next.lanes.filter((l) => !line.has(l.from) && !line.has(l.to)) };
  const [node, ...queue] = ids as [string, ...string[]];
  next = { ...next, stations: [...next.stations, { id: stationName(next), node, queue, pick_s: 8 }] };
  const kinds = kindsOf(next);
  const at = new Map(next.nodes.map((n) => [n.id, n]));
  const open = (id: string): string[] =>
    next.nodes
      .filter(
        (n) =>
          ['aisle', 'exit'].includes(kinds.get(n.id)!) &&
          Math.hypot(n.x - at.get(id)!.x, n.y - at.get(id)!.y) <= reach(pitch),
      )
      .map((n) => n.id);
  const last = queue[queue.length - 1]!;
  const lanes: FileLane[] = [
    ...ids.slice(1).map((from, i): FileLane => ({ from, to: ids[i]!, for: ROBOTS })),
    ...open(node).map((to): FileLane => ({ from: node, to, for: ROBOTS })),
    ...open(last).map((from): FileLane => ({ from, to: last, for: ROBOTS })),
  ];
  return withLanes(next, lanes);
}

/** A rectangle that stands in people's way, or on which they may walk. */
export function drawOutline(map: MapFile, a: Spot, b: Spot, list: 'obstacles' | 'walkable'): MapFile {
  if (Math.abs(a.x - b.x) < NEAR_M || Math.abs(a.y - b.y) < NEAR_M) return map;
  const [x0, x1, y0, y1] = [Math.min(a.x, b.x), Math.max(a.x, b.x), Math.min(a.y, b.y), Math.max(a.y, b.y)];
  const outline: Corner[] = [
    [x0, y0],
    [x1, y0],
    [x1, y1],
    [x0, y1],
  ];
  return { ...map, [list]: [...map[list], outline] };
}

/** Without some nodes, and everything that refers to them. */
function withoutNodes(map: MapFile, ids: ReadonlySet<string>): MapFile {
  const rest = withoutRoles(map, ids);
  return {
    ...rest,
    nodes: rest.nodes.filter((n) => !ids.has(n.id)),
    lanes: rest.lanes.filter((l) => !ids.has(l.from) && !ids.has(l.to)),
  };
}

function distanceToLane(at: Spot, a: Spot, b: Spot): number {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const t = Math.min(1, Math.max(0, ((at.x - a.x) * dx + (at.y - a.y) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(at.x - a.x - t * dx, at.y - a.y - t * dy);
}

function isInside({ x, y }: Spot, outline: readonly Corner[]): boolean {
  let inside = false;
  outline.forEach(([ax, ay], i) => {
    const [bx, by] = outline[(i + 1) % outline.length]!;
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
  });
  return inside;
}

/** Without what is at a place: a node, else a lane, else the outline around it. */
export function erase(map: MapFile, at: Spot, within: number): MapFile {
  const node = nodeAt(map, at, within);
  if (node) return withoutNodes(map, new Set([node.id]));
  const spots = new Map(map.nodes.map((n) => [n.id, n]));
  const far = (l: FileLane): number => {
    const [a, b] = [spots.get(l.from), spots.get(l.to)];
    return a && b ? distanceToLane(at, a, b) : Infinity;
  };
  const [lane] = map.lanes.filter((l) => far(l) <= within).sort((a, b) => far(a) - far(b));
  if (lane) return { ...map, lanes: map.lanes.filter((l) => l !== lane) };
  for (const list of ['obstacles', 'walkable'] as const) {
    const hit = [...map[list]].reverse().find((o) => isInside(at, o));
    if (hit) return { ...map, [list]: map[list].filter((o) => o !== hit) };
  }
  return map;
}

/** Without everything in a rectangle. */
export function eraseArea(map: MapFile, a: Spot, b: Spot): MapFile {
  const [x0, x1, y0, y1] = [Math.min(a.x, b.x), Math.max(a.x, b.x), Math.min(a.y, b.y), Math.max(a.y, b.y)];
  const inside = (x: number, y: number): boolean =>
    x >= x0 - NEAR_M && x <= x1 + NEAR_M && y >= y0 - NEAR_M && y <= y1 + NEAR_M;
  const rest = withoutNodes(map, new Set(map.nodes.filter((n) => inside(n.x, n.y)).map((n) => n.id)));
  const keep = (o: readonly Corner[]): boolean => !o.every(([x, y]) => inside(x, y));
  return { ...rest, obstacles: rest.obstacles.filter(keep), walkable: rest.walkable.filter(keep) };
}

/** A cell so much farther to the right and up. */
function movedCell(cell: FileCell, dx: number, dy: number): FileCell {
  const outline = (corners: readonly Corner[]): Corner[] => corners.map(([x, y]) => [round(x + dx), round(y + dy)]);
  const place = ([x, y, z]: Place): Place => [round(x + dx), round(y + dy), z];
  return {
    ...cell,
    workplace: outline(cell.workplace),
    opening: { ...cell.opening, outline: outline(cell.opening.outline) },
    totes: cell.totes.map((tote) => ({ ...tote, at: place(tote.at) })),
    ...(cell.arm ? { arm: { ...cell.arm, base: place(cell.arm.base) } } : {}),
  };
}

/** A node elsewhere, if no other is there, and with a station its cell; lanes that had a length of their own become
 *  straight again. */
export function moveNode(map: MapFile, id: string, to: Spot): MapFile {
  const [there, from] = [nodeAt(map, to), map.nodes.find((n) => n.id === id)];
  if (there !== null || !from) return map;
  const along = (cell: FileCell): FileCell => movedCell(cell, to.x - from.x, to.y - from.y);
  return {
    ...map,
    stations: map.stations.map((s) => (s.node === id && s.cell ? { ...s, cell: along(s.cell) } : s)),
    nodes: map.nodes.map((n) => (n.id === id ? { ...n, x: to.x, y: to.y } : n)),
    lanes: map.lanes.map((l) => {
      if (l.length_m === undefined || (l.from !== id && l.to !== id)) return l;
      const { length_m: _, ...straight } = l;
      return straight;
    }),
  };
}

/** A node by another name, everywhere; the map as it is where another node has it. */
export function renameNode(map: MapFile, id: string, name: string): MapFile {
  if (name === '' || map.nodes.some((n) => n.id === name)) return map;
  const swap = (one: string): string => (one === id ? name : one);
  const all = (list: readonly string[]): string[] => list.map(swap);
  return {
    ...map,
    nodes: map.nodes.map((n) => (n.id === id ? { ...n, id: name } : n)),
    lanes: map.lanes.map((l) =>
      joins(l, id, l.from === id ? l.to : l.from) ? { ...l, from: swap(l.from), to: swap(l.to) } : l,
    ),
    storage: all(map.storage),
    chargers: all(map.chargers),
    parking: all(map.parking),
    exits: all(map.exits),
    racks: map.racks.map((r) => ({ ...r, node: swap(r.node) })),
    stations: map.stations.map((s) => ({ ...s, node: swap(s.node), ...(s.queue ? { queue: all(s.queue) } : {}) })),
  };
}
