// The page of a wearer, without browser, network or headset: poses, marks, guidance, arrow, coming back.
import { beforeEach, describe, expect, test } from 'vitest';
import { beside, fit, mark, suggest, type Mark, type Marking } from '../src/headset/align';
import { aim, multiply } from '../src/headset/arrow';
import { cellWords, lights, type CellLights } from '../src/headset/cell';
import { DEAD_MS, type LineEvents } from '../src/headset/feed';
import { floorHit, rotate, toDevice, toMap, type Alignment, type Vec2, type Vec3 } from '../src/headset/frame';
import { buzz, show, STALE_MS, type Guidance, type Standing, type Task } from '../src/headset/guide';
import { lens, onCanvas, onMap, wayAhead } from '../src/headset/phone';
import { LOST_MS, Pump, type Sample } from '../src/headset/pump';
import { eyes, ribbon, Shapes, STRIDE, type Ink } from '../src/headset/shapes';
import { PLACED_MS, Wearer } from '../src/headset/wearer';
import type { FloorMap } from '../src/wire';

const quarter: Alignment = { theta: Math.PI / 2, shift: [5, 7] };
const sample = (t: number, more: Partial<Sample> = {}): Sample => ({
  t,
  pos: [0, 1.6, 0],
  quat: [0, 0, 0, 1],
  emulated: false,
  ...more,
});
const guidance = (more: Partial<Guidance> = {}): Guidance => ({
  state: 'following',
  reason: null,
  version: 1,
  path: [
    [0, 0],
    [3, 4],
  ],
  next: [3, 4],
  eta_s: 65,
  assignment: 'a1',
  near: [],
  ...more,
});

describe('frames', () => {
  test('a point goes to the map and back', () => {
    // A device that walks ahead walks to -z, which is up in its plan and, turned by a quarter, to -x on the map.
    expect(toMap(quarter, [0, 1.6, -2])).toEqual([expect.closeTo(3), expect.closeTo(7)]);
    const back = toDevice(quarter, toMap(quarter, [1.5, 0, 4]), 0.1);
    expect(back).toEqual([expect.closeTo(1.5), 0.1, expect.closeTo(4)]);
  });
  test('a quaternion turns as WebXR says', () => {
    const half = Math.SQRT1_2;
    expect(rotate([0, half, 0, half], [0, 0, -1])).toEqual([expect.closeTo(-1), expect.closeTo(0), expect.closeTo(0)]);
  });
  test('a ray meets the floor only where it points down and near', () => {
    expect(floorHit([0, 1.5, 0], [0, -1, -1], 0)).toEqual([0, 0, expect.closeTo(-1.5)]);
    expect(floorHit([0, 1.5, 0], [0, -0.1, -1], 0)).toBeNull();
    expect(floorHit([0, 1.5, 0], [0, 1, 0], 0)).toBeNull();
    expect(floorHit([0, 1.5, 0], [0, -1, -3], 0), 'too far to be exact').toBeNull();
  });
});

