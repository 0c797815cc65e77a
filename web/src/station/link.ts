// The link of a station's display: one socket, of which each message is the whole state. It notices silence, and a
// clock that stands, and comes back by itself. Socket, clock and chance come from outside, so that tests own them.
import { retryDelay, type Clock, type Socket, type SocketEvents } from '../wire';

export interface LinkOptions {
  open(events: SocketEvents): Socket;
  clock: Clock;
  random(): number;
  /** Takes a message; the server's time of it, null for what is no message. */
  hear(text: string): string | null;
  /** The socket is shut; whether it could be opened at all before. */
  onLost(wasOpen: boolean): void;
}

/** The server says something at least once a second: after so long what is shown is old. */
export const OLD_MS = 3_000;
/** A socket silent for so long is taken for dead: half-open connections never report it themselves. */
export const DEAD_MS = 8_000;
const LOOK_MS = 500;

export class StationLink {
  /** When the server's time was last seen to go on; null before the first message. */
  freshAt: number | null = null;
  #said: string | null = null;
  #options: LinkOptions;
  #socket: Socket | null = null;
  #turn = 0;
  #attempt = 0;
  #heardAt = 0;
  #isOpen = false;
  #startedAt = 0;
  #timers: { retry: unknown; look: unknown } = { retry: null, look: null };

  constructor(options: LinkOptions) {
    this.#options = options;
  }

  start(): void {
    this.#startedAt = this.#options.clock.now();
    this.#connect();
    this.#look();
  }
  stop(): void {
    this.#drop();
    this.#options.clock.cancel(this.#timers.retry);
    this.#options.clock.cancel(this.#timers.look);
  }

  /** How old what is shown is, milliseconds. */
  get age_ms(): number {
    return this.#options.clock.now() - (this.freshAt ?? this.#startedAt);
  }
  /** Whether what is shown may not be trusted. */
  get isOld(): boolean {
    return this.freshAt === null || !this.#isOpen || this.age_ms >= OLD_MS;
  }

  #connect(): void {
    const { clock, open } = this.#options;
    this.#heardAt = clock.now();
    // Events of a socket that was given up may still arrive; they are told apart by their turn.
    const turn = ++this.#turn;
    const mine = (run: () => void): void => {
      if (turn === this.#turn) run();
    };
    try {
      this.#socket = open({ message: (text) => mine(() => this.#heard(text)), closed: () => mine(() => this.#lost()) });
    } catch {
      this.#lost();
    }
  }

  #heard(text: string): void {
    const said = this.#options.hear(text);
    if (said === null) return;
    this.#heardAt = this.#options.clock.now();
    if (said !== this.#said) this.freshAt = this.#heardAt;
    [this.#said, this.#isOpen, this.#attempt] = [said, true, 0];
  }

  #lost(): void {
    const { clock, random, onLost } = this.#options;
    const wasOpen = this.#isOpen;
    this.#drop();
    this.#timers.retry = clock.after(retryDelay(this.#attempt, random()), () => this.#connect());
    this.#attempt += 1;
    onLost(wasOpen);
  }

  #drop(): void {
    this.#turn += 1;
    this.#socket?.close();
    [this.#socket, this.#isOpen] = [null, false];
  }

  #look(): void {
    const { clock } = this.#options;
    if (this.#socket && clock.now() - this.#heardAt >= DEAD_MS) this.#lost();
    this.#timers.look = clock.after(LOOK_MS, () => this.#look());
  }
}
