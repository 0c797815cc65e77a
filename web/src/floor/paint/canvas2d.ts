// The canvas 2D painter, for machines without a graphics card: the same sheets, mark by mark; runs of the
// same mark in the same ink become one path.
import { t } from '../../words';
import { label } from './ground';
import type { Frame, Painter } from './painter';
import type { Palette } from './palette';
import { outlinePerson, PERSON_REACH } from '../scene/people';
import { ARC_WIDTH, cssOf, DASH, KIND, RING_DASHES, STRIDE, type Kind, type Sheet } from './sheet';
import { inSight, toScreen, type View } from '../scene/view';

const TAU = 2 * Math.PI;
/** Marks of which many in a row become one path. */
const RUNS: ReadonlySet<Kind> = new Set([KIND.box, KIND.disc, KIND.ring, KIND.frame, KIND.dashes]);
interface Run {
  kind: Kind;
  dye: number;
  /** Of the line; 0 for what is filled. */
  width: number;
  more: number;
  path: Path2D;
}

export class Canvas2dPainter implements Painter {
  readonly kind = 'canvas2d';
  readonly element = document.createElement('canvas');
  #ink: CanvasRenderingContext2D;
  #palette: Palette;
  #density = 1;
  #css = new Map<number, string>();
  #kept = new Map<Sheet, { turn: number; strokes: (() => void)[] | null }>();
  #scale = 1;
  #turned = false;

