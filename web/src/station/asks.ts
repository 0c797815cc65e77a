// The question about the piece that nobody has seen in its tote when its rack left. Most pieces are seen there a moment
// later, so the question waits for that.
import { make } from '../parts';
import { leftOf } from './lines';
import type { Change } from './server';
import type { Station } from './state';
import { t } from './words';

/** So long a piece is expected to be on its way to its tote. */
const ON_ITS_WAY_MS = 1_000;

export class Asks {
  readonly box = make('div', { className: 'asks', role: 'status', hidden: true });
  #shown = '';
  #key = '';
  #since = 0;

  constructor(private readonly onAnswer: (change: Change) => void) {}

  show({ unconfirmed }: Pick<Station, 'unconfirmed'>, now: number): void {
    const key = unconfirmed ? `${unconfirmed.job} ${unconfirmed.line.n}` : '';
    if (key !== this.#key) [this.#key, this.#since] = [key, now];
    this.box.hidden = !unconfirmed || now - this.#since < ON_ITS_WAY_MS;
    const shown = JSON.stringify(unconfirmed);
    if (!unconfirmed || shown === this.#shown) return;
    this.#shown = shown;
    const { slot, tote } = unconfirmed.line;
    const count = leftOf(unconfirmed.line);
    const button = (words: string, change: Change): HTMLButtonElement => {
      const made = make('button', { type: 'button', textContent: words });
      made.addEventListener('click', (event) => {
        if (event.detail > 0) made.blur();
        this.onAnswer(change);
      });
      return made;
    };
    this.box.replaceChildren(
      make('span', { textContent: t('asks', { count, slot, tote }) }),
      button(t('asks.yes'), { done: count }),
      button(t('asks.no'), { short: true }),
    );
  }
}
