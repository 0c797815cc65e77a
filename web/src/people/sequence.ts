// What somebody has most probably been up to, as lines with a time each. Pure.
import { placeNear } from '../floor';
import type { Episode, MapNode } from '../wire';
import { timeOfDay } from '../words';

export interface Line {
  readonly since: string;
  readonly text: string;
}

/** The newest first, so many at most. */
export function sequenceLines(all: readonly Episode[], places: readonly MapNode[], most = 6): Line[] {
  const text = ({ state, x, y }: Episode): string =>
    state !== 'goal' ? state : x === null || y === null ? 'to a place that is no longer on the map' : `to ${placeNear(places, x, y) ?? '?'}`;
  return all.slice(-most).toReversed().map((e) => ({ since: timeOfDay(e.since), text: text(e) }));
}
