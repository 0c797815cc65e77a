// What both views have in common: the words on the board, the shaking, the light that stays on.
import { metres } from './align';
import { make } from './dom';
import { buzz, type Shown } from './guide';
import type { Wearer } from './wearer';

export class Screen {
  readonly title = make('h1', { className: 'title' });
  readonly detail = make('p', { className: 'detail' });
  readonly banner = make('div', { className: 'banner', role: 'status' }, this.title, this.detail);
  /** What the server says about what it gets, below everything else. */
  readonly note = make('p', { className: 'dim small', role: 'status', hidden: true });
  readonly stop = make('div', { className: 'stop', role: 'alert', hidden: true });
  #kind: Shown['kind'] | null = null;
  #light: WakeLockSentinel | null = null;

  constructor(readonly root: HTMLElement, readonly wearer: Wearer) {
    document.addEventListener('visibilitychange', this.#sight);
    addEventListener('pagehide', this.#hidden);
    void this.#keepLight();
  }

  say(shown: Shown, title: string, detail: string): void {
    const pattern = buzz(this.#kind, shown.kind);
    if (pattern.length > 0) navigator.vibrate?.(pattern);
    this.#kind = shown.kind;
    Object.assign(this.root.dataset, {
      shown: shown.kind, link: this.wearer.feed.kind, marking: this.wearer.marking.kind, sent: String(this.wearer.sent),
      epoch: String(this.wearer.pump.epoch), near: String(shown.near.length), path: String(shown.path.length),
    });
    this.banner.dataset['tone'] = shown.tone;
    write(this.title, title);
    write(this.detail, detail);
    const notice = this.wearer.notice();
    this.note.hidden = notice === null;
    write(this.note, notice === null ? '' : `From the server: ${notice}`);
    if (this.stop.hidden === (shown.kind === 'stop')) {
      this.stop.hidden = shown.kind !== 'stop';
      this.stop.replaceChildren(...(shown.kind === 'stop' ? [make('strong', { textContent: 'STOP' }), make('span', { className: 'why' })] : []));
    }
    const why = this.stop.querySelector<HTMLElement>('.why');
    if (why) write(why, shown.detail);
  }

  close(): void {
    document.removeEventListener('visibilitychange', this.#sight);
    removeEventListener('pagehide', this.#hidden);
    this.wearer.stop();
    void this.#light?.release().catch(() => {});
  }

  #hidden = (): void => this.wearer.bye();

  #sight = (): void => {
    if (document.visibilityState !== 'visible') return;
    this.wearer.woke();
    void this.#keepLight();
  };

  async #keepLight(): Promise<void> {
    try {
      this.#light = (await navigator.wakeLock?.request('screen')) ?? null;
    } catch {
      // Not every browser keeps the light on; the wearer does then.
    }
  }
}

export const write = (element: HTMLElement, text: string): void => {
  if (element.textContent !== text) element.textContent = text;
};

/** What the board says: taking marks goes before guidance, but not before STOP and a broken connection. */
export function board(shown: Shown, wearer: Wearer): readonly [title: string, detail: string] {
  if (shown.kind === 'stop' || shown.kind === 'offline' || shown.kind === 'lost') return [shown.title, shown.detail];
  const { marking } = wearer;
  const { names, taken } = marking;
  switch (marking.kind) {
    case 'taking':
      return [`Mark ${taken.length + 1} of ${names.length}: ${names[taken.length]}`, 'Stand on it or point at it: the ring must lie on the mark. Then pinch, pull the trigger or tap.'];
    case 'asking':
      return ['Checking the marks', ''];
    case 'refused':
      return ['The marks do not fit', `${marking.text} Confirm to take them again.`];
    case 'done':
      if (wearer.due() !== null) return [shown.title, `${shown.detail} ${refusal(wearer)}Done here? Pinch, pull the trigger or tap.`.trim()];
      return [shown.title, shown.kind === 'idle' && names.length > 0 ? `${shown.detail} Marks fit within ${metres(marking.rms_m)}; hold the trigger to take them again.` : shown.detail];
  }
}

/** Why being done was not taken, to stand before what comes next. */
export const refusal = ({ notTaken }: Wearer): string => (notTaken === null ? '' : `Not accepted: ${notTaken} `);
