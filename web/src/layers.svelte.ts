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
    const ask = async (): Promise<void> => {
      // Nobody but the server knows its clock; what it shows is at most this old.
      const from = period === 3_600 ? {} : { from: new Date(Date.now() - 1_000 * period).toISOString() };
      const answer = await this.#api.heat(kind, from);
      if (left) return;
      if (answer.kind === 'ok') {
        const { cells, borders } = cellsOf(answer.value);
        [this.cells, this.borders, this.from] = [cells, borders, answer.value.from];
      }
      this.trouble = trouble(answer);
      timer = setTimeout(() => void ask(), EVERY_MS);
    };
    void ask();
    return () => {
      left = true;
      clearTimeout(timer);
    };
  }
}
