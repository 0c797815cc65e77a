// The page of a wearer, without browser, network or headset: poses, marks, guidance, arrow, coming back.
import { describe, expect, test } from 'vitest';
import { beside, fit, mark, suggest, type Mark, type Marking } from '../src/headset/align';
import { aim, multiply } from '../src/headset/arrow';
import { floorHit, rotate, toDevice, toMap, type Alignment, type Vec2, type Vec3 } from '../src/headset/frame';
import { buzz, show, STALE_MS, type Guidance, type Standing } from '../src/headset/guide';
import { lens, onCanvas, onMap, wayAhead } from '../src/headset/phone';
import { LOST_MS, Pump, type Sample } from '../src/headset/pump';
import { eyes, ribbon, Shapes, STRIDE, type Ink } from '../src/headset/shapes';
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
