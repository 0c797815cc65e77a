// The immersive session: frames with poses, confirmations, jumps of the origin. In the room, the browser itself shows
// what is around, and no camera image is asked for; in the twin, nothing of the room is seen.
import type { Aim } from './arrow';
import type { Joints } from './cell';
import { floorHit, rotate, type Vec3 } from './frame';
import type { Eyesight, Overlay, Scene } from './overlay';
import type { Sample } from './pump';

export type Immersion = 'immersive-ar' | 'immersive-vr';
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
  /** Before each frame with a pose: sticks and buttons of what is held. */
  inputs?(sources: Iterable<XRInputSource>): void;
  /** Whether joints of hands go with the samples. */
  wantsHands?(): boolean;
}

/** A trigger held for so long asks for new marks. */
const HELD_MS = 1_500;
/** A finger trembles, and some devices report one press by two inputs: what follows so soon is the same press. */
const SAME_PRESS_MS = 300;

/** Whether this browser can show the room with something in it, or the twin around the wearer. */
export async function offers(mode: Immersion): Promise<boolean> {
  try {
    return (await navigator.xr?.isSessionSupported(mode)) ?? false;
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
  #overlay: Overlay;
  #events: Events;
  #pressedAt = 0;
  #selectedAt = -Infinity;
  #isMeant = false;
  #floor = 0;
  #pointed: { at: Vec3 } | null = null;

  /** Begins; must be called out of a click. */
  static async enter(mode: Immersion, overlay: Overlay, events: Events): Promise<RoomView> {
    if (!navigator.xr) throw new Error('this browser has no WebXR');
    // In the twin, a stick goes far, and the device itself stays in a room.
    const optionalFeatures = mode === 'immersive-ar' ? ['unbounded', 'hand-tracking'] : [];
    const session = await navigator.xr.requestSession(mode, { requiredFeatures: ['local-floor'], optionalFeatures });
    try {
      await overlay.painter.gl.makeXRCompatible();
      await session.updateRenderState({ baseLayer: new XRWebGLLayer(session, overlay.painter.gl) });
      const floor = await session.requestReferenceSpace('local-floor');
      const wide = mode === 'immersive-ar' ? await session.requestReferenceSpace('unbounded').catch(() => null) : null;
      return new RoomView(session, wide ?? floor, floor, wide !== null, overlay, events);
    } catch (error) {
      await session.end();
      throw error;
    }
  }

  private constructor(
    session: XRSession,
    space: XRReferenceSpace,
    floor: XRReferenceSpace,
    wide: boolean,
    overlay: Overlay,
    events: Events,
  ) {
    [this.#session, this.#space, this.#floorSpace, this.wide] = [session, space, floor, wide];
    [this.#overlay, this.#events] = [overlay, events];
    space.addEventListener('reset', () => events.reset());
    session.addEventListener('end', () => events.ended());
    session.addEventListener('visibilitychange', () => {
      if (session.visibilityState === 'visible') events.woke();
    });
    session.addEventListener('selectstart', () => {
      this.#pressedAt = performance.now();
    });
    // A press that was cancelled ends without a select. Not all runtimes keep to the order of the specification.
    session.addEventListener('select', () => {
      this.#isMeant = true;
    });
    session.addEventListener('selectend', (event) => {
      if (this.#isMeant) this.#selected(event);
    });
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
    if (!pose) {
      this.#pointed = null;
      this.#overlay.drawBlind(layer.framebuffer, this.#events.scene());
      this.#events.drew(null);
      return;
    }
    const { position: p, orientation: q } = pose.transform;
    const head: Vec3 = [p.x, p.y, p.z];
    const floor =
      this.#space === this.#floorSpace ? 0 : frame.getPose(this.#floorSpace, this.#space)?.transform.position.y;
    this.#floor = floor ?? this.#floor;
    const feet: Vec3 = [p.x, this.#floor, p.z];
    const pointing = [...this.#session.inputSources]
      .map((source) => this.#ray(frame, source))
      .find((hit) => hit !== null);
    this.#pointed = { at: pointing ?? feet };
    // Behind a menu of the system, the wearer does something else.
    const emulated = pose.emulatedPosition || this.#session.visibilityState !== 'visible';
    this.#events.inputs?.(this.#session.inputSources);
    const predicted = frame.predictedDisplayTime;
    const hands = this.#events.wantsHands?.() ? { hands: this.#hands(frame) } : {};
    this.#events.sample({
      t: typeof predicted === 'number' && predicted > 0 ? predicted : t,
      pos: head,
      quat: [q.x, q.y, q.z, q.w],
      emulated,
      ...hands,
    });
    this.#draw(pose, layer, head);
  };

  /** Joints of both hands; nothing of a hand of which one is not seen. */
  #hands(frame: XRFrame): { l: Joints | null; r: Joints | null } {
    const seen: { l: Joints | null; r: Joints | null } = { l: null, r: null };
    for (const { hand, handedness } of this.#session.inputSources) {
      if (!hand || handedness === 'none') continue;
      const poses = [...hand.values()].map((joint) => frame.getJointPose?.(joint, this.#space));
      const joints = poses.flatMap((pose) => {
        const p = pose?.transform.position;
        return p ? [[p.x, p.y, p.z, pose.radius ?? 0] as const] : [];
      });
      if (joints.length === poses.length) seen[handedness === 'left' ? 'l' : 'r'] = joints;
    }
    return seen;
  }

  #draw(pose: XRViewerPose, layer: XRWebGLLayer, at: Vec3): void {
    const sights = pose.views.flatMap((view): Eyesight[] => {
      const port = layer.getViewport(view);
      return port ? [{ port, projection: view.projectionMatrix, toEye: view.transform.inverse.matrix }] : [];
    });
    const head = { at, matrix: pose.transform.matrix, inverse: pose.transform.inverse.matrix, floor: this.#floor };
    this.#events.drew(
      this.#overlay.draw(layer.framebuffer, head, sights, this.#events.scene(), this.#pointed?.at ?? null),
    );
  }
}
