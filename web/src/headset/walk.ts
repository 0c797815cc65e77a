// Walking through the twin: the eye of the window, and the frame that a VR headset is carried in. Pure.
import { multiply, type Mat4 } from './arrow';
import { planOf, rotate, toMap, type Alignment, type Quat, type Vec2, type Vec3 } from './frame';

/** Where somebody stands on the map and where they look: radians, `heading` from the x axis, `pitch` up. */
export interface Eye {
  at: Vec2;
  heading: number;
  pitch: number;
}
/** What keys, stick or pad ask for, -1 to 1 each. */
export interface Drive {
  ahead: number;
  left: number;
  /** To the left. */
  turn: number;
}
/** Whether a person can stand there. */
export type Free = (at: Vec2) => boolean;

/** The eyes of a person of middle height, metres. */
export const EYE_M = 1.65;
/** As fast as people walk, metres per second: the server does not believe much faster ones. */
export const WALK_MPS = 1.2;
const TURN_RPS = 1.5;
const STEEPEST = 1.4;
/** A frame that took longer, because the page was hidden, is no long step: seconds. */
const LONGEST_STEP_S = 0.1;
/** Half of what the longer side of a window shows, one metre ahead: 80°. */
export const LONG_SIDE = Math.tan((40 * Math.PI) / 180);
const [NEAR_M, FAR_M] = [0.1, 400];

/** A step of a walker, who slides along what cannot be walked through. */
export function step(eye: Eye, drive: Drive, dt: number, free: Free): Eye {
  const s = Math.min(dt, LONGEST_STEP_S);
  const heading = eye.heading + drive.turn * TURN_RPS * s;
  return { ...eye, heading, at: walked(eye.at, heading, drive, s, free) };
}

/** Where a walker who faces `heading` gets to. */
export function walked(
  at: Vec2,
  heading: number,
  { ahead, left }: Pick<Drive, 'ahead' | 'left'>,
  dt: number,
  free: Free,
): Vec2 {
  const asked = Math.hypot(ahead, left);
  if (asked === 0) return at;
  const length = (Math.min(1, asked) / asked) * WALK_MPS * Math.min(dt, LONGEST_STEP_S);
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  const [dx, dy] = [(c * ahead - s * left) * length, (s * ahead + c * left) * length];
  // Whoever stands where nobody can stand may leave in any direction.
  const may = (to: Vec2): boolean => free(to) || !free(at);
  return (
    (
      [
        [at[0] + dx, at[1] + dy],
        [at[0] + dx, at[1]],
        [at[0], at[1] + dy],
      ] as const
    ).find(may) ?? at
  );
}

/** Turns the eye as if the floor were dragged: pixels of a window of so many metres of view one metre ahead. */
export function drag(eye: Eye, dx: number, dy: number, metresPerPixel: number): Eye {
  const pitch = eye.pitch + Math.atan(dy * metresPerPixel);
  return {
    ...eye,
    heading: eye.heading + Math.atan(dx * metresPerPixel),
    pitch: Math.max(-STEEPEST, Math.min(STEEPEST, pitch)),
  };
}

export const product = (a: Quat, b: Quat): Quat => [
  a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
  a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
  a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
  a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
];
const aboutUp = (angle: number): Quat => [0, Math.sin(angle / 2), 0, Math.cos(angle / 2)];

/** The pose of an eye, with WebXR's axes on the map: x, height, -y. */
export function poseOf({ at, heading, pitch }: Eye): { pos: Vec3; quat: Quat } {
  // A quaternion of no turn looks to -z, which is up on the map: a quarter before its x axis.
  const yaw = aboutUp(heading - Math.PI / 2);
  return { pos: [at[0], EYE_M, -at[1]], quat: product(yaw, [Math.sin(pitch / 2), 0, 0, Math.cos(pitch / 2)]) };
}

/** From the frame of a pose to that around it; and the other way. */
export function matricesOf(pos: Vec3, quat: Quat): { matrix: Float32Array; inverse: Float32Array } {
  const axes = [rotate(quat, [1, 0, 0]), rotate(quat, [0, 1, 0]), rotate(quat, [0, 0, 1])] as const;
  const matrix = new Float32Array([...axes.flatMap((a) => [...a, 0]), ...pos, 1]);
  const dot = (a: Vec3): number => a[0] * pos[0] + a[1] * pos[1] + a[2] * pos[2];
  const inverse = new Float32Array([
    ...[0, 1, 2].flatMap((i) => [...axes.map((a) => a[i]!), 0]),
    ...axes.map((a) => -dot(a)),
    1,
  ]);
  return { matrix, inverse };
}

/** The projection of a window. */
export function perspective(width: number, height: number): Float32Array {
  const long = Math.max(width, height);
  const out = new Float32Array(16);
  [out[0], out[5], out[10], out[11], out[14]] = [
    long / width / LONG_SIDE,
    long / height / LONG_SIDE,
    (FAR_M + NEAR_M) / (NEAR_M - FAR_M),
    -1,
    (2 * FAR_M * NEAR_M) / (NEAR_M - FAR_M),
  ];
  return out;
}

// --- The frame of a VR headset, which is carried over the map by its stick ---

/** Where a head looks on the floor plan of its own frame; none if it looks straight up or down. */
export function headingOf(quat: Quat): number | null {
  const [x, y] = planOf(rotate(quat, [0, 0, -1]));
  return Math.hypot(x, y) < 0.1 ? null : Math.atan2(y, x);
}

/** The frame in which a head is at a place of the map and faces that way. */
export function seated(head: Vec3, facing: number, at: Vec2, heading: number): Alignment {
  return shifted({ theta: heading - facing, shift: [0, 0] }, head, at);
}

/** The same frame, with the head at another place of the map. */
export function shifted(rig: Alignment, head: Vec3, at: Vec2): Alignment {
  const now = toMap(rig, head);
  return { theta: rig.theta, shift: [rig.shift[0] + at[0] - now[0], rig.shift[1] + at[1] - now[1]] };
}

/** The frame turned around the head. */
export const turned = (rig: Alignment, head: Vec3, by: number): Alignment =>
  shifted({ ...rig, theta: rig.theta + by }, head, toMap(rig, head));

/** The pose of a headset, on the map. */
export function onMap(rig: Alignment, head: Vec3, quat: Quat): { pos: Vec3; quat: Quat } {
  const [x, y] = toMap(rig, head);
  return { pos: [x, head[1], -y], quat: product(aboutUp(rig.theta), quat) };
}

/** From the map, with WebXR's axes, to the frame of the headset. */
export function fromMap({ theta, shift: [sx, sy] }: Alignment): Float32Array {
  const [c, s] = [Math.cos(theta), Math.sin(theta)];
  return new Float32Array([c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0, -c * sx - s * sy, 0, c * sy - s * sx, 1]);
}

export const through = (clip: Mat4, rig: Alignment): Float32Array => multiply(clip, fromMap(rig));
