// Why a robot waited in the past, from the words of the frames alone: so it works for a file without a server, too.
import { doing, said, t } from '../words';
import { row, type Mirror, type Robot } from '../wire';

/** One link of a chain: a robot, and what it waits for or does, in words. */
export interface Link {
  readonly who: string;
  readonly text: string;
}

/** From a robot that waits to the root, as far as the words of the frame lead; empty where it does not wait. */
export function chainOf(mirror: Mirror, id: string): Link[] {
  const chain: Link[] = [];
  const met = new Set<string>();
  for (let robot = row(mirror.robots, id); robot && !met.has(robot.id); robot = namedIn(robot.why, mirror)) {
    met.add(robot.id);
    if (chain.length === 0 && robot.why === null) return [];
    chain.push({ who: robot.id, text: robot.why !== null ? said(robot.why) : (robot.speed > 0.01 ? t('why.was.drives') : doing(robot.doing)) });
  }
  return chain;
}

/** The robot that words name. */
function namedIn(words: string | null, mirror: Mirror): Robot | undefined {
  const names = words?.split(/[\s,;:]+/) ?? [];
  return names.map((name) => row(mirror.robots, name)).find((found) => found !== undefined);
}