describe('marks', () => {
  const at = (name: string, map: Vec2, off: Vec2 = [0, 0]): Mark => {
    const [x, , z] = toDevice(quarter, map, 0);
    return { name, map, device: [x + off[0], 0, z + off[1]] };
  };
  test('two marks give turn and shift as docs/headset.md has them', () => {
    const fitted = fit([at('A', [0, 0]), at('B', [10, 0])]);
    if (fitted.kind !== 'fits') throw new Error(fitted.kind);
    expect(fitted.alignment.theta).toBeCloseTo(Math.PI / 2);
    expect(fitted.alignment.shift).toEqual([expect.closeTo(5), expect.closeTo(7)]);
    expect(fitted.rms_m).toBeCloseTo(0);
  });
  test('one mark is not enough, and what the server would refuse is refused here', () => {
    expect(fit([at('A', [0, 0])]).kind).toBe('more');
    expect(fit([at('A', [0, 0]), at('B', [0.5, 0])])).toMatchObject({
      kind: 'misfit',
      text: expect.stringContaining('50 cm apart'),
    });
    expect(fit([at('A', [0, 0]), at('B', [10, 0], [0, 0.6])]).kind, 'six centimetres in a metre').toBe('misfit');
    expect(fit([at('A', [0, 0]), at('B', [10, 0]), at('C', [5, 8], [0.5, 0])]).kind).toBe('misfit');
  });
  test('the marks proposed are far apart, but no day trip', () => {
    const place = (name: string, x: number) => ({ name, at: [x, 0] as const });
    expect(suggest([place('a', 0), place('b', 5), place('c', 11), place('d', 90)])?.map((p) => p.name)).toEqual([
      'a',
      'c',
    ]);
    expect(suggest([place('a', 0)])).toBeNull();
  });
  test('the third mark proposed lies beside the line of the first two, and none on it does', () => {
    const place = (name: string, x: number, y: number) => ({ name, at: [x, y] as const });
    const two = [place('a', 0, 7), place('b', 12, 7)] as const;
    const places = [...two, place('on', 6, 7.5), place('near', 6, 12), place('far', 80, 90)];
    expect(beside(places, [two[0], two[1]])?.name).toBe('near');
    expect(beside(places.slice(0, 3), [two[0], two[1]])).toBeNull();
  });
  test('marks of one floor at different heights are taken again', () => {
    const raised = (m: Mark, y: number): Mark => ({ ...m, device: [m.device[0], y, m.device[2]] });
    expect(fit([at('A', [0, 0]), raised(at('B', [10, 0]), 3.5), raised(at('C', [5, 8]), -2)])).toMatchObject({
      kind: 'misfit',
      text: expect.stringContaining('height'),
    });
    expect(fit([at('A', [0, 0]), raised(at('B', [10, 0]), 0.1)]).kind).toBe('fits');
  });
  test('marks are taken one after the other, asked, refused, taken again, and forgotten when the frame jumps', () => {
    const names = ['A', 'B'];
    let now: Marking = { kind: 'taking', names, taken: [] };
    const confirm = (m: Mark): void => {
      now = mark(now, { kind: 'confirm', at: m.device, map: m.map });
    };
    confirm(at('A', [0, 0]));
    expect(now).toMatchObject({ kind: 'taking', taken: [{ name: 'A' }] });
    confirm(at('B', [10, 0], [0, 5]));
    expect(now.kind, 'the length is wrong').toBe('refused');
    confirm(at('B', [10, 0]));
    expect(now).toMatchObject({ kind: 'taking', taken: [] });
    confirm(at('A', [0, 0]));
    confirm(at('B', [10, 0]));
    expect(now).toMatchObject({ kind: 'asking', taken: [{ name: 'A' }, { name: 'B' }] });
    now = mark(now, { kind: 'aligned', rms_m: 0.02 });
    expect(now).toMatchObject({ kind: 'done', rms_m: 0.02 });
    expect(mark(now, { kind: 'again' }).kind, 'a new connection hears of them').toBe('asking');
    expect(mark(now, { kind: 'reset' })).toMatchObject({ kind: 'taking', taken: [] });
  });
});

describe('poses', () => {
  const run = (hz: number, waiting = 0): number => {
    const pump = new Pump();
    pump.enter(2, true);
    let sent = 0;
    for (let i = 0; i < hz * 10; i += 1) if (pump.offer(sample((i * 1000) / hz), waiting)) sent += 1;
    return sent / 10;
  };
  test('any display gives 20 to 60 a second, evenly', () => {
    for (const hz of [60, 72, 80, 90, 120, 144]) {
      expect(run(hz)).toBeGreaterThan(20);
      expect(run(hz)).toBeLessThanOrEqual(60);
      expect(Math.abs(hz / run(hz) - Math.round(hz / run(hz))), `${hz} Hz is divided by a whole number`).toBeLessThan(
        0.05,
      );
    }
  });
  test('a line that does not keep up gets 20, then nothing until it does', () => {
    expect(run(90, 10_000)).toBeGreaterThanOrEqual(18);
    expect(run(90, 10_000)).toBeLessThanOrEqual(22.6);
    expect(run(90, 100_000)).toBe(0);
  });
  test('numbers begin again with each epoch, and nothing leaves before alignment', () => {
    const pump = new Pump();
    expect(pump.offer(sample(0), 0)).toBeNull();
    pump.enter(4, true);
    expect(pump.offer(sample(20), 0)).toMatchObject({ epoch: 4, seq: 1, quality: 'tracked' });
    expect(pump.offer(sample(40, { emulated: true }), 0)).toMatchObject({ seq: 2, quality: 'emulated' });
    pump.enter(5, true);
    expect(pump.offer(sample(41), 0)).toMatchObject({ epoch: 5, seq: 1 });
  });
  test('a device without a pose says so twice a second', () => {
    const pump = new Pump();
    pump.enter(1, true);
    pump.offer(sample(1000), 0);
    expect(pump.missing(1000 + LOST_MS - 1)).toBeNull();
    expect(pump.missing(1000 + LOST_MS)).toMatchObject({ quality: 'lost', seq: 2 });
    expect(pump.missing(1100 + LOST_MS)).toBeNull();
    expect(pump.missing(1000 + 2 * LOST_MS)).toMatchObject({ seq: 3 });
    pump.offer(sample(3000), 0);
    expect(pump.isLost(3001)).toBe(false);
  });
});

