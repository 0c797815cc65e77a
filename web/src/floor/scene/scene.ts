// Everything that moves, as typed arrays that a painter can draw without asking elsewhere. `take` turns a
// mirror into arrays (about ten times a second); `at` moves them between two patches (every frame).
import {
  ACTIVITIES,
  activityOf,
  type FloorMap,
  type Footprint,
  type MapNode,
  type Mirror,
  type Robot,
  row,
} from '../../wire';
import { People, type Person } from './people';
import { shortTurn } from './turn';

/** Segments as x0, y0, x1, y1 …; those of robot i are numbers from[i] to from[i + 1]. */
export interface Paths {
  at: Float32Array;
  from: Uint32Array;
}
/** How a robot is drawn: by what it is at. What needs a person lies above the rest. */
export const LOOKS = ACTIVITIES;
export type Look = (typeof LOOKS)[number];

export interface Scene {
  robots: number;
  x: Float32Array;
  y: Float32Array;
  heading: Float32Array;
  /** Index into LOOKS. */
  look: Uint8Array;
  /** 0 to 1. */
  battery: Float32Array;
  /** Half the width of its mark, metres. */
  reach: Float32Array;
  ids: string[];
  racks: number;
  /** Counts the times that a rack was lifted, set down or moved. */
  rackTurn: number;
  rackIds: string[];
  rackX: Float32Array;
  rackY: Float32Array;
  /** The robot under the rack, or -1. */
  rackOn: Int32Array;
  /** Counts the times that a way changed. */
  wayTurn: number;
  granted: Paths;
  held: Paths;
  stations: readonly { id: string; x: number; y: number; title: string; waiting: number }[];
  /** Places with a name of their own. */
  nodes: readonly MapNode[];
  people: readonly Person[];
}

export const LOW_BATTERY = 0.2;
/** Half the width of a robot's mark where its kind has no footprint of its own, metres. */
const USUAL_REACH_M = 0.38;
/** Further than any robot drives between two patches: it was put there, so it is not slid there. */
const JUMP_M = 3;
/** A replay at a quarter of the speed has a recorded frame every 800 ms. */
const LONGEST_GLIDE_MS = 900;

export class Stage {
  scene: Scene = blank();
  #map: FloorMap;
  #joined: Set<number>;
  #reach: ReadonlyMap<string, number>;
  #from = new Float32Array(0);
  #to = new Float32Array(0);
  #tookAt = -Infinity;
  #glide = 100;
  #order: ReadonlyMap<string, number> | null = null;
  #racks: Mirror['racks'] | null = null;
  #stations: Mirror['stations'] | null = null;
  /** The rows that the ways were made of, to make only those anew that changed. */
  #rows: readonly Robot[] = [];
  #granted: number[][] = [];
  #held: number[][] = [];
  #people = new People();

  constructor(map: FloorMap) {
    this.#map = map;
    this.scene.nodes = map.nodes.filter((node) => node.kind !== 'station');
    this.#reach = new Map((map.kinds ?? []).map((kind) => [kind.name, reach(kind.footprint)]));
    this.#joined = new Set(map.lanes.flatMap((l) => [pair(l.from, l.to), pair(l.to, l.from)]));
  }

