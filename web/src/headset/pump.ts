// From the display's frames to poses on the wire: at most 60 a second, at least 20, evenly spaced, numbered within an
// epoch, with a word on their quality. Nothing is queued: what cannot leave now is replaced by something newer. Pure.
import { reaching, type Joints, type Reaching } from './cell';
import type { Quat, Vec2, Vec3 } from './frame';

export type Quality = 'tracked' | 'emulated' | 'lost';

/** What the device knows at one moment. */
export interface Sample {
  /** Milliseconds of the page's own clock; headsets predict, so it may be a little ahead. */
  t: number;
  pos: Vec3;
  quat: Quat;
  /** The position is a guess of the device. */
  emulated: boolean;
  /** Joints of the hands, where they are wanted and seen. */
  hands?: { l: Joints | null; r: Joints | null };
}

export interface PoseMessage {
  type: 'pose';
  epoch: number;
  seq: number;
  t: number;
  pos?: Vec3;
  quat?: Quat;
  at?: Vec2;
  accuracy?: number;
  quality: Quality;
  gaze?: Reaching['gaze'];
  hands?: Reaching['hands'];
}

const FASTEST_HZ = 60;
const SLOWEST_HZ = 20;
/** Frames jitter: one that comes this much early is taken all the same. */
const EARLY_MS = 2;
/** From so many bytes that wait in the socket on, it goes slowly; from so many on, it waits. */
const SLOW_BYTES = 4_096;
const FULL_BYTES = 32_768;
/** Without a pose for so long, the server is told that there is none. */
export const LOST_MS = 500;

export class Pump {
  epoch = 1;
  aligned = false;
  /** The server asks for hands: they go with each pose, and the head's ray with them. */
  wantsHands = false;
  #seq = 0;
  #sentAt = -Infinity;
  #seenAt = -Infinity;
  #lostAt = -Infinity;

  /** The server began a new epoch: numbers begin again. */
  enter(epoch: number, aligned: boolean): void {
    [this.epoch, this.aligned, this.#seq, this.#sentAt] = [epoch, aligned, 0, -Infinity];
  }

  /** The message for a frame's pose; none where it is not its turn. `waiting` counts bytes in the socket. */
  offer(sample: Sample, waiting: number): PoseMessage | null {
    this.#seenAt = sample.t;
    const spacing = 1000 / (waiting > SLOW_BYTES ? SLOWEST_HZ : FASTEST_HZ) - EARLY_MS;
    if (!this.aligned || waiting > FULL_BYTES || sample.t - this.#sentAt < spacing) return null;
    this.#sentAt = sample.t;
    return {
      type: 'pose',
      epoch: this.epoch,
      seq: ++this.#seq,
      t: sample.t,
      pos: sample.pos,
      quat: sample.quat,
      quality: sample.emulated ? 'emulated' : 'tracked',
      ...(this.wantsHands ? reaching(sample) : {}),
    };
  }

  /** A place on the map that the wearer pointed out. */
  place(at: Vec2, t: number, accuracy: number): PoseMessage {
    this.#seenAt = t;
    return { type: 'pose', epoch: this.epoch, seq: ++this.#seq, t, at, accuracy, quality: 'tracked' };
  }

  /** Called now and then: the message that there is no pose, twice a second while there is none. */
  missing(now: number): PoseMessage | null {
    if (!this.isLost(now) || !this.aligned || now - this.#lostAt < LOST_MS) return null;
    this.#lostAt = now;
    return { type: 'pose', epoch: this.epoch, seq: ++this.#seq, t: now, quality: 'lost' };
  }

  isLost(now: number): boolean {
    return now - this.#seenAt >= LOST_MS;
  }
}
