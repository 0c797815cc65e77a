// What lies on the floor besides what is there: forecasts, and where robots waited or met people. Fetches maps of
// heat while one is shown; forecasts come with the live feed.
import { untrack } from 'svelte';
import { poll } from '../parts';
import type { Recording, Source } from '../replay';
import type { Api, HeatKind } from '../wire';
import { trouble } from '../words';
import { cellsOf, heatOfPlaces, unusual, type Cell } from './paint/heatmap';

const EVERY_MS = 10_000;
export const PERIODS = [
  { word: 'layers.hour', s: 3_600 },
  { word: 'layers.day', s: 86_400 },
] as const;
/** Which moments ahead are drawn: one of them, or all, one over the other. */
export const LONGEST_S = 4;
export const AHEADS = ['all', 'none', 1, 2, LONGEST_S] as const;

/** What can lie on the floor; `unusual`: where robots waited beyond what is usual there. */
export type HeatLayer = HeatKind | 'unusual' | 'none';
/** What is usual is taken from this long before the period, seconds: so long waiting is kept. */
const BEFORE_S = 86_400;

export class Layers {
  heat = $state<HeatLayer>('none');
  period = $state<number>(PERIODS[0].s);
  ahead = $state<(typeof AHEADS)[number]>('all');
  cells = $state.raw<readonly Cell[]>([]);
  borders = $state.raw<readonly number[]>([]);
  /** From when on it is added up. */
  from = $state.raw<string | null>(null);
  trouble = $state.raw<string | null>(null);
  /** What the cells of the past are of. */
  #cellsOf: HeatLayer = 'none';

  /** Keeps the map of heat fresh, of the present or of what a replay has in sight; to be called in an effect, returns
   *  what ends it. */
  keep(source: Source<'heat'>, from: number, to: number): () => void {
    void this.heat;
    return source.tense === 'now'
      ? this.#keepNow(source.api)
      : untrack(() => this.#keepThen(source.replay.recording, from, to));
  }

  #keepNow(api: Pick<Api, 'heat'>): () => void {
    const [kind, period] = [this.heat, this.period];
    this.#cellsOf = 'none';
    if (kind === 'none') {
      this.cells = [];
      return () => {};
    }
    if (kind === 'unusual') return this.#keepUnusual(api);
    let newest: string | null = null;
    return poll(async (over) => {
      // The server's clock says when now is; a recording has a clock of its own. With no time given, it answers for the
      // last hour.
      const from = newest === null ? {} : { from: new Date(Date.parse(newest) - 1_000 * period).toISOString() };
      const answer = await api.heat(kind, from);
      if (over()) return null;
      const first = newest === null && answer.kind === 'ok' && period !== PERIODS[0].s;
      if (answer.kind === 'ok') {
        const { cells, borders } = cellsOf(answer.value);
        [this.cells, this.borders, this.from] = [cells, borders, answer.value.from];
        newest = answer.value.to;
      }
      this.trouble = trouble(answer);
      return first ? 0 : EVERY_MS;
    });
  }

  /** The last hour against the day before it. */
  #keepUnusual(api: Pick<Api, 'heat'>): () => void {
    return poll(async (over) => {
      const now = await api.heat('waiting', {});
      if (over()) return null;
      this.trouble = trouble(now);
      if (now.kind !== 'ok') return EVERY_MS;
      const { from } = now.value;
      const before = await api.heat('waiting', {
        from: new Date(Date.parse(from) - 1_000 * BEFORE_S).toISOString(),
        to: from,
      });
      if (over()) return null;
      this.trouble = trouble(before);
      if (before.kind !== 'ok') return EVERY_MS;
      const { cells, borders } = cellsOf(unusual(now.value, before.value) ?? { ...now.value, cells: [] });
      [this.cells, this.borders, this.from] = [cells, borders, from];
      return EVERY_MS;
    });
  }

  /** Of seconds of a recording: where robots met people from the bookmarks, where they waited from the server that
   *  recorded it. */
  #keepThen(recording: Recording, from: number, to: number): () => void {
    const kind = this.heat === 'unusual' ? 'none' : this.heat;
    const put = (
      cells: readonly Cell[],
      borders: readonly number[],
      from: string | null,
      wrong: string | null,
    ): void => {
      [this.cells, this.borders, this.from, this.trouble, this.#cellsOf] = [cells, borders, from, wrong, kind];
    };
    // What is there stays until there is something newer, unless it was something else.
    if (kind !== this.#cellsOf) put([], [], null, null);
    if (kind === 'none') return () => {};
    let gone = false;
    if (kind === 'encounters') {
      const met = recording.marks.filter((mark) => mark.kind === 'encounter' && mark.at_s >= from && mark.at_s <= to);
      const places = met.flatMap((mark) => (mark.place ? [mark.place] : []));
      const { cells, borders } = cellsOf({ kind, from: '', to: '', size: 1, cells: heatOfPlaces(places) });
      put(cells, borders, null, null);
    } else {
      void recording.heat(kind, from, to).then((page) => {
        if (gone) return;
        const known = typeof page === 'string' ? null : page;
        const { cells, borders } = known ? cellsOf(known) : { cells: [], borders: [] };
        put(cells, borders, known?.from ?? null, typeof page === 'string' ? page : null);
      });
    }
    return () => {
      gone = true;
    };
  }
}
