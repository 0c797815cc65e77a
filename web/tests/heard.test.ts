// What a worker hears and reads: the task with its place, each thing once, in the worker's language; and names that do
// not cover each other.
import { afterEach, describe, expect, test, vi } from 'vitest';
import { Announcer, type Topic } from '../src/headset/announcer';
import { show, taskText, type Guidance, type Standing, type Task } from '../src/headset/guide';
import { around, lifts, placed, type Box } from '../src/headset/labels';
import { partsOf } from '../src/headset/sheet';
import { marksOf, placesOf } from '../src/headset/signin';
import { Voice, voiceFor } from '../src/headset/voice';
import { learn } from '../src/headset/words';
import type { FloorMap } from '../src/wire';

const WELL: Standing = { age_ms: 100, link: 'live', tracking: 'tracked', aligned: true };
const COUNT: Task = { id: 'a1', what: 'Count K1', place: 'G6-7' };
const PICK: Task = { id: 'a2', what: 'Pick 3 boxes', place: 'R102' };
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

/** A worker's minutes: what comes, and what is heard of it. */
class Ears {
  heard: string[] = [];
  #announcer = new Announcer();
  #now = 0;
  #topic: Topic | null = null;
  come(
    more: Partial<Guidance>,
    {
      task = null,
      finished = null,
      ended = null,
      at = {},
    }: Partial<Pick<Topic, 'task' | 'finished' | 'ended'>> & { at?: Partial<Standing> } = {},
  ): void {
    const g = guidance(more);
    this.#topic = { shown: show(g, { ...WELL, ...at }, task), assignment: g.assignment, task, finished, ended };
    this.wait(250);
  }
  /** The same, for so long. */
  wait(ms: number): void {
    for (let gone = 0; gone < ms; gone += 250) {
      this.#now += 250;
      const said = this.#topic ? this.#announcer.next(this.#topic, this.#now) : null;
      if (said) this.heard.push(said.text);
    }
  }
  again(): string {
    return this.#topic ? this.#announcer.again(this.#topic) : '';
  }
}

afterEach(() => learn('en'));

