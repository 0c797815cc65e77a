// Where a replay takes its frames from: a file that is here as a whole, or a server that is asked for a minute at a
// time. Seconds count from the start of the recording; a server's earlier runs lie before 0.
import type { Api, FloorMap, HeatKind, HeatPage, Mark, Sum } from '../wire';
import { t, trouble } from '../words';
import { readReel, type Listed, type Reel, type Frame } from './frames';
import { ends, type Span } from './spans';
import { linesOf } from './unpack';

export interface Recording {
  readonly source: 'file' | 'server' | 'recording';
  readonly name: string;
  /** Null where the page has it already. */
  readonly map: FloorMap | null;
  /** Seconds since 1970 from which times count; null in a simulation. */
  readonly start: number | null;
  /** From when to when there are frames. */
  readonly spans: readonly Span[];
  readonly marks: readonly Mark[];
  /** What is wrong, in words. */
  readonly wrong: string | null;
  /** The frames round a moment; null while they are fetched. */
  frames(t: number): readonly Frame[] | null;
  /** The frames from one moment to another, as far as they are here; the others are fetched. */
  between(from: number, to: number): readonly Frame[];
  /** Lists of the jobs that waited round a moment, in order; null while they are fetched. */
  lists(t: number): readonly Listed[] | null;
  /** Work cells round a moment, in order; null while they are fetched. */
  cells(t: number): readonly Listed[] | null;
  /** Sums from one moment to another, one for so many seconds at least; or what is wrong, in words. */
  sums(from: number, to: number, step: number): Promise<readonly Sum[] | string>;
  /** A map of heat of the seconds from one moment to another; or what is wrong, in words. */
  heat(kind: HeatKind, from: number, to: number): Promise<HeatPage | string>;
  /** Looks whether there is more by now. */
  refresh(): Promise<void>;
}

export class FileRecording implements Recording {
  readonly source = 'file';
  readonly name: string;
  readonly map: FloorMap;
  readonly start: number | null;
  readonly spans: readonly Span[];
  readonly marks: readonly Mark[];
  readonly wrong = null;
  #reel: Reel;

  constructor(reel: Reel) {
    if (!reel.map) throw new Error(t('reel.no-map'));
    this.name = reel.name;
    this.map = reel.map;
    this.start = reel.start;
    this.marks = reel.marks;
    this.#reel = reel;
    this.spans = spansOf(reel.frames);
  }

  static async open(bytes: Blob): Promise<FileRecording> {
    return new FileRecording(readReel(await linesOf(bytes)));
  }

  frames = (): readonly Frame[] => this.#reel.frames;
  between = (): readonly Frame[] => this.#reel.frames;
  lists = (): readonly Listed[] => this.#reel.lists;
  cells = (): readonly Listed[] => this.#reel.cells;
  sums = (): Promise<readonly Sum[]> => Promise.resolve(this.#reel.sums);
  heat = (): Promise<string> => Promise.resolve(t('replay.no-heat'));
  refresh = (): Promise<void> => Promise.resolve();
}

/** A longer time without a frame is a gap. */
const GAP_S = 5;

function spansOf(frames: readonly Frame[]): Span[] {
  const spans: Span[] = [];
  for (const { at } of frames) {
    const last = spans.at(-1);
    if (last && at - last.to_s < GAP_S) last.to_s = Math.max(last.to_s, at);
    else spans.push({ from_s: at, to_s: at });
  }
  return spans;
}

/** What a recording asks of a server. */
export type RecordingApi = Pick<Api, 'past' | 'figures' | 'reel' | 'heat'>;
/** A server's past comes in pieces of so many seconds. */
const PIECE_S = 60;
/** So many of them are kept. */
const MOST_PIECES = 16;
const AGAIN_MS = 2_000;

interface Piece {
  frames: readonly Frame[];
  lists: readonly Listed[];
  cells: readonly Listed[];
  to: number;
}

export class ServerRecording implements Recording {
  source: 'server' | 'recording' = 'server';
  readonly name = '';
  readonly map = null;
  start: number | null = null;
  spans: readonly Span[] = [];
  marks: readonly Mark[] = [];
  wrong: string | null = null;
  #api: RecordingApi;
  #now: () => number;
  #pieces = new Map<number, Piece>();
  #asked = new Map<number, number>();
  #fetching = new Set<number>();
  /** Pieces that were put together last. */
  #joined: { pieces: readonly Piece[]; frames: readonly Frame[] } = { pieces: [], frames: [] };

  private constructor(api: RecordingApi, now: () => number) {
    this.#api = api;
    this.#now = now;
  }

