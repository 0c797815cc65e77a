// What can be shown below the floor, of the present and of the past.
import { wordsBy } from '../words';

export const BELOW_KEYS = {
  jobs: 'jobs',
  robots: 'robots',
  timelines: 'timelines',
  charts: 'charts',
  encounters: 'encounters',
} as const;
export type Below = keyof typeof BELOW_KEYS;
/** What is shown below the scrubber: nothing, so that the floor is large, or more of what was. */
export type Then = 'floor' | Below;
export const BELOW = wordsBy<Below>(BELOW_KEYS);
