// The live link: one WebSocket that keeps a Mirror up to date. It resumes after a break from the
// version it has, asks for a new snapshot when a patch does not fit, and backs off when the server is
// away. Socket, clock and chance come from outside, so that tests own them.
import { EMPTY, reduce, type Mirror } from './mirror';
import { parseMessage } from './feed';

export type LinkState =
  /** Something else is shown than what comes: the past. */
  | { kind: 'replay' }
  | { kind: 'connecting' }
  | { kind: 'live' }
  /** The socket is open, but nothing came for a while. */
  | { kind: 'slow' }
  /** Messages come, but the floor's own clock stands: what they say is old. */
  | { kind: 'still' }
  | { kind: 'lost'; attempt: number; retryAt: number };

export interface Socket {
  close(): void;
}
export interface SocketEvents {
  message(text: string): void;
  closed(): void;
}
export interface Clock {
  now(): number;
  after(ms: number, run: () => void): unknown;
  cancel(timer: unknown): void;
}
export interface LinkOptions {
  /** Opens a socket; may throw, which counts as a failed attempt. */
  open(since: number | null, events: SocketEvents): Socket;
  clock: Clock;
  random(): number;
  onState(state: LinkState): void;
  onMirror(mirror: Mirror, kind: 'snapshot' | 'patched'): void;
}

export const SLOW_MS = 2_000;
/** A socket silent for this long is taken for dead: half-open connections never report it themselves. */
export const DEAD_MS = 10_000;
const FIRST_RETRY_MS = 500;
const LONGEST_RETRY_MS = 10_000;
const WATCH_MS = 500;

export function retryDelay(attempt: number, random: number): number {
  const ceiling = Math.min(LONGEST_RETRY_MS, FIRST_RETRY_MS * 2 ** attempt);
  // Half fixed, half chance: pages that lost the same server must not come back in step.
  return ceiling / 2 + (random * ceiling) / 2;
}

export class Link {
  mirror: Mirror = EMPTY;
  /** When the last message came, on the client's clock; null before the first. */
  heardAt: number | null = null;
  /** When the floor's own clock was last seen to go on, on the client's clock. */
  freshAt: number | null = null;
  state: LinkState = { kind: 'connecting' };

  #options: LinkOptions;
  #socket: Socket | null = null;
  #turn = 0;
  #openedAt = 0;
  #heardOnThisSocket = false;
  #resume: 'from version' | 'from snapshot' = 'from version';
  #attempt = 0;
  #retry: unknown = null;
  #watch: unknown = null;

  constructor(options: LinkOptions) {
    this.#options = options;
  }

  start(): void {
    this.#connect();
    this.#look();
  }

  stop(): void {
    this.#drop();
    this.#options.clock.cancel(this.#retry);
    this.#options.clock.cancel(this.#watch);
  }

  retryNow(): void {
    this.#drop();
    this.#options.clock.cancel(this.#retry);
    this.#attempt = 0;
    this.#connect();
  }

  #connect(): void {
    const { clock, open } = this.#options;
    this.#heardOnThisSocket = false;
    this.#openedAt = clock.now();
    // Events of a socket that was given up may still arrive; they are told apart by their turn.
    const turn = ++this.#turn;
    const events: SocketEvents = {
      message: (text) => {
        if (turn === this.#turn) this.#heard(text);
      },
      closed: () => {
        if (turn !== this.#turn) return;
        // A server that hangs up on a resume without a word may no longer know that version.
        if (!this.#heardOnThisSocket) this.#resume = 'from snapshot';
        this.#drop();
        this.#lost();
      },
    };
    try {
      this.#socket = open(this.#resume === 'from version' ? this.mirror.version : null, events);
    } catch {
      this.#lost();
    }
  }

  #heard(text: string): void {
    let message;
    try {
      message = parseMessage(text);
    } catch {
      this.#startOver();
      return;
    }
    this.heardAt = this.#options.clock.now();
    this.#heardOnThisSocket = true;
    if (!message) return;
    const reduced = reduce(this.mirror, message);
    if (reduced.kind === 'gap') {
      this.#startOver();
      return;
    }
    if (reduced.kind === 'snapshot' || reduced.mirror.time_s !== this.mirror.time_s) this.freshAt = this.heardAt;
    this.mirror = reduced.mirror;
    this.#attempt = 0;
    this.#resume = 'from version';
    this.#become(this.#isStill() ? { kind: 'still' } : { kind: 'live' });
    this.#options.onMirror(reduced.mirror, reduced.kind);
  }

  /** What we have does not fit what comes: begin again from a snapshot, with the usual back-off. */
  #startOver(): void {
    this.#resume = 'from snapshot';
    this.#drop();
    this.#lost();
  }

  #lost(): void {
    const { clock, random } = this.#options;
    const delay = retryDelay(this.#attempt, random());
    this.#become({ kind: 'lost', attempt: this.#attempt, retryAt: clock.now() + delay });
    this.#attempt += 1;
    this.#retry = clock.after(delay, () => this.#connect());
  }

  #drop(): void {
    this.#turn += 1;
    this.#socket?.close();
    this.#socket = null;
  }

  #look(): void {
    const { clock } = this.#options;
    if (this.#socket) {
      const last = this.#heardOnThisSocket ? (this.heardAt ?? this.#openedAt) : this.#openedAt;
      const silent = clock.now() - last;
      if (silent >= DEAD_MS) {
        this.#drop();
        this.#lost();
      } else if (silent >= SLOW_MS && (this.state.kind === 'live' || this.state.kind === 'still')) {
        this.#become({ kind: 'slow' });
      } else if (this.state.kind === 'live' && this.#isStill()) {
        this.#become({ kind: 'still' });
      }
    }
    this.#watch = clock.after(WATCH_MS, () => this.#look());
  }

  #isStill(): boolean {
    return this.freshAt !== null && this.#options.clock.now() - this.freshAt >= SLOW_MS;
  }

  #become(state: LinkState): void {
    if (state.kind === this.state.kind && state.kind !== 'lost') return;
    this.state = state;
    this.#options.onState(state);
  }
}
