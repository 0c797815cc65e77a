// What on the floor is pointed at, and what is chosen.
import type { Picked } from './scene/picked';

export class Pointing {
  chosen = $state.raw<Picked | null>(null);
  hovered = $state.raw<Picked | null>(null);

  /** What the card is about: what is chosen stays, whatever the pointer passes. */
  get picked(): Picked | null {
    return this.chosen ?? this.hovered;
  }
}
