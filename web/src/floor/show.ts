// Runs the floor: owns the camera, the kept picture of the ground and the animation loop. It draws what
// it is given and knows no panel.
import type { Activity, Closure, FloorMap, Mirror, Point } from '../wire';
import type { Picked } from './scene/picked';
import type { Cell } from './paint/heatmap';
import { alarmedOf, announced, Composer, type Chosen } from './paint/compose';
import { drawGround } from './paint/ground';
import { listen } from './scene/hands';
import type { Forecast } from './paint/heat';
import { titlesOf } from './paint/labels';
import type { Frame, Painter } from './paint/painter';
import { readPalette, type Palette } from './paint/palette';
import { placeOf, thingAt, thingBeside } from './scene/pick';
import { LOOKS, Stage } from './scene/scene';
import { fit, FOOT_PX, onPicture, pan, toWorld, zoomAt, type FixedName, type View } from './scene/view';

export interface ShowOptions {
  host: HTMLElement;
  map: FloorMap;
  painter(palette: Palette): Promise<Painter>;
  onHover(picked: Picked | null): void;
  onChoose(picked: Picked | null): void;
  /** The camera moved. */
  onView?(view: View): void;
  /** The map alone is wanted on the whole screen, or no longer. */
  onFull(): void;
}

/** The kept picture reaches this far beyond the window, as a share of it, on every side. */
const BEYOND = 0.25;
const REST_MS = 140;
const DENSEST = 2;
/** Pixels per metre when one thing is brought to the middle: names are shown from NAMES_FROM on. */
const CLOSE_SCALE = 36;

export class Show {
  view: View;
  #options: ShowOptions;
  #painter: Painter;
  #palette: Palette;
  #stage: Stage;
  #composer: Composer;
  /** Kept from one frame to the next: only its parts change. */
  #drawn: Frame;
  #picks: Chosen = { robot: -1, person: -1, place: null, look: -1 };
  #mirror: Mirror | null = null;
  #forecasts: readonly Forecast[] = [];
  #how: 'glide' | 'jump' = 'jump';
  #told = -1;
  #chosen: Picked | null = null;
  #marked: Point | null = null;
  #closures: readonly Closure[] = [];
  #alarms: Mirror['alarms'] = [];
  #titles: readonly FixedName[];
  #foot = FOOT_PX;
  #movedAt = 0;
  #dirty = true;
  #fitted = true;
  #frame = 0;
  #observer: ResizeObserver;
  #gone = new AbortController();

  static async open(options: ShowOptions): Promise<Show> {
    const palette = readPalette(options.host);
    return new Show(options, await options.painter(palette), palette);
  }

