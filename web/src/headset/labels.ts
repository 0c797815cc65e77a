// Names that stand near each other: each gets a place of its own, so that none covers another. Pure.

/** An area of a picture. */
export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}
const meet = (a: Box, b: Box): boolean =>
  a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;

/** The first place of each name's wishes that is still free, the most important name first; null where none is. */
export function placed(names: readonly (readonly Box[])[], taken: readonly Box[] = []): (Box | null)[] {
  const full = [...taken];
  return names.map((wishes) => {
    const free = wishes.find((wish) => !full.some((box) => meet(wish, box))) ?? null;
    if (free) full.push(free);
    return free;
  });
}

/** Where a name may stand around a thing of a radius: below, above, to the right, to the left, then further away. */
export function around([x, y]: readonly [number, number], radius: number, width: number, height: number): Box[] {
  const beside = (away: number): Box[] => [
    { x: x - width / 2, y: y + away, width, height },
    { x: x - width / 2, y: y - away - height, width, height },
    { x: x + away, y: y - height / 2, width, height },
    { x: x - away - width, y: y - height / 2, width, height },
  ];
  return [...beside(radius), ...beside(radius + height)];
}

/** A name in the room, seen from the eyes: radians, to the left and up. */
export interface Bearing {
  left: number;
  up: number;
}
const turn = (angle: number): number => Math.atan2(Math.sin(angle), Math.cos(angle));

/** By how much each name is lifted so that none covers another: radians, the nearest first and not at all. */
export function lifts(names: readonly Bearing[], width: number, height: number): number[] {
  const done: Bearing[] = [];
  return names.map(({ left, up }) => {
    const beside = done.filter((other) => Math.abs(turn(other.left - left)) < width);
    let free = up;
    // Each one in the way lifts it over itself; there are no more than there are names.
    for (let again = true; again;) {
      const under = beside.find((other) => Math.abs(other.up - free) < height);
      again = under !== undefined;
      if (under) free = under.up + height;
    }
    done.push({ left, up: free });
    return free - up;
  });
}
