// What the whole page shares: map, live link, the mirror as shown in panels, who is chosen, the lock.
// Panels get a new mirror four times a second; the floor gets every one, past the framework.
import { Api } from './api';
import { Chances } from './chances';
import { History } from './history';
import { Link, type LinkState } from './link';
import { EMPTY, type Mirror } from './mirror';
import type { Picked } from './picked';
import type { Drawing } from './sketch';
import { Story } from './story';
import type { FloorMap, Point } from './wire';

export type Loaded<T> = { kind: 'loading' } | { kind: 'ready'; value: T } | { kind: 'failed'; why: string };

const PANEL_MS = 250;
const MAP_RETRY_MS = 3_000;

export class Session {
  readonly api = new Api();
  readonly history = new History();
  readonly story = new Story();
  readonly chances = new Chances();
  map = $state.raw<Loaded<FloorMap>>({ kind: 'loading' });
  link = $state.raw<LinkState>({ kind: 'connecting' });
  /** The mirror as the panels show it. */
  mirror = $state.raw<Mirror>(EMPTY);
  /** Age of the picture in seconds; null before the first. */
  age = $state.raw<number | null>(null);
  lock = $state.raw<'open' | 'locked'>('open');
  chosen = $state.raw<Picked | null>(null);
  hovered = $state.raw<Picked | null>(null);
  /** The job whose card is open. */
  job = $state.raw<string | null>(null);
  /** Somebody is to show something on the floor: a rectangle, a polygon or a point. */
  drawing = $state.raw<Drawing | null>(null);
  /** What was drawn and is still being talked about. */
  sketch = $state.raw<readonly Point[] | null>(null);
  /** Every mirror as it comes, for the floor. */
  onMirror: (mirror: Mirror, how: 'glide' | 'jump') => void = () => {};

  #link = new Link({
    open: (since, events) => this.api.openLive(since, events),
    clock: {
      now: () => performance.now(),
      after: (ms, run) => setTimeout(run, ms),
      cancel: (timer) => clearTimeout(timer as ReturnType<typeof setTimeout>),
    },
    random: Math.random,
    onState: (state) => { this.link = state; },
    onMirror: (mirror, kind) => {
      this.history.add(mirror.time_s, mirror.counters.deliveries_per_hour);
      this.onMirror(mirror, kind === 'snapshot' ? 'jump' : 'glide');
    },
  });
  #timers: ReturnType<typeof setTimeout>[] = [];

  get live(): Mirror {
    return this.#link.mirror;
  }

  start(): void {
    this.api.onLocked = () => { this.lock = 'locked'; };
    void this.#loadMap();
    this.#link.start();
    this.#timers.push(setInterval(() => this.#publish(), PANEL_MS));
  }

  stop(): void {
    this.#link.stop();
    this.#timers.forEach(clearTimeout);
  }

  unlock(token: string): void {
    this.api.token = token;
    this.lock = 'open';
    void this.#loadMap();
    this.#link.retryNow();
  }

  retryNow(): void {
    this.#link.retryNow();
  }

  async #loadMap(): Promise<void> {
    const answer = await this.api.map();
    if (answer.kind === 'ok') {
      this.map = { kind: 'ready', value: answer.value };
      this.story.places = answer.value.nodes;
      return;
    }
    const locked = answer.kind === 'refused' && answer.problem.status === 401;
    const why = answer.kind === 'refused' ? (answer.problem.detail ?? answer.problem.title) : 'The server cannot be reached.';
    this.map = { kind: 'failed', why: locked ? 'The server wants an access token.' : why };
    // With a wrong token, asking again would only lock the page again: wait for another token.
    if (!locked) this.#timers.push(setTimeout(() => void this.#loadMap(), MAP_RETRY_MS));
  }

  #publish(): void {
    if (this.mirror !== this.#link.mirror) {
      this.story.note(this.#link.mirror);
      this.chances.note(this.#link.mirror);
      this.mirror = this.#link.mirror;
    }
    const { freshAt } = this.#link;
    const age = freshAt === null ? null : Math.floor((performance.now() - freshAt) / 1_000);
    if (age !== this.age) this.age = age;
  }
}
