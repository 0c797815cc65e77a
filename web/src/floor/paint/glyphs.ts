// Letters for the WebGL painter: one picture with a cell for each, drawn when first needed. Red says how
// much of a pixel is letter, green how much is letter or the rim around it.

/** Size of a cell, pixels of the picture; letters are drawn this much larger than FONT_PX. */
export const CELL = 40;
const ACROSS = 16;
export const SIDE = CELL * ACROSS;
const FONT_PX = 11;
export const SHARPNESS = 2;
const RIM = 3 * SHARPNESS;

export class Glyphs {
  readonly picture = document.createElement('canvas');
  /** Counts the times that the picture changed. */
  turn = 0;
  #ink: CanvasRenderingContext2D;
  #cells = new Map<string, { cell: number; advance: number }>();

  constructor() {
    this.picture.width = this.picture.height = SIDE;
    const ink = this.picture.getContext('2d', { willReadFrequently: true });
    if (!ink) throw new Error('no 2D canvas to draw letters on');
    ink.fillStyle = '#000';
    ink.fillRect(0, 0, SIDE, SIDE);
    ink.font = `600 ${FONT_PX * SHARPNESS}px system-ui, sans-serif`;
    ink.textAlign = 'left';
    ink.textBaseline = 'middle';
    ink.lineJoin = 'round';
    ink.lineWidth = RIM;
    this.#ink = ink;
  }

  /** The cell of a letter, and how far the next one is from it as a part of the height of letters. */
  of(letter: string): { cell: number; advance: number } {
    return this.#cells.get(letter) ?? this.#draw(letter);
  }

  #draw(letter: string): { cell: number; advance: number } {
    if (this.#cells.size === ACROSS * ACROSS) return this.#cells.get('?') ?? { cell: 0, advance: 0.6 };
    const ink = this.#ink;
    const cell = this.#cells.size;
    const [x, y] = [(cell % ACROSS) * CELL, Math.floor(cell / ACROSS) * CELL];
    const known = { cell, advance: ink.measureText(letter).width / (FONT_PX * SHARPNESS) };
    this.#cells.set(letter, known);
    ink.save();
    ink.beginPath();
    ink.rect(x, y, CELL, CELL);
    ink.clip();
    ink.strokeStyle = ink.fillStyle = '#0f0';
    ink.strokeText(letter, x + RIM, y + CELL / 2);
    ink.fillText(letter, x + RIM, y + CELL / 2);
    ink.globalCompositeOperation = 'lighter';
    ink.fillStyle = '#f00';
    ink.fillText(letter, x + RIM, y + CELL / 2);
    ink.restore();
    this.turn += 1;
    return known;
  }

  /** Where a letter begins in its cell, as a part of the height of letters. */
  static readonly INSET = RIM / (FONT_PX * SHARPNESS);
  /** Side of a cell in heights of letters. */
  static readonly REACH = CELL / (FONT_PX * SHARPNESS);
}
