// What the whole page shares: map, live link, the mirror as shown in panels, who is chosen, the lock.
// Panels get a new mirror four times a second; the floor gets every one, past the framework.
import { Api } from './api';
import { Chances } from './chances';
import { History } from './history';
import { Link, type LinkState } from './link';
import { EMPTY, type Mirror } from './mirror';
import type { Picked } from './picked';
import type { Film } from './reel/film';
import { Replay } from './reel/replay.svelte';
import type { Drawing } from './sketch';
import { Story } from './story';
import type { FloorMap, Point } from './wire';

export type Loaded<T> = { kind: 'loading' } | { kind: 'ready'; value: T } | { kind: 'failed'; why: string };

const PANEL_MS = 250;
const MAP_RETRY_MS = 3_000;

export class Session {
  readonly api = new Api();
  /** This page is a file with a reel in it: there is no server, and no present. */
  readonly alone = document.getElementById('reel') !== null;
  history = new History();
  story = new Story();
  chances = new Chances();
  map = $state.raw<Loaded<FloorMap>>({ kind: 'loading' });
  link = $state.raw<LinkState>({ kind: 'connecting' });
  /** The mirror as the panels show it. */
  mirror = $state.raw<Mirror>(EMPTY);
  /** Age of the picture in seconds; null before the first. */
  age = $state.raw<number | null>(null);
  /** The past, while that is shown instead of the present. */
  replay = $state.raw<Replay | null>(null);
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
    onState: (state) => { if (!this.replay) this.link = state; },
    onMirror: (mirror, kind) => { if (!this.replay) this.#show(mirror, kind === 'snapshot' ? 'jump' : 'glide'); },
  });
  /** The map of the present. */
  #map: Loaded<FloorMap> = { kind: 'loading' };
  #timers: ReturnType<typeof setTimeout>[] = [];

  get live(): Mirror {
    return this.replay ? this.replay.mirror : this.#link.mirror;
  }

  /** Shows the past: from a moment on, up to another one where that is given. */
  watch(film: Film, from: number | null = null, to: number | null = null): void {
    this.replay?.stop();
    this.replay = new Replay(film, from, to, (mirror, how) => this.#show(mirror, how));
    this.#begin('past', film.map ? { kind: 'ready', value: film.map } : this.#map, { kind: 'replay' });
    this.replay.start();
    if (this.alone && this.#timers.length === 0) this.#timers.push(setInterval(() => this.#publish(), PANEL_MS));
  }

  /** Shows the present again. */
  goLive(): void {
    this.replay?.stop();
    this.replay = null;
    this.#begin('present', this.#map, this.#link.state);
    this.onMirror(this.#link.mirror, 'jump');
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
    if (answer.kind === 'ok') return this.#load({ kind: 'ready', value: answer.value });
    const locked = answer.kind === 'refused' && answer.problem.status === 401;
    const why = answer.kind === 'refused' ? (answer.problem.detail ?? answer.problem.title) : 'The server cannot be reached.';
    this.#load({ kind: 'failed', why: locked ? 'The server wants an access token.' : why });
    // With a wrong token, asking again would only lock the page again: wait for another token.
    if (!locked) this.#timers.push(setTimeout(() => void this.#loadMap(), MAP_RETRY_MS));
  }

  #load(map: Loaded<FloorMap>): void {
    this.#map = map;
    // A film without a map of its own is of this floor.
    if (!this.replay?.film.map) this.#use(map);
  }

  #use(map: Loaded<FloorMap>): void {
    this.map = map;
    if (map.kind === 'ready') this.story.places = map.value.nodes;
  }

  #begin(shows: 'present' | 'past', map: Loaded<FloorMap>, link: LinkState): void {
    this.api.shows = shows;
    this.link = link;
    this.#forget();
    this.drawing = null;
    this.#use(map);
  }

  #forget(): void {
    const { places } = this.story;
    this.story = new Story();
    this.story.places = places;
    this.history = new History();
    this.chances = new Chances();
  }

  #show(mirror: Mirror, how: 'glide' | 'jump'): void {
    // After a jump, nobody knows what happened in between.
    if (this.replay && how === 'jump') this.#forget();
    this.history.add(mirror.time_s, mirror.counters.deliveries_per_hour);
    this.onMirror(mirror, how);
  }

  #publish(): void {
    const { live } = this;
    if (this.mirror !== live) {
      this.story.note(live);
      this.chances.note(live);
      this.mirror = live;
    }
    const { freshAt } = this.#link;
    const age = freshAt === null ? null : Math.floor((performance.now() - freshAt) / 1_000);
    if (age !== this.age) this.age = age;
  }
}