describe('guidance', () => {
  const well: Standing = { age_ms: 100, link: 'live', tracking: 'tracked', aligned: true };
  test('each state has its words and its urgency', () => {
    expect(show(guidance(), well)).toMatchObject({
      kind: 'following',
      tone: 'calm',
      detail: '5.0 m · 1:05',
      next: [3, 4],
    });
    expect(show(guidance({ state: 'redirected', reason: 'you left the path' }), well)).toMatchObject({
      kind: 'redirected',
      detail: 'You left the path. 5.0 m · 1:05',
    });
    expect(show(guidance({ state: 'deviating' }), well)).toMatchObject({ kind: 'deviating', tone: 'warn' });
    expect(show(guidance({ state: 'idle' }), well)).toMatchObject({
      kind: 'idle',
      title: 'Nothing to do',
      tone: 'calm',
    });
    const closed = 'the place of your task is in a closed area, wait outside: oil';
    expect(show(guidance({ state: 'idle', reason: closed }), well)).toMatchObject({
      title: 'Wait here',
      tone: 'notice',
      detail: expect.stringContaining('wait outside: oil'),
    });
    expect(show(guidance({ reason: 'the way leads round a closed area: oil' }), well).detail).toBe(
      'The way leads round a closed area: oil. 5.0 m · 1:05',
    );
    expect(show(guidance({ state: 'stop', reason: 'robot-7 stands on the path' }), well)).toMatchObject({
      kind: 'stop',
      title: 'STOP',
      detail: 'Robot-7 stands on the path.',
      path: [],
    });
  });
  test('old guidance is never shown as true, but a stop stands', () => {
    expect(show(guidance(), { ...well, age_ms: STALE_MS })).toMatchObject({ kind: 'offline', path: [], near: [] });
    expect(show(guidance(), { ...well, link: 'lost' }).kind).toBe('offline');
    expect(show(null, { ...well, age_ms: null, link: 'connecting' }).title).toBe('Connecting');
    expect(show(guidance({ state: 'stop' }), { ...well, age_ms: 9_000, link: 'lost' })).toMatchObject({
      kind: 'stop',
      detail: expect.stringContaining('connection has been lost'),
    });
    // A wait whose length is known is counted; where the connection is lost, nothing is.
    expect(show(guidance({ state: 'stop', reason: 'robot-7 crosses your path', wait_s: 3.2 }), well)).toMatchObject({
      kind: 'stop',
      title: 'WAIT 4 sec',
      detail: 'Robot-7 crosses your path.',
    });
    expect(show(guidance({ state: 'stop', wait_s: 3.2 }), { ...well, age_ms: 9_000, link: 'lost' })).toMatchObject({
      kind: 'stop',
      title: 'STOP',
    });
  });
  test('a phone without a connection keeps the task and the path, and says how old they are', () => {
    const phone: Standing = { ...well, tracking: 'none', age_ms: 65_000, link: 'lost' };
    const kept = show(guidance(), phone, { id: 'a3', what: 'Count K1', place: 'G6-7' });
    expect(kept).toMatchObject({
      kind: 'offline',
      tone: 'warn',
      title: 'No connection',
      path: guidance().path,
      next: guidance().next,
      near: [],
    });
    expect(kept.detail).toContain('1:05');
    expect(show(guidance({ assignment: 'a3' }), phone, { id: 'a3', what: 'Count K1', place: 'G6-7' }).detail).toContain(
      'Count K1 at G6-7',
    );
    expect(show(guidance(), { ...phone, tracking: 'tracked' }), 'a headset walks on, its path does not').toMatchObject({
      path: [],
    });
  });
  test('a phone is told to tap the map, a headset to touch the marks', () => {
    const lost = guidance({ state: 'stop', cause: { kind: 'not_tracked', robot: null, closure: null } });
    expect(show(lost, well).detail).toContain('touch the marks');
    const phone = show(lost, { ...well, tracking: 'none' }).detail;
    expect(phone).toContain('tap the map');
    expect(phone).not.toContain('marks');
    const unsure = guidance({ state: 'stop', cause: { kind: 'place_unsure', robot: 'robot-7', closure: null } });
    expect(show(unsure, { ...well, tracking: 'none' }).detail).toMatch(/^robot-7 waits .* tap the map/);
  });
  test('without a position or marks there is no path', () => {
    expect(show(guidance(), { ...well, tracking: 'lost' })).toMatchObject({ kind: 'lost', path: [] });
    expect(show(guidance(), { ...well, aligned: false })).toMatchObject({ kind: 'marks', path: [] });
    expect(show(guidance(), { ...well, tracking: 'emulated' }).detail).toContain('guess');
  });
  test('the device shakes at changes only, most for STOP', () => {
    expect(buzz('following', 'following')).toEqual([]);
    expect(buzz('following', 'stop').length).toBeGreaterThan(buzz('following', 'redirected').length);
    expect(buzz(null, 'offline')).toEqual([]);
    expect(buzz('stop', 'following')).toEqual([]);
  });
});

