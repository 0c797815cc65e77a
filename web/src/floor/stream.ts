// Every mirror as it comes, past the framework: the floor moves between them, panels need no more than four a second.
import type { Mirror } from '../wire';

export type See = (mirror: Mirror, how: 'glide' | 'jump') => void;
export interface Stream {
  /** The newest. */
  latest(): Mirror;
  /** Calls `see` with each that comes from now on; returns what ends it. */
  watch(see: See): () => void;
}
