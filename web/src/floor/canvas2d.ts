// The canvas 2D painter, for machines without a graphics card: the same sheets, mark by mark; runs of the
// same mark in the same ink become one path.
import { label } from './ground';
import type { Frame, Painter } from './painter';
import type { Palette } from './palette';
import { outlinePerson, PERSON_REACH } from './people';
import { ARC_WIDTH, cssOf, DASH, KIND, RING_DASHES, STRIDE, type Kind, type Sheet } from './sheet';
import type { View } from './view';

const TAU = 2 * Math.PI;

export class Canvas2dPainter implements Painter {
  readonly kind = 'canvas2d';
  readonly element = document.createElement('canvas');
  #ink: CanvasRenderingContext2D;
  #palette: Palette;
  #density = 1;
  #css = new Map<number, string>();

  constructor(palette: Palette) {
    const ink = this.element.getContext('2d', { alpha: false });
    if (!ink) throw new Error('This browser can draw neither with WebGL nor on a 2D canvas.');
    this.#ink = ink;
    this.#palette = palette;
  }

  recolour(palette: Palette): void {
    this.#palette = palette;
  }

  resize(width: number, height: number, density: number): void {
    this.#density = density;
    this.element.width = Math.round(width * density);
    this.element.height = Math.round(height * density);
  }

