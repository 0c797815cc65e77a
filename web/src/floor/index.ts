// The floor: the map that is drawn, what on it is pointed at, chosen or sketched, and the layers over it. `scene/` says
// what is where, `paint/` how it looks; both are inside, and no other room reaches them.
export type { Extent } from './extent';
export { foundJob, namesOn, type Found } from './find';
export { Pad } from './pad.svelte';
export { Pointing } from './pointing.svelte';
export { LOW_BATTERY } from './scene/scene';
export { around, headingOf } from './scene/sketch';
export { placeNear } from './scene/places';
export { PICKED_KINDS, type Picked } from './scene/picked';
export type { Drawing } from './scene/sketch';
export type { See, Stream } from './stream';