  private constructor(options: ShowOptions, painter: Painter, palette: Palette) {
    this.#options = options;
    this.#painter = painter;
    this.#palette = palette;
    this.#stage = new Stage(options.map);
    this.#titles = titlesOf(options.map);
    this.view = this.#whole(300, 150);
    this.#composer = new Composer(palette);
    this.#drawn = {
      view: this.view,
      ground: { picture: document.createElement('canvas'), view: this.view },
      sheets: Object.values(this.#composer.sheets),
      words: this.#composer.words,
    };
    const { host } = options;
    const canvas = painter.element;
    canvas.dataset['painter'] = painter.kind;
    canvas.setAttribute('aria-hidden', 'true');
    host.prepend(canvas);
    listen(
      host,
      {
        pan: (dx, dy) => this.#pan(dx, dy),
        zoom: (factor, px, py) => this.zoom(factor, px, py),
        fit: () => this.fit(),
        full: () => options.onFull(),
        hover: (at) => options.onHover(at && lively(this.#pickedAt(...at))),
        choose: (at) => options.onChoose(at && this.#pickedAt(...at)),
        step: (step) => options.onChoose(thingBeside(options.map, this.#stage.scene, this.view, this.#chosen, step)),
      },
      this.#gone.signal,
    );
    this.#observer = new ResizeObserver(() => this.#measure());
    this.#observer.observe(host);
    this.#measure();
    this.#frame = requestAnimationFrame((now) => this.#loop(now));
  }

  take(mirror: Mirror, how: 'glide' | 'jump'): void {
    this.#stage.take(mirror, performance.now(), how);
    this.#mirror = mirror;
    this.#how = how;
    if (this.#alarms !== mirror.alarms) {
      this.#alarms = mirror.alarms;
      this.#composer.alarmed = alarmedOf(mirror.alarms);
    }
    if (this.#closures !== mirror.closures) {
      this.#closures = mirror.closures;
      this.#composer.notes = announced(mirror.closures);
      this.#paintGround();
    }
    this.#dirty = true;
  }

  choose(picked: Picked | null): void {
    this.#chosen = picked;
    if (picked !== null) this.#marked = null;
    this.#dirty = true;
  }

  /** Shows robots that are at anything else pale; null shows all alike. */
  filter(only: Activity | null): void {
    this.#picks.look = only === null ? -1 : (LOOKS as readonly string[]).indexOf(only);
    this.#dirty = true;
  }

  /** Where people may be soon; an empty list shows nothing. */
  forecast(forecasts: readonly Forecast[]): void {
    this.#forecasts = forecasts;
    this.#painter.element.dataset['forecasts'] = String(forecasts.filter((f) => f.parts.length > 0).length);
    this.#dirty = true;
  }

  /** A map of heat; an empty list shows none. */
  amounts(cells: readonly Cell[]): void {
    this.#composer.cells = cells;
    this.#painter.element.dataset['cells'] = String(cells.length);
    this.#dirty = true;
  }

  /** Marks a place where nothing need be, and brings it to the middle. */
  mark(at: Point): void {
    this.#marked = at;
    this.#centre(at);
  }

  /** Brings a thing to the middle; says whether it is there. */
  centreOn(picked: Picked): boolean {
    const at = placeOf(this.#options.map, this.#mirror, this.#stage.scene, picked);
    if (at) this.#centre(at);
    return at !== null;
  }

  #centre(at: readonly [x: number, y: number]): void {
    this.#fitted = false;
    this.#move({ ...this.view, x: at[0], y: at[1], scale: Math.max(this.view.scale, CLOSE_SCALE) });
  }

  fit(): void {
    this.#fitted = true;
    this.#move(this.#whole(this.view.width, this.view.height));
  }

  /** Leaves so many pixels free below the whole floor. */
  leaveFree(px: number): void {
    if (px === this.#foot) return;
    this.#foot = px;
    if (this.#fitted) this.fit();
  }

  zoom(factor: number, px = this.view.width / 2, py = this.view.height / 2): void {
    this.#fitted = false;
    this.#move(zoomAt(this.view, factor, px, py, this.#options.map.bounds));
  }

  recolour(): void {
    this.#palette = readPalette(this.#options.host);
    this.#painter.recolour(this.#palette);
    this.#composer.recolour(this.#palette);
    this.#paintGround();
  }

  destroy(): void {
    cancelAnimationFrame(this.#frame);
    this.#observer.disconnect();
    this.#gone.abort();
    this.#painter.destroy();
  }

  #loop(now: number): void {
    const under = this.#stage.at(now);
    if (now - this.#movedAt > REST_MS || !this.#covers()) this.#freshenGround();
    if (this.#dirty || under) {
      this.#draw();
      this.#dirty = under;
    }
    this.#frame = requestAnimationFrame((next) => this.#loop(next));
  }

  #draw(): void {
    const { scene } = this.#stage;
    const picks = this.#picks;
    picks.robot = this.#chosen?.kind === 'robot' ? scene.ids.indexOf(this.#chosen.id) : -1;
    picks.person = this.#chosen?.kind === 'worker' ? scene.people.findIndex((p) => p.id === this.#chosen?.id) : -1;
    const stands = this.#chosen !== null && this.#chosen.kind !== 'robot' && this.#chosen.kind !== 'worker';
    picks.place = stands ? placeOf(this.#options.map, this.#mirror, scene, this.#chosen!) : this.#marked;
    this.#composer.compose(scene, this.view, picks, this.#forecasts);
    this.#drawn.view = this.view;
    this.#painter.draw(this.#drawn);
    const version = this.#mirror?.version ?? -1;
    if (this.#told === version) return;
    this.#told = version;
    // What is on the screen, for tests and for the curious.
    const { dataset } = this.#painter.element;
    dataset['robots'] = String(scene.robots);
    dataset['racks'] = String(scene.racks);
    dataset['people'] = String(scene.people.length);
    dataset['motion'] = this.#how;
    dataset['version'] = String(version);
    dataset['routes'] = String(this.#composer.sheets.ways.count);
    dataset['names'] = String(this.#composer.words.count);
    dataset['turned'] = String(Boolean(this.view.turned));
    dataset['view'] = [this.view.x, this.view.y, this.view.scale].map((n) => n.toFixed(2)).join(' ');
  }

  #move(view: View): void {
    this.view = view;
    this.#options.onView?.(view);
    this.#movedAt = performance.now();
    this.#dirty = true;
  }

  #pan(dx: number, dy: number): void {
    this.#fitted = false;
    this.#move(pan(this.view, dx, dy, this.#options.map.bounds));
  }

  #measure(): void {
    const { clientWidth, clientHeight } = this.#options.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.#painter.resize(clientWidth, clientHeight, this.#density());
    const resized = { ...this.view, width: clientWidth, height: clientHeight };
    this.#move(this.#fitted ? this.#whole(clientWidth, clientHeight) : resized);
    this.#paintGround();
  }

  #whole(width: number, height: number): View {
    return fit(this.#options.map.bounds, width, height, this.#titles, this.#foot);
  }

  #covers(): boolean {
    const kept = this.#drawn.ground.view;
    const zoom = this.view.scale / kept.scale;
    const [right, up] = onPicture(kept, this.view.x - kept.x, this.view.y - kept.y);
    return (
      zoom > 0.6 &&
      zoom < 2.5 &&
      Boolean(kept.turned) === Boolean(this.view.turned) &&
      Math.abs(right) * 2 + this.view.width / this.view.scale <= kept.width / kept.scale &&
      Math.abs(up) * 2 + this.view.height / this.view.scale <= kept.height / kept.scale
    );
  }

  #freshenGround(): void {
    const kept = this.#drawn.ground.view;
    if (kept.scale !== this.view.scale || !this.#covers()) this.#paintGround();
  }

  #paintGround(): void {
    const grow = 1 + 2 * BEYOND;
    const view = { ...this.view, width: this.view.width * grow, height: this.view.height * grow };
    const density = this.#density();
    // A new canvas each time: a painter tells by it that the picture has changed.
    const picture = document.createElement('canvas');
    picture.width = Math.ceil(view.width * density);
    picture.height = Math.ceil(view.height * density);
    const ink = picture.getContext('2d', { alpha: false });
    if (!ink) return;
    ink.scale(picture.width / view.width, picture.height / view.height);
    drawGround(ink, this.#options.map, this.#closures, view, this.#palette);
    this.#drawn.ground = { picture, view };
    this.#dirty = true;
  }

  #density = (): number => Math.min(DENSEST, window.devicePixelRatio || 1);

  #pickedAt(px: number, py: number): Picked | null {
    const [x, y] = toWorld(this.view, px, py);
    return thingAt(this.#options.map, this.#mirror, this.#stage.scene, x, y, 1 / this.view.scale);
  }
}

/** Racks and places are everywhere: their cards come when asked for, not wherever the pointer passes. */
const lively = (picked: Picked | null): Picked | null =>
  picked?.kind === 'rack' || picked?.kind === 'place' ? null : picked;
