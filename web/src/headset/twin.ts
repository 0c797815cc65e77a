// The twin: the floor as the server sees it, in a window of the page or around the wearer of a VR headset. Whoever
// walks in it is a worker like any other.
import { hallInk, inkOf, roomInk } from './ink';
import { make } from './dom';
import { toMap, type Alignment, type Quat, type Vec2, type Vec3 } from './frame';
import { Painter } from './gl';
import { Hall } from './backdrop';
import { Overlay, type Scene } from './overlay';
import { canStand } from './polygon';
import { board, Screen } from './screen';
import type { Server } from './server';
import { steer } from './steer';
import {
  drag,
  headingOf,
  LONG_SIDE,
  matricesOf,
  onMap,
  perspective,
  poseOf,
  seated,
  shifted,
  step,
  turned,
  walked,
  type Eye,
  type Free,
} from './walk';
import { Wearer, type WearerOptions } from './wearer';
import { t } from './words';
import { offers, RoomView } from './xr';
import { Api, Link, type FloorMap } from '../wire';

export interface TwinOptions {
  host: HTMLElement;
  server: Server;
  map: FloorMap;
  worker: { id: string; name: string };
  /** Where to begin. */
  start: Vec2;
  clock: WearerOptions['clock'];
  safety: string;
  /** The wearer leaves; the page goes on. */
  left(): void;
}

/** The map's own frame: WebXR's axes on it are x, height, -y. */
const ON_MAP: Alignment = { theta: 0, shift: [0, 0] };
/** A push of the right stick turns by so much at once, which is easier on the stomach than turning: radians. */
const SNAP = Math.PI / 6;
/** A stick that rests is not exactly in its middle. */
const DEAD = 0.2;
/** Buttons of a WebXR controller: A or X, which is the narrow view here. */
const NARROW_BUTTON = 4;
const DENSEST = 2;
const BEAT_MS = 100;

export class Twin {
  #o: TwinOptions;
  #free: Free;
  #eye: Eye;
  #narrow = false;
  #wearer: Wearer;
  #screen: Screen;
  #hall: Hall;
  #overlay: Overlay;
  #link: Link;
  #canvas: HTMLCanvasElement;
  #vr: { view: RoomView | null; rig: Alignment | null; snapped: boolean; pressed: boolean; at: number } | null = null;
  #before = 0;
  #ends: (() => void)[] = [];
  #narrowButton = make('button', { type: 'button', textContent: t('twin.narrow'), ariaPressed: 'false' });
  #doneButton = make('button', { type: 'button', textContent: t('done'), className: 'main', hidden: true });
  #error = make('p', { className: 'error', role: 'alert' });

