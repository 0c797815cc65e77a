// What every card has beside its subject.
import type { Line } from './changes';

export interface CardFrame {
  /** Of a thing that is only pointed at, a card comes and goes with the pointer. */
  readonly kept: 'chosen' | 'hovered';
  /** What happened to the thing, newest first. */
  readonly lines: readonly Line[];
  /** Since what was opened that is noted. */
  readonly since: 'page' | 'replay';
  readonly onCentre: () => void;
  readonly onClose: () => void;
}
