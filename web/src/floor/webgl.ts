// The WebGL painter (pixi.js). It draws what canvas2d.ts draws, layer by layer, and only what changed:
// racks when one moves, ways when a patch comes, robots and people every frame.
import 'pixi.js/unsafe-eval'; // The name is about what it replaces: the page allows no eval.
import { Container, Sprite, Texture, WebGLRenderer } from 'pixi.js';
import { ROBOT_STATES } from '../wire';
import { Brush, inkOf, paintAtlas } from './brush';
import { Names } from './names';
import { personRadius, SIZE, type Frame, type Painter } from './painter';
import type { Palette } from './palette';
import { PERSON_REACH } from './people';
import type { Paths, Scene } from './scene';

const INTERRUPTED = ROBOT_STATES.indexOf('interrupted');
const FAILED = ROBOT_STATES.indexOf('failed');

export async function openWebgl(palette: Palette): Promise<Painter> {
  const renderer = new WebGLRenderer();
  await renderer.init({ antialias: true, width: 16, height: 16, clearBeforeRender: true, skipExtensionImports: true });
  return new WebglPainter(renderer, palette);
}

class WebglPainter implements Painter {
  readonly kind = 'webgl';
  readonly element: HTMLCanvasElement;
  #renderer: WebGLRenderer;
  #palette: Palette;
  #root = new Container();
  /** A unit is a metre and y points up. */
  #world = new Container();
  #ground = new Sprite();
  #racks: Brush;
  #ways: Brush;
  #robots: Brush;
  #people: Brush;
  #names: Names;
  #drawn = { picture: null as HTMLCanvasElement | null, racks: -1, ways: null as Paths | null, scale: 0, chosen: -1 };

  constructor(renderer: WebGLRenderer, palette: Palette) {
    this.#renderer = renderer;
    this.element = renderer.canvas as HTMLCanvasElement;
    this.#palette = palette;
    const atlas = paintAtlas();
    this.#racks = new Brush(atlas);
    this.#ways = new Brush(atlas);
    this.#robots = new Brush(atlas);
    this.#people = new Brush(atlas);
    this.#names = new Names();
    this.#ground.anchor.set(0.5);
    this.#world.addChild(this.#racks.layer, this.#ways.layer, this.#robots.layer, this.#people.layer);
    this.#root.addChild(this.#ground, this.#world, this.#names.layer);
    this.recolour(palette);
  }

