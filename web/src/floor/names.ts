// Names of people, robots and racks for the WebGL painter: each drawn once as a small picture, shown when zoomed in.
import { Container, Sprite, Texture } from 'pixi.js';
import { label } from './ground';
import { belowPerson, NAMES_FROM, RACK_NAMES_FROM } from './painter';
import type { Palette } from './palette';
import type { Scene } from './scene';
import type { View } from './view';

const FONT_PX = 11;
const SHARPNESS = 2;

export class Names {
  readonly layer = new Container();
  #palette: Palette | null = null;
  #sprites = new Map<string, Sprite>();
  #shown: Sprite[] = [];

  recolour(palette: Palette): void {
    this.destroy();
    this.#palette = palette;
  }

  draw(scene: Scene, view: View, chosen: number): void {
    for (const sprite of this.#shown) sprite.visible = false;
    this.#shown.length = 0;
    for (const p of scene.people) this.#show(p.title, p.x, p.y, view, belowPerson(view.scale));
    if (view.scale >= NAMES_FROM) {
      for (let i = 0; i < scene.robots; i++) this.#show(scene.ids[i]!, scene.x[i]!, scene.y[i]!, view, 0.62);
    } else if (chosen >= 0) {
      this.#show(scene.ids[chosen]!, scene.x[chosen]!, scene.y[chosen]!, view, 0.9);
    }
    if (view.scale < RACK_NAMES_FROM) return;
    for (let i = 0; i < scene.racks; i++) {
      if (scene.rackOn[i]! < 0) this.#show(scene.rackIds[i]!, scene.rackX[i]!, scene.rackY[i]!, view, 0);
    }
  }

  destroy(): void {
    for (const sprite of this.#sprites.values()) sprite.destroy({ texture: true, textureSource: true });
    this.#sprites.clear();
    this.#shown.length = 0;
  }

  #show(name: string, x: number, y: number, view: View, below: number): void {
    const px = (x - view.x) * view.scale + view.width / 2;
    const py = (view.y - y) * view.scale + view.height / 2;
    // Said this way round, a place that is not a number is out of sight too.
    if (!(px > -50 && py > -50 && px < view.width + 50 && py < view.height + 50)) return;
    const sprite = this.#spriteOf(name);
    sprite.visible = true;
    this.#shown.push(sprite);
    // Whole pixels, or text is smeared as it moves.
    sprite.position.set(Math.round(px), Math.round(py + view.scale * below));
  }

  #spriteOf(name: string): Sprite {
    const known = this.#sprites.get(name);
    if (known) return known;
    const canvas = document.createElement('canvas');
    const ink = canvas.getContext('2d')!;
    ink.font = `600 ${FONT_PX}px system-ui, sans-serif`;
    canvas.width = Math.ceil((ink.measureText(name).width + 8) * SHARPNESS);
    canvas.height = (FONT_PX + 8) * SHARPNESS;
    ink.scale(SHARPNESS, SHARPNESS);
    label(ink, name, canvas.width / SHARPNESS / 2, canvas.height / SHARPNESS / 2, FONT_PX, this.#palette!.of);
    const sprite = new Sprite(Texture.from(canvas, true));
    sprite.anchor.set(0.5);
    sprite.scale.set(1 / SHARPNESS);
    this.#sprites.set(name, sprite);
    this.layer.addChild(sprite);
    return sprite;
  }
}
