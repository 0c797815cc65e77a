// What can be shown below the floor, of the present and of the past.
import { wordsBy } from '../words';

export const BELOW_KEYS = { jobs: 'jobs', robots: 'robots', timelines: 'timelines', charts: 'charts', encounters: 'encounters' } as const;
export type Below = keyof typeof BELOW_KEYS;
export const BELOW = wordsBy<Below>(BELOW_KEYS);
