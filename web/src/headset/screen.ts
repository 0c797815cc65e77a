// What all views have in common: the words on the board, the voice, the shaking, the light that stays on.
import { Announcer, type Topic } from './announcer';
import { cellWords } from './cell';
import { make } from './dom';
import { buzz, joined, type Shown } from './guide';
import { voice } from './voice';
import type { Wearer } from './wearer';
import { metres, t } from './words';

/** How long it shakes where a hand is wrong, milliseconds. */
const WRONG_MS = 120;

export class Screen {
  readonly title = make('h1', { className: 'title' });
  readonly detail = make('p', { className: 'detail' });
  readonly banner = make('div', { className: 'banner', role: 'status' }, this.title, this.detail);
  /** What the server says about what it gets, below everything else. */
  readonly note = make('p', { className: 'dim small', role: 'status', hidden: true });
  readonly stop = make('div', { className: 'stop', role: 'alert', hidden: true });
  /** Says the last words again, and switches the voice on and off. */
  readonly talk: readonly HTMLElement[];
  #announcer = new Announcer();
  #voiceButton = make('button', { type: 'button', className: 'voice' });
  #noVoice = make('span', { className: 'dim small', hidden: true });
  #kind: Shown['kind'] | null = null;
  #wrong = '';
  #light: WakeLockSentinel | null = null;

  constructor(
    readonly root: HTMLElement,
    readonly wearer: Wearer,
  ) {
    const again = make('button', { type: 'button', textContent: t('voice.again') });
    again.addEventListener('click', () => this.again());
    this.#voiceButton.addEventListener('click', () => {
      voice.isOn = !voice.isOn;
      this.#showVoice();
      if (voice.isOn) this.again();
    });
    this.talk = [again, this.#voiceButton, this.#noVoice];
    this.#showVoice();
    document.addEventListener('visibilitychange', this.#sight);
    addEventListener('pagehide', this.#hidden);
    void this.#keepLight();
  }

  say(shown: Shown, title: string, detail: string): void {
    const pattern = buzz(this.#kind, shown.kind);
    if (pattern.length > 0) navigator.vibrate?.(pattern);
    this.#kind = shown.kind;
    Object.assign(this.root.dataset, {
      shown: shown.kind,
      link: this.wearer.feed.kind,
      marking: this.wearer.marking.kind,
      sent: String(this.wearer.sent),
      epoch: String(this.wearer.pump.epoch),
      near: String(shown.near.length),
      path: String(shown.path.length),
    });
    this.banner.dataset['tone'] = shown.tone;
    write(this.title, title);
    write(this.detail, detail);
    const notice = this.wearer.notice();
    this.note.hidden = notice === null;
    write(this.note, notice === null ? '' : `${t('server.says')} ${notice}`);
    if (this.stop.hidden === (shown.kind === 'stop')) {
      this.stop.hidden = shown.kind !== 'stop';
      this.stop.replaceChildren(
        ...(shown.kind === 'stop'
          ? [make('strong', { textContent: t('stop') }), make('span', { className: 'why' })]
          : []),
      );
    }
    const why = this.stop.querySelector<HTMLElement>('.why');
    if (why) write(why, shown.detail);
    const said = this.#announcer.next(this.#topic(shown), performance.now());
    if (said) voice.say(said);
    this.#sayCell();
    this.root.dataset['said'] = voice.said;
  }

  /** A hand that is wrong is told of at once, aloud and by shaking. */
  #sayCell(): void {
    const { cell } = this.wearer;
    const wrong = cell?.warning ? (cellWords(cell)?.[0] ?? '') : '';
    this.root.dataset['cell'] = cell?.warning?.kind ?? cell?.slot?.id ?? '';
    if (wrong !== '' && wrong !== this.#wrong) {
      navigator.vibrate?.(WRONG_MS);
      voice.say({ text: wrong, urgent: true });
    }
    this.#wrong = wrong;
  }

  /** What stands now is said again. */
  again(): void {
    voice.say({ text: this.#announcer.again(this.#topic(this.wearer.shown())), urgent: true });
    this.root.dataset['said'] = voice.said;
  }

  #topic(shown: Shown): Topic {
    const { guidance, task, finished, ended } = this.wearer;
    return { shown, assignment: guidance?.assignment ?? null, task, finished, ended };
  }

  #showVoice(): void {
    write(this.#voiceButton, t(voice.isOn ? 'voice.on' : 'voice.off'));
    this.#noVoice.hidden = !voice.isOn || !voice.isMissing;
    write(this.#noVoice, t('voice.none'));
  }

  close(): void {
    document.removeEventListener('visibilitychange', this.#sight);
    removeEventListener('pagehide', this.#hidden);
    this.wearer.stop();
    voice.hush();
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
      return [
        t('mark.take', { count: taken.length + 1, all: names.length, name: names[taken.length] ?? '' }),
        t('mark.take.detail'),
      ];
    case 'asking':
      return [t('mark.asking'), ''];
    case 'refused':
      return [t('mark.refused'), t('mark.refused.detail', { why: marking.text })];
    case 'done': {
      const picks = shown.kind === 'idle' ? cellWords(wearer.cell) : null;
      if (picks) return picks;
      if (wearer.due() !== null) return [shown.title, joined(shown.detail, refusal(wearer), t('task.ask'))];
      const hasMarks = shown.kind === 'idle' && names.length > 0;
      return [shown.title, joined(shown.detail, hasMarks ? t('mark.fit', { distance: metres(marking.rms_m) }) : '')];
    }
  }
}

/** Why being done was not taken, to stand before what comes next. */
export const refusal = ({ notTaken }: Wearer): string =>
  notTaken === null ? '' : t('task.refused', { why: notTaken });
