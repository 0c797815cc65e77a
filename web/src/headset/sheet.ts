// The writing in the room, on one canvas: the board before the eyes, the word STOP, and a label for each robot.
import type { Tone } from './guide';
import { spoken } from './words';

export interface Writing {
  tone: Tone;
  title: string;
  detail: string;
  labels: readonly { text: string; close: boolean }[];
}
type Piece = readonly [x: number, y: number, width: number, height: number];

export const MOST_LABELS = 6;
const [WIDTH, BOARD, LABEL] = [1024, 304, 96] as const;
export const BOARD_PIECE: Piece = [0, 0, WIDTH, BOARD];
export const labelPiece = (i: number): Piece => [
  (i % 2) * (WIDTH / 2),
  BOARD + Math.floor(i / 2) * LABEL,
  WIDTH / 2,
  LABEL,
];
/** Not more often: writing is slow. */
const EVERY_MS = 150;

export class Sheet {
  readonly canvas = document.createElement('canvas');
  #written = '';
  #at = -Infinity;
  #ink: (name: string) => string;

  constructor(ink: (name: string) => string) {
    this.#ink = ink;
    [this.canvas.width, this.canvas.height] = [WIDTH, BOARD + (LABEL * MOST_LABELS) / 2];
  }

  /** Writes it, unless it is there already; true where something changed. */
  write(writing: Writing, now: number): boolean {
    const key = JSON.stringify(writing);
    const urgent = writing.tone === 'stop' && !this.#written.includes('"tone":"stop"');
    if (key === this.#written || (!urgent && now - this.#at < EVERY_MS)) return false;
    const c = this.canvas.getContext('2d');
    if (!c) return false;
    [this.#written, this.#at] = [key, now];
    c.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.#board(c, writing);
    writing.labels.slice(0, MOST_LABELS).forEach(({ text, close }, i) => {
      const [x, y, w, h] = labelPiece(i);
      box(c, x + 8, y + 8, w - 16, h - 16, this.#ink(close ? 'xr-close' : 'xr-board'));
      c.fillStyle = this.#ink(close ? 'xr-on-close' : 'xr-text');
      fit(c, text, 46, 650, w - 50, x + w / 2, y + h / 2);
    });
    return true;
  }

  #board(c: CanvasRenderingContext2D, { tone, title, detail }: Writing): void {
    const stop = tone === 'stop';
    if (!stop) box(c, 4, 4, WIDTH - 8, BOARD - 8, this.#ink('xr-board'));
    if (tone === 'warn' || tone === 'notice') {
      c.fillStyle = this.#ink(tone === 'warn' ? 'xr-close' : 'xr-next');
      c.fillRect(4, 40, 16, BOARD - 80);
    }
    c.fillStyle = this.#ink(stop ? 'xr-on-stop' : 'xr-text');
    fit(c, title, stop ? 150 : 84, 700, WIDTH - 90, WIDTH / 2, stop ? 84 : 74);
    const lines = wrap(c, detail, 50, WIDTH - 80).slice(0, 3);
    lines.forEach((line, i) => fit(c, line, 50, 450, WIDTH - 70, WIDTH / 2, (lines.length < 3 ? 180 : 158) + 56 * i));
  }
}

const font = (px: number, weight: number): string =>
  `${weight} ${px}px system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', sans-serif`;

function fit(
  c: CanvasRenderingContext2D,
  text: string,
  px: number,
  weight: number,
  room: number,
  x: number,
  y: number,
): void {
  c.font = font(px, weight);
  const wide = c.measureText(text).width;
  if (wide > room) c.font = font((px * room) / wide, weight);
  [c.textAlign, c.textBaseline] = ['center', 'middle'];
  c.fillText(text, x, y);
}

function wrap(c: CanvasRenderingContext2D, text: string, px: number, room: number): string[] {
  c.font = font(px, 450);
  const lines = [''];
  for (const part of partsOf(text)) {
    const longer = `${lines.at(-1)}${part}`;
    if (c.measureText(longer.trimEnd()).width > room && lines.at(-1) !== '') lines.push(part);
    else lines[lines.length - 1] = longer;
  }
  return lines.map((line) => line.trim());
}

/** What a line may end with: words with the space behind them; in languages without spaces, as their words go. */
export function partsOf(text: string, language = spoken()): string[] {
  if (language !== 'zh') return text.split(/(?<= )/);
  const parts: string[] = [];
  for (const { segment, isWordLike } of new Intl.Segmenter(language, { granularity: 'word' }).segment(text)) {
    // No line begins with a full stop.
    if (isWordLike || parts.length === 0) parts.push(segment);
    else parts.push(`${parts.pop()}${segment}`);
  }
  return parts;
}

function box(c: CanvasRenderingContext2D, x: number, y: number, w: number, h: number, fill: string): void {
  c.fillStyle = fill;
  c.beginPath();
  c.roundRect(x, y, w, h, 28);
  c.fill();
}
