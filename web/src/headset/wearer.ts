// One wearer: the feed, the pump, the marks and the guidance together. Every event ends in a new answer to "what is
// to be seen now". Knows no display and no browser.
import type { CellLights } from './cell';
import { mark, type Mark, type MarkEvent, type Marking } from './align';
import { Feed, type FeedEvent, type FeedOptions, type FeedState } from './feed';
import { distance, type Alignment, type Vec2, type Vec3 } from './frame';
import { lengthOf, show, type Ended, type Guidance, type Shown, type Standing, type Task } from './guide';
import { Pump, type Sample } from './pump';
import { explained, said, spoken } from '../language';

export interface WearerOptions extends Pick<FeedOptions, 'frame' | 'open' | 'clock' | 'random'> {
  /** Names of the marks that the wearer will show, and where the map has them. */
  marks: readonly { name: string; at: Vec2 }[];
  /** Poses of frames, as from a headset; or places that the wearer points out on a map. */
  poses: 'tracked' | 'placed';
  /** Asks the server for an assignment of this worker; null where it does not answer. */
  task(assignment: string): Promise<Task | null>;
  onChange(): void;
}

/** A place that the wearer pointed out on a map is believed for so long. */
export const PLACED_MS = 60_000;
const PLACED_EVERY_MS = 1_000;
const NOTICE_MS = 6_000;
/** So much of the path may be left for the wearer to be at the place already: metres. */
const THERE_M = 2.5;
/** A person who points at a map is right to about a metre. */
const PLACED_ACCURACY_M = 1;
/** What the server knows of a place is asked for every second, and old after two. */
const KNOWN_MS = 2_500;
/** After an assignment that could not be read it is asked for again, milliseconds. */
const ASK_AGAIN_MS = 3_000;
/** The end of an assignment may reach the server's list a moment after guidance: how often it is asked for, and how
 *  soon again, milliseconds. */
const ASK_END = 5;
const ASK_END_AGAIN_MS = 300;

export class Wearer {
  marking: Marking;
  alignment: Alignment | null = null;
  guidance: Guidance | null = null;
  feed: FeedState = { kind: 'connecting' };
  /** Why the last word that work is done was not taken. */
  notTaken: string | null = null;
  /** Poses that were sent. */
  sent = 0;
  placed: { at: Vec2; since: number } | null = null;
  /** What the worker is to do, as soon as the server has said it. */
  task: Task | null = null;
  /** The assignment that was done last, by the wearer's word. */
  finished: string | null = null;
  /** What is to be picked where the wearer stands. */
  cell: CellLights | null = null;
  /** How the assignment ended that guidance was for last, once the server has said so. */
  ended: Ended | null = null;
  readonly pump = new Pump();

  #options: WearerOptions;
  #feed: Feed;
  #heardAt: number | null = null;
  #quality: 'tracked' | 'emulated' = 'tracked';
  #acked = -1;
  #placedAt = -Infinity;
  /** The assignment that was said to be done, until the server has another one. */
  #reported: string | null = null;
  #asked: { assignment: string; at: number } | null = null;
  /** How well the server knows the place, by the most exact source. */
  #known: { accuracy_m: number; at: number } | null = null;
  /** The last thing that the server found wrong with what it got. */
  #warning: { text: string; at: number } | null = null;

