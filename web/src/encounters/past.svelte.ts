// The encounters in sight on the scrubber, from their bookmarks: each leads there.
import type { Replay } from '../replay';
import type { Encounter } from '../wire';
import { moment, t } from '../words';
import { metIn } from './bookmarked';
import type { Again, EncountersShown } from './shown';

export class PastEncounters implements EncountersShown {
  readonly title = t('encounters.title.then');
  readonly wrong = null;
  readonly csv = null;
  readonly older = null;
  worker = $state('');
  robot = $state('');
  #replay: Replay;
  #met = $derived.by(() => {
    const { marks, left, right, recording } = this.#replay;
    return metIn(
      marks.filter((m) => m.at_s >= left && m.at_s <= right),
      recording.start,
    );
  });

  constructor(replay: Replay) {
    this.#replay = replay;
  }

  get items(): readonly Encounter[] {
    return this.#met.items;
  }

  get none(): string {
    return t(this.#met.bare > 0 ? 'encounters.none.known' : 'encounters.none.then');
  }

  get note(): string | null {
    const { bare } = this.#met;
    return bare === 0 ? null : t('encounters.bare', { count: bare });
  }

  when(e: Encounter): string {
    return moment(this.#replay.recording.start, this.#met.marks[e.id]?.at_s ?? 0);
  }

  again(e: Encounter): Again {
    const mark = this.#met.marks[e.id];
    return {
      kind: 'go',
      go: () => {
        if (mark) this.#replay.goTo(mark);
      },
    };
  }

  keep(): () => void {
    return () => {};
  }
}