describe('the arrow', () => {
  const f = 1;
  const projection = [f, 0, 0, 0, 0, f, 0, 0, 0, 0, -1, -1, 0, 0, -0.2, 0];
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const look = (p: Vec3) => aim(p, identity, projection);
  test('what is in view needs none', () => {
    expect(look([0.2, -0.3, -2])).toEqual({ kind: 'in view', x: expect.closeTo(0.1), y: expect.closeTo(-0.15) });
  });
  test('it stands at the edge towards the point', () => {
    expect(look([5, 0, -1])).toEqual({
      kind: 'off view',
      x: expect.closeTo(0.72),
      y: expect.closeTo(0),
      angle: expect.closeTo(0),
    });
    expect(look([0, -5, -1])).toMatchObject({ kind: 'off view', x: expect.closeTo(0), y: expect.closeTo(-0.72) });
  });
  test('what is behind is shown to the shorter side, also straight behind', () => {
    expect(look([-1, -1.6, 4])).toMatchObject({ kind: 'off view', x: expect.closeTo(-0.72), y: expect.closeTo(0) });
    expect(look([1, 0, 4])).toMatchObject({ x: expect.closeTo(0.72) });
    expect(look([0, 0, 4]).kind).toBe('off view');
  });
  test('matrices multiply column by column', () => {
    const shift = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 3, 4, 1];
    expect([...multiply(identity, shift)]).toEqual(shift);
    expect([...multiply(shift, shift)].slice(12)).toEqual([4, 6, 8, 1]);
  });
});

describe('shapes', () => {
  const c = [0, 0, 0, 1] as const;
  const ink: Ink = { path: c, chevron: c, next: c, robot: c, close: c, mark: c, stop: c, outside: c };
  test('the ribbon covers the path, corners too, and goes no further', () => {
    const shapes = new Shapes();
    ribbon(
      shapes,
      [
        [0, 0, 0],
        [2, 0, 0],
        [2, 0, 2],
      ],
      ink,
    );
    const corners = shapes.corners;
    const xs = [...corners].filter((_, i) => i % STRIDE === 0);
    const zs = [...corners].filter((_, i) => i % STRIDE === 2);
    expect([Math.min(...xs), Math.max(...xs)]).toEqual([expect.closeTo(0), expect.closeTo(2.13)]);
    expect(Math.max(...zs)).toBeCloseTo(2);
    ribbon(new Shapes(), [], ink);
    ribbon(
      new Shapes(),
      [
        [1, 0, 1],
        [1, 0, 1],
      ],
      ink,
    );
  });
  test('STOP covers the view and hides the arrow', () => {
    const well: Standing = { age_ms: 1, link: 'live', tracking: 'tracked', aligned: true };
    const off = { kind: 'off view', x: 1, y: 0, angle: 0 } as const;
    const stop = eyes(show(guidance({ state: 'stop' }), well), off, [1, 1], ink).corners;
    expect(stop.length).toBe(6 * STRIDE);
    expect(Math.max(...stop)).toBeGreaterThan(5);
    expect(eyes(show(guidance(), well), off, [1, 1], ink).isEmpty).toBe(false);
    expect(eyes(show(guidance(), well), { kind: 'in view', x: 0, y: 0 }, [1, 1], ink).isEmpty).toBe(true);
  });
});

