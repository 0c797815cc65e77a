// What lies on the floor besides what is there: forecasts, and where robots waited or met people. Fetches maps of
// heat while one is shown; forecasts come with the live feed.
import { trouble, type Api } from './api';
import { cellsOf, type Cell } from './heatmap';
import type { HeatKind } from './wire';

const EVERY_MS = 10_000;
export const PERIODS = [{ word: 'last hour', s: 3_600 }, { word: 'last day', s: 86_400 }] as const;
/** Which moments ahead are drawn: one of them, or all, one over the other. */
export const AHEADS = ['all', 'none', 1, 2, 4] as const;

export class Layers {
  heat = $state<HeatKind | 'none'>('none');
  period = $state<number>(PERIODS[0].s);
  ahead = $state<(typeof AHEADS)[number]>('all');
  cells = $state.raw<readonly Cell[]>([]);
  borders = $state.raw<readonly number[]>([]);
  /** From when on it is added up. */
  from = $state.raw<string | null>(null);
  trouble = $state.raw<string | null>(null);
  #api: Api;

  constructor(api: Api) {
    this.#api = api;
  }

  /** Keeps the map of heat fresh; to be called in an effect, returns what ends it. */
  keep(): () => void {
    const [kind, period] = [this.heat, this.period];
    if (kind === 'none') {
      this.cells = [];
      return () => {};
    }
    let left = false;
    let timer: ReturnType<typeof setTimeout> | undefined;
    let newest: string | null = null;
    const ask = async (): Promise<void> => {
      // The server's clock says when now is; a recording has a clock of its own. Who does not say gets an hour.
      const from = newest === null ? {} : { from: new Date(Date.parse(newest) - 1_000 * period).toISOString() };
      const answer = await this.#api.heat(kind, from);
      if (left) return;
      const first = newest === null && answer.kind === 'ok' && period !== PERIODS[0].s;
      if (answer.kind === 'ok') {
        const { cells, borders } = cellsOf(answer.value);
        [this.cells, this.borders, this.from] = [cells, borders, answer.value.from];
        newest = answer.value.to;
      }
      this.trouble = trouble(answer);
      timer = setTimeout(() => void ask(), first ? 0 : EVERY_MS);
    };
    void ask();
    return () => {
      left = true;
      clearTimeout(timer);
    };
  }
}