  constructor(options: TwinOptions) {
    this.#o = options;
    const { host, server, map, worker, start, clock } = options;
    this.#free = (at) => canStand(map, at);
    this.#eye = { at: start, heading: towards(start, map), pitch: -0.12 };
    this.#canvas = make('canvas', { tabIndex: 0, role: 'application', ariaLabel: t('twin.canvas') });
    this.#hall = new Hall(map, hallInk());
    this.#overlay = new Overlay(new Painter(this.#canvas), roomInk(), inkOf, this.#hall);
    this.#wearer = new Wearer({
      frame: 'map',
      poses: 'tracked',
      clock,
      random: Math.random,
      marks: [],
      open: (events) => server.open(worker.id, events),
      task: (assignment) => server.task(worker.id, assignment),
      onChange: () => this.#refresh(),
    });
    this.#screen = new Screen(host, this.#wearer);
    const api = new Api();
    this.#link = new Link({
      open: (since, events) => api.openLive(since, events),
      clock,
      random: Math.random,
      onState: () => {},
      onMirror: (mirror) => this.#hall.take(mirror, worker.id, performance.now()),
    });
  }

  /** Shows it, and begins to send poses. */
  async open(): Promise<void> {
    const { host, map, worker, safety, left } = this.#o;
    const hands = steer(this.#canvas, {
      drag: (dx, dy) => {
        this.#eye = drag(this.#eye, dx, dy, this.#metresPerPixel());
      },
      done: () => {
        if (!this.#wearer.done()) this.#screen.again();
      },
      narrow: () => this.#toggle(),
    });
    const enter = make('button', {
      type: 'button',
      textContent: t('twin.vr'),
      hidden: !(await offers('immersive-vr')),
    });
    const gone = make('button', { type: 'button', textContent: t('left.gone') });
    this.#narrowButton.addEventListener('click', () => this.#toggle());
    this.#doneButton.addEventListener('click', () => this.#wearer.done());
    enter.addEventListener('click', () => void this.#enter());
    gone.addEventListener('click', () => {
      this.close();
      left();
    });
    const real = make('p', { className: 'safety', hidden: true, textContent: t('twin.real') });
    const { banner, note, stop, talk } = this.#screen;
    // The board and STOP are drawn into the picture; here they are for those who do not see it.
    host.dataset['screen'] = 'twin';
    host.replaceChildren(
      make(
        'main',
        { className: 'twin' },
        make('div', { className: 'hidden' }, banner, stop),
        make('div', { className: 'window' }, this.#canvas, hands.pad),
        make(
          'div',
          { className: 'row wrap' },
          make('span', { className: 'dim grow', textContent: t('twin.on', { name: worker.name, map: map.name }) }),
          this.#doneButton,
          ...talk,
          this.#narrowButton,
          enter,
          gone,
        ),
        real,
        note,
        this.#error,
        make('p', { className: 'dim small', textContent: t('twin.help') }),
        make('p', { className: 'safety', textContent: safety }),
      ),
    );
    const watch = new ResizeObserver(() => this.#measure());
    watch.observe(this.#canvas);
    const beat = setInterval(() => {
      this.#wearer.tick();
      real.hidden = this.#hall.mirror.source !== 'real';
    }, BEAT_MS);
    let frame = requestAnimationFrame(
      function next(this: Twin, t: number) {
        frame = requestAnimationFrame(next.bind(this));
        this.#frame(t, hands.drive());
      }.bind(this),
    );
    this.#ends.push(
      () => watch.disconnect(),
      () => clearInterval(beat),
      () => cancelAnimationFrame(frame),
    );
    this.#measure();
    this.#link.start();
    this.#wearer.start();
    this.#canvas.focus();
    this.#refresh();
  }

  close(): void {
    this.#ends.forEach((end) => end());
    void this.#vr?.view?.leave();
    this.#screen.close();
    this.#link.stop();
  }

  #refresh(): void {
    const [title, detail] = this.#words();
    this.#screen.say(this.#wearer.shown(), title, detail);
    this.#doneButton.hidden = this.#wearer.due() === null;
  }

  #words(): readonly [title: string, detail: string] {
    const { feed } = this.#wearer;
    return feed.kind === 'ended' ? [t('ended'), feed.text] : board(this.#wearer.shown(), this.#wearer);
  }

  #toggle(): void {
    this.#narrow = !this.#narrow;
    this.#narrowButton.ariaPressed = String(this.#narrow);
  }

  #scene(alignment: Alignment | null): Scene {
    const [title, detail] = this.#words();
    return {
      shown: this.#wearer.shown(),
      alignment,
      marking: false,
      narrow: this.#narrow,
      board: this.#vr === null ? 'window' : 'eyes',
      title,
      detail,
    };
  }

  // --- In the window ---

  #frame(t: number, drive: ReturnType<ReturnType<typeof steer>['drive']>): void {
    const dt = (t - this.#before) / 1_000;
    this.#before = t;
    if (this.#vr !== null) return;
    this.#eye = step(this.#eye, drive, dt, this.#free);
    const { pos, quat } = poseOf(this.#eye);
    this.#wearer.frame({ t, pos, quat, emulated: false });
    const { width, height } = this.#canvas;
    const { matrix, inverse } = matricesOf(pos, quat);
    this.#hall.prepare(this.#overlay.painter, this.#eye.at, performance.now());
    const aim = this.#overlay.draw(
      null,
      { at: pos, matrix, inverse, floor: 0 },
      [{ port: { x: 0, y: 0, width, height }, projection: perspective(width, height), toEye: inverse }],
      this.#scene(ON_MAP),
      null,
    );
    this.#drew('window', this.#eye.at, aim?.kind ?? 'none');
  }

  #drew(where: 'window' | 'vr', at: Vec2, aim: string): void {
    this.#wearer.drawn();
    const { robots, people, version } = this.#hall.drawn;
    // What is seen, for tests and for the curious.
    Object.assign(this.#o.host.dataset, {
      twin: where,
      at: at.map((v) => v.toFixed(2)).join(),
      heading: this.#eye.heading.toFixed(2),
      narrow: String(this.#narrow),
      aim,
      robots: String(robots),
      people: String(people),
      version: String(version),
    });
  }

  #measure(): void {
    const ratio = Math.min(DENSEST, devicePixelRatio || 1);
    this.#canvas.width = Math.max(1, Math.round(this.#canvas.clientWidth * ratio));
    this.#canvas.height = Math.max(1, Math.round(this.#canvas.clientHeight * ratio));
  }

  /** Of the view one metre ahead. */
  #metresPerPixel(): number {
    const { clientWidth, clientHeight } = this.#canvas;
    return (2 * LONG_SIDE) / Math.max(1, clientWidth, clientHeight);
  }

  // --- Around the wearer ---

  async #enter(): Promise<void> {
    if (this.#vr !== null) return;
    const vr = {
      view: null as RoomView | null,
      rig: null as Alignment | null,
      snapped: false,
      pressed: false,
      at: performance.now(),
    };
    this.#vr = vr;
    this.#error.textContent = '';
    let last: { head: Vec3; quat: Quat } | null = null;
    try {
      vr.view = await RoomView.enter('immersive-vr', this.#overlay, {
        sample: (sample) => {
          last = { head: sample.pos, quat: sample.quat };
          vr.rig ??= seated(sample.pos, headingOf(sample.quat) ?? this.#eye.heading, this.#eye.at, this.#eye.heading);
          const pose = onMap(vr.rig, sample.pos, sample.quat);
          const at = toMap(vr.rig, sample.pos);
          this.#eye = {
            ...this.#eye,
            at,
            heading: (headingOf(sample.quat) ?? this.#eye.heading - vr.rig.theta) + vr.rig.theta,
          };
          this.#wearer.frame({ ...sample, ...pose });
          this.#hall.prepare(this.#overlay.painter, at, performance.now());
        },
        inputs: (sources) => {
          if (last !== null) this.#sticks(sources, last.head);
        },
        confirm: () => {
          if (!this.#wearer.done()) this.#screen.again();
        },
        held: () => {},
        // The origin of the device jumped: the wearer did not, and stays where they were on the map.
        reset: () => {
          vr.rig = null;
        },
        woke: () => this.#wearer.woke(),
        ended: () => {
          this.#vr = null;
          this.#before = performance.now();
          this.#measure();
        },
        scene: () => this.#scene(vr.rig),
        drew: (aim) => this.#drew('vr', this.#eye.at, aim?.kind ?? 'none'),
      });
    } catch (error) {
      this.#vr = null;
      this.#error.textContent = t('failed.vr', { why: error instanceof Error ? error.message : String(error) });
    }
  }

  /** The left stick walks where the wearer looks, the right one turns in steps, a button switches the narrow view. */
  #sticks(sources: Iterable<XRInputSource>, head: Vec3): void {
    const vr = this.#vr;
    if (!vr?.rig) return;
    const now = performance.now();
    const dt = (now - vr.at) / 1_000;
    vr.at = now;
    let [turn, pressed] = [0, false];
    for (const { gamepad, handedness } of sources) {
      const [x, y] = stickOf(gamepad?.axes ?? []);
      if (handedness === 'right') turn = x;
      else if (Math.hypot(x, y) > DEAD)
        vr.rig = shifted(
          vr.rig,
          head,
          walked(this.#eye.at, this.#eye.heading, { ahead: -y, left: -x }, dt, this.#free),
        );
      pressed ||= gamepad?.buttons[NARROW_BUTTON]?.pressed === true;
    }
    if (Math.abs(turn) > 0.6 && !vr.snapped) vr.rig = turned(vr.rig, head, -Math.sign(turn) * SNAP);
    vr.snapped = Math.abs(turn) > 0.3;
    if (pressed && !vr.pressed) this.#toggle();
    vr.pressed = pressed;
  }
}

/** A stick is axes 2 and 3 where there is a touchpad as well, and 0 and 1 where there is none. */
const stickOf = (axes: readonly number[]): readonly [number, number] =>
  axes.length >= 4 ? [axes[2] ?? 0, axes[3] ?? 0] : [axes[0] ?? 0, axes[1] ?? 0];

/** To begin with, the wearer looks along the floor's longer way: to the middle of it. */
const towards = ([x, y]: Vec2, { bounds: [x0, y0, x1, y1] }: FloorMap): number =>
  Math.atan2((y0 + y1) / 2 - y, (x0 + x1) / 2 - x);