  /** What the server keeps, or why there is nothing to be had. `now` is a clock in milliseconds. */
  static async open(api: RecordingApi, now = () => performance.now()): Promise<ServerRecording | string> {
    const recording = new ServerRecording(api, now);
    await recording.refresh();
    return recording.wrong ?? recording;
  }

  async refresh(): Promise<void> {
    // An encounter is known when it is over, and its bookmark is where it began.
    const since = this.spans.length === 0 ? null : ends(this) - 2 * PIECE_S;
    const answer = await this.#api.past(since);
    this.wrong = trouble(answer);
    if (answer.kind !== 'ok') return;
    const { start, spans, bookmarks, recording } = answer.value;
    this.source = recording ? 'recording' : 'server';
    this.start = start === null ? null : Date.parse(start) / 1_000;
    this.spans = spans;
    this.marks = [...this.marks.filter((mark) => mark.at_s < (since ?? -Infinity)), ...bookmarks];
  }

  frames(t: number): readonly Frame[] | null {
    const number = Math.floor(t / PIECE_S);
    const piece = this.#pieces.get(number);
    // What was fetched while it was being written lacks its end.
    const lacks = !piece || (t > piece.to && ends(this) > piece.to + 0.5);
    if (lacks) void this.#fetch(number);
    if ((number + 1) * PIECE_S <= ends(this) && !this.#pieces.has(number + 1)) void this.#fetch(number + 1);
    return piece?.frames ?? null;
  }

  /** The same array as before where no piece has come. */
  between(from: number, to: number): readonly Frame[] {
    const pieces: Piece[] = [];
    for (let n = Math.floor(from / PIECE_S); n * PIECE_S <= to; n += 1) {
      if (!this.spans.some((span) => span.from_s < (n + 1) * PIECE_S && span.to_s >= n * PIECE_S)) continue;
      const piece = this.#pieces.get(n);
      if (!piece || piece.to + 0.5 < Math.min(to, (n + 1) * PIECE_S, ends(this))) void this.#fetch(n);
      if (piece) pieces.push(piece);
    }
    if (pieces.length !== this.#joined.pieces.length || pieces.some((piece, i) => piece !== this.#joined.pieces[i])) {
      // Each begins with a key frame, from before the end of the one that it follows.
      const frames = pieces.flatMap((piece, i) =>
        i === 0 ? piece.frames : piece.frames.filter((frame) => frame.at > pieces[i - 1]!.to),
      );
      this.#joined = { pieces, frames };
    }
    return this.#joined.frames;
  }

  lists = (t: number): readonly Listed[] | null => this.#pieces.get(Math.floor(t / PIECE_S))?.lists ?? null;
  cells = (t: number): readonly Listed[] | null => this.#pieces.get(Math.floor(t / PIECE_S))?.cells ?? null;

  async sums(from: number, to: number, step: number): Promise<readonly Sum[] | string> {
    const answer = await this.#api.figures(from, to, step);
    return answer.kind === 'ok' ? answer.value.sums : (trouble(answer) ?? '');
  }

  async heat(kind: HeatKind, from: number, to: number): Promise<HeatPage | string> {
    // A recording that a server plays has no figures by place.
    if (this.source !== 'server' || this.start === null) return t('replay.no-heat');
    const { start } = this;
    const time = (s: number): string => new Date(1_000 * (start + s)).toISOString();
    const answer = await this.#api.heat(kind, { from: time(from), to: time(to) });
    return answer.kind === 'ok' ? answer.value : (trouble(answer) ?? '');
  }

  async #fetch(number: number): Promise<void> {
    const now = this.#now();
    if (this.#fetching.has(number) || now - (this.#asked.get(number) ?? -Infinity) < AGAIN_MS) return;
    this.#asked.set(number, now);
    this.#fetching.add(number);
    const answer = await this.#api.reel(number * PIECE_S, (number + 1) * PIECE_S + 0.5, 'without map');
    this.#fetching.delete(number);
    this.wrong = trouble(answer);
    if (answer.kind !== 'ok') return;
    try {
      const { frames, lists, cells } = readReel(await linesOf(answer.value));
      this.#pieces.delete(number);
      this.#pieces.set(number, { frames, lists, cells, to: frames.at(-1)?.at ?? 0 });
    } catch (error) {
      this.wrong = error instanceof Error ? error.message : String(error);
    }
    for (const oldest of this.#pieces.keys()) {
      if (this.#pieces.size <= MOST_PIECES) break;
      this.#pieces.delete(oldest);
      this.#asked.delete(oldest);
    }
  }
}
