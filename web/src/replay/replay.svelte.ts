// The past being played: which moment, how fast, and what of it is in sight on the scrubber. It gives mirrors as the
// live link does, whichever shows them.
import { EMPTY, type Mark, type Mirror } from '../wire';
import type { Recording } from './recording';
import { begins, ends, snap, type Span } from './spans';
import { seek, type Shown } from './seek';

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64] as const;
/** How much of the past the scrubber shows, seconds; 0 is all of it. */
export const REACHES = [120, 600, 3_600, 0] as const;
const REFRESH_MS = 3_000;
const RECENT_S = 60;
/** A user who goes to a bookmark wants to see how it came about. */
const LEAD_S = 5;

export class Replay {
  readonly recording: Recording;
  t = $state(0);
  playing = $state(true);
  speed = $state(1);
  /** The frames of this moment are being fetched. */
  waiting = $state(false);
  wrong = $state.raw<string | null>(null);
  marks = $state.raw<readonly Mark[]>([]);
  begin = $state(0);
  end = $state(0);
  spans = $state.raw<readonly Span[]>([]);
  /** The left end of the scrubber, and how much it shows. */
  left = $state(0);
  reach = $state<number>(0);
  mirror: Mirror = EMPTY;
  /** The bookmark that was gone to, and is a few seconds ahead. */
  #aim = $state.raw<Mark | null>(null);

  #shown: Shown | null = null;
  #give: (mirror: Mirror, how: 'glide' | 'jump') => void;
  #until: number | null;
  #frame = 0;
  #timer: ReturnType<typeof setInterval> | undefined;

  constructor(
    recording: Recording,
    from: number | null,
    to: number | null,
    give: (mirror: Mirror, how: 'glide' | 'jump') => void,
  ) {
    this.recording = recording;
    this.#give = give;
    this.#until = to;
    this.#look();
    const long = this.end - this.begin > 1_200;
    this.reach = from !== null && to !== null && to > from ? to - from : long ? 600 : 0;
    // A user who asks a running server for nothing in particular wants to see what has just happened.
    const recent = recording.source === 'server';
    this.left = from ?? (recent && this.reach > 0 ? Math.max(this.begin, this.end - this.reach) : this.begin);
    this.t = snap(recording, from ?? (recent ? Math.max(this.begin, this.end - RECENT_S) : this.begin));
  }

  /** The right end of the scrubber. */
  get right(): number {
    return this.reach === 0 ? this.end : this.left + this.reach;
  }

  start(): void {
    let before = performance.now();
    const next = (now: number): void => {
      this.#turn((now - before) / 1_000);
      before = now;
      this.#frame = requestAnimationFrame(next);
    };
    this.#frame = requestAnimationFrame(next);
    this.#timer = setInterval(() => void this.recording.refresh().then(() => this.#look()), REFRESH_MS);
  }

  stop(): void {
    cancelAnimationFrame(this.#frame);
    clearInterval(this.#timer);
  }

  toggle(): void {
    if (!this.playing && this.t >= this.end) this.seek(this.begin);
    this.playing = !this.playing;
    this.#until = null;
  }

  seek(t: number): void {
    this.t = snap(this.recording, Math.min(this.end, Math.max(this.begin, t)));
    this.#until = null;
    this.#aim = null;
    this.#follow();
  }

  /** How much the scrubber shows, with the moment in the middle. */
  show(reach: number): void {
    this.reach = reach;
    this.left = reach === 0 ? this.begin : Math.max(this.begin, Math.min(this.t - reach / 2, this.end - reach));
  }

  goTo(mark: Mark): void {
    const early = mark.at_s - LEAD_S;
    // Bookmarks may be closer together than that: who goes on is not taken back.
    this.seek(mark.at_s > this.at ? Math.max(early, this.t) : early);
    this.#aim = mark;
  }

  /** The moment that bookmarks are counted from: the one that was gone to, until it is there. */
  get at(): number {
    return this.#aim ? Math.max(this.t, this.#aim.at_s) : this.t;
  }

  /** The bookmark before or after the moment; null where there is none. */
  beside(step: 1 | -1): Mark | null {
    const { at } = this;
    return (step === 1 ? this.marks.find((m) => m.at_s > at) : this.marks.findLast((m) => m.at_s < at)) ?? null;
  }

  #turn(seconds: number): void {
    if (this.playing && !this.waiting) this.#advance(Math.min(Math.max(seconds, 0), 0.25) * this.speed);
    const frames = this.recording.frames(this.t);
    const shown = frames && seek(frames, this.t, this.#shown);
    this.waiting = !shown;
    this.wrong = this.recording.wrong;
    if (!shown || shown === this.#shown) return;
    this.#shown = shown;
    this.mirror = shown.mirror;
    this.#give(shown.mirror, shown.how);
  }

  #advance(by: number): void {
    const to = this.#until ?? this.end;
    const t = Math.min(snap(this.recording, this.t + by), Math.max(to, this.t));
    // A past that still grows is followed; one that is over, or a span that was asked for, ends.
    if (t >= to && (this.#until !== null || this.recording.source === 'file')) this.playing = false;
    this.t = t;
    this.#follow();
  }

  #follow(): void {
    if (this.reach === 0) this.left = this.begin;
    else if (this.t < this.left || this.t > this.left + this.reach)
      this.left = this.t - this.reach * (this.t < this.left ? 0.5 : 0.1);
  }

  #look(): void {
    this.begin = begins(this.recording);
    this.end = ends(this.recording);
    this.spans = [...this.recording.spans];
    if (this.marks !== this.recording.marks) this.marks = this.recording.marks;
  }
}
