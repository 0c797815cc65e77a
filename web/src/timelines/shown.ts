// What the panel of timelines shows: of the present, asked of the server, or of the past, read from frames.
import type { Replay, Source } from '../replay';
import type { Api, FloorMap, Timelines } from '../wire';
import { trouble } from '../words';
import { BACK_S } from './gantt';
import { HeldThen, type Around } from './held';

/** An area: x0, y0, x1, y1. */
export type Area = readonly number[];
export interface Held {
  /** Null where there is nothing to show instead of what is shown: it is coming. */
  readonly seen: Timelines | null;
  readonly wrong: string | null;
  /** When to ask again, milliseconds; null if the same area would be refused again. */
  readonly pause_ms: number | null;
}
export interface TimelinesShown {
  readonly tense: 'now' | 'then';
  /** What holds the places of an area, so many seconds ahead. */
  ask(area: Area, ahead: number): Promise<Held>;
}

const EVERY_MS = 1_000;

export function timelinesOf(source: Source<'timelines'>, map: FloorMap | null): TimelinesShown {
  if (source.tense === 'now') return { tense: 'now', ask: (area, ahead) => askNow(source.api, area, ahead) };
  const past = new PastTimelines(source.replay);
  return {
    tense: 'then',
    ask: (area, ahead) => {
      const seen = map && past.around(map, area, ahead);
      return Promise.resolve({ seen, wrong: null, pause_ms: seen?.whole === false ? 0 : EVERY_MS });
    },
  };
}

async function askNow(api: Pick<Api, 'timelines'>, area: Area, ahead: number): Promise<Held> {
  const answer = await api.timelines(area, ahead);
  const nothing: Timelines = { at: '', ahead_s: ahead, nodes: [] };
  // What was refused is not shown as it was before.
  const seen = answer.kind === 'ok' ? answer.value : answer.kind === 'refused' ? nothing : null;
  return {
    seen,
    wrong: trouble(answer),
    pause_ms: answer.kind === 'refused' && answer.problem.status === 422 ? null : EVERY_MS,
  };
}

/** Timelines around the moment that a replay shows. */
export class PastTimelines {
  #replay: Pick<Replay, 'recording' | 't'>;
  #held = new HeldThen();
  /** What was said last: the same again while nothing changes. */
  #told: (Timelines & Around & { asked: readonly unknown[] }) | null = null;

  constructor(replay: Pick<Replay, 'recording' | 't'>) {
    this.#replay = replay;
  }

  /** What held the places of an area around the moment, and whether that is all; null while frames are fetched. */
  around(map: FloorMap, area: Area, ahead: number): (Timelines & Pick<Around, 'whole'>) | null {
    const { recording, t } = this.#replay;
    if (!recording.frames(t)) return null;
    const frames = recording.between(t - BACK_S, t + ahead);
    const asked = [frames, map, t, ahead, ...area];
    if (!this.#told?.whole || this.#told.asked.some((one, i) => one !== asked[i])) {
      this.#told = { asked, at: '', ahead_s: ahead, ...this.#held.around(frames, map, area, t, ahead) };
    }
    return this.#told;
  }
}
