// What a painter is: something that shows a kept picture of the ground and sheets above it. There are
// two, WebGL and canvas 2D, and they draw the same sheets.
import type { Palette } from './palette';
import type { Sheet, Words } from './sheet';
import type { View } from '../scene/view';

/** The ground as drawn for one view, usually larger than the window so that panning needs no redraw. */
export interface Ground {
  picture: HTMLCanvasElement;
  view: View;
}
export interface Frame {
  view: View;
  ground: Ground;
  /** From the floor up. */
  sheets: readonly Sheet[];
  words: Words;
}
export interface Painter {
  readonly kind: 'webgl' | 'canvas2d';
  readonly element: HTMLCanvasElement;
  recolour(palette: Palette): void;
  resize(width: number, height: number, density: number): void;
  draw(frame: Frame): void;
  destroy(): void;
}