describe('a map on a phone', () => {
  const map = { bounds: [0, 0, 40, 20] } as unknown as FloorMap;
  test('a tap is where the finger was', () => {
    const l = lens(map, { at: [10, 10], heading: null }, 300, 400);
    expect(onMap(l, onCanvas(l, [12, 9], 300, 400), 300, 400)).toEqual([expect.closeTo(12), expect.closeTo(9)]);
    expect(onCanvas(l, [10, 11], 300, 400)[1], 'north is up').toBeLessThan(onCanvas(l, [10, 10], 300, 400)[1]);
  });
  test('without a place the whole floor is shown, with one what is around it', () => {
    const whole = lens(map, null, 400, 400);
    expect(whole.centre).toEqual([20, 10]);
    expect(lens(map, { at: [2, 10], heading: null }, 400, 400).scale).toBeGreaterThan(2 * whole.scale);
  });
  test('the way ahead skips what is underfoot', () => {
    const shown = show(
      guidance({
        next: [1, 1.1],
        path: [
          [1, 1],
          [1, 5],
        ],
      }),
      { age_ms: 1, link: 'live', tracking: 'none', aligned: true },
    );
    expect(wayAhead([1, 1], shown)).toBeCloseTo(Math.PI / 2);
  });
});

class World {
  time = 1_000;
  tasks: Task[] = [];
  lines: { events: LineEvents; sent: Record<string, unknown>[]; shut: boolean }[] = [];
  #timers: { at: number; run: () => void }[] = [];
  wearer: Wearer;
  constructor(frame: 'device' | 'map') {
    this.wearer = new Wearer({
      frame,
      poses: frame === 'map' ? 'placed' : 'tracked',
      random: () => 1,
      onChange: () => {},
      task: async (id) => this.tasks.find((task) => task.id === id) ?? null,
      marks: [
        { name: 'A', at: [0, 0] },
        { name: 'B', at: [10, 0] },
      ],
      open: (events) => {
        const line = { events, sent: [] as Record<string, unknown>[], shut: false };
        this.lines.push(line);
        return {
          send: (text) => void line.sent.push(JSON.parse(text)),
          close: () => {
            line.shut = true;
          },
          waiting: () => 0,
        };
      },
      clock: {
        now: () => this.time,
        after: (ms, run) => {
          const timer = { at: this.time + ms, run };
          this.#timers.push(timer);
          return timer;
        },
        cancel: (timer) => {
          this.#timers = this.#timers.filter((t) => t !== timer);
        },
      },
    });
    this.wearer.start();
  }
  get line() {
    return this.lines.at(-1)!;
  }
  get said(): unknown[] {
    return this.line.sent.map((m) => m['type']);
  }
  hear(message: object): void {
    this.line.events.message(JSON.stringify(message));
  }
  welcome(aligned = false): void {
    this.line.events.opened();
    this.hear({ type: 'welcome', version: 1, epoch: 1, aligned });
  }
  pass(ms: number): void {
    const until = this.time + ms;
    for (;;) {
      const next = this.#timers.filter((t) => t.at <= until).sort((a, b) => a.at - b.at)[0];
      if (!next) break;
      this.#timers = this.#timers.filter((t) => t !== next);
      this.time = next.at;
      next.run();
    }
    this.time = until;
  }
  align(): void {
    this.wearer.confirm([0, 0, 0]);
    this.wearer.confirm([10, 0, 0]);
    this.hear({ type: 'aligned', epoch: 2, theta: 0, shift: [0, 0], rms_m: 0.01, heading_error: 0.01, dropped: [] });
  }
  look(): void {
    this.wearer.frame(sample(this.time));
  }
}

