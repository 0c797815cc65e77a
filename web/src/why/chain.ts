// Why a robot waited in the past, from the reasons in the frames alone: so it works for a file without a server, too.
import { doing, said, t } from '../words';
import { row, type Mirror, type Robot, type SentenceArg } from '../wire';

/** One link of a chain: a robot, and what it waits for or does, in words. */
export interface Link {
  readonly who: string;
  readonly text: string;
}

/** From a robot that waits to the root, as far as the reasons in the frame lead; empty where it does not wait. */
export function chainOf(mirror: Mirror, id: string): Link[] {
  const chain: Link[] = [];
  const met = new Set<string>();
  for (let robot = row(mirror.robots, id); robot && !met.has(robot.id); robot = namedIn(robot.why, mirror)) {
    met.add(robot.id);
    if (chain.length === 0 && robot.why === null) return [];
    chain.push({
      who: robot.id,
      text: robot.why !== null ? said(robot.why) : robot.speed > 0.01 ? t('why.was.drives') : doing(robot.doing),
    });
  }
  return chain;
}

/** The robot that a reason names. */
function namedIn(why: Robot['why'], mirror: Mirror): Robot | undefined {
  // Recordings of earlier versions have words alone.
  const names =
    typeof why === 'string' ? why.split(/[\s,;:]+/) : why === null ? [] : textsIn(Object.values(why.args ?? {}));
  return names.map((name) => row(mirror.robots, name)).find((found) => found !== undefined);
}

/** The texts in the places of a sentence, and of sentences within it. */
const textsIn = (args: readonly SentenceArg[]): string[] =>
  args.flatMap((arg) =>
    typeof arg === 'string'
      ? [arg]
      : typeof arg === 'number'
        ? []
        : textsIn('text' in arg ? Object.values(arg.args ?? {}) : arg),
  );