describe('what a worker hears', () => {
  test('task and place, you are there, done, the next, and that there is no more, each once', () => {
    const ears = new Ears();
    ears.come({}, { task: null });
    expect(ears.heard, 'it is not known yet what the assignment is about').toEqual([]);
    ears.come({}, { task: COUNT });
    ears.wait(5_000);
    ears.come({ arrived: true }, { task: COUNT });
    ears.wait(5_000);
    expect(ears.heard).toEqual(['Count K1 at G6-7.', 'You are there.']);
    ears.come({ assignment: 'a2' }, { task: COUNT, finished: 'a1' });
    ears.come({ assignment: 'a2' }, { task: PICK, finished: 'a1' });
    ears.wait(5_000);
    expect(ears.heard.slice(2)).toEqual(['Done.', 'Next: Pick 3 boxes at R102.']);
    ears.come({ assignment: 'a2', arrived: true }, { task: PICK });
    ears.come({ state: 'idle', assignment: null, path: [] }, { task: PICK, ended: { id: 'a2', how: 'done' } });
    ears.wait(5_000);
    expect(ears.heard.slice(4)).toEqual(['You are there.', 'Done.', 'Nothing more to do.']);
  });
  test('who is sent elsewhere before the work is done does not hear that it is', () => {
    const ears = new Ears();
    ears.come({}, { task: COUNT });
    ears.come({ assignment: 'a2' }, { task: PICK });
    ears.wait(2_000);
    expect(ears.heard).toEqual(['Count K1 at G6-7.', 'Next: Pick 3 boxes at R102.']);
  });
  test('a task that is cancelled is said to be cancelled, also after the worker was there', () => {
    const ears = new Ears();
    ears.come({}, { task: COUNT });
    ears.come({ arrived: true }, { task: COUNT });
    ears.come({ assignment: 'a2' }, { task: PICK });
    expect(ears.heard.slice(2), 'the server has not said yet how it ended').toEqual([]);
    ears.come({ assignment: 'a2' }, { task: PICK, ended: { id: 'a1', how: 'cancelled' } });
    expect(ears.heard.slice(2)).toEqual(['This task is cancelled. Next: Pick 3 boxes at R102.']);
    ears.come({ state: 'idle', assignment: null, path: [] }, { ended: { id: 'a2', how: 'cancelled' } });
    ears.wait(5_000);
    expect(ears.heard.slice(3)).toEqual(['This task is cancelled.', 'Nothing more to do.']);
  });
  test('how a task ended is not made up where the server does not say it', () => {
    const ears = new Ears();
    ears.come({}, { task: COUNT });
    ears.come({ arrived: true }, { task: COUNT });
    ears.come({ state: 'idle', assignment: null, path: [] }, { ended: { id: 'a0', how: 'done' } });
    ears.wait(5_000);
    expect(ears.heard.slice(2)).toEqual(['Nothing more to do.']);
  });
  test('a stop is said with its reason, once, though its seconds count down', () => {
    const ears = new Ears();
    ears.come({}, { task: COUNT });
    const cause = { kind: 'robot_crosses', robot: 'robot-7', closure: null };
    for (const wait_s of [4, 3.2, 2.1, 0.9]) ears.come({ state: 'stop', cause, wait_s, path: [] }, { task: COUNT });
    ears.come({}, { task: COUNT });
    expect(ears.heard).toEqual([
      'Count K1 at G6-7.',
      'WAIT 4 sec. robot-7 crosses your path: wait a moment, this way is still the fastest.',
    ]);
    ears.come({ state: 'stop', cause: { kind: 'robot_comes', robot: 'robot-7', closure: null } }, { task: COUNT });
    ears.come({}, { task: COUNT });
    ears.come({ state: 'stop', cause: { kind: 'robot_comes', robot: 'robot-7', closure: null } }, { task: COUNT });
    expect(ears.heard.slice(2), 'a second stop is a new one').toEqual(
      Array(2).fill('STOP. robot-7 is coming close: stand still.'),
    );
  });
  test('whoever walks along the edge of the path is told once that it is over there', () => {
    const ears = new Ears();
    for (let i = 0; i < 6; i += 1) {
      ears.come({ state: 'deviating' }, { task: COUNT });
      ears.come({}, { task: COUNT });
    }
    expect(ears.heard.filter((text) => text.startsWith('The path is over there'))).toHaveLength(1);
  });
  test('a connection that breaks and comes back is said, and not while the page opens', () => {
    const ears = new Ears();
    ears.come({}, { at: { link: 'connecting', age_ms: null } });
    ears.wait(2_000);
    expect(ears.heard).toEqual([]);
    ears.come({}, { task: COUNT });
    ears.come({}, { task: COUNT, at: { link: 'lost' } });
    ears.come({}, { task: COUNT });
    expect(ears.heard.slice(1)).toEqual([
      'No connection. No guidance. Robots do not know where you are: look out for yourself.',
      'Connected again.',
    ]);
  });
  test('a tap says again what stands now', () => {
    const ears = new Ears();
    ears.come({}, { task: COUNT });
    expect(ears.again()).toBe('Count K1 at G6-7.');
    ears.come({ arrived: true }, { task: COUNT });
    expect(ears.again()).toBe('Count K1 at G6-7. You are there.');
    ears.come({ state: 'stop', cause: { kind: 'no_way', robot: null, closure: null } }, { task: COUNT });
    expect(ears.again()).toBe('STOP. No path to the place is free.');
    ears.come({ state: 'idle', assignment: null, path: [] });
    expect(ears.again()).toBe('Nothing to do. Wait for the next task.');
    expect(ears.heard.slice(2), 'and that makes nothing new').toEqual(['STOP. No path to the place is free.']);
  });
});

describe('languages', () => {
  test('task and warnings are heard in the language of the wearer', async () => {
    const said: Record<string, string[]> = {};
    for (const language of ['de', 'es', 'zh'] as const) {
      await learn(language);
      const ears = new Ears();
      ears.come({}, { task: COUNT });
      ears.come({ state: 'stop', cause: { kind: 'robot_waits', robot: 'robot-7', closure: null } }, { task: COUNT });
      said[language] = ears.heard;
    }
    expect(said).toEqual({
      de: ['Count K1 bei G6-7.', 'STOPP. robot-7 wartet auf Sie: Bitte machen Sie Platz.'],
      es: ['Count K1 en G6-7.', 'ALTO. robot-7 le espera: por favor, deje sitio.'],
      zh: ['G6-7：Count K1。', '停。 robot-7 在等您：请让一让。'],
    });
    expect(document.documentElement.lang).toBe('zh-Hans');
  });
  test('a cause that this page does not know is said in the words of the server', () => {
    const cause = { kind: 'of_tomorrow', robot: null, closure: null };
    expect(show(guidance({ state: 'stop', cause, reason: 'the floor is wet' }), WELL).detail).toBe('The floor is wet.');
    expect(
      show(guidance({ cause: { kind: 'round_closure', robot: null, closure: 'oil' }, reason: 'x' }), WELL).detail,
    ).toBe('The way leads round a closed area: oil. 5.0 m · 1:05');
  });
  test('a long task is cut on the board, and one without words leads to its place', () => {
    expect(taskText({ id: 'a', what: ' ', place: 'A1' })).toBe('Go to A1');
    expect(show(guidance({ arrived: true }), WELL, { id: 'a1', what: '', place: 'A1' })).toMatchObject({
      title: 'You are there',
      detail: 'A1.',
    });
    const text = taskText({ id: 'a', what: 'x'.repeat(500), place: 'A1' });
    expect(text).toBe(`${'x'.repeat(79)}… at A1`);
  });
  test('lines break between words, also where a language has no spaces', () => {
    expect(partsOf('Stand still, please.', 'en')).toEqual(['Stand ', 'still, ', 'please.']);
    const chinese = partsOf('请站住，慢慢环顾四周。', 'zh');
    expect(chinese.length).toBeGreaterThan(3);
    expect(chinese.join('')).toBe('请站住，慢慢环顾四周。');
    expect(
      chinese.some((part) => /^[，。]/.test(part)),
      'no line begins with a comma',
    ).toBe(false);
  });
});

