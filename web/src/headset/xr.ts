// The immersive session: frames with poses, confirmations, jumps of the origin, and the drawing of the room. No camera
// image is asked for; the browser shows the room itself.
import { aim, multiply, type Aim, type Mat4 } from './arrow';
import { floorHit, rotate, toDevice, toMap, type Alignment, type Vec2, type Vec3 } from './frame';
import { Painter } from './gl';
import type { Shown } from './guide';
import type { Sample } from './pump';
import { BOARD_PIECE, labelPiece, MOST_LABELS, Sheet, type Writing } from './sheet';
import { eyes, reticle, robotAt, room, type Ink } from './shapes';

/** What is to be drawn now. */
export interface Scene {
  shown: Shown;
  alignment: Alignment | null;
  /** While marks are taken, a ring shows where a confirmation would take one. */
  marking: boolean;
  title: string;
  detail: string;
}
export interface Events {
  sample(sample: Sample): void;
  confirm(at: Vec3): void;
  /** The trigger or the pinch was held. */
  held(): void;
  reset(): void;
  woke(): void;
  ended(): void;
  scene(): Scene;
  drew(target: Aim | null): void;
}

/** A trigger held for so long asks for new marks. */
const HELD_MS = 1_500;
/** A finger trembles, and some devices report one press by two inputs: what follows so soon is the same press. */
const SAME_PRESS_MS = 300;

/** Whether this browser can show the room with something in it. */
export async function hasRoomView(): Promise<boolean> {
  try {
    return (await navigator.xr?.isSessionSupported('immersive-ar')) ?? false;
  } catch {
    return false;
  }
}

export class RoomView {
  /** Whether the device follows through large halls, or only some 15 m around the start. */
  readonly wide: boolean;
  #session: XRSession;
  #space: XRReferenceSpace;
  #floorSpace: XRReferenceSpace;
  #painter: Painter;
  #sheet: Sheet;
  #ink: Ink;
  #events: Events;
  #pressedAt = 0;
  #selectedAt = -Infinity;
  #isMeant = false;
  /** How the eyes sit in the head, from the last frame with a pose. */
  #eyes: { port: XRViewport; viewer: Float32Array }[] = [];
  #half: Vec2 = [1, 1];
  #floor = 0;
  #pointed: { at: Vec3 } | null = null;

  /** Begins; must be called out of a click. */
  static async enter(canvas: HTMLCanvasElement, ink: Ink, words: (name: string) => string, events: Events): Promise<RoomView> {
    if (!navigator.xr) throw new Error('this browser has no WebXR');
    const session = await navigator.xr.requestSession('immersive-ar', { requiredFeatures: ['local-floor'], optionalFeatures: ['unbounded'] });
    try {
      const painter = new Painter(canvas);
      await session.updateRenderState({ baseLayer: new XRWebGLLayer(session, painter.gl) });
      const floor = await session.requestReferenceSpace('local-floor');
      const wide = await session.requestReferenceSpace('unbounded').catch(() => null);
      return new RoomView(session, wide ?? floor, floor, wide !== null, painter, new Sheet(words), ink, events);
    } catch (error) {
      await session.end();
      throw error;
    }
  }

