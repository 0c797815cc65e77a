// The canvas 2D painter: a few large paths per frame instead of one drawing call per robot.
import { ROBOT_STATES } from '../wire';
import { label } from './ground';
import { belowPerson, NAMES_FROM, personRadius, RACK_NAMES_FROM, SIZE, type Frame, type Painter } from './painter';
import type { Palette } from './palette';
import { outlinePerson, type Person } from './people';
import type { Paths, Scene } from './scene';
import type { View } from './view';

const INTERRUPTED = ROBOT_STATES.indexOf('interrupted');
const FAILED = ROBOT_STATES.indexOf('failed');

export class Canvas2dPainter implements Painter {
  readonly kind = 'canvas2d';
  readonly element = document.createElement('canvas');
  #ink: CanvasRenderingContext2D;
  #palette: Palette;
  #density = 1;

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

  draw({ view, ground, scene, chosen, person }: Frame): void {
    const ink = this.#ink;
    const c = this.#palette.of;
    ink.setTransform(this.#density, 0, 0, this.#density, 0, 0);
    ink.fillStyle = c.void;
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
    const hair = 1 / view.scale;
    this.#racks(scene, view, 'resting');
    ink.lineCap = 'round';
    this.#ways(scene.held, c.held, Math.max(SIZE.held, 0.8 * hair));
    this.#ways(scene.granted, c.granted, Math.max(SIZE.granted, 1.4 * hair));
    if (chosen >= 0) this.#chosen(scene, chosen, hair);
    this.#robots(scene, view, hair);
    this.#racks(scene, view, 'carried');
    this.#ticks(scene, view, hair);
    this.#people(scene, view, person);
    this.#names(scene, view, chosen);
  }

  destroy(): void {
    this.element.remove();
  }

  #ways(paths: Paths, colour: string, width: number, only?: number): void {
    const first = only === undefined ? 0 : paths.from[only]!;
    const end = only === undefined ? paths.at.length / 4 : paths.from[only + 1]!;
    const ink = this.#ink;
    ink.beginPath();
    for (let k = 4 * first; k < 4 * end; k += 4) {
      ink.moveTo(paths.at[k]!, paths.at[k + 1]!);
      ink.lineTo(paths.at[k + 2]!, paths.at[k + 3]!);
    }
    ink.strokeStyle = colour;
    ink.lineWidth = width;
    ink.stroke();
  }

