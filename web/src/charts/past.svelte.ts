// Figures of what is in sight on the scrubber, with the moment that is shown.
import { untrack } from 'svelte';
import { poll } from '../parts';
import type { Replay } from '../replay';
import type { Mirror, Sum } from '../wire';
import { roundSpan, t } from '../words';
import type { Grid } from './series';
import type { ChartsShown } from './shown';
import { CHARTS_THEN, gridOfSums, stepOf } from './sums';

const EVERY_MS = 10_000;

export class PastCharts implements ChartsShown {
  readonly charts = CHARTS_THEN;
  readonly spans = null;
  readonly arm = null;
  wrong = $state.raw<string | null>(null);
  #sums = $state.raw<readonly Sum[] | null>(null);
  #replay: Replay;
  #mirror: () => Mirror;
  #step = $derived.by(() => stepOf(this.#replay.right - this.#replay.left));
  // Whole steps, so that an end that grows does not ask for all of it every time.
  #from = $derived.by(() => Math.floor(this.#replay.left / this.#step) * this.#step);
  #to = $derived.by(() => Math.ceil(this.#replay.right / this.#step) * this.#step);

  constructor(replay: Replay, mirror: () => Mirror) {
    this.#replay = replay;
    this.#mirror = mirror;
  }

  grid = $derived.by((): Grid | null => {
    const sums = this.#sums;
    return sums && sums.length > 1 ? gridOfSums(sums, this.#from, this.#to, this.#replay.recording.start) : null;
  });

  /** As often as panels are told. */
  moment = $derived.by(() => {
    void this.#mirror();
    return 1_000 * ((this.#replay.recording.start ?? 0) + untrack(() => this.#replay.t));
  });

  get title(): string {
    return t('charts.title.then', { step: roundSpan(this.#step) });
  }

  get instead(): string {
    if (this.#sums === null) return t(this.wrong === null ? 'loading' : 'charts.nothing');
    return t(this.#sums.length === 1 ? 'charts.too-short' : 'charts.older');
  }

  onGo = (ms: number): void => this.#replay.seek(ms / 1_000 - (this.#replay.recording.start ?? 0));

  keep(): () => void {
    const { recording } = this.#replay;
    const [from, to, step] = [this.#from, this.#to, this.#step];
    return poll(async (over) => {
      const answer = await recording.sums(from, to, step);
      if (over()) return null;
      this.wrong = typeof answer === 'string' ? answer : null;
      if (typeof answer !== 'string') this.#sums = answer;
      return recording.source === 'file' ? null : EVERY_MS;
    });
  }
}
