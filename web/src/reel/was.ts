// What pictures of the past say beyond the floor: who held which places when, what jobs were under way, and who waited
// for whom. It reads pictures only, so it does for a file without a server as well.
import { doing } from '../format';
import { BACK_S } from '../gantt';
import { row, type Mirror } from '../mirror';
import type { FloorMap, Hold, Robot, Strip } from '../wire';
import type { Shot } from './reel';
import { seek, type Shown } from './seek';

/** A longer time without a picture is no hold. */
const GAP_S = 1;

/** One link of a chain: who, and what it waits for or does, in words. */
export interface Link {
  readonly who: string;
  readonly text: string;
  /** Nobody behind it: what everything depends on. */
  readonly root: boolean;
}

/** From a robot that waits to the root, as far as the words of the picture lead; empty where it does not wait. */
export function chainOf(mirror: Mirror, id: string): Link[] {
  const chain: Link[] = [];
  const met = new Set<string>();
  for (let robot = row(mirror.robots, id); robot && !met.has(robot.id); robot = namedIn(robot.why, mirror)) {
    met.add(robot.id);
    if (chain.length === 0 && robot.why === null) return [];
    chain.push({ who: robot.id, text: robot.why ?? (robot.speed > 0.01 ? 'drives on and leaves it free' : doing(robot.doing)), root: false });
  }
  return chain.map((link, i) => ({ ...link, root: i === chain.length - 1 }));
}

/** The robot that words name. */
function namedIn(words: string | null, mirror: Mirror): Robot | undefined {
  const names = words?.split(/[\s,;:]+/) ?? [];
  return names.map((name) => row(mirror.robots, name)).find((found) => found !== undefined);
}

/** Robots with a job, by the number of the job. */
export function jobsUnderWay(mirror: Mirror): Robot[] {
  const number = (r: Robot) => Number(/\d+$/.exec(r.job ?? '')?.[0] ?? 0);
  return mirror.robots.rows.filter((r) => r.job !== null).sort((a, b) => number(a) - number(b));
}

interface Open {
  hold: Hold;
  last: number;
}

/** Who held the places of an area around `t`, from pictures: seconds from `t`, as far as there are any. */
export function heldAround(shots: readonly Shot[], map: FloorMap, area: readonly number[], t: number, ahead: number): Strip[] {
  const [x0 = 0, y0 = 0, x1 = 0, y1 = 0] = area;
  const strips = new Map<number, Strip>();
  map.nodes.forEach((n, i) => {
    if (n.x >= x0 && n.x <= x1 && n.y >= y0 && n.y <= y1) strips.set(i, { id: n.id, x: n.x, y: n.y, holds: [], conditions: [] });
  });
  const open = new Map<string, Open>();
  const note = (node: number, by: string, granted: boolean, at: number): void => {
    const strip = strips.get(node);
    if (!strip) return;
    const key = `${node} ${by} ${granted}`;
    const known = open.get(key);
    if (known && at - known.last <= GAP_S) {
      known.hold.to_s = at - t;
      known.last = at;
      return;
    }
    const hold: Hold = { by, kind: 'robot', from_s: at - t, to_s: at - t, granted, conflict: false };
    open.set(key, { hold, last: at });
    strip.holds.push(hold);
  };
  let shown: Shown | null = seek(shots, t - BACK_S, null);
  for (const shot of shots) {
    if (shot.at < t - BACK_S || shot.at > t + ahead || shot.kind === 'key') continue;
    shown = seek(shots, shot.at, shown);
    for (const robot of shown?.mirror.robots.rows ?? []) {
      robot.granted.forEach((node) => note(node, robot.id, true, shot.at));
      robot.held.forEach((node) => { if (!robot.granted.includes(node)) note(node, robot.id, false, shot.at); });
    }
  }
  // What was only promised, to one after the other, lies below where somebody was.
  strips.forEach((strip) => strip.holds.sort((a, b) => Number(a.granted) - Number(b.granted)));
  return [...strips.values()];
}