  #chosen(scene: Scene, i: number, hair: number): void {
    const c = this.#palette.of;
    this.#ways(scene.held, c.chosen, Math.max(SIZE.held * 1.4, 1.2 * hair), i);
    this.#ways(scene.granted, c.chosen, Math.max(SIZE.granted * 1.5, 2.5 * hair), i);
    this.#ink.beginPath();
    this.#ink.arc(scene.x[i]!, scene.y[i]!, Math.max(SIZE.chosen, 7 * hair), 0, 2 * Math.PI);
    this.#ink.lineWidth = Math.max(0.09, 2 * hair);
    this.#ink.stroke();
  }

  #robots(scene: Scene, view: View, hair: number): void {
    const ink = this.#ink;
    const r = Math.max(SIZE.robot, 2.2 * hair);
    this.#palette.states.forEach((colour, state) => {
      ink.beginPath();
      this.#each(scene, view, (i, x, y) => {
        if (scene.state[i] !== state) return;
        ink.moveTo(x + r, y);
        ink.arc(x, y, r, 0, 2 * Math.PI);
      });
      ink.fillStyle = colour;
      ink.fill();
    });
  }

  #racks(scene: Scene, view: View, which: 'resting' | 'carried'): void {
    const ink = this.#ink;
    const c = this.#palette.of;
    const half = which === 'resting' ? SIZE.rack : SIZE.carried;
    ink.beginPath();
    for (let i = 0; i < scene.racks; i++) {
      if (scene.rackOn[i]! >= 0 !== (which === 'carried')) continue;
      const x = scene.rackX[i]!;
      const y = scene.rackY[i]!;
      if (inSight(view, x, y)) ink.rect(x - half, y - half, 2 * half, 2 * half);
    }
    // The robot stays visible under the rack that it carries.
    ink.globalAlpha = which === 'carried' ? 0.16 : 1;
    ink.fillStyle = which === 'carried' ? c.carried : c.rack;
    ink.fill();
    ink.globalAlpha = 1;
    ink.strokeStyle = which === 'carried' ? c.carried : c['rack-edge'];
    ink.lineWidth = which === 'carried' ? Math.max(0.09, 1 / view.scale) : 0.05;
    if (which === 'carried' || view.scale > 9) ink.stroke();
  }

  /** Heading ticks, and the shapes that say interrupted, failed and low battery without colour. */
  #ticks(scene: Scene, view: View, hair: number): void {
    const ink = this.#ink;
    const c = this.#palette.of;
    const ticks = new Path2D();
    const rings = new Path2D();
    const crosses = new Path2D();
    const low = new Path2D();
    this.#each(scene, view, (i, x, y) => {
      const turn = scene.heading[i]!;
      ticks.moveTo(x + Math.cos(turn) * 0.06, y + Math.sin(turn) * 0.06);
      ticks.lineTo(x + Math.cos(turn) * SIZE.tick, y + Math.sin(turn) * SIZE.tick);
      if (scene.state[i] === INTERRUPTED) {
        rings.moveTo(x + SIZE.ring, y);
        rings.arc(x, y, SIZE.ring, 0, 2 * Math.PI);
      }
      if (scene.state[i] === FAILED) {
        for (const side of [1, -1]) {
          crosses.moveTo(x - 0.45, y - 0.45 * side);
          crosses.lineTo(x + 0.45, y + 0.45 * side);
        }
      }
      if (scene.lowBattery[i]) low.rect(x + 0.2, y + 0.3, 0.3, 0.16);
    });
    ink.strokeStyle = c.tick;
    ink.lineWidth = Math.max(0.1, hair);
    if (view.scale > 5) ink.stroke(ticks);
    ink.strokeStyle = this.#palette.states[INTERRUPTED]!;
    ink.lineWidth = Math.max(0.08, 1.5 * hair);
    ink.stroke(rings);
    ink.strokeStyle = c.label;
    ink.lineWidth = Math.max(0.1, 2 * hair);
    ink.stroke(crosses);
    ink.fillStyle = c.low;
    ink.fill(low);
    ink.strokeStyle = c.halo;
    ink.lineWidth = Math.max(0.03, 0.5 * hair);
    ink.stroke(low);
  }

  #people({ people }: Scene, view: View, chosen: number): void {
    const ink = this.#ink;
    const c = this.#palette.of;
    const hair = 1 / view.scale;
    ink.beginPath();
    for (const p of people) {
      for (const r of p.regions) {
        ink.moveTo(p.x + r, p.y);
        ink.arc(p.x, p.y, r, 0, 2 * Math.PI);
      }
    }
    ink.strokeStyle = c.region;
    ink.lineWidth = 1.2 * hair;
    ink.stroke();
    for (const p of people) {
      ink.beginPath();
      for (let k = 0; k < p.ahead.length; k += 4) {
        ink.moveTo(p.ahead[k]!, p.ahead[k + 1]!);
        ink.lineTo(p.ahead[k + 2]!, p.ahead[k + 3]!);
      }
      ink.strokeStyle = p === people[chosen] ? c.chosen : c.ahead;
      ink.lineWidth = Math.max(SIZE.ahead, 1.5 * hair);
      ink.stroke();
    }
    for (const p of people) this.#person(p, p === people[chosen], hair);
  }

  #person(p: Person, chosen: boolean, hair: number): void {
    const ink = this.#ink;
    const c = this.#palette.of;
    const r = personRadius(1 / hair);
    ink.save();
    ink.translate(p.x, p.y);
    if (chosen) {
      ink.beginPath();
      ink.arc(0, 0, Math.max(SIZE.chosen, 11 * hair), 0, 2 * Math.PI);
      ink.strokeStyle = c.chosen;
      ink.lineWidth = 2 * hair;
      ink.stroke();
    }
    ink.rotate(p.heading);
    const mark = (radius: number): void => { ink.beginPath(); outlinePerson(ink, radius); };
    mark(1.25 * r);
    ink.fillStyle = c.halo;
    ink.fill();
    mark(r);
    ink.fillStyle = c.person;
    ink.globalAlpha = p.presence === 'tracked' ? 1 : 0.35;
    if (p.presence !== 'lost') ink.fill();
    ink.globalAlpha = 1;
    ink.strokeStyle = c.person;
    ink.lineWidth = 0.2 * r;
    if (p.presence !== 'tracked') ink.stroke();
    ink.restore();
  }

  #names(scene: Scene, view: View, chosen: number): void {
    const ink = this.#ink;
    ink.setTransform(this.#density, 0, 0, this.#density, 0, 0);
    const name = (text: string, x: number, y: number, below: number): void => {
      const px = (x - view.x) * view.scale + view.width / 2;
      const py = (view.y - y) * view.scale + view.height / 2;
      label(ink, text, px, py + view.scale * below, 11, this.#palette.of);
    };
    for (const p of scene.people) if (inSight(view, p.x, p.y)) name(p.title, p.x, p.y, belowPerson(view.scale));
    if (view.scale >= NAMES_FROM) this.#each(scene, view, (i, x, y) => name(scene.ids[i]!, x, y, 0.62));
    else if (chosen >= 0) name(scene.ids[chosen]!, scene.x[chosen]!, scene.y[chosen]!, 0.9);
    if (view.scale < RACK_NAMES_FROM) return;
    for (let i = 0; i < scene.racks; i++) {
      if (scene.rackOn[i]! < 0 && inSight(view, scene.rackX[i]!, scene.rackY[i]!)) name(scene.rackIds[i]!, scene.rackX[i]!, scene.rackY[i]!, 0);
    }
  }

  #each(scene: Scene, view: View, see: (i: number, x: number, y: number) => void): void {
    for (let i = 0; i < scene.robots; i++) {
      const x = scene.x[i]!;
      const y = scene.y[i]!;
      if (inSight(view, x, y)) see(i, x, y);
    }
  }
}

/** False too for a place that is not a number. */
function inSight(view: View, x: number, y: number): boolean {
  return Math.abs(x - view.x) * view.scale < view.width / 2 + view.scale &&
    Math.abs(y - view.y) * view.scale < view.height / 2 + view.scale;
}
