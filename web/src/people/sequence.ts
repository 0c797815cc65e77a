// What somebody has most probably been up to, as lines with a time each. Pure.
import { placeNear } from '../floor';
import type { Episode, MapNode } from '../wire';
import { t, timeOfDay, wordsBy } from '../words';

const STATES = wordsBy<Exclude<Episode['state'], 'goal'>>({
  undecided: 'chances.undecided',
  elsewhere: 'chances.elsewhere',
});

export interface Line {
  readonly since: string;
  readonly text: string;
}

/** The newest first, so many at most. */
export function sequenceLines(all: readonly Episode[], places: readonly MapNode[], most = 6): Line[] {
  const text = ({ state, x, y }: Episode): string => {
    if (state !== 'goal') return STATES[state] ?? state;
    return x === null || y === null
      ? t('sequence.to.gone')
      : t('sequence.to', { place: placeNear(places, x, y) ?? '?' });
  };
  return all
    .slice(-most)
    .toReversed()
    .map((e) => ({ since: timeOfDay(e.since), text: text(e) }));
}
