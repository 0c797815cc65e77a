// Keys that a person pressed, and scans: a scanner types its text faster than anybody, and Enter after it. Pure.

/** Between two characters of a scan there is less time. */
export const GAP_MS = 50;

export type Pressed = { kind: 'scan'; text: string } | { kind: 'key'; key: string };

export class Keys {
  #text = '';
  #last = -Infinity;

  /** A key went down; what is to be done now. Its character may turn out to begin a scan, so it waits for `settle`. */
  press(key: string, at: number): Pressed[] {
    const before = this.settle(at);
    if (key === 'Enter') {
      const text = this.#text;
      this.#text = '';
      return [...before, text === '' ? { kind: 'key', key } : { kind: 'scan', text }];
    }
    // Shift and its like belong to the character that follows.
    if ([...key].length === 1) [this.#text, this.#last] = [this.#text + key, at];
    return before;
  }

  /** Nothing has followed for long enough: one character is a key. Several without Enter are neither key nor scan. */
  settle(at: number): Pressed[] {
    if (this.#text === '' || at - this.#last < GAP_MS) return [];
    const text = this.#text;
    this.#text = '';
    return [...text].length === 1 ? [{ kind: 'key', key: text }] : [];
  }
}

/** A finger bounces, some click twice, and nobody reads faster: what follows so soon is no press of its own. */
export const SAME_PRESS_MS = 400;
/** Pieces are counted one by one, and quick presses are meant. */
export const SAME_PIECE_MS = 120;

/** Lets one press through at a time, and none right after it. */
export class Once {
  #until = -Infinity;
  #isBusy = false;

  /** Whether a press counts. If so, `over` is to be called when it was answered. */
  begin(at: number, pause_ms: number): boolean {
    if (this.#isBusy || at < this.#until) return false;
    [this.#isBusy, this.#until] = [true, at + pause_ms];
    return true;
  }
  over(): void {
    this.#isBusy = false;
  }
}
