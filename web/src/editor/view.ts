// Which part of the floor is in sight. On the sheet y points down, on the floor up.
import { boundsOf, type MapFile } from './file';
import type { Spot } from './edit';

export interface Sight {
  readonly x: number;
  readonly y: number;
  readonly w: number;
  readonly h: number;
}

const MARGIN_M = 2;

/** All of a map, in a window of this shape (height by width). */
export function whole(map: MapFile, shape: number): Sight {
  const { x0, y0, x1, y1 } = boundsOf(map);
  const [wide, high] = [x1 - x0 + 2 * MARGIN_M, y1 - y0 + 2 * MARGIN_M];
  const w = Math.max(wide, high / shape);
  const h = w * shape;
  return { x: (x0 + x1) / 2 - w / 2, y: -(y0 + y1) / 2 - h / 2, w, h };
}

/** Nearer or farther, with one point of the sheet staying where it is. */
export function zoomed(sight: Sight, by: number, at: Spot): Sight {
  const w = Math.min(20_000, Math.max(2, sight.w * by));
  const k = w / sight.w;
  return { x: at.x - (at.x - sight.x) * k, y: at.y - (at.y - sight.y) * k, w, h: sight.h * k };
}

export const middle = ({ x, y, w, h }: Sight): Spot => ({ x: x + w / 2, y: y + h / 2 });

/** With a place of the floor in its middle. */
export const around = (sight: Sight, at: Spot): Sight => ({ ...sight, x: at.x - sight.w / 2, y: -at.y - sight.h / 2 });
