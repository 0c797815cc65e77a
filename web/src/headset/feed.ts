// The feed of one worker: greeting, clock, epochs, guidance, and coming back after a break. What is sent while the
// socket is shut is dropped, since only the newest pose counts. Socket, clock and chance come from outside.
import { asSaid, said, type Said } from '../language';
import { retryDelay, type Clock } from '../wire';
import type { Guidance } from './guide';
import type { PoseMessage } from './pump';
import type { Alignment } from './frame';
import type { Mark } from './align';
import type { CellLights } from './cell';

export interface Aligned extends Alignment {
  rms_m: number;
  heading_error: number;
}
/** What came over the feed. */
export type FeedEvent =
  | { kind: 'welcome'; epoch: number; aligned: boolean }
  | { kind: 'epoch'; epoch: number; aligned: boolean }
  | { kind: 'aligned'; epoch: number; fit: Aligned }
  | { kind: 'refused'; reason: Said | string; remedy: Said | string; aligned: boolean }
  | { kind: 'guidance'; guidance: Guidance }
  | { kind: 'cell'; cell: CellLights }
  | { kind: 'done'; assignment: string; refused: Said | string | null }
  | { kind: 'clock'; error_ms: number }
  | { kind: 'warning'; code: string; text: Said | string };

export type FeedState =
  | { kind: 'connecting' }
  | { kind: 'live' }
  | { kind: 'lost'; retryAt: number }
  /** The server does not want this client: coming back by itself would do no good. */
  | { kind: 'ended'; text: string };

export interface Line {
  send(text: string): void;
  close(): void;
  /** Bytes that have not left yet. */
  waiting(): number;
}
export interface LineEvents {
  opened(): void;
  message(text: string): void;
  closed(code: number, reason: string): void;
}
export interface FeedOptions {
  frame: 'device' | 'map';
  open(events: LineEvents): Line;
  clock: Clock;
  random(): number;
  onState(state: FeedState): void;
  onEvent(event: FeedEvent): void;
}

/** Guidance comes four times a second; a line silent for so long is dead, whatever the socket says. */
export const DEAD_MS = 5_000;
/** How long a line may take to open. */
const OPEN_MS = 10_000;
const LOOK_MS = 500;
/** RFC 6455, section 7.4.1: the server refuses on principle. */
const POLICY = 1008;

export class Feed {
  state: FeedState = { kind: 'connecting' };
  #options: FeedOptions;
  #line: Line | null = null;
  #turn = 0;
  #attempt = 0;
  #heardAt = 0;
  #open = false;
  #last: Said | string = '';
  #timers: { retry: unknown; look: unknown } = { retry: null, look: null };

  constructor(options: FeedOptions) {
    this.#options = options;
  }

  start(): void {
    this.#connect();
    this.#look();
  }

  /** The device is taken off, or its page closed: no more poses come. */
  bye(): void {
    this.#say({ type: 'bye' });
  }

  stop(): void {
    this.bye();
    this.#drop();
    this.#options.clock.cancel(this.#timers.retry);
    this.#options.clock.cancel(this.#timers.look);
  }

  /** Tries now, such as when the page comes back into sight. */
  retryNow(): void {
    if (this.state.kind !== 'lost' && this.state.kind !== 'ended') return;
    this.#options.clock.cancel(this.#timers.retry);
    this.#attempt = 0;
    this.#connect();
  }

  get waiting(): number {
    return this.#line?.waiting() ?? 0;
  }

  pose(message: PoseMessage): void {
    this.#say(message);
  }
  anchors(marks: readonly Mark[]): void {
    this.#say({ type: 'anchors', pairs: marks.map(({ device, name }) => ({ device, mark: name })) });
  }
  reset(): void {
    this.#say({ type: 'reset' });
  }
  resync(): void {
    this.#say({ type: 'resync' });
  }
  done(assignment: string): void {
    this.#say({ type: 'done', assignment });
  }
  seen(version: number): void {
    this.#say({ type: 'ack', version });
  }

