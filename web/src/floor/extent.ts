// How much of the page the map takes: its part beside the panels, all of it, or all of it with large figures, on a
// wall.
export type Extent = 'part' | 'full' | 'wall';
