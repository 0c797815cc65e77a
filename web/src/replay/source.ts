// What a panel shows, in one small type: the floor as it is, asked of the server, or as it was, taken from a replay.
// Each room makes of it what its panel needs; the panel itself does not ask which of the two it is.
import type { Api } from '../wire';
import type { Replay } from './replay.svelte';

/** Of the server, a panel may ask only what it names: `Source<'history'>` reaches nothing but figures over time. */
export type Source<Asks extends keyof Api> = { tense: 'now'; api: Pick<Api, Asks> } | { tense: 'then'; replay: Replay };
