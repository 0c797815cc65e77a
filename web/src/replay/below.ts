// What can be shown below the floor, of the present and of the past.

export const BELOW = { jobs: 'Jobs', robots: 'Robots', timelines: 'Timelines', charts: 'Charts', encounters: 'Encounters' } as const;
export type Below = keyof typeof BELOW;
