// What can be shown below the floor, of the present and of the past.

export const BELOW = { jobs: 'Jobs', timelines: 'Timelines', charts: 'Charts', encounters: 'Encounters' } as const;
export type Below = keyof typeof BELOW;