  take(mirror: Mirror, now: number, how: 'glide' | 'jump'): void {
    const { rows, at } = mirror.robots;
    this.at(now);
    const same = this.#order === at && how === 'glide';
    this.#order = at;
    if (this.scene.robots !== rows.length) this.#resize(rows.length);
    const s = this.scene;
    for (let i = 0; i < rows.length; i++) {
      const r = rows[i]!;
      const k = 3 * i;
      // One that has left is nowhere: nothing is drawn, met or picked there.
      const [x, y] = r.state === 'gone' ? [NaN, NaN] : [r.x, r.y];
      const near = Math.abs(x - s.x[i]!) <= JUMP_M && Math.abs(y - s.y[i]!) <= JUMP_M;
      if (!same || !near) {
        s.x[i] = x;
        s.y[i] = y;
        s.heading[i] = r.heading;
      }
      this.#from[k] = s.x[i]!;
      this.#from[k + 1] = s.y[i]!;
      this.#from[k + 2] = s.heading[i]!;
      this.#to[k] = x;
      this.#to[k + 1] = y;
      this.#to[k + 2] = r.heading;
      s.look[i] = Math.max(0, (LOOKS as readonly string[]).indexOf(activityOf(r)));
      s.battery[i] = r.battery;
      s.reach[i] = this.#reach.get(r.kind) ?? USUAL_REACH_M;
      s.ids[i] = r.id;
    }
    // Glide for about as long as patches take to come, so that motion neither stutters nor runs ahead.
    const gap = now - this.#tookAt;
    if (gap < 1_000) this.#glide += (Math.min(LONGEST_GLIDE_MS, gap * 1.1) - this.#glide) * 0.2;
    this.#tookAt = now;
    if (this.#racks !== mirror.racks) this.#takeRacks(mirror);
    if (this.#stations !== mirror.stations) this.#takeStations(mirror);
    this.#takeWays(rows);
    this.#people.take(mirror.workers.rows, how);
    s.people = this.#people.list;
  }

  /** Moves robots and people to where they are shown at `now`; true while anything is still under way. */
  at(now: number): boolean {
    const s = this.scene;
    const part = Math.min(1, Math.max(0, (now - this.#tookAt) / this.#glide));
    for (let i = 0; i < s.robots; i++) {
      const k = 3 * i;
      s.x[i] = this.#from[k]! + (this.#to[k]! - this.#from[k]!) * part;
      s.y[i] = this.#from[k + 1]! + (this.#to[k + 1]! - this.#from[k + 1]!) * part;
      s.heading[i] = this.#from[k + 2]! + shortTurn(this.#from[k + 2]!, this.#to[k + 2]!) * part;
    }
    this.#people.at(part);
    for (let i = 0; i < s.racks; i++) {
      const robot = s.rackOn[i]!;
      if (robot < 0) continue;
      s.rackX[i] = s.x[robot]!;
      s.rackY[i] = s.y[robot]!;
    }
    return part < 1;
  }

  #takeRacks(mirror: Mirror): void {
    const { rows } = mirror.racks;
    const s = this.scene;
    s.rackTurn += 1;
    if (s.racks !== rows.length) {
      s.racks = rows.length;
      s.rackIds = new Array<string>(rows.length).fill('');
      s.rackX = new Float32Array(rows.length);
      s.rackY = new Float32Array(rows.length);
      s.rackOn = new Int32Array(rows.length);
    }
    rows.forEach((rack, i) => {
      s.rackIds[i] = rack.id;
      s.rackOn[i] = rack.robot !== null && row(mirror.robots, rack.robot) ? mirror.robots.at.get(rack.robot)! : -1;
      const node = rack.node === null ? undefined : this.#map.nodes[rack.node];
      // A rack that is nowhere this page knows is not drawn at all rather than drawn wrongly.
      s.rackX[i] = node?.x ?? NaN;
      s.rackY[i] = node?.y ?? NaN;
    });
    this.#racks = mirror.racks;
  }

  #takeStations(mirror: Mirror): void {
    this.#stations = mirror.stations;
    this.scene.stations = this.#map.stations.flatMap((station) => {
      const node = this.#map.nodes[station.node];
      if (!node) return [];
      const waiting = row(mirror.stations, station.id)?.queue.length ?? 0;
      return {
        id: station.id,
        x: node.x,
        y: node.y,
        waiting,
        title: `${station.id}  ${waiting}/${station.queue.length}`,
      };
    });
  }

  #takeWays(rows: readonly Robot[]): void {
    let news = rows.length !== this.#rows.length;
    this.#granted.length = this.#held.length = rows.length;
    for (let i = 0; i < rows.length; i++) {
      const [r, before] = [rows[i]!, this.#rows[i]];
      if (before !== undefined && before.granted === r.granted && before.held === r.held) continue;
      this.#granted[i] = this.#runs(r.granted);
      this.#held[i] = this.#runs(heldBeyond(r.granted, r.held));
      news = true;
    }
    this.#rows = rows;
    if (!news) return;
    this.scene.granted = flat(this.#granted);
    this.scene.held = flat(this.#held);
    this.scene.wayTurn += 1;
  }

  /** The way along some nodes in as few segments as it has corners. */
  #runs(list: readonly number[]): number[] {
    const at: number[] = [];
    const { nodes } = this.#map;
    for (let k = 1; k < list.length; k++) {
      const a = nodes[list[k - 1]!];
      const b = nodes[list[k]!];
      // Held nodes need not be neighbours: only what a lane joins is a way.
      if (!a || !b || !this.#joined.has(pair(list[k - 1]!, list[k]!))) continue;
      const n = at.length;
      if (n > 0 && at[n - 2] === a.x && at[n - 1] === a.y && goesOn(at[n - 4]!, at[n - 3]!, a, b)) {
        at[n - 2] = b.x;
        at[n - 1] = b.y;
      } else {
        at.push(a.x, a.y, b.x, b.y);
      }
    }
    return at;
  }

  #resize(robots: number): void {
    const { scene } = this;
    this.#from = new Float32Array(3 * robots);
    this.#to = new Float32Array(3 * robots);
    this.scene = {
      ...scene,
      robots,
      x: new Float32Array(robots),
      y: new Float32Array(robots),
      heading: new Float32Array(robots),
      look: new Uint8Array(robots),
      battery: new Float32Array(robots),
      reach: new Float32Array(robots),
      ids: new Array<string>(robots).fill(''),
    };
    this.#racks = null;
  }
}

/** How far a robot of such an outline reaches from its middle along its axes, metres. */
function reach(footprint: Footprint | null): number {
  if (footprint === null) return USUAL_REACH_M;
  if ('square_m' in footprint) return footprint.square_m / 2;
  return 'circle_m' in footprint ? footprint.circle_m : Math.max(...footprint.polygon_m.flat().map(Math.abs));
}

/** The robot nearest to a point, or -1 when none is within reach. */
export function robotNear(scene: Scene, x: number, y: number, reach: number): number {
  let best = -1;
  let bestSq = reach * reach;
  for (let i = 0; i < scene.robots; i++) {
    const dx = scene.x[i]! - x;
    const dy = scene.y[i]! - y;
    const sq = dx * dx + dy * dy;
    if (sq <= bestSq) {
      best = i;
      bestSq = sq;
    }
  }
  return best;
}

/** What is held but not granted, begun at the last granted node so that the two ways join. */
export function heldBeyond(granted: readonly number[], held: readonly number[]): number[] {
  const rest = held.filter((node) => !granted.includes(node));
  const last = granted.at(-1);
  return last === undefined || rest.length === 0 ? rest : [last, ...rest];
}

const pair = (a: number, b: number): number => a * 1_000_000 + b;

/** Whether a way from (x0, y0) to `a` goes straight on to `b`. */
function goesOn(x0: number, y0: number, a: MapNode, b: MapNode): boolean {
  const [ux, uy, vx, vy] = [a.x - x0, a.y - y0, b.x - a.x, b.y - a.y];
  return Math.abs(ux * vy - uy * vx) < 1e-6 && ux * vx + uy * vy > 0;
}

function flat(lists: readonly number[][]): Paths {
  const from = new Uint32Array(lists.length + 1);
  let sum = 0;
  lists.forEach((list, i) => {
    from[i + 1] = (sum += list.length) / 4;
  });
  const at = new Float32Array(sum);
  lists.forEach((list, i) => at.set(list, 4 * from[i]!));
  return { at, from };
}

function blank(): Scene {
  const none = (): Paths => ({ at: new Float32Array(0), from: new Uint32Array(1) });
  return {
    robots: 0,
    x: new Float32Array(0),
    y: new Float32Array(0),
    heading: new Float32Array(0),
    look: new Uint8Array(0),
    battery: new Float32Array(0),
    reach: new Float32Array(0),
    ids: [],
    racks: 0,
    rackTurn: 0,
    rackIds: [],
    rackX: new Float32Array(0),
    rackY: new Float32Array(0),
    rackOn: new Int32Array(0),
    wayTurn: 0,
    granted: none(),
    held: none(),
    stations: [],
    nodes: [],
    people: [],
  };
}
