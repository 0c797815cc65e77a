// The camera over the floor: pure arithmetic between metres (y up) and CSS pixels (y down).
export interface View {
  /** Metres in the middle of the picture. */
  x: number;
  y: number;
  /** Pixels per metre. */
  scale: number;
  width: number;
  height: number;
}
export type Bounds = readonly [x0: number, y0: number, x1: number, y1: number];

const LARGEST_SCALE = 160;
const FIT_MARGIN_PX = 14;
/** Kept free below the floor for the legend. */
const FOOT_PX = 52;

export function fit(bounds: Bounds, width: number, height: number): View {
  const [x0, y0, x1, y1] = bounds;
  const across = Math.max(40, width - 2 * FIT_MARGIN_PX) / Math.max(1, x1 - x0);
  const upright = Math.max(40, height - 2 * FIT_MARGIN_PX - FOOT_PX) / Math.max(1, y1 - y0);
  const scale = Math.min(across, upright, LARGEST_SCALE);
  return { x: (x0 + x1) / 2, y: (y0 + y1) / 2 - FOOT_PX / 2 / scale, scale, width, height };
}

export const toScreen = (v: View, x: number, y: number): [number, number] =>
  [(x - v.x) * v.scale + v.width / 2, (v.y - y) * v.scale + v.height / 2];

export const toWorld = (v: View, px: number, py: number): [number, number] =>
  [(px - v.width / 2) / v.scale + v.x, v.y - (py - v.height / 2) / v.scale];

export function pan(v: View, dx: number, dy: number, bounds: Bounds): View {
  return within({ ...v, x: v.x - dx / v.scale, y: v.y + dy / v.scale }, bounds);
}

/** Zooms so that the metre under (px, py) stays under it. */
export function zoomAt(v: View, factor: number, px: number, py: number, bounds: Bounds): View {
  const smallest = fit(bounds, v.width, v.height).scale * 0.6;
  const scale = Math.min(LARGEST_SCALE, Math.max(smallest, v.scale * factor));
  const [wx, wy] = toWorld(v, px, py);
  const x = wx - (px - v.width / 2) / scale;
  const y = wy + (py - v.height / 2) / scale;
  return within({ ...v, x, y, scale }, bounds);
}

/** Keeps the middle of the picture on the floor, so that nobody loses the floor out of sight. */
function within(v: View, [x0, y0, x1, y1]: Bounds): View {
  return { ...v, x: Math.min(x1, Math.max(x0, v.x)), y: Math.min(y1, Math.max(y0, v.y)) };
}
