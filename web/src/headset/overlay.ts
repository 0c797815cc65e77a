// What a wearer sees of guidance, over the room, a twin of it, or nothing: drawn for one eye or two from one
// description.
import { aim, multiply, type Aim, type Mat4 } from './arrow';
import { lights, type CellLights } from './cell';
import { toDevice, toMap, type Alignment, type Vec2, type Vec3 } from './frame';
import type { Painter } from './gl';
import type { Shown } from './guide';
import { lifts } from './labels';
import { mask, sight, straight } from './mask';
import { eyes, POST_M, reticle, robotAt, room, Shapes, type Colour, type Ink } from './shapes';
import { BOARD_PIECE, labelPiece, MOST_LABELS, Sheet, type Writing } from './sheet';
import { metres } from './words';

/** What is to be drawn now. */
export interface Scene {
  shown: Shown;
  alignment: Alignment | null;
  /** While marks are taken, a ring shows where a confirmation would take one. */
  marking: boolean;
  /** A window, and the narrow view, have their board at the lower edge; a display worn before the eyes has none. */
  board: 'eyes' | 'window';
  /** Only what the display of the published experiments would show is seen. */
  narrow: boolean;
  /** What is lit at a station. */
  cell?: CellLights | null;
  title: string;
  detail: string;
}
/** What lies behind the guidance where the room itself is not seen. */
export interface Backdrop {
  sky: Colour;
  /** Draws it for one eye: `clip` leads from the frame of the device to the screen. */
  draw(painter: Painter, clip: Mat4, alignment: Alignment): void;
}
/** One eye, or a window: its part of the picture, and how it sees. */
export interface Eyesight {
  port: { x: number; y: number; width: number; height: number };
  projection: Mat4;
  /** From the frame of the device to that of the eye. */
  toEye: Mat4;
}
export interface Head {
  at: Vec3;
  /** From the frame of the head to that of the device; and the other way. */
  matrix: Mat4;
  inverse: Mat4;
  /** Height of the floor in the frame of the device. */
  floor: number;
}

/** Labels change their colour with robots closer than this, metres. */
const CLOSE_M = 2;
/** How high above the floor labels stand, metres, and half their width and height as seen from one metre away. */
const LABEL_M = 1.35;
const [LABEL_WIDE, LABEL_HIGH] = [0.13, 0.13 * 0.19] as const;
const NEAREST_LABEL_M = 0.5;
/** Between the board and the lower edge of a window, as a share of half of its height. */
const EDGE = 0.04;

export class Overlay {
  readonly painter: Painter;
  #sheet: Sheet;
  #ink: Ink;
  #backdrop: Backdrop | null;
  /** How the eyes sit in the head, from the last frame with a pose. */
  #eyes: { port: Eyesight['port']; viewer: Float32Array }[] = [];
  #half: Vec2 = [1, 1];

