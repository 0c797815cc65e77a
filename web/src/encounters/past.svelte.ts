// The encounters in sight on the scrubber, from their bookmarks: each leads there.
import type { Replay } from '../replay';
import type { Encounter } from '../wire';
import { count, moment } from '../words';
import { metIn } from './met';
import type { Again, EncountersShown } from './shown';

export class PastEncounters implements EncountersShown {
  readonly title = 'Encounters in the time range: a robot entered region 1 of a person';
  readonly wrong = null;
  readonly csv = null;
  readonly older = null;
  worker = $state('');
  robot = $state('');
  #replay: Replay;
  #met = $derived.by(() => {
    const { marks, left, right, recording } = this.#replay;
    return metIn(marks.filter((m) => m.at_s >= left && m.at_s <= right), recording.start);
  });

  constructor(replay: Replay) {
    this.#replay = replay;
  }

  get items(): readonly Encounter[] {
    return this.#met.items;
  }

  get none(): string {
    return this.#met.bare > 0 ? 'No details are known.' : 'No encounters in this time range.';
  }

  get note(): string | null {
    const { bare } = this.#met;
    const which = bare === 1 ? 'One encounter was' : `${count(bare)} encounters were`;
    return bare === 0 ? null : `${which} recorded by an older version, which kept no details; see the bookmarks.`;
  }

  when(e: Encounter): string {
    return moment(this.#replay.recording.start, this.#met.marks[e.id]?.at_s ?? 0);
  }

  again(e: Encounter): Again {
    const mark = this.#met.marks[e.id];
    return { kind: 'go', go: () => { if (mark) this.#replay.goTo(mark); } };
  }

  keep(): () => void {
    return () => {};
  }
}
