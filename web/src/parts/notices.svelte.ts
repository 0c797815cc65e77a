// What was just done on this page, or could not be shown, in a sentence; and how to undo it, for some seconds.
import { t } from '../words';

/** Long enough to be read and reached by keys; the clock stands while the bar is pointed at or has the focus. */
export const OFFERED_MS = 10_000;

export interface Notice {
  readonly words: string;
  /** Takes back what was done; answers why it could not. Null where there is nothing to take back. */
  readonly undo: (() => Promise<string | null>) | null;
  readonly wrong: boolean;
}

export class Notices {
  notice = $state.raw<Notice | null>(null);
  undoing = $state(false);
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** Says what was done, and offers to undo it. */
  did(words: string, undo: () => Promise<string | null>): void {
    this.#show({ words, undo, wrong: false });
    this.resume();
  }

  /** Says what was done, where that cannot be undone. */
  tell(words: string): void {
    this.#show({ words, undo: null, wrong: false });
    this.resume();
  }

  /** Says what could not be shown or done; it stays until it is dismissed. */
  say(words: string): void {
    this.#show({ words, undo: null, wrong: true });
  }

  dismiss(): void {
    this.#show(null);
  }

  /** Undoes what was done last, if that is still offered. */
  async undo(): Promise<void> {
    const undo = this.notice?.undo;
    if (!undo || this.undoing) return;
    this.hold();
    this.undoing = true;
    const wrong = await undo();
    this.undoing = false;
    if (wrong === null) this.dismiss();
    else this.say(t('notices.undo.failed', { why: wrong }));
  }

  /** Somebody is about to use it: it stays. */
  hold(): void {
    clearTimeout(this.#timer);
  }

  resume(): void {
    this.hold();
    if (this.notice && !this.notice.wrong) this.#timer = setTimeout(() => this.dismiss(), OFFERED_MS);
  }

  #show(notice: Notice | null): void {
    this.hold();
    this.notice = notice;
  }
}