  recolour(palette: Palette): void {
    this.#palette = palette;
    this.#renderer.background.color = palette.of.void;
    this.#names.recolour(palette);
    Object.assign(this.#drawn, { racks: -1, ways: null });
  }

  resize(width: number, height: number, density: number): void {
    this.#renderer.resize(width, height, density);
  }

  draw(frame: Frame): void {
    const { view, scene, chosen, person } = frame;
    const drawn = this.#drawn;
    this.#world.position.set(view.width / 2 - view.x * view.scale, view.height / 2 + view.y * view.scale);
    this.#world.scale.set(view.scale, -view.scale);
    this.#placeGround(frame);
    const rescaled = drawn.scale !== view.scale;
    if (drawn.racks !== scene.rackTurn || rescaled) this.#drawRacks(scene, view.scale);
    if (drawn.ways !== scene.granted || rescaled || drawn.chosen !== chosen) this.#drawWays(scene, view.scale, chosen);
    this.#drawRobots(scene, view.scale, chosen);
    this.#drawPeople(scene, view.scale, person);
    this.#names.draw(scene, view, chosen);
    Object.assign(drawn, { racks: scene.rackTurn, ways: scene.granted, scale: view.scale, chosen });
    this.#renderer.render(this.#root);
  }

  destroy(): void {
    this.#ground.texture.destroy(true);
    this.#names.destroy();
    this.#root.destroy({ children: true });
    // Contexts are few in a browser: give this one back now rather than at the next collection.
    this.#renderer.gl.getExtension('WEBGL_lose_context')?.loseContext();
    this.#renderer.destroy();
    this.element.remove();
  }

  #placeGround({ view, ground }: Frame): void {
    if (this.#drawn.picture !== ground.picture) {
      const old = this.#ground.texture;
      this.#ground.texture = Texture.from(ground.picture, true);
      if (old !== Texture.EMPTY) old.destroy(true);
      this.#drawn.picture = ground.picture;
    }
    const zoom = view.scale / ground.view.scale;
    this.#ground.setSize(ground.view.width * zoom, ground.view.height * zoom);
    this.#ground.position.set(
      (ground.view.x - view.x) * view.scale + view.width / 2,
      (view.y - ground.view.y) * view.scale + view.height / 2);
  }

  #drawRacks(scene: Scene, scale: number): void {
    const fill = inkOf(this.#palette.of.rack);
    const edge = inkOf(this.#palette.of['rack-edge']);
    const brush = this.#racks;
    brush.begin();
    for (let i = 0; i < scene.racks; i++) {
      const x = scene.rackX[i]!;
      if (scene.rackOn[i]! >= 0 || Number.isNaN(x)) continue;
      brush.put('square', x, scene.rackY[i]!, 2 * SIZE.rack, 2 * SIZE.rack, fill);
      if (scale > 9) brush.put('frame', x, scene.rackY[i]!, 2 * SIZE.rack, 2 * SIZE.rack, edge);
    }
    brush.end();
  }

  #drawWays(scene: Scene, scale: number, chosen: number): void {
    const c = this.#palette.of;
    const hair = 1 / scale;
    this.#ways.begin();
    this.#lines(scene.held, Math.max(SIZE.held, 0.8 * hair), inkOf(c.held));
    this.#lines(scene.granted, Math.max(SIZE.granted, 1.4 * hair), inkOf(c.granted));
    if (chosen >= 0) {
      const ink = inkOf(c.chosen);
      this.#lines(scene.held, Math.max(SIZE.held * 1.4, 1.2 * hair), ink, chosen);
      this.#lines(scene.granted, Math.max(SIZE.granted * 1.5, 2.5 * hair), ink, chosen);
    }
    this.#ways.end();
  }

  #lines(paths: Paths, width: number, ink: number, only?: number): void {
    const first = only === undefined ? 0 : paths.from[only]!;
    const end = only === undefined ? paths.at.length / 4 : paths.from[only + 1]!;
    for (let k = 4 * first; k < 4 * end; k += 4) {
      this.#ways.line(paths.at[k]!, paths.at[k + 1]!, paths.at[k + 2]!, paths.at[k + 3]!, width, ink);
    }
  }

  #drawRobots(scene: Scene, scale: number, chosen: number): void {
    const c = this.#palette.of;
    const hair = 1 / scale;
    const brush = this.#robots;
    const inks = this.#palette.states.map((colour) => inkOf(colour));
    const [tick, carried, under, low, halo, mark] =
      [inkOf(c.tick), inkOf(c.carried), inkOf(c.carried, 0.16), inkOf(c.low), inkOf(c.halo), inkOf(c.label)];
    const size = 2 * Math.max(SIZE.robot, 2.2 * hair);
    brush.begin();
    if (chosen >= 0) {
      const around = 2 * Math.max(SIZE.chosen, 7 * hair);
      brush.put('ring', scene.x[chosen]!, scene.y[chosen]!, around, around, inkOf(c.chosen));
    }
    for (let i = 0; i < scene.robots; i++) brush.put('disc', scene.x[i]!, scene.y[i]!, size, size, inks[scene.state[i]!]!);
    for (let i = 0; i < scene.racks; i++) {
      if (scene.rackOn[i]! < 0) continue;
      brush.put('square', scene.rackX[i]!, scene.rackY[i]!, 2 * SIZE.carried, 2 * SIZE.carried, under);
      brush.put('frame', scene.rackX[i]!, scene.rackY[i]!, 2 * SIZE.carried, 2 * SIZE.carried, carried);
    }
    for (let i = 0; i < scene.robots; i++) {
      const [x, y, turn] = [scene.x[i]!, scene.y[i]!, scene.heading[i]!];
      const [dx, dy] = [Math.cos(turn), Math.sin(turn)];
      if (scale > 5) brush.line(x + dx * 0.06, y + dy * 0.06, x + dx * SIZE.tick, y + dy * SIZE.tick, Math.max(0.1, hair), tick);
      if (scene.state[i] === INTERRUPTED) brush.put('ring', x, y, 2 * SIZE.ring, 2 * SIZE.ring, inks[INTERRUPTED]!);
      if (scene.state[i] === FAILED) brush.put('cross', x, y, 0.95, 0.95, mark);
      if (!scene.lowBattery[i]) continue;
      brush.put('square', x + 0.35, y + 0.38, 0.3 + hair, 0.16 + hair, halo);
      brush.put('square', x + 0.35, y + 0.38, 0.3, 0.16, low);
    }
    brush.end();
  }

  #drawPeople({ people }: Scene, scale: number, chosen: number): void {
    const c = this.#palette.of;
    const hair = 1 / scale;
    const [mark, pale, halo, region, ahead] =
      [inkOf(c.person), inkOf(c.person, 0.35), inkOf(c.halo), inkOf(c.region), inkOf(c.ahead)];
    const size = 2 * PERSON_REACH * personRadius(scale);
    const brush = this.#people;
    brush.begin();
    people.forEach((p, i) => {
      const ink = i === chosen ? inkOf(c.chosen) : ahead;
      for (const r of p.regions) brush.circle(p.x, p.y, r, 1.2 * hair, region);
      for (let k = 0; k < p.ahead.length; k += 4) {
        brush.line(p.ahead[k]!, p.ahead[k + 1]!, p.ahead[k + 2]!, p.ahead[k + 3]!, Math.max(SIZE.ahead, 1.5 * hair), ink);
      }
    });
    people.forEach((p, i) => {
      if (i === chosen) brush.circle(p.x, p.y, Math.max(SIZE.chosen, 11 * hair), 2 * hair, inkOf(c.chosen));
      brush.put('person', p.x, p.y, 1.25 * size, 1.25 * size, halo, p.heading);
      if (p.presence !== 'lost') brush.put('person', p.x, p.y, size, size, p.presence === 'tracked' ? mark : pale, p.heading);
      if (p.presence !== 'tracked') brush.put('shadow', p.x, p.y, size, size, mark, p.heading);
    });
    brush.end();
  }
}
