// How many robots are at what, and for how long the first of them. Pure.
import { ACTIVITIES, activityOf, ageOf, type Activity, type Mirror } from '../wire';

export interface ActivityCount {
  readonly activity: (typeof ACTIVITIES)[number];
  readonly robots: number;
  /** For how long the one has been at it that has been the longest; null where no robot is, or where that is not
   *  known. */
  readonly longest_s: number | null;
}

/** One entry for everything that robots can be at, in the order of the list. */
export function countsOf(mirror: Pick<Mirror, 'robots' | 'time_s' | 'started'>): ActivityCount[] {
  const sums = new Map<Activity, { robots: number; longest_s: number | null }>();
  for (const robot of mirror.robots.rows) {
    const activity = activityOf(robot);
    const sum = sums.get(activity) ?? { robots: 0, longest_s: null };
    const age = ageOf(mirror, robot);
    sums.set(activity, {
      robots: sum.robots + 1,
      longest_s: age === null ? sum.longest_s : Math.max(sum.longest_s ?? 0, age),
    });
  }
  return ACTIVITIES.map((activity) => ({ activity, ...(sums.get(activity) ?? { robots: 0, longest_s: null }) }));
}
