// Figures over time that the server keeps: the last quarter of an hour, hour or day.
import { untrack } from 'svelte';
import { poll } from '../parts';
import type { Api, HistoryPage } from '../wire';
import { longSpan, t, trouble } from '../words';
import { CHARTS, gridOf, type Grid } from './series';
import type { ChartsShown } from './shown';

/** How far back, in which steps, and how often it is asked for, seconds. */
const SPANS = [
  { span_s: 900, step_s: 30, every_s: 5 },
  { span_s: 3_600, step_s: 60, every_s: 10 },
  { span_s: 86_400, step_s: 600, every_s: 30 },
] as const;

class Spans {
  readonly words = SPANS.map(({ span_s }) => longSpan(span_s));
  chosen = $state(0);

  get span(): (typeof SPANS)[number] {
    return SPANS[this.chosen] ?? SPANS[0];
  }
}

export class LiveCharts implements ChartsShown {
  readonly title = t('charts.title');
  readonly charts = CHARTS;
  readonly moment = null;
  readonly onGo = undefined;
  readonly spans = new Spans();
  wrong = $state.raw<string | null>(null);
  #page = $state.raw<HistoryPage | null>(null);
  #api: Pick<Api, 'history'>;

  constructor(api: Pick<Api, 'history'>) {
    this.#api = api;
  }

  grid = $derived.by((): Grid | null => {
    const page = this.#page;
    if (!page) return null;
    // Until the answer for another span is here, the page is of the one before.
    const of = SPANS.find((s) => s.step_s === page.step_s) ?? this.spans.span;
    return gridOf(page, of.span_s);
  });

  get arm(): string | null {
    return this.#page?.arm ?? null;
  }

  get instead(): string {
    return t(this.wrong === null ? 'loading' : 'charts.nothing');
  }

  keep(): () => void {
    const { span_s, step_s, every_s } = this.spans.span;
    return poll(async (over) => {
      // The server's clock says when now is; a recording has a clock of its own.
      const newest = untrack(() => this.#page?.to);
      const from = newest === undefined ? {} : { from: new Date(Date.parse(newest) - 1_000 * span_s).toISOString() };
      const answer = await this.#api.history({ ...from, step: String(step_s) });
      if (over()) return null;
      if (answer.kind === 'ok') this.#page = answer.value;
      this.wrong = trouble(answer);
      return newest === undefined && answer.kind === 'ok' ? 0 : 1_000 * every_s;
    });
  }
}