  constructor(options: WearerOptions) {
    this.#options = options;
    const names = options.marks.map((m) => m.name);
    // In the frame of the map there is nothing to align.
    this.marking =
      options.frame === 'map' ? { kind: 'done', names, taken: [], rms_m: 0 } : { kind: 'taking', names, taken: [] };
    this.#feed = new Feed({
      ...options,
      onState: (state) => {
        this.feed = state;
        if (state.kind !== 'live') {
          [this.pump.aligned, this.cell, this.pump.wantsHands] = [false, null, false];
        }
        options.onChange();
      },
      onEvent: (event) => {
        this.#heard(event);
        options.onChange();
      },
    });
  }

  /** The page goes: no more poses come. */
  bye(): void {
    this.#feed.bye();
  }

  start(): void {
    this.#feed.start();
  }
  stop(): void {
    this.#feed.stop();
  }
  retryNow(): void {
    this.#feed.retryNow();
  }

  /** A frame of the display with a pose. */
  frame(sample: Sample): void {
    this.#quality = sample.emulated ? 'emulated' : 'tracked';
    const message = this.pump.offer(sample, this.#feed.waiting);
    if (message) this.#send(message);
  }

  /** Called a few times a second, with and without frames. */
  tick(): void {
    const now = this.#options.clock.now();
    this.#askTask(now);
    if (this.#options.poses === 'tracked') {
      const message = this.pump.missing(now);
      if (message) this.#send(message);
    } else if (this.placed && now - this.placed.since >= PLACED_MS) {
      this.placed = null;
    } else if (this.placed && now - this.#placedAt >= PLACED_EVERY_MS && this.pump.aligned) {
      this.#placedAt = now;
      this.#send(this.pump.place(this.placed.at, now, PLACED_ACCURACY_M));
    }
    this.#options.onChange();
  }

  /** The wearer confirms: the mark that is due, here; or, once the marks fit, that the work is done. False for
   *  neither. */
  confirm(at: Vec3): boolean {
    if (this.marking.kind === 'done') return this.done();
    const due = this.#options.marks[this.marking.taken.length];
    this.#mark({ kind: 'confirm', at, map: due?.at ?? [0, 0] });
    return true;
  }
  /**
   * The assignment that the wearer can say to be done with. In the room that is where its place is near, so that no
   * chance gesture ends it; a phone often knows no place, and has a button.
   */
  due(): string | null {
    const assignment = this.guidance?.assignment ?? null;
    const guided = ['following', 'deviating', 'redirected'].includes(this.shown().kind);
    if (!guided || assignment === null || assignment === this.#reported) return null;
    const isThere = this.guidance?.arrived === true || lengthOf(this.guidance?.path ?? []) < THERE_M;
    return this.#options.poses === 'placed' || isThere ? assignment : null;
  }
  done(): boolean {
    const due = this.due();
    if (due === null) return false;
    [this.#reported, this.notTaken] = [due, null];
    this.#feed.done(due);
    this.#options.onChange();
    return true;
  }
  /** Takes the marks anew; until then the alignment from before stands. */
  remark(): void {
    this.#mark({ kind: 'begin' });
  }
  /** The origin of the device's frame jumped. */
  reset(): void {
    this.alignment = null;
    this.pump.aligned = false;
    this.#feed.reset();
    this.#mark({ kind: 'reset' });
  }
  /** The page was hidden or the device slept: its clock may have stood. */
  woke(): void {
    this.#feed.resync();
    this.#feed.retryNow();
  }
  /** The wearer says where they stand; a tag that knows it better is believed instead. */
  place(at: Vec2): void {
    if (this.isKnown()) return this.#options.onChange();
    [this.placed, this.#placedAt] = [{ at, since: this.#options.clock.now() }, -Infinity];
    this.tick();
  }

  /** How well the server knows where the worker is; null where it does not. */
  located(accuracy_m: number | null): void {
    this.#known = accuracy_m === null ? null : { accuracy_m, at: this.#options.clock.now() };
    if (this.isKnown()) this.placed = null;
  }
  /** Whether a tag or another device sees the worker more exactly than a finger points. */
  isKnown(): boolean {
    const known = this.#known;
    return known !== null && known.accuracy_m < PLACED_ACCURACY_M && this.#options.clock.now() - known.at < KNOWN_MS;
  }

  shown(): Shown {
    const now = this.#options.clock.now();
    const tracking = this.#options.poses === 'placed' ? 'none' : this.pump.isLost(now) ? 'lost' : this.#quality;
    const link: Standing['link'] = this.feed.kind;
    const age_ms = this.#heardAt === null ? null : now - this.#heardAt;
    return show(
      this.guidance,
      { age_ms, link, tracking, aligned: this.#options.frame === 'map' || this.alignment !== null },
      this.task,
    );
  }

  /** What the server finds wrong with what it gets. It says so every two seconds while it lasts. */
  notice(): string | null {
    return this.#warning && this.#options.clock.now() - this.#warning.at < NOTICE_MS ? this.#warning.text : null;
  }

  /** Guidance of this version is on the screen. */
  drawn(): void {
    const version = this.guidance?.version;
    if (version === undefined || version === this.#acked || this.feed.kind !== 'live') return;
    this.#acked = version;
    this.#feed.seen(version);
  }

  /** How far the wearer is from the mark that is due, where that can be known. */
  fromMark(at: Vec2): number | null {
    const due = this.#options.marks[this.marking.taken.length];
    return due ? distance(at, due.at) : null;
  }

  #send(message: Parameters<Feed['pose']>[0]): void {
    this.sent += 1;
    this.#feed.pose(message);
  }

  #heard(event: FeedEvent): void {
    switch (event.kind) {
      case 'welcome':
        this.pump.enter(event.epoch, event.aligned);
        this.#acked = -1;
        // What was said on the old connection may never have arrived.
        this.#reported = null;
        // The marks are still where they were in the device's frame; the new connection has to hear of them.
        if (this.#options.frame === 'device') this.#mark({ kind: 'again' });
        return;
      case 'aligned':
        this.pump.enter(event.epoch, true);
        this.alignment = { theta: event.fit.theta, shift: event.fit.shift };
        return this.#mark({ kind: 'aligned', rms_m: event.fit.rms_m });
      case 'epoch':
        this.pump.enter(event.epoch, event.aligned);
        if (!event.aligned) this.alignment = null;
        return;
      case 'refused':
        if (!event.aligned) this.alignment = null;
        return this.#mark({ kind: 'refused', text: explained(spoken(), said(event.reason), said(event.remedy)) });
      case 'guidance':
        if (event.guidance.assignment !== this.guidance?.assignment) this.#leave(this.guidance?.assignment ?? null);
        [this.guidance, this.#heardAt] = [event.guidance, this.#options.clock.now()];
        return this.#askTask(this.#heardAt);
      case 'cell':
        [this.cell, this.pump.wantsHands] = [event.cell, event.cell.hands];
        return;
      case 'done':
        if (event.refused !== null) [this.#reported, this.notTaken] = [null, said(event.refused)];
        else this.finished = event.assignment;
        return;
      case 'warning':
        this.#warning = { text: said(event.text), at: this.#options.clock.now() };
        return;
      case 'clock':
        return;
    }
  }

  /** Guidance is no longer for an assignment. */
  #leave(assignment: string | null): void {
    this.notTaken = null;
    if (assignment !== null && assignment !== this.finished) this.#askEnd(assignment, ASK_END);
  }

  #askEnd(assignment: string, times: number): void {
    void this.#options.task(assignment).then((task) => {
      if (task?.state === 'done' || task?.state === 'cancelled') {
        this.ended = { id: assignment, how: task.state };
        this.#options.onChange();
      } else if (times > 1) this.#options.clock.after(ASK_END_AGAIN_MS, () => this.#askEnd(assignment, times - 1));
    });
  }

  /** Guidance names the assignment; what it is about is asked for once. */
  #askTask(now: number): void {
    const assignment = this.guidance?.assignment ?? null;
    if (assignment === null || assignment === this.task?.id) return;
    if (this.#asked?.assignment === assignment && now - this.#asked.at < ASK_AGAIN_MS) return;
    this.#asked = { assignment, at: now };
    void this.#options.task(assignment).then((task) => {
      if (task === null || this.guidance?.assignment !== task.id) return;
      this.task = task;
      this.#options.onChange();
    });
  }

  #mark(event: MarkEvent): void {
    const before = this.marking;
    this.marking = mark(before, event);
    if (this.marking.kind === 'asking' && this.marking !== before)
      this.#feed.anchors(this.marking.taken satisfies readonly Mark[]);
    this.#options.onChange();
  }
}
