// What is on the screen: the present, or the past while a replay plays. Panels get a new mirror four times a second;
// the floor gets every one, past the framework.
import type { See, Stream } from '../floor';
import { valueOf, type Loaded } from '../parts';
import { Replay, type Recording } from '../replay';
import { EMPTY, type FloorMap, type LinkState, type Mirror } from '../wire';
import type { Live } from './live.svelte';
import { Memory } from './memory';

const PANEL_MS = 250;

export class Screen implements Stream {
  /** The mirror as the panels show it. */
  mirror = $state.raw<Mirror>(EMPTY);
  /** The present as the panels show it, also while the past is shown. */
  present = $state.raw<Mirror>(EMPTY);
  /** The past, while that is shown instead of the present. */
  replay = $state.raw<Replay | null>(null);
  readonly memory = new Memory();
  #live: Live;
  #onTense: (tense: 'now' | 'then') => void;
  #see: See = () => {};
  #timer: ReturnType<typeof setInterval> | undefined;

  constructor(live: Live, onTense: (tense: 'now' | 'then') => void) {
    this.#live = live;
    this.#onTense = onTense;
    live.onMirror = (mirror, how) => {
      if (!this.replay) this.#show(mirror, how);
    };
  }

  /** A recording without a map of its own is of this floor. */
  get map(): Loaded<FloorMap> {
    const map = this.replay?.recording.map;
    return map ? { kind: 'ready', value: map } : this.#live.map;
  }

  get link(): LinkState {
    return this.replay ? { kind: 'replay' } : this.#live.link;
  }

  latest(): Mirror {
    return this.replay ? this.#live.called(this.replay.mirror) : this.#live.mirror;
  }

  watch(see: See): () => void {
    this.#see = see;
    return () => {
      if (this.#see === see) this.#see = () => {};
    };
  }

  /** Shows the past: from a moment on, up to another one where that is given. */
  play(recording: Recording, from: number | null = null, to: number | null = null): void {
    this.#begin(new Replay(recording, from, to, (mirror, how) => this.#show(this.#live.called(mirror), how)), 'then');
    this.replay?.start();
  }

  /** Shows the present again. */
  goLive(): void {
    this.#begin(null, 'now');
    this.#see(this.#live.mirror, 'jump');
  }

  start(): void {
    this.#timer = setInterval(() => this.#publish(), PANEL_MS);
  }

  stop(): void {
    this.replay?.stop();
    clearInterval(this.#timer);
  }

  #begin(replay: Replay | null, tense: 'now' | 'then'): void {
    this.replay?.stop();
    this.replay = replay;
    this.memory.forget();
    this.#onTense(tense);
  }

  #show(mirror: Mirror, how: 'glide' | 'jump'): void {
    // After a jump in the past it is not known what happened in between.
    if (this.replay && how === 'jump') this.memory.forget();
    this.memory.count(mirror);
    this.#see(mirror, how);
  }

  #publish(): void {
    const latest = this.latest();
    if (this.mirror !== latest) {
      this.memory.note(latest, valueOf(this.map)?.nodes ?? []);
      this.mirror = latest;
    }
    if (this.present !== this.#live.mirror) this.present = this.#live.mirror;
    this.#live.look();
  }
}
