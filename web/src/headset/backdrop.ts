// The hall around the wearer of the twin, from the live feed: what it holds on the graphics card, and when that is new.
import type { Mat4 } from './arrow';
import { distance, type Alignment, type Vec2 } from './frame';
import { Glide } from './glide';
import type { Haze, Mesh, Painter } from './gl';
import { ground, movers, racks, SEEN_M, type HallInk } from './hall';
import type { Backdrop } from './overlay';
import type { Colour } from './shapes';
import { through } from './walk';
import { EMPTY, type Closure, type FloorMap, type Mirror } from '../wire';

/** After so many metres, racks that come into sight are drawn anew. */
const STRIDE_M = 3;

export class Hall implements Backdrop {
  readonly sky: Colour;
  /** What was drawn last, for tests and for the curious. */
  drawn = { robots: 0, people: 0, version: -1 };
  #map: FloorMap;
  #ink: HallInk;
  #haze: Haze;
  #glide = new Glide();
  #mirror: Mirror = EMPTY;
  #self = '';
  #meshes: { ground: Mesh | null; racks: Mesh | null; movers: Mesh | null } = {
    ground: null,
    racks: null,
    movers: null,
  };
  #closures: readonly Closure[] | null = null;
  #racked: { rows: Mirror['racks']; from: Vec2 } | null = null;

  constructor(map: FloorMap, ink: HallInk) {
    [this.#map, this.#ink, this.sky] = [map, ink, ink.sky];
    this.#haze = { colour: ink.sky, metres: SEEN_M };
  }

  get mirror(): Mirror {
    return this.#mirror;
  }

  /** A newer picture of the floor; `self` is the worker through whose eyes it is seen. */
  take(mirror: Mirror, self: string, now: number): void {
    this.#glide.take(mirror, now);
    [this.#mirror, this.#self] = [mirror, self];
  }

  /** Makes what is to be drawn in this frame, for all eyes. */
  prepare(painter: Painter, from: Vec2, now: number): void {
    const [map, mirror, ink, meshes] = [this.#map, this.#mirror, this.#ink, this.#meshes];
    if (this.#closures !== mirror.closures) {
      meshes.ground = painter.keep(ground(map, mirror.closures, ink).corners, meshes.ground);
      this.#closures = mirror.closures;
    }
    if (this.#racked?.rows !== mirror.racks || distance(this.#racked.from, from) > STRIDE_M) {
      meshes.racks = painter.keep(racks(map, mirror, from, ink).corners, meshes.racks);
      this.#racked = { rows: mirror.racks, from };
    }
    const { shapes, robots, people } = movers(map, mirror, (id) => this.#glide.where(id, now), from, this.#self, ink);
    meshes.movers = painter.keep(shapes.corners, meshes.movers);
    this.drawn = { robots, people, version: mirror.version ?? -1 };
  }

  draw(painter: Painter, clip: Mat4, alignment: Alignment): void {
    const matrix = through(clip, alignment);
    const { ground, racks, movers } = this.#meshes;
    if (ground) painter.mesh(ground, matrix, this.#haze, 'painted');
    if (racks) painter.mesh(racks, matrix, this.#haze, 'solid');
    if (movers) painter.mesh(movers, matrix, this.#haze, 'solid');
  }
}
