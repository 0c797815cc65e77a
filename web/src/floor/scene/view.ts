// The camera over the floor: pure arithmetic between metres (y up) and CSS pixels (y down).
export interface View {
  /** Metres in the middle of the picture. */
  x: number;
  y: number;
  /** Pixels per metre. */
  scale: number;
  width: number;
  height: number;
  /** A quarter turn: what is up on the map is to the right, so that a long floor uses a picture that lies the other
   *  way. */
  turned?: boolean;
}
export type Bounds = readonly [x0: number, y0: number, x1: number, y1: number];

/** A name that belongs to a place and is written above it. */
export interface FixedName {
  x: number;
  y: number;
  /** Half its width, pixels. */
  half_px: number;
  /** How far it reaches above the place: so many metres and so many pixels. */
  up_m: number;
  up_px: number;
}

const LARGEST_SCALE = 160;
const FIT_MARGIN_PX = 8;
/** Marks of places at the edge, a station at most, reach so far beyond it. */
const EDGE_M = 0.65;
/** Kept free below the floor for the folded legend. */
export const FOOT_PX = 52;
/** At the right edge, for the buttons; above the floor, for the field, but only where there is room left. */
const TOOLS_PX = 46;
const HEAD_PX = 44;
/** Between a name and the edge of the picture. */
const NAME_GAP_PX = 4;
/** Names may take this share of the picture on each side: a small screen is for the floor. */
const MOST_FOR_NAMES = 0.2;
/** The margins depend on the scale and the scale on the margins; after so many rounds they agree to a pixel. */
const ROUNDS = 4;

/** The floor is turned where that makes it larger by this, and not for less: people know their hall one way up. */
const WORTH_TURNING = 1.1;

/** Metres on the map as metres to the right and up on the picture. */
export const onPicture = ({ turned }: Pick<View, 'turned'>, dx: number, dy: number): [right: number, up: number] =>
  turned ? [dy, -dx] : [dx, dy];
/** And back. */
export const onMap = ({ turned }: Pick<View, 'turned'>, right: number, up: number): [dx: number, dy: number] =>
  turned ? [-up, right] : [right, up];

/** The whole floor with the names at its edge, above `foot` pixels that are left free; turned if it is much larger
 *  so. */
export function fit(
  bounds: Bounds,
  width: number,
  height: number,
  names: readonly FixedName[] = [],
  foot = FOOT_PX,
): View {
  const upright = fitUpright(bounds, width, height, names, foot);
  const turn = { turned: true };
  const [left, top] = onPicture(turn, bounds[0], bounds[1]);
  const [right, bottom] = onPicture(turn, bounds[2], bounds[3]);
  const moved = names.map((name): FixedName => {
    const [x, y] = onPicture(turn, name.x, name.y);
    return { ...name, x, y };
  });
  const other = fitUpright([left, bottom, right, top], width, height, moved, foot);
  if (other.scale < upright.scale * WORTH_TURNING) return upright;
  const [x, y] = onMap(turn, other.x, other.y);
  return { ...other, x, y, turned: true };
}

function fitUpright(bounds: Bounds, width: number, height: number, names: readonly FixedName[], foot: number): View {
  const [x0, y0, x1, y1] = [bounds[0] - EDGE_M, bounds[1] - EDGE_M, bounds[2] + EDGE_M, bounds[3] + EDGE_M];
  let [left, right, top] = [FIT_MARGIN_PX, TOOLS_PX, FIT_MARGIN_PX];
  let scale = LARGEST_SCALE;
  for (let round = 0; round < ROUNDS; round++) {
    const across = Math.max(40, width - left - right) / Math.max(1, x1 - x0);
    const upright = Math.max(40, height - top - FIT_MARGIN_PX - foot) / Math.max(1, y1 - y0);
    scale = Math.min(across, upright, LARGEST_SCALE);
    const room = (most: number, wanted: number[], least = FIT_MARGIN_PX): number =>
      Math.max(least, Math.min(most, Math.max(0, ...wanted) + NAME_GAP_PX));
    left = room(
      MOST_FOR_NAMES * width,
      names.map((n) => n.half_px - (n.x - x0) * scale),
    );
    right = room(
      MOST_FOR_NAMES * width,
      names.map((n) => n.half_px - (x1 - n.x) * scale),
      TOOLS_PX,
    );
    top = room(
      MOST_FOR_NAMES * height,
      names.map((n) => n.up_px + n.up_m * scale - (y1 - n.y) * scale),
    );
  }
  top += Math.min(HEAD_PX, Math.max(0, height - top - FIT_MARGIN_PX - foot - (y1 - y0) * scale));
  return {
    x: (x0 + x1) / 2 - (left - right) / 2 / scale,
    y: (y0 + y1) / 2 + (top - FIT_MARGIN_PX - foot) / 2 / scale,
    scale,
    width,
    height,
  };
}

export function toScreen(v: View, x: number, y: number): [number, number] {
  const [right, up] = onPicture(v, x - v.x, y - v.y);
  return [right * v.scale + v.width / 2, v.height / 2 - up * v.scale];
}

export function toWorld(v: View, px: number, py: number): [number, number] {
  const [dx, dy] = onMap(v, (px - v.width / 2) / v.scale, (v.height / 2 - py) / v.scale);
  return [v.x + dx, v.y + dy];
}

/** Whether a place, or what reaches so many metres around it, is on the picture. */
export function inSight(v: View, x: number, y: number, reach = 0): boolean {
  const [right, up] = onPicture(v, x - v.x, y - v.y);
  return Math.abs(right) <= v.width / 2 / v.scale + reach && Math.abs(up) <= v.height / 2 / v.scale + reach;
}

export function pan(v: View, px: number, py: number, bounds: Bounds): View {
  const [dx, dy] = onMap(v, -px / v.scale, py / v.scale);
  return within({ ...v, x: v.x + dx, y: v.y + dy }, bounds);
}

/** Zooms so that the metre under (px, py) stays under it. */
export function zoomAt(v: View, factor: number, px: number, py: number, bounds: Bounds): View {
  const smallest = fit(bounds, v.width, v.height).scale * 0.6;
  const scale = Math.min(LARGEST_SCALE, Math.max(smallest, v.scale * factor));
  const [wx, wy] = toWorld(v, px, py);
  const [dx, dy] = onMap(v, (px - v.width / 2) / scale, (v.height / 2 - py) / scale);
  return within({ ...v, x: wx - dx, y: wy - dy, scale }, bounds);
}

/** Keeps the middle of the picture on the floor, so that nobody loses the floor out of sight. */
function within(v: View, [x0, y0, x1, y1]: Bounds): View {
  return { ...v, x: Math.min(x1, Math.max(x0, v.x)), y: Math.min(y1, Math.max(y0, v.y)) };
}