  constructor(painter: Painter, ink: Ink, words: (name: string) => string, backdrop: Backdrop | null) {
    [this.painter, this.#ink, this.#sheet, this.#backdrop] = [painter, ink, new Sheet(words), backdrop];
  }

  /** A frame with a pose. Answers where the next point is. */
  draw(
    target: WebGLFramebuffer | null,
    head: Head,
    sights: readonly Eyesight[],
    scene: Scene,
    pointed: Vec3 | null,
  ): Aim | null {
    const { shown, alignment, marking, narrow, board, cell, title, detail } = scene;
    const first = sights[0];
    if (!first) return null;
    const half = sight(first.projection, narrow);
    const from = alignment ? toMap(alignment, head.at) : null;
    const next =
      alignment && shown.next
        ? aim(toDevice(alignment, shown.next, head.floor + POST_M), head.inverse, straight(first.projection, half))
        : null;
    const things = alignment && from ? room(shown, alignment, head.floor, from, this.#ink) : new Shapes();
    if (cell && alignment) lights(things, cell, alignment, head.floor, this.#ink);
    const inRoom = things.corners;
    const ring = marking && pointed ? reticle(pointed, this.#ink).corners : new Float32Array();
    const before = eyes(shown, next, half, this.#ink).corners;
    const masked = narrow ? mask(this.#ink.outside).corners : new Float32Array();
    const near = shown.near.slice(0, MOST_LABELS);
    this.#write({
      tone: shown.tone,
      title,
      detail,
      labels: near.map((r) => ({ text: `${r.id} ${metres(r.distance)}`, close: r.distance < CLOSE_M })),
    });
    const labels =
      alignment && from
        ? labelsAt(
            near.map((robot) => toDevice(alignment, robotAt(from, robot), head.floor + LABEL_M)),
            head.at,
          )
        : [];
    this.painter.begin(target, this.#backdrop?.sky);
    [this.#eyes, this.#half] = [[], half];
    for (const { port, projection, toEye } of sights) {
      this.painter.gl.viewport(port.x, port.y, port.width, port.height);
      const world = multiply(projection, toEye);
      const viewer = multiply(world, head.matrix);
      if (alignment) this.#backdrop?.draw(this.painter, world, alignment);
      this.painter.flat(inRoom, world, this.#backdrop ? 'behind' : 'over all');
      this.painter.flat(ring, world);
      labels.forEach((at, i) => this.#label(at, head.at, world, i));
      this.painter.flat(before, viewer);
      this.#board(shown, half, viewer, narrow ? 'window' : board);
      this.painter.flat(masked, viewer);
      this.#eyes.push({ viewer, port });
    }
    return next;
  }

  /** Without a pose there is no room, but what is before the eyes stays: above all STOP. */
  drawBlind(
    target: WebGLFramebuffer | null,
    { shown, title, detail }: Pick<Scene, 'shown' | 'title' | 'detail'>,
  ): void {
    this.#write({ tone: shown.tone, title, detail, labels: [] });
    this.painter.begin(target, this.#backdrop?.sky);
    const before = eyes(shown, null, this.#half, this.#ink).corners;
    for (const { viewer, port } of this.#eyes) {
      this.painter.gl.viewport(port.x, port.y, port.width, port.height);
      this.painter.flat(before, viewer);
      this.#board(shown, this.#half, viewer, 'eyes');
    }
  }

  #write(writing: Writing): void {
    if (this.#sheet.write(writing, performance.now())) this.painter.write(this.#sheet.canvas);
  }

  #label(at: Vec3, head: Vec3, matrix: Mat4, i: number): void {
    // It faces the wearer and keeps its size in the view, so that it can be read from afar.
    const [dx, dz] = [head[0] - at[0], head[2] - at[2]];
    const d = Math.max(NEAREST_LABEL_M, Math.hypot(dx, dz));
    const size = LABEL_WIDE * d;
    this.painter.sprite({
      matrix,
      centre: at,
      right: [(dz / d) * size, 0, (-dx / d) * size],
      up: [0, LABEL_HIGH * d, 0],
      piece: labelPiece(i),
    });
  }

  #board(shown: Shown, half: Vec2, matrix: Mat4, where: Scene['board']): void {
    const stop = shown.kind === 'stop';
    // Low in the view while all is well, in the middle when it matters.
    const wide = stop ? Math.min(half[0] * 0.8, 0.6) : Math.min(half[0] * 0.55, where === 'window' ? 0.24 : 0.44);
    const high = (wide * BOARD_PIECE[3]) / BOARD_PIECE[2];
    const low = where === 'window' ? half[1] * (1 - EDGE) - high : half[1] * 0.62;
    this.painter.sprite({
      matrix,
      centre: [0, stop ? 0 : -low, -1],
      right: [wide, 0, 0],
      up: [0, high, 0],
      piece: BOARD_PIECE,
    });
  }
}

/** Where labels stand so that none covers another from the head: those behind are lifted over those before them. */
function labelsAt(wished: readonly Vec3[], head: Vec3): Vec3[] {
  const far = ([x, , z]: Vec3): number => Math.max(NEAREST_LABEL_M, Math.hypot(x - head[0], z - head[2]));
  const bearings = wished.map((at) => ({
    left: Math.atan2(head[0] - at[0], head[2] - at[2]),
    up: (at[1] - head[1]) / far(at),
  }));
  const lifted = lifts(bearings, 2 * LABEL_WIDE, 2 * LABEL_HIGH);
  return wished.map((at, i) => [at[0], at[1] + (lifted[i] ?? 0) * far(at), at[2]]);
}
