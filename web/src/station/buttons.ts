// The buttons below the rack, each with its key.
import { make } from '../parts';
import { leftOf, litOf } from './lines';
import type { Line, Station } from './state';
import { t, type Key } from './words';

export type Act = 'done' | 'plus' | 'short' | 'undo' | 'pause' | 'release';

/** What keys do; letters are those of the English words on every keyboard. */
const KEYS: Readonly<Record<string, Act>> = {
  Enter: 'done',
  ' ': 'done',
  '+': 'plus',
  M: 'short',
  U: 'undo',
  P: 'pause',
};
export const actOf = (key: string): Act | null => KEYS[key.toUpperCase()] ?? KEYS[key] ?? null;

/** What can be done now. */
export function possible(station: Station, undo: Line | null): Readonly<Record<Act, boolean>> {
  const { visit } = station;
  const lit = litOf(visit);
  const isFree = visit !== null && visit.lines.length === 0;
  return {
    done: lit !== null || isFree,
    plus: lit !== null && leftOf(lit) > 1,
    short: lit !== null,
    undo: undo !== null,
    pause: true,
    release: visit !== null && !isFree,
  };
}

export class Buttons {
  readonly row = make('div', { className: 'acts', role: 'group', ariaLabel: t('act.all') });
  #all = new Map<Act, { button: HTMLButtonElement; words: HTMLElement }>();

  constructor(onAct: (act: Act) => void) {
    const keys: readonly (readonly [Act, Key | null])[] = [
      ['done', 'key.done'],
      ['plus', 'key.plus'],
      ['short', 'key.short'],
      ['undo', 'key.undo'],
      ['pause', 'key.pause'],
      ['release', null],
    ];
    for (const [act, key] of keys) {
      const words = make('span', { textContent: t(`act.${act}`) });
      const button = make('button', { type: 'button', className: act === 'done' ? 'main' : '' }, words);
      if (key) button.append(make('kbd', { textContent: t(key) }));
      button.dataset['act'] = act;
      button.addEventListener('click', (event) => {
        // After a finger or a mouse the focus would stay here, and the next Enter would press this button again.
        if (event.detail > 0) button.blur();
        onAct(act);
      });
      this.#all.set(act, { button, words });
      this.row.append(button);
    }
  }

  show(station: Station | null, undo: Line | null, isOld: boolean): void {
    const can = station && !isOld ? possible(station, undo) : null;
    for (const [act, { button, words }] of this.#all) {
      const label = this.#label(act, station, undo);
      if (words.textContent !== label) words.textContent = label;
      button.disabled = !can?.[act];
    }
  }

  #label(act: Act, station: Station | null, undo: Line | null): string {
    if (act === 'undo' && undo) return t('act.undo.line', { slot: undo.slot });
    if (act === 'pause' && station && station.paused !== null) return t('act.resume');
    return t(`act.${act}`);
  }
}

/** Asks once before a rack with lines is let go; whether it shall be. */
export function askRelease(host: HTMLElement, rack: string, lines: number): Promise<boolean> {
  const yes = make('button', { textContent: t('release.yes') });
  const no = make('button', { className: 'main', textContent: t('release.no') });
  const heading = make('h2', { id: 'release', textContent: t('release.heading', { rack }) });
  const text = make('p', { textContent: t('release.text', { lines }) });
  const dialog = make('dialog', {}, heading, text, make('div', { className: 'row' }, yes, no));
  dialog.setAttribute('aria-labelledby', heading.id);
  host.append(dialog);
  return new Promise((answer) => {
    yes.addEventListener('click', () => dialog.close('yes'));
    no.addEventListener('click', () => dialog.close());
    dialog.addEventListener('close', () => {
      dialog.remove();
      answer(dialog.returnValue === 'yes');
    });
    dialog.showModal();
    // Whoever presses Enter without reading keeps the rack, and so does a scanner.
    no.focus();
  });
}