describe('a wearer', () => {
  let world: World;
  beforeEach(() => {
    world = new World('device');
  });

  test('greets, answers pings with two readings of the clock, aligns, and sends poses of the new epoch', () => {
    world.welcome();
    world.hear({ type: 'ping', id: 7 });
    world.look();
    expect(world.line.sent).toEqual([
      { type: 'hello', versions: [2, 1], frame: 'device' },
      { type: 'pong', id: 7, t1: 1000, t2: 1000 },
    ]);
    world.align();
    expect(world.line.sent.at(-1)).toEqual({
      type: 'anchors',
      pairs: [
        { device: [0, 0, 0], mark: 'A' },
        { device: [10, 0, 0], mark: 'B' },
      ],
    });
    world.look();
    expect(world.line.sent.at(-1)).toMatchObject({ type: 'pose', epoch: 2, seq: 1, t: 1000 });
  });
  test("sends hands with the head's ray only while the server asks for them, and says so to the wearer", () => {
    const hands = { l: null, r: Array.from({ length: 25 }, () => [0.2, 1, -0.4, 0.01] as const) };
    const shows = (): void => world.wearer.frame(sample((world.time += 50), { hands }));
    world.welcome();
    world.align();
    shows();
    expect(world.line.sent.at(-1)).not.toHaveProperty('hands');
    const cell: CellLights = {
      station: 'S1',
      hands: true,
      pieces: 2,
      warning: null,
      slot: { id: 'C3', at: [1, 2, 1.1] },
      tote: { id: 'B', at: [2, 2, 0.8] },
    };
    world.hear({ type: 'cell', ...cell });
    shows();
    expect(world.line.sent.at(-1)).toMatchObject({
      gaze: { kind: 'head', origin: [0, 1.6, 0], dir: [0, 0, -1] },
      hands: { l: null, r: hands.r },
    });
    expect(cellWords(world.wearer.cell)?.join()).toMatch(/2.*C3.*B.*hands are seen/);
    world.hear({ type: 'cell', ...cell, warning: { kind: 'wrong_slot', slot: 'A1', tote: null } });
    expect(cellWords(world.wearer.cell)?.[0]).toBe('Wrong slot: A1');
    world.hear({ type: 'cell', station: null, hands: false, slot: null, pieces: 0, tote: null, warning: null });
    shows();
    expect(world.line.sent.at(-1)).not.toHaveProperty('hands');
    expect(cellWords(world.wearer.cell)).toBeNull();
  });
  test('hands are not wanted any more once the line is lost', () => {
    world.welcome();
    world.align();
    world.hear({ type: 'cell', station: 'S1', hands: true, slot: null, pieces: 0, tote: null, warning: null });
    expect(world.wearer.pump.wantsHands).toBe(true);
    world.line.events.closed(1006, '');
    expect([world.wearer.pump.wantsHands, world.wearer.cell]).toEqual([false, null]);
  });
  test('lit slots and totes are drawn where they are in the room, in the colour of alarm while a hand is wrong', () => {
    const [next, close] = [
      [0, 1, 0, 1],
      [1, 0, 0, 1],
    ] as const;
    const cell: CellLights = {
      station: 'S1',
      hands: true,
      pieces: 1,
      warning: null,
      slot: { id: 'C3', at: [3, 7, 1.2] },
      tote: { id: 'B', at: [4, 7, 0.8] },
    };
    const drawn = (wrong: CellLights['warning']): Float32Array => {
      const shapes = new Shapes();
      lights(shapes, { ...cell, warning: wrong }, quarter, 0.1, { next, close } as unknown as Ink);
      return shapes.corners;
    };
    const corners = drawn(null);
    const at = Array.from({ length: corners.length / STRIDE }, (_, i) => [
      ...corners.slice(i * STRIDE, i * STRIDE + STRIDE),
    ]);
    const [x, y, z] = toDevice(quarter, [3, 7], 1.3);
    const slot = at.filter(([a, b, c]) => Math.hypot(a! - x, b! - y, c! - z) < 0.18);
    expect(slot.length).toBeGreaterThan(20);
    expect(at.every((corner) => corner[4] === 1)).toBe(true);
    expect(drawn({ kind: 'wrong_slot', slot: 'A1', tote: null })[3]).toBe(1);
  });
  test('marks that the server refuses are taken again, and its words are shown', () => {
    world.welcome();
    world.wearer.confirm([0, 0, 0]);
    world.wearer.confirm([10, 0, 0]);
    world.hear({
      type: 'refused',
      what: 'anchors',
      reason: 'the marks are off',
      remedy: 'touch it again',
      epoch: 1,
      aligned: false,
    });
    expect(world.wearer.marking).toMatchObject({ kind: 'refused', text: 'the marks are off: touch it again' });
    world.wearer.confirm([0, 0, 0]);
    expect(world.wearer.marking).toMatchObject({ kind: 'taking', taken: [] });
  });
  test('a jump of the origin ends the alignment and asks for the marks again', () => {
    world.welcome();
    world.align();
    world.wearer.reset();
    expect(world.said.at(-1)).toBe('reset');
    expect(world.wearer.alignment).toBeNull();
    const before = world.line.sent.length;
    world.look();
    expect(world.line.sent.length, 'no pose of a frame that is not known').toBe(before);
    world.hear({ type: 'epoch', epoch: 3, aligned: false });
    world.hear({ ...guidance(), type: 'guidance' });
    world.look();
    expect(world.wearer.shown().kind).toBe('marks');
    expect(world.wearer.marking).toMatchObject({ kind: 'taking', taken: [] });
  });
  test('after a break it comes back by itself, greets, and shows the server the marks it knows', () => {
    world.welcome();
    world.align();
    world.look();
    world.hear({ ...guidance(), type: 'guidance' });
    expect(world.wearer.shown().kind).toBe('following');
    world.line.events.closed(1006, '');
    world.look();
    expect(world.wearer.shown().kind).toBe('offline');
    world.pass(1_000);
    expect(world.lines.length).toBe(2);
    world.look();
    expect(world.line.sent, 'nothing was kept for later').toEqual([]);
    world.welcome();
    expect(world.said).toEqual(['hello', 'anchors']);
    world.hear({ type: 'aligned', epoch: 2, theta: 0, shift: [0, 0], rms_m: 0.01, heading_error: 0.01, dropped: [] });
    world.look();
    expect(world.line.sent.at(-1)).toMatchObject({ type: 'pose', epoch: 2, seq: 1 });
  });
  test('what the server finds wrong is shown for as long as it says so', () => {
    world.welcome();
    expect(world.wearer.notice()).toBeNull();
    world.hear({ type: 'warning', code: 'future', count: 3, text: '3 poses were from the future' });
    expect(world.wearer.notice()).toBe('3 poses were from the future');
    world.pass(3_000);
    expect(world.wearer.notice()).not.toBeNull();
    world.pass(4_000);
    expect(world.wearer.notice()).toBeNull();
  });
  test('work is said to be done where its place is near, once, and again where that was not heard', () => {
    world.welcome();
    world.align();
    world.look();
    world.hear({
      ...guidance({
        path: [
          [0, 0],
          [3, 4],
        ],
      }),
      type: 'guidance',
    });
    world.wearer.confirm([0, 0, 0]);
    expect(world.said, 'five metres away').not.toContain('done');
    world.hear({
      ...guidance({
        path: [
          [2, 3],
          [3, 4],
        ],
      }),
      type: 'guidance',
    });
    expect(world.wearer.due()).toBe('a1');
    world.wearer.confirm([0, 0, 0]);
    expect(world.line.sent.at(-1)).toEqual({ type: 'done', assignment: 'a1' });
    expect(world.wearer.due(), 'it was said').toBeNull();
    world.hear({ type: 'done', assignment: 'a1', refused: 'nothing was accepted' });
    expect(world.wearer.due()).toBe('a1');
    expect(world.wearer.notTaken).toBe('nothing was accepted');
    world.wearer.confirm([0, 0, 0]);
    expect(world.wearer.notTaken, 'it was said again').toBeNull();
    world.hear({ type: 'done', assignment: 'a1', refused: 'nothing was accepted' });
    world.hear({ ...guidance({ assignment: 'a2' }), type: 'guidance' });
    expect(world.wearer.notTaken, 'that was of another assignment').toBeNull();
    world.hear({
      ...guidance({
        path: [
          [2, 3],
          [3, 4],
        ],
      }),
      type: 'guidance',
    });
    world.hear({ ...guidance({ state: 'stop', path: [] }), type: 'guidance' });
    expect(world.wearer.due(), 'no gesture during a stop').toBeNull();
    world.hear({ ...guidance({ assignment: null, path: [] }), type: 'guidance' });
    expect(world.wearer.due()).toBeNull();
  });
  test('a line that says nothing is given up, and one that never opens too', () => {
    world.welcome();
    world.pass(DEAD_MS + 2_000);
    expect(world.lines[0]!.shut).toBe(true);
    expect(world.lines.length).toBe(2);
    world.pass(30_000);
    expect(world.lines.length).toBeGreaterThan(2);
  });
  test('when another device took the place, it does not fight for it', () => {
    world.welcome();
    world.hear({ type: 'error', text: 'another connection of this worker replaced this one' });
    world.line.events.closed(1008, '');
    world.pass(120_000);
    expect(world.lines.length).toBe(1);
    expect(world.wearer.feed).toEqual({ kind: 'ended', text: 'another connection of this worker replaced this one' });
    world.wearer.retryNow();
    expect(world.lines.length).toBe(2);
  });
  test('guidance that was drawn is acknowledged once for each version', () => {
    world.welcome();
    world.hear({ ...guidance({ version: 5 }), type: 'guidance' });
    world.wearer.drawn();
    world.wearer.drawn();
    expect(world.line.sent.filter((m) => m['type'] === 'ack')).toEqual([{ type: 'ack', version: 5 }]);
  });
  test('messages that cannot be read or are of tomorrow do no harm', () => {
    world.welcome();
    world.line.events.message('{');
    world.hear({ type: 'tomorrow' });
    expect(world.wearer.feed.kind).toBe('live');
  });
});

