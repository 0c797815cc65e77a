// What a painter is: something that shows a kept picture of the ground and the scene above it. There are
// two, WebGL and canvas 2D, and they must look alike.
import type { Palette } from './palette';
import type { Scene } from './scene';
import type { View } from './view';

/** The ground as drawn for one view, usually larger than the window so that panning needs no redraw. */
export interface Ground {
  picture: HTMLCanvasElement;
  view: View;
}
export interface Frame {
  view: View;
  ground: Ground;
  scene: Scene;
  /** Index of the robot in the side panel, or -1. */
  chosen: number;
  /** Index of the person in the side panel, or -1. */
  person: number;
}
export interface Painter {
  readonly kind: 'webgl' | 'canvas2d';
  readonly element: HTMLCanvasElement;
  recolour(palette: Palette): void;
  resize(width: number, height: number, density: number): void;
  draw(frame: Frame): void;
  destroy(): void;
}

/** Sizes in metres, shared so that the painters agree. */
export const SIZE = {
  robot: 0.38, tick: 0.36, rack: 0.42, carried: 0.46, ring: 0.5, chosen: 0.62,
  granted: 0.13, held: 0.05, person: 0.4, ahead: 0.09,
} as const;
/** Names appear from this many pixels per metre on, where neighbours no longer write over each other. */
export const NAMES_FROM = 56;
export const RACK_NAMES_FROM = 44;
/** How far below its mark a person's name stands, metres: people are few, so it is shown at any scale. */
export const belowPerson = (scale: number): number => Math.max(0.7, 15 / scale);
/** Of a person's mark, metres: never so small that it is lost among the robots. */
export const personRadius = (scale: number): number => Math.max(SIZE.person, 6 / scale);
