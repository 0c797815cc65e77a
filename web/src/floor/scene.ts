// Everything that moves, as typed arrays that a painter can draw without asking anyone. `take` turns a
// mirror into arrays (about ten times a second); `at` moves them between two patches (every frame).
import { row, type Mirror } from '../mirror';
import { ROBOT_STATES, type FloorMap } from '../wire';
import { People, type Person } from './people';
import { shortTurn } from './turn';

/** Segments as x0, y0, x1, y1 …; those of robot i are numbers from[i] to from[i + 1]. */
export interface Paths {
  at: Float32Array;
  from: Uint32Array;
}
export interface Scene {
  robots: number;
  x: Float32Array;
  y: Float32Array;
  heading: Float32Array;
  /** Index into ROBOT_STATES. */
  state: Uint8Array;
  lowBattery: Uint8Array;
  ids: string[];
  racks: number;
  /** Counts the times that a rack was lifted, set down or moved. */
  rackTurn: number;
  rackIds: string[];
  rackX: Float32Array;
  rackY: Float32Array;
  /** The robot under the rack, or -1. */
  rackOn: Int32Array;
  granted: Paths;
  held: Paths;
  people: readonly Person[];
}

export const LOW_BATTERY = 0.2;
/** Further than any robot drives between two patches: it was put there, so it is not slid there. */
const JUMP_M = 3;
const LONGEST_GLIDE_MS = 400;

export class Stage {
  scene: Scene = blank();
  #map: FloorMap;
  #joined: Set<number>;
  #from = new Float32Array(0);
  #to = new Float32Array(0);
  #tookAt = -Infinity;
  #glide = 100;
  #order: ReadonlyMap<string, number> | null = null;
  #racks: Mirror['racks'] | null = null;
  #people = new People();

  constructor(map: FloorMap) {
    this.#map = map;
    this.#joined = new Set(map.lanes.flatMap((l) => [this.#pair(l.from, l.to), this.#pair(l.to, l.from)]));
  }

  take(mirror: Mirror, now: number, how: 'glide' | 'jump'): void {
    const { rows, at } = mirror.robots;
    this.at(now);
    const same = this.#order === at && how === 'glide';
    this.#order = at;
    if (this.scene.robots !== rows.length) this.#resize(rows.length);
    const s = this.scene;
    rows.forEach((r, i) => {
      const jump = !same || Math.hypot(r.x - s.x[i]!, r.y - s.y[i]!) > JUMP_M;
      if (jump) { s.x[i] = r.x; s.y[i] = r.y; s.heading[i] = r.heading; }
      this.#from.set([s.x[i]!, s.y[i]!, s.heading[i]!], 3 * i);
      this.#to.set([r.x, r.y, r.heading], 3 * i);
      s.state[i] = Math.max(0, ROBOT_STATES.indexOf(r.state));
      s.lowBattery[i] = r.battery < LOW_BATTERY ? 1 : 0;
      s.ids[i] = r.id;
    });
    // Glide for about as long as patches take to come, so that motion neither stutters nor runs ahead.
    const gap = now - this.#tookAt;
    if (gap < 1_000) this.#glide += (Math.min(LONGEST_GLIDE_MS, gap * 1.1) - this.#glide) * 0.2;
    this.#tookAt = now;
    if (this.#racks !== mirror.racks) this.#takeRacks(mirror);
    this.#people.take(mirror.workers.rows, how);
    s.people = this.#people.list;
    s.granted = this.#paths(rows.map((r) => r.granted));
    s.held = this.#paths(rows.map((r) => heldBeyond(r.granted, r.held)));
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

  #paths(lists: readonly (readonly number[])[]): Paths {
    const from = new Uint32Array(lists.length + 1);
    const at: number[] = [];
    const { nodes } = this.#map;
    lists.forEach((list, i) => {
      for (let k = 1; k < list.length; k++) {
        const a = nodes[list[k - 1]!];
        const b = nodes[list[k]!];
        // Held nodes need not be neighbours: only what a lane joins is a way.
        if (a && b && this.#joined.has(this.#pair(list[k - 1]!, list[k]!))) at.push(a.x, a.y, b.x, b.y);
      }
      from[i + 1] = at.length / 4;
    });
    return { at: Float32Array.from(at), from };
  }

  #pair = (a: number, b: number): number => a * 1_000_000 + b;

  #resize(robots: number): void {
    const { scene } = this;
    this.#from = new Float32Array(3 * robots);
    this.#to = new Float32Array(3 * robots);
    this.scene = {
      ...scene, robots,
      x: new Float32Array(robots), y: new Float32Array(robots), heading: new Float32Array(robots),
      state: new Uint8Array(robots), lowBattery: new Uint8Array(robots), ids: new Array<string>(robots).fill(''),
    };
    this.#racks = null;
  }
}

/** The robot nearest to a point, or -1 when none is within reach. */
export function robotNear(scene: Scene, x: number, y: number, reach: number): number {
  let best = -1;
  let bestSq = reach * reach;
  for (let i = 0; i < scene.robots; i++) {
    const dx = scene.x[i]! - x;
    const dy = scene.y[i]! - y;
    const sq = dx * dx + dy * dy;
    if (sq <= bestSq) { best = i; bestSq = sq; }
  }
  return best;
}

/** What is held but not granted, begun at the last granted node so that the two ways join. */
export function heldBeyond(granted: readonly number[], held: readonly number[]): number[] {
  const may = new Set(granted);
  const rest = held.filter((node) => !may.has(node));
  const last = granted.at(-1);
  return last === undefined || rest.length === 0 ? rest : [last, ...rest];
}

function blank(): Scene {
  const none = (): Paths => ({ at: new Float32Array(0), from: new Uint32Array(1) });
  return {
    robots: 0, x: new Float32Array(0), y: new Float32Array(0), heading: new Float32Array(0),
    state: new Uint8Array(0), lowBattery: new Uint8Array(0), ids: [],
    racks: 0, rackTurn: 0, rackIds: [], rackX: new Float32Array(0), rackY: new Float32Array(0), rackOn: new Int32Array(0),
    granted: none(), held: none(), people: [],
  };
}