test('a phone says where it stands for as long as that was said, and then no more', () => {
  const world = new World('map');
  world.welcome(true);
  world.wearer.tick();
  expect(world.said).toEqual(['hello']);
  world.wearer.place([3, 4]);
  expect(world.line.sent.at(-1)).toMatchObject({ type: 'pose', at: [3, 4], accuracy: 1, quality: 'tracked' });
  for (let i = 0; i < 200; i += 1) {
    world.hear({ type: 'ping', id: i });
    world.pass(500);
    world.wearer.tick();
  }
  const poses = world.line.sent.filter((m) => m['type'] === 'pose');
  expect(poses.length).toBeLessThanOrEqual(PLACED_MS / 1_000 + 1);
  expect(poses.length).toBeGreaterThan(50);
  expect(world.wearer.placed).toBeNull();
});

test('a tap that says where a phone stands yields to a tag, which is more exact, and counts again without it', () => {
  const world = new World('map');
  world.welcome(true);
  const poses = (): number => world.said.filter((type) => type === 'pose').length;
  world.wearer.place([3, 4]);
  world.wearer.located(1.02);
  world.pass(1_000);
  world.wearer.tick();
  expect(world.wearer.placed, 'the server knows no more than the tap').not.toBeNull();
  const before = poses();
  world.wearer.located(0.3);
  expect(world.wearer.placed).toBeNull();
  world.wearer.place([9, 9]);
  world.pass(1_000);
  world.wearer.tick();
  expect(poses(), 'what the finger says is not sent any more').toBe(before);
  world.wearer.located(null);
  world.wearer.place([9, 9]);
  expect(world.line.sent.at(-1)).toMatchObject({ type: 'pose', at: [9, 9], accuracy: 1 });
});
test('a wearer asks once what an assignment is about, and again where there was no answer', async () => {
  const world = new World('map');
  world.welcome(true);
  world.hear({ ...guidance(), type: 'guidance' });
  await Promise.resolve();
  expect(world.wearer.task).toBeNull();
  world.tasks.push({ id: 'a1', what: 'Count K1', place: 'G6-7' });
  world.hear({ ...guidance(), type: 'guidance' });
  await Promise.resolve();
  expect(world.wearer.task, 'not so soon').toBeNull();
  world.pass(4_000);
  world.hear({ ...guidance(), type: 'guidance' });
  await Promise.resolve();
  expect(world.wearer.shown()).toMatchObject({ kind: 'following', title: 'Count K1 at G6-7', detail: '5.0 m · 1:05' });
  world.hear({ ...guidance({ arrived: true }), type: 'guidance' });
  expect(world.wearer.shown()).toMatchObject({ title: 'You are there', detail: 'Count K1 at G6-7.' });
});
test('a wearer asks how an assignment ended, until the server has it', async () => {
  const world = new World('map');
  world.welcome(true);
  world.tasks = [{ id: 'a1', what: 'Count K1', place: 'G6-7', state: 'working' }];
  world.hear({ ...guidance({ arrived: true }), type: 'guidance' });
  world.hear({ ...guidance({ state: 'idle', assignment: null, path: [] }), type: 'guidance' });
  await Promise.resolve();
  expect(world.wearer.ended, 'the list is a moment behind').toBeNull();
  world.tasks = [{ id: 'a1', what: 'Count K1', place: 'G6-7', state: 'cancelled' }];
  world.pass(400);
  await Promise.resolve();
  expect(world.wearer.ended).toEqual({ id: 'a1', how: 'cancelled' });
});
