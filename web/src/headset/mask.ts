// What the wearer can see: the field of view of a display, and the narrow view, which shows no more than the display of
// the published experiments did (30° by 17.5°) and masks the rest. Pure.
import type { Mat4 } from './arrow';
import type { Vec2, Vec3 } from './frame';
import { Shapes, type Colour } from './shapes';

const half = (degrees: number): number => Math.tan((degrees * Math.PI) / 360);
/** Half of the narrow view, as lengths one metre ahead of the eye: 30° across, 17.5° up and down. */
export const NARROW: Vec2 = [half(30), half(17.5)];

/** So far ahead of the head the mask lies, metres. At this distance it sits in the same direction for both eyes. */
const MASK_M = 20;
/** The mask reaches so far to the sides, one metre ahead of the head: further than any display. */
const WIDE = 9;

/** Half of what can be seen, one metre ahead: of the display, or of the narrow view where that is smaller. */
export function sight(projection: Mat4, narrow: boolean): Vec2 {
  const whole: Vec2 = [1 / projection[0]!, 1 / projection[5]!];
  return narrow ? [Math.min(whole[0], NARROW[0]), Math.min(whole[1], NARROW[1])] : whole;
}

/** The projection for a field of view: straight ahead, although an eye looks past its middle, as it is for both
 *  eyes. */
export function straight(projection: Mat4, seen: Vec2): Float32Array {
  const out = Float32Array.from(projection);
  [out[0], out[5], out[8], out[9]] = [1 / seen[0], 1 / seen[1], 0, 0];
  return out;
}

/** Everything outside of the narrow view, in the frame of the head. */
export function mask(ink: Colour): Shapes {
  const shapes = new Shapes();
  const [x, y] = NARROW;
  const at = (right: number, up: number): Vec3 => [right * MASK_M, up * MASK_M, -MASK_M];
  const part = (x0: number, y0: number, x1: number, y1: number): void =>
    shapes.quad(at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1), ink);
  part(-WIDE, y, WIDE, WIDE);
  part(-WIDE, -WIDE, WIDE, -y);
  part(-WIDE, -y, -x, y);
  part(x, -y, WIDE, y);
  return shapes;
}
