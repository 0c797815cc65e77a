// The past: reels (what the live feed said, on file or kept by a server), and the player that makes mirrors of them.
// It knows no panel of another room; the other rooms take from a replay what they show.
export { type Recording } from './recording';
export { type Listed, type Frame } from './frames';
export { replayRoute } from './route';
export { Replay } from './replay.svelte';
export { after, seek, type Shown } from './seek';
export { type Span } from './spans';
export type { Source } from './source';
export { BELOW_KEYS, type Below, type Then } from './below';
