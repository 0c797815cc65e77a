// What the page remembers of the mirrors it saw: the story of each thing, where people were thought to be going, and
// deliveries per hour. After a jump in time it is empty: what happened in between is not known.
import { Story } from '../cards';
import { Chances } from '../people';
import type { MapNode, Mirror } from '../wire';
import { History } from './history';

export class Memory {
  history = new History();
  story = new Story();
  chances = new Chances();

  /** Takes a figure of every mirror. */
  count({ time_s, counters }: Mirror): void {
    this.history.add(time_s, counters.deliveries_per_hour);
  }

  /** Takes a mirror that panels show. */
  note(mirror: Mirror, places: readonly MapNode[]): void {
    this.story.places = places;
    this.story.note(mirror);
    this.chances.note(mirror);
  }

  forget(): void {
    this.history = new History();
    this.story = new Story();
    this.chances = new Chances();
  }
}
