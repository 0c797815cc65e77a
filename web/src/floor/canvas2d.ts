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
    /** What the open path is made of; -1 while there is none. */
    let [kind, colour, width, more] = [-1, -1, 0, 0];
    const end = (): void => {
      if (kind === KIND.box || kind === KIND.disc) ink.fill();
      else if (kind >= 0) ink.stroke();
      if (kind === KIND.dashes) ink.setLineDash([]);
      kind = -1;
    };
    for (let at = 0; at < count * STRIDE; at += STRIDE) {
      const x = marks[at]!;
      const y = marks[at + 1]!;
      const w = marks[at + 2]!;
      const h = marks[at + 3]!;
      const reach = Math.max(w, h);
      if (Math.abs(x - view.x) > halfX + reach || Math.abs(y - view.y) > halfY + reach) continue;
      const [turn, is, extra, dye] = [marks[at + 4]!, marks[at + 5]! as Kind, marks[at + 6]!, inks[at + 7]!];
      // Along an axis or across it, a turned box is a plain one.
      const across = Math.abs(Math.cos(turn)) < 1e-6;
      const runs = is === KIND.disc || is === KIND.ring || is === KIND.dashes || (is === KIND.box && (across || Math.abs(Math.sin(turn)) < 1e-6));
      const lineWidth = is === KIND.ring ? extra : h;
      const stroked = is === KIND.ring || is === KIND.dashes;
      if (!runs || is !== kind || dye !== colour || (stroked && (lineWidth !== width || extra !== more))) {
        end();
        ink.fillStyle = ink.strokeStyle = this.#colour(dye);
      }
      if (!runs) {
        ink.save();
        ink.translate(x, y);
        if (turn !== 0) ink.rotate(turn);
        this.#mark(is, w, h, extra, view.scale, dye);
        ink.restore();
        continue;
      }
      if (kind < 0) {
        ink.beginPath();
        if (stroked) ink.lineWidth = lineWidth;
        if (is === KIND.dashes) ink.setLineDash([extra * DASH, extra * (1 - DASH)]);
      }
      [kind, colour, width, more] = [is, dye, lineWidth, extra];
      const r = w / 2;
      if (is === KIND.disc) { ink.moveTo(x + r, y); ink.arc(x, y, r, 0, TAU); }
      else if (is === KIND.ring) { ink.moveTo(x + r - extra / 2, y); ink.arc(x, y, r - extra / 2, 0, TAU); }
      else if (is === KIND.dashes) {
        const [dx, dy] = [r * Math.cos(turn), r * Math.sin(turn)];
        ink.moveTo(x - dx, y - dy);
        ink.lineTo(x + dx, y + dy);
      } else if (across) ink.rect(x - h / 2, y - r, h, w);
      else ink.rect(x - r, y - h / 2, w, h);
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
      case KIND.cross:
        ink.moveTo(-r, -r); ink.lineTo(r, r); ink.moveTo(-r, r); ink.lineTo(r, -r);
        ink.lineWidth = more; ink.stroke();
        return;
      case KIND.person:
        outlinePerson(ink, r / PERSON_REACH);
        if (more === 0) { ink.fill(); return; }
        ink.lineWidth = more; ink.stroke();
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