  draw({ view, ground, sheets, words }: Frame): void {
    const ink = this.#ink;
    ink.setTransform(this.#density, 0, 0, this.#density, 0, 0);
    ink.fillStyle = this.#palette.of.void;
    ink.fillRect(0, 0, view.width, view.height);
    const zoom = view.scale / ground.view.scale;
    const w = ground.view.width * zoom;
    const h = ground.view.height * zoom;
    ink.drawImage(ground.picture,
      (ground.view.x - view.x) * view.scale + view.width / 2 - w / 2,
      (view.y - ground.view.y) * view.scale + view.height / 2 - h / 2, w, h);

    // From here on a unit is a metre and y points up.
    const m = view.scale * this.#density;
    ink.setTransform(m, 0, 0, -m,
      (view.width / 2 - view.x * view.scale) * this.#density,
      (view.height / 2 + view.y * view.scale) * this.#density);
    ink.lineCap = 'butt';
    for (const sheet of sheets) this.#sheet(sheet, view);
    ink.setTransform(this.#density, 0, 0, this.#density, 0, 0);
    for (let i = 0; i < words.count; i++) {
      const { text, x, y, below, px } = words.list[i]!;
      label(ink, text, (x - view.x) * view.scale + view.width / 2, (view.y - y) * view.scale + view.height / 2 + below, px, this.#palette.of);
    }
  }

  destroy(): void {
    this.element.remove();
  }

  #sheet({ marks, inks, count }: Sheet, view: View): void {
    const ink = this.#ink;
    const [halfX, halfY] = [view.width / 2 / view.scale, view.height / 2 / view.scale];
    let run = -1;
    let colour = -1;
    const end = (): void => {
      if (run >= 0) ink.fill();
      run = -1;
    };
    for (let at = 0; at < count * STRIDE; at += STRIDE) {
      const x = marks[at]!;
      const y = marks[at + 1]!;
      const w = marks[at + 2]!;
      const h = marks[at + 3]!;
      const reach = Math.max(w, h);
      if (Math.abs(x - view.x) > halfX + reach || Math.abs(y - view.y) > halfY + reach) continue;
      const kind = marks[at + 5]! as Kind;
      const turn = marks[at + 4]!;
      const plain = kind === KIND.disc || (kind === KIND.box && turn === 0);
      if (!plain || kind !== run || inks[at + 7] !== colour) end();
      colour = inks[at + 7]!;
      if (plain) {
        if (run < 0) { ink.beginPath(); ink.fillStyle = this.#colour(colour); }
        run = kind;
        if (kind === KIND.disc) { ink.moveTo(x + w / 2, y); ink.arc(x, y, w / 2, 0, TAU); }
        else ink.rect(x - w / 2, y - h / 2, w, h);
        continue;
      }
      ink.fillStyle = ink.strokeStyle = this.#colour(colour);
      ink.save();
      ink.translate(x, y);
      if (turn !== 0) ink.rotate(turn);
      this.#mark(kind, w, h, marks[at + 6]!, view.scale, colour);
      ink.restore();
    }
    end();
  }

  /** One mark around the origin, in the ink that is set. */
  #mark(kind: Kind, w: number, h: number, more: number, scale: number, colour: number): void {
    const ink = this.#ink;
    const r = w / 2;
    ink.beginPath();
    switch (kind) {
      case KIND.box: ink.fillRect(-r, -h / 2, w, h); return;
      case KIND.frame:
        ink.lineWidth = more;
        ink.strokeRect(more / 2 - r, (more - h) / 2, w - more, h - more);
        return;
      case KIND.disc: ink.arc(0, 0, r, 0, TAU); ink.fill(); return;
      case KIND.ring: ink.arc(0, 0, r - more / 2, 0, TAU); ink.lineWidth = more; ink.stroke(); return;
      case KIND.cross:
        ink.moveTo(-r, -r); ink.lineTo(r, r); ink.moveTo(-r, r); ink.lineTo(r, -r);
        ink.lineWidth = more; ink.stroke();
        return;
      case KIND.person:
        outlinePerson(ink, r / PERSON_REACH);
        if (more === 0) { ink.fill(); return; }
        ink.lineWidth = more; ink.stroke();
        return;
      case KIND.dashes:
        ink.setLineDash([more * DASH, more * (1 - DASH)]);
        ink.moveTo(-r, 0); ink.lineTo(r, 0); ink.lineWidth = h; ink.stroke(); ink.setLineDash([]);
        return;
      case KIND.dashring: {
        const dash = TAU * r / RING_DASHES;
        ink.setLineDash([dash * DASH, dash * (1 - DASH)]);
        ink.arc(0, 0, r - more / 2, 0, TAU); ink.lineWidth = more; ink.stroke(); ink.setLineDash([]);
        return;
      }
      case KIND.hatch:
        ink.arc(0, 0, r, 0, TAU); ink.clip(); ink.beginPath();
        for (let d = -2 * r; d < 2 * r; d += more * Math.SQRT2) { ink.moveTo(d - r, r); ink.lineTo(d + r, -r); }
        ink.lineWidth = 1.2 / scale; ink.stroke();
        return;
      case KIND.arc: {
        const width = r * ARC_WIDTH;
        ink.arc(0, 0, r - width / 2, Math.PI / 2, Math.PI / 2 - TAU * more, true); ink.lineWidth = width; ink.stroke();
        return;
      }
      case KIND.bolt:
        ink.moveTo(0.3 * r, r); ink.lineTo(-0.6 * r, -0.12 * r); ink.lineTo(0, -0.12 * r); ink.lineTo(-0.3 * r, -r);
        ink.lineTo(0.6 * r, 0.12 * r); ink.lineTo(0, 0.12 * r); ink.closePath(); ink.fill();
        return;
      case KIND.heat: {
        ink.scale(1, h / w);
        const bell = ink.createRadialGradient(0, 0, 0, 0, 0, r);
        for (const part of [0, 0.2, 0.4, 0.6, 0.8, 1]) {
          const shade = Math.max(0, Math.exp(-4.5 * part * part) - 0.0111);
          bell.addColorStop(part, cssOf(((Math.round((colour >>> 24) * shade) << 24) | (colour & 0xffffff)) >>> 0));
        }
        ink.fillStyle = bell;
        ink.arc(0, 0, r, 0, TAU); ink.fill();
      }
    }
  }

  #colour(ink: number): string {
    let css = this.#css.get(ink);
    if (css === undefined) this.#css.set(ink, css = cssOf(ink));
    return css;
  }
}