describe('a voice', () => {
  const voice = (lang: string, localService = true): SpeechSynthesisVoice => ({
    lang,
    localService,
    default: false,
    name: lang,
    voiceURI: lang,
  });
  test('is one of the language, without a network first; none where there is only another', () => {
    const all = [voice('en-US'), voice('de-DE', false), voice('de_AT')];
    expect(voiceFor(all, 'de')?.lang).toBe('de_AT');
    expect(voiceFor(all, 'en')?.lang).toBe('en-US');
    expect(voiceFor(all, 'zh')).toBeNull();
  });
  test('speaks the language, is silenced by a stop, and can be switched off', () => {
    const spoken: string[] = [];
    let cancelled = 0;
    vi.stubGlobal(
      'SpeechSynthesisUtterance',
      class {
        lang = '';
        voice = null;
        constructor(readonly text: string) {}
      },
    );
    vi.stubGlobal('speechSynthesis', {
      pending: false,
      getVoices: () => [voice('en-GB')],
      cancel: () => {
        cancelled += 1;
      },
      speak: ({ lang, text }: { lang: string; text: string }) => spoken.push(`${lang}: ${text}`),
    });
    const mouth = new Voice();
    mouth.say({ text: 'Go to A1.', urgent: false });
    expect(cancelled).toBe(0);
    mouth.say({ text: 'STOP.', urgent: true });
    expect(cancelled).toBe(1);
    mouth.isOn = false;
    mouth.say({ text: 'Done.', urgent: false });
    expect(spoken).toEqual(['en-GB: Go to A1.', 'en-GB: STOP.']);
    expect(new Voice().isOn, 'it is remembered').toBe(false);
    mouth.isOn = true;
    vi.unstubAllGlobals();
  });
});

describe('names near each other', () => {
  const meet = (a: Box, b: Box): boolean =>
    a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
  test('stand apart on a map, the most important one where it belongs', () => {
    const wishes = [
      [100, 100],
      [104, 102],
      [98, 110],
      [120, 100],
    ].map(([x, y]) => around([x!, y!], 12, 90, 18));
    const boxes = placed(wishes);
    expect(boxes[0]).toEqual(wishes[0]![0]);
    expect(boxes.every((box) => box !== null)).toBe(true);
    for (const [i, a] of boxes.entries()) for (const b of boxes.slice(i + 1)) expect(meet(a!, b!)).toBe(false);
  });
  test('that find no room are left out, and none covers what must be seen', () => {
    const wish: Box = { x: 0, y: 0, width: 10, height: 10 };
    expect(placed([[wish], [wish]])).toEqual([wish, null]);
    expect(placed([[wish]], [{ x: 5, y: 5, width: 1, height: 1 }])).toEqual([null]);
  });
  test('are lifted over each other in the room, also where the view wraps around', () => {
    const lifted = lifts(
      [
        { left: 3.1, up: 0 },
        { left: -3.1, up: 0.01 },
        { left: 3.12, up: -0.02 },
        { left: 0, up: 0 },
      ],
      0.26,
      0.05,
    );
    expect(lifted).toEqual([0, expect.closeTo(0.04), expect.closeTo(0.12), 0]);
  });
});

test('the marks of a map are those that it lists, else what stands fast; nodes can be marks besides', () => {
  const nodes = [
    { id: 'A1', x: 0, y: 0, kind: 'aisle' },
    { id: 'S1', x: 3, y: 0, kind: 'station' },
  ];
  const map = { nodes } as unknown as FloorMap;
  expect(marksOf(map).map((p) => p.name)).toEqual(['S1']);
  const marks = [{ name: 'M1', x: 1.5, y: 2 }];
  expect(marksOf({ ...map, marks })).toEqual([{ name: 'M1', at: [1.5, 2] }]);
  expect(placesOf({ ...map, marks }).map((p) => p.name)).toEqual(['M1', 'A1', 'S1']);
});