  #say(message: object): void {
    if (this.#open && this.state.kind === 'live') this.#line?.send(JSON.stringify(message));
  }

  #connect(): void {
    const { clock, open, frame } = this.#options;
    this.#become({ kind: 'connecting' });
    [this.#heardAt, this.#open, this.#last] = [clock.now(), false, ''];
    const turn = ++this.#turn;
    const mine =
      <T extends unknown[]>(run: (...all: T) => void) =>
      (...all: T): void => {
        if (turn === this.#turn) run(...all);
      };
    try {
      this.#line = open({
        opened: mine(() => {
          [this.#open, this.#heardAt] = [true, clock.now()];
          this.#line?.send(JSON.stringify({ type: 'hello', versions: [2, 1], frame }));
        }),
        message: mine((text: string) => this.#hear(text)),
        closed: mine((code: number, reason: string) => {
          this.#drop();
          if (code === POLICY) this.#become({ kind: 'ended', text: this.#last === '' ? reason : said(this.#last) });
          else this.#lose();
        }),
      });
    } catch {
      this.#lose();
    }
  }

  #hear(text: string): void {
    const got = this.#options.clock.now();
    this.#heardAt = got;
    const m = read(text);
    switch (m?.['type']) {
      case 'ping':
        this.#line?.send(JSON.stringify({ type: 'pong', id: m['id'], t1: got, t2: this.#options.clock.now() }));
        return;
      case 'welcome':
        this.#attempt = 0;
        this.#become({ kind: 'live' });
        return this.#tell({ kind: 'welcome', epoch: Number(m['epoch']), aligned: m['aligned'] === true });
      case 'epoch':
        return this.#tell({ kind: 'epoch', epoch: Number(m['epoch']), aligned: m['aligned'] === true });
      case 'aligned':
        return this.#tell({ kind: 'aligned', epoch: Number(m['epoch']), fit: m as unknown as Aligned });
      case 'refused':
        return this.#tell({
          kind: 'refused',
          reason: asSaid(m['reason']) ?? '',
          remedy: asSaid(m['remedy']) ?? '',
          aligned: m['aligned'] === true,
        });
      case 'guidance':
        return this.#tell({ kind: 'guidance', guidance: m as unknown as Guidance });
      case 'cell':
        return this.#tell({ kind: 'cell', cell: m as unknown as CellLights });
      case 'done':
        return this.#tell({ kind: 'done', assignment: String(m['assignment']), refused: asSaid(m['refused']) });
      case 'clock':
        return this.#tell({ kind: 'clock', error_ms: Number(m['error_ms']) });
      case 'warning':
        return this.#tell({ kind: 'warning', code: String(m['code']), text: asSaid(m['text']) ?? '' });
      case 'error':
        this.#last = asSaid(m['text']) ?? '';
        return;
      default:
        // A newer server may say more than this page knows.
        return;
    }
  }

  #tell(event: FeedEvent): void {
    this.#options.onEvent(event);
  }

  #lose(): void {
    const { clock, random } = this.#options;
    const delay = retryDelay(this.#attempt, random());
    this.#attempt += 1;
    this.#become({ kind: 'lost', retryAt: clock.now() + delay });
    this.#timers.retry = clock.after(delay, () => this.#connect());
  }

  #drop(): void {
    this.#turn += 1;
    this.#line?.close();
    [this.#line, this.#open] = [null, false];
  }

  #look(): void {
    const { clock } = this.#options;
    if (this.#line && clock.now() - this.#heardAt >= (this.#open ? DEAD_MS : OPEN_MS)) {
      this.#drop();
      this.#lose();
    }
    this.#timers.look = clock.after(LOOK_MS, () => this.#look());
  }

  #become(state: FeedState): void {
    this.state = state;
    this.#options.onState(state);
  }
}

function read(text: string): Record<string, unknown> | null {
  try {
    const value: unknown = JSON.parse(text);
    return typeof value === 'object' && value !== null ? (value as Record<string, unknown>) : null;
  } catch {
    return null;
  }
}