  private constructor(
    session: XRSession, space: XRReferenceSpace, floor: XRReferenceSpace, wide: boolean, painter: Painter, sheet: Sheet, ink: Ink, events: Events,
  ) {
    [this.#session, this.#space, this.#floorSpace, this.wide] = [session, space, floor, wide];
    [this.#painter, this.#sheet, this.#ink, this.#events] = [painter, sheet, ink, events];
    space.addEventListener('reset', () => events.reset());
    session.addEventListener('end', () => events.ended());
    session.addEventListener('visibilitychange', () => { if (session.visibilityState === 'visible') events.woke(); });
    session.addEventListener('selectstart', () => { this.#pressedAt = performance.now(); });
    // A press that was cancelled ends without a select. Not all runtimes keep to the order of the specification.
    session.addEventListener('select', () => { this.#isMeant = true; });
    session.addEventListener('selectend', (event) => { if (this.#isMeant) this.#selected(event); });
    session.requestAnimationFrame(this.#frame);
  }

  async leave(): Promise<void> {
    await this.#session.end().catch(() => {});
  }

  #selected(event: XRInputSourceEvent): void {
    const now = performance.now();
    this.#isMeant = false;
    const same = now - this.#selectedAt < SAME_PRESS_MS;
    this.#selectedAt = now;
    if (same) return;
    if (now - this.#pressedAt >= HELD_MS) {
      this.#events.held();
      return;
    }
    const at = this.#ray(event.frame, event.inputSource) ?? this.#pointed?.at;
    if (at) this.#events.confirm(at);
  }

  /** Where somebody points at the floor close by. */
  #ray(frame: XRFrame, source: XRInputSource): Vec3 | null {
    if (source.targetRayMode === 'gaze') return null;
    const ray = frame.getPose(source.targetRaySpace, this.#space)?.transform;
    if (!ray) return null;
    const { x, y, z, w } = ray.orientation;
    return floorHit([ray.position.x, ray.position.y, ray.position.z], rotate([x, y, z, w], [0, 0, -1]), this.#floor);
  }

  #frame = (t: number, frame: XRFrame): void => {
    this.#session.requestAnimationFrame(this.#frame);
    const pose = frame.getViewerPose(this.#space);
    const layer = this.#session.renderState.baseLayer;
    if (!layer) return;
    this.#painter.begin(layer.framebuffer);
    if (!pose) {
      this.#pointed = null;
      this.#drawBlind(layer);
      return;
    }
    const { position: p, orientation: q } = pose.transform;
    const head: Vec3 = [p.x, p.y, p.z];
    const floor = this.#space === this.#floorSpace ? 0 : frame.getPose(this.#floorSpace, this.#space)?.transform.position.y;
    this.#floor = floor ?? this.#floor;
    const feet: Vec3 = [p.x, this.#floor, p.z];
    const pointing = [...this.#session.inputSources].map((source) => this.#ray(frame, source)).find((hit) => hit !== null);
    this.#pointed = { at: pointing ?? feet };
    // Behind a menu of the system, the wearer does something else.
    const emulated = pose.emulatedPosition || this.#session.visibilityState !== 'visible';
    const predicted = frame.predictedDisplayTime;
    this.#events.sample({ t: typeof predicted === 'number' && predicted > 0 ? predicted : t, pos: head, quat: [q.x, q.y, q.z, q.w], emulated });
    this.#draw(pose, layer, head);
  };

  #draw(pose: XRViewerPose, layer: XRWebGLLayer, head: Vec3): void {
    const { shown, alignment, marking, title, detail } = this.#events.scene();
    const first = pose.views[0];
    if (!first) return;
    const half: Vec2 = [1 / first.projectionMatrix[0]!, 1 / first.projectionMatrix[5]!];
    const from = alignment ? toMap(alignment, head) : null;
    const target = alignment && shown.next ? aim(toDevice(alignment, shown.next, this.#floor), pose.transform.inverse.matrix, middle(first.projectionMatrix)) : null;
    const inRoom = alignment && from ? room(shown, alignment, this.#floor, from, this.#ink).corners : new Float32Array();
    const ring = marking && this.#pointed ? reticle(this.#pointed.at, this.#ink).corners : new Float32Array();
    const before = eyes(shown, target, half, this.#ink).corners;
    const near = shown.near.slice(0, MOST_LABELS);
    const labels = near.map((r) => ({ text: `${r.id} ${r.distance.toFixed(1)} m`, close: r.distance < 2 }));
    const writing: Writing = { tone: shown.tone, title, detail, labels };
    if (this.#sheet.write(writing, performance.now())) this.#painter.write(this.#sheet.canvas);
    const { gl } = this.#painter;
    [this.#eyes, this.#half] = [[], half];
    for (const view of pose.views) {
      const port = layer.getViewport(view);
      if (!port) continue;
      gl.viewport(port.x, port.y, port.width, port.height);
      const toEye = view.transform.inverse.matrix;
      const world = multiply(view.projectionMatrix, toEye);
      const viewer = multiply(world, pose.transform.matrix);
      this.#painter.flat(inRoom, world);
      this.#painter.flat(ring, world);
      if (alignment && from) near.forEach((robot, i) => this.#label(toDevice(alignment, robotAt(from, robot), this.#floor + 1.35), head, world, i));
      this.#painter.flat(before, viewer);
      this.#board(shown, half, viewer);
      this.#eyes.push({ viewer, port });
    }
    this.#events.drew(target);
  }

  /** Without a pose there is no room, but what is before the eyes stays: above all STOP. */
  #drawBlind(layer: XRWebGLLayer): void {
    const { shown, title, detail } = this.#events.scene();
    if (this.#sheet.write({ tone: shown.tone, title, detail, labels: [] }, performance.now())) this.#painter.write(this.#sheet.canvas);
    this.#painter.begin(layer.framebuffer);
    const before = eyes(shown, null, this.#half, this.#ink).corners;
    for (const { viewer, port } of this.#eyes) {
      this.#painter.gl.viewport(port.x, port.y, port.width, port.height);
      this.#painter.flat(before, viewer);
      this.#board(shown, this.#half, viewer);
    }
    this.#events.drew(null);
  }

  #label(at: Vec3, head: Vec3, matrix: Mat4, i: number): void {
    // It faces the wearer and keeps its size in the view, so that it can be read from afar.
    const [dx, dz] = [head[0] - at[0], head[2] - at[2]];
    const d = Math.max(0.5, Math.hypot(dx, dz));
    const size = 0.13 * d;
    this.#painter.sprite({ matrix, centre: at, right: [(dz / d) * size, 0, (-dx / d) * size], up: [0, size * 0.19, 0], piece: labelPiece(i) });
  }

  #board(shown: Shown, half: Vec2, matrix: Mat4): void {
    const stop = shown.kind === 'stop';
    // Low in the view while all is well, in the middle when it matters.
    const wide = Math.min(half[0] * (stop ? 0.8 : 0.55), stop ? 0.6 : 0.44);
    const centre = [0, stop ? 0 : -half[1] * 0.62, -1] as const;
    this.#painter.sprite({ matrix, centre, right: [wide, 0, 0], up: [0, (wide * BOARD_PIECE[3]) / BOARD_PIECE[2], 0], piece: BOARD_PIECE });
  }
}

/** An eye looks past its middle; the arrow is for both. */
function middle(projection: Mat4): Float32Array {
  const straight = Float32Array.from(projection);
  [straight[8], straight[9]] = [0, 0];
  return straight;
}
