// One batch of textured rectangles for WebGL: begin, put any number of shapes, end. Shapes are white in
// the atlas and take their colour when put; particles are kept from one frame to the next.
import { Particle, ParticleContainer, Rectangle, Texture } from 'pixi.js';
import { outlinePerson, PERSON_REACH } from './people';

const CELL = 64;
const PAD = 2;
/** Pieces of a thin circle. */
const ARCS = 64;
const SHAPES = ['disc', 'square', 'frame', 'ring', 'cross', 'person', 'shadow'] as const;
export type Shape = (typeof SHAPES)[number];
export type Atlas = Record<Shape, Texture>;

export function paintAtlas(): Atlas {
  const canvas = document.createElement('canvas');
  canvas.width = CELL * SHAPES.length;
  canvas.height = CELL;
  const ink = canvas.getContext('2d');
  if (!ink) throw new Error('no 2D canvas to draw shapes on');
  ink.fillStyle = ink.strokeStyle = '#fff';
  const half = CELL / 2 - PAD;
  const draw: Record<Shape, () => void> = {
    disc: () => { ink.arc(0, 0, half, 0, 2 * Math.PI); ink.fill(); },
    square: () => ink.fillRect(-half, -half, 2 * half, 2 * half),
    frame: () => { ink.lineWidth = 6; ink.strokeRect(3 - half, 3 - half, 2 * half - 6, 2 * half - 6); },
    ring: () => { ink.lineWidth = 5; ink.arc(0, 0, half - 2.5, 0, 2 * Math.PI); ink.stroke(); },
    cross: () => {
      ink.lineWidth = 7; ink.lineCap = 'round';
      ink.moveTo(4 - half, 4 - half); ink.lineTo(half - 4, half - 4);
      ink.moveTo(half - 4, 4 - half); ink.lineTo(4 - half, half - 4); ink.stroke();
    },
    person: () => { outlinePerson(ink, half / PERSON_REACH); ink.fill(); },
    shadow: () => { ink.lineWidth = 5; ink.lineJoin = 'round'; outlinePerson(ink, (half - 3) / PERSON_REACH); ink.stroke(); },
  };
  SHAPES.forEach((shape, i) => {
    ink.setTransform(1, 0, 0, 1, i * CELL + CELL / 2, CELL / 2);
    ink.beginPath();
    draw[shape]();
  });
  const { source } = Texture.from(canvas, true);
  // Robots are a few pixels wide on a whole floor; without mipmaps they would flicker as they move.
  source.autoGenerateMipmaps = true;
  source.scaleMode = 'linear';
  const frame = (i: number) => new Rectangle(i * CELL + PAD, PAD, CELL - 2 * PAD, CELL - 2 * PAD);
  return Object.fromEntries(SHAPES.map((shape, i) => [shape, new Texture({ source, frame: frame(i) })])) as Atlas;
}

/** A CSS colour as computed ("rgb(…)" or "rgba(…)") in the order that particles want: ABGR. */
export function inkOf(css: string, opacity = 1): number {
  const [r = 0, g = 0, b = 0, a = 1] = (css.match(/[\d.]+/g) ?? []).map(Number);
  return ((Math.round(a * opacity * 255) << 24) | (b << 16) | (g << 8) | r) >>> 0;
}

export class Brush {
  readonly layer: ParticleContainer;
  #atlas: Atlas;
  #pool: Particle[] = [];
  #used = 0;

  constructor(atlas: Atlas) {
    this.#atlas = atlas;
    this.layer = new ParticleContainer({
      texture: atlas.square,
      dynamicProperties: { position: true, rotation: true, vertex: true, uvs: true, color: true },
    });
  }

  begin(): void {
    this.#used = 0;
  }

  put(shape: Shape, x: number, y: number, width: number, height: number, ink: number, turn = 0): void {
    let particle = this.#pool[this.#used];
    if (!particle) {
      particle = new Particle({ texture: this.#atlas.square, anchorX: 0.5, anchorY: 0.5 });
      this.#pool.push(particle);
    }
    this.#used += 1;
    particle.texture = this.#atlas[shape];
    particle.x = x;
    particle.y = y;
    particle.scaleX = width / (CELL - 2 * PAD);
    particle.scaleY = height / (CELL - 2 * PAD);
    particle.rotation = turn;
    particle.color = ink;
  }

  line(x0: number, y0: number, x1: number, y1: number, width: number, ink: number): void {
    const far = Math.hypot(x1 - x0, y1 - y0);
    this.put('square', (x0 + x1) / 2, (y0 + y1) / 2, far + width, width, ink, Math.atan2(y1 - y0, x1 - x0));
  }

  circle(x: number, y: number, r: number, width: number, ink: number): void {
    const step = (2 * Math.PI) / ARCS;
    for (let k = 0; k < ARCS; k++) {
      const [a, b] = [k * step, (k + 1) * step];
      this.line(x + r * Math.cos(a), y + r * Math.sin(a), x + r * Math.cos(b), y + r * Math.sin(b), width, ink);
    }
  }

  end(): void {
    const shown = this.layer.particleChildren as Particle[];
    if (shown.length !== this.#used) {
      shown.length = Math.min(shown.length, this.#used);
      for (let i = shown.length; i < this.#used; i++) shown.push(this.#pool[i]!);
      this.layer.update();
    }
  }
}
