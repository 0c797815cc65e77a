// A wearer's side of the link, with a clock and a line that the test moves: greeting, marks, poses, work, coming back.
import { beforeEach, describe, expect, test } from 'vitest';
import { cellWords, lights, type CellLights } from '../src/headset/cell';
import { DEAD_MS, type LineEvents } from '../src/headset/feed';
import { toDevice, type Alignment } from '../src/headset/frame';
import type { Guidance, Task } from '../src/headset/guide';
import type { Sample } from '../src/headset/pump';
import { Shapes, STRIDE, type Ink } from '../src/headset/shapes';
import { PLACED_MS, Wearer } from '../src/headset/wearer';

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