  constructor(palette: Palette) {
    const ink = this.element.getContext('2d', { alpha: false });
    if (!ink) throw new Error(t('floor.no-canvas'));
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
    const [cx, cy] = toScreen(view, ground.view.x, ground.view.y);
    ink.drawImage(ground.picture, cx - w / 2, cy - h / 2, w, h);

    // From here on a unit is a metre and the axes are those of the map.
    const m = view.scale * this.#density;
    const [ox, oy] = toScreen(view, 0, 0);
    if (view.turned) ink.setTransform(0, m, m, 0, ox * this.#density, oy * this.#density);
    else ink.setTransform(m, 0, 0, -m, ox * this.#density, oy * this.#density);
    if (this.#turned !== Boolean(view.turned)) this.#kept.clear();
    this.#turned = Boolean(view.turned);
    ink.lineCap = 'butt';
    this.#scale = view.scale;
    for (const sheet of sheets) this.#sheet(sheet, view);
    ink.setLineDash([]);
    ink.setTransform(this.#density, 0, 0, this.#density, 0, 0);
    for (let i = 0; i < words.count; i++) {
      const { text, x, y, below, px, pale } = words.list[i]!;
      const { halo, label: dark, gauge } = this.#palette.of;
      const [left, top] = toScreen(view, x, y);
      label(ink, text, left, top + below, px, halo, pale ? gauge : dark);
    }
  }

  destroy(): void {
    this.element.remove();
  }

  /** A sheet that stays as it is becomes paths the second time, which are then drawn with few words. */
  #sheet(sheet: Sheet, view: View): void {
    let kept = this.#kept.get(sheet);
    if (kept?.turn !== sheet.turn) {
      this.#kept.set(sheet, { turn: sheet.turn, strokes: null });
      this.#walk(sheet, view, (stroke) => stroke());
      return;
    }
    if (kept.strokes === null) {
      const strokes: (() => void)[] = [];
      this.#walk(sheet, null, (stroke) => strokes.push(stroke));
      this.#kept.set(sheet, (kept = { turn: sheet.turn, strokes }));
    }
    for (const stroke of kept.strokes!) stroke();
  }

  /** Goes through the marks in sight, or through all without a view, and hands out what is to be drawn. */
  #walk({ marks, inks, count }: Sheet, view: View | null, out: (stroke: () => void) => void): void {
    let run: Run | null = null;
    for (let at = 0; at < count * STRIDE; at += STRIDE) {
      const x = marks[at]!;
      const y = marks[at + 1]!;
      const w = marks[at + 2]!;
      const h = marks[at + 3]!;
      if (view && !inSight(view, x, y, Math.max(w, h))) continue;
      const [turn, kind, more, dye] = [marks[at + 4]!, marks[at + 5]! as Kind, marks[at + 6]!, inks[at + 7]!];
      const width = kind === KIND.dashes ? h : kind === KIND.ring || kind === KIND.frame ? more : 0;
      if (!RUNS.has(kind) || (kind === KIND.frame && turn !== 0)) {
        if (run) out(this.#finish(run));
        run = null;
        out(() => this.#single(kind, x, y, w, h, turn, more, dye));
        continue;
      }
      if (run && (run.kind !== kind || run.dye !== dye || run.width !== width || (width > 0 && run.more !== more))) {
        out(this.#finish(run));
        run = null;
      }
      run ??= { kind, dye, width, more, path: new Path2D() };
      const { path } = run;
      const r = w / 2;
      switch (kind) {
        case KIND.disc:
          path.moveTo(x + r, y);
          path.arc(x, y, r, 0, TAU);
          break;
        case KIND.ring:
          path.moveTo(x + r - more / 2, y);
          path.arc(x, y, r - more / 2, 0, TAU);
          break;
        case KIND.frame:
          path.rect(x - r + more / 2, y - (h - more) / 2, w - more, h - more);
          break;
        case KIND.dashes: {
          const [dx, dy] = [r * Math.cos(turn), r * Math.sin(turn)];
          path.moveTo(x - dx, y - dy);
          path.lineTo(x + dx, y + dy);
          break;
        }
        default:
          addBox(path, x, y, w, h, turn);
      }
    }
    if (run) out(this.#finish(run));
  }

  #finish({ kind, dye, width, more, path }: Run): () => void {
    const ink = this.#ink;
    const colour = this.#colour(dye);
    if (width === 0)
      return () => {
        ink.fillStyle = colour;
        ink.fill(path);
      };
    const dash = kind === KIND.dashes ? [more * DASH, more * (1 - DASH)] : [];
    return () => {
      ink.strokeStyle = colour;
      ink.lineWidth = width;
      ink.setLineDash(dash);
      ink.stroke(path);
    };
  }

  #single(kind: Kind, x: number, y: number, w: number, h: number, turn: number, more: number, dye: number): void {
    const ink = this.#ink;
    ink.fillStyle = ink.strokeStyle = this.#colour(dye);
    ink.setLineDash([]);
    ink.save();
    ink.translate(x, y);
    // Signs stand upright on the picture.
    const upright = this.#turned && (kind === KIND.arc || kind === KIND.bolt) ? Math.PI / 2 : 0;
    if (turn + upright !== 0) ink.rotate(turn + upright);
    this.#mark(kind, w, h, more, dye);
    ink.restore();
  }

  /** One mark around the origin, in the ink that is set. */
  #mark(kind: Kind, w: number, h: number, more: number, colour: number): void {
    const ink = this.#ink;
    const r = w / 2;
    ink.beginPath();
    switch (kind) {
      case KIND.box:
        ink.fillRect(-r, -h / 2, w, h);
        return;
      case KIND.cross:
        ink.moveTo(-r, -r);
        ink.lineTo(r, r);
        ink.moveTo(-r, r);
        ink.lineTo(r, -r);
        ink.lineWidth = more;
        ink.stroke();
        return;
      case KIND.person:
        outlinePerson(ink, r / PERSON_REACH);
        if (more === 0) {
          ink.fill();
          return;
        }
        ink.lineWidth = more;
        ink.stroke();
        return;
      case KIND.dashring: {
        const dash = (TAU * r) / RING_DASHES;
        ink.setLineDash([dash * DASH, dash * (1 - DASH)]);
        ink.arc(0, 0, r - more / 2, 0, TAU);
        ink.lineWidth = more;
        ink.stroke();
        ink.setLineDash([]);
        return;
      }
      case KIND.hatch:
        ink.arc(0, 0, r, 0, TAU);
        ink.clip();
        ink.beginPath();
        for (let d = -2 * r; d < 2 * r; d += more * Math.SQRT2) {
          ink.moveTo(d - r, r);
          ink.lineTo(d + r, -r);
        }
        ink.lineWidth = 1.2 / this.#scale;
        ink.stroke();
        return;
      case KIND.arc: {
        const width = r * ARC_WIDTH;
        ink.arc(0, 0, r - width / 2, Math.PI / 2, Math.PI / 2 - TAU * more, true);
        ink.lineWidth = width;
        ink.stroke();
        return;
      }
      case KIND.bolt:
        ink.moveTo(0.3 * r, r);
        ink.lineTo(-0.6 * r, -0.12 * r);
        ink.lineTo(0, -0.12 * r);
        ink.lineTo(-0.3 * r, -r);
        ink.lineTo(0.6 * r, 0.12 * r);
        ink.lineTo(0, 0.12 * r);
        ink.closePath();
        ink.fill();
        return;
      case KIND.heat: {
        ink.scale(1, h / w);
        const bell = ink.createRadialGradient(0, 0, 0, 0, 0, r);
        for (const part of [0, 0.2, 0.4, 0.6, 0.8, 1]) {
          const shade = Math.max(0, Math.exp(-4.5 * part * part) - 0.0111);
          bell.addColorStop(part, cssOf(((Math.round((colour >>> 24) * shade) << 24) | (colour & 0xffffff)) >>> 0));
        }
        ink.fillStyle = bell;
        ink.arc(0, 0, r, 0, TAU);
        ink.fill();
      }
    }
  }

  #colour(ink: number): string {
    let css = this.#css.get(ink);
    if (css === undefined) this.#css.set(ink, (css = cssOf(ink)));
    return css;
  }
}

/** A box around (x, y) that is turned. */
function addBox(path: Path2D, x: number, y: number, w: number, h: number, turn: number): void {
  if (turn === 0) return path.rect(x - w / 2, y - h / 2, w, h);
  const [ax, ay] = [(Math.cos(turn) * w) / 2, (Math.sin(turn) * w) / 2];
  const [bx, by] = [(-Math.sin(turn) * h) / 2, (Math.cos(turn) * h) / 2];
  path.moveTo(x - ax - bx, y - ay - by);
  path.lineTo(x + ax - bx, y + ay - by);
  path.lineTo(x + ax + bx, y + ay + by);
  path.lineTo(x - ax + bx, y - ay + by);
  path.closePath();
}
