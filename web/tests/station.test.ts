// The display of a station: which line is lit and what undo takes back, keys and scans, the drawing, the link.
import { beforeEach, describe, expect, test } from 'vitest';
import { Asks } from '../src/station/asks';
import { draw, reachWidth, rowEdges } from '../src/station/face';
import { judge, warned } from '../src/station/judge';
import { GAP_MS, Keys, Once, SAME_PRESS_MS, type Pressed } from '../src/station/keys';
import { Changes, countdown, leftOf, linesLeft, litOf, nextOf, slotMarks } from '../src/station/lines';
import { DEAD_MS, OLD_MS, StationLink } from '../src/station/link';
import { signInAt } from '../src/station/server';
import { readStation, type Line, type Station, type Visit } from '../src/station/state';
import type { SocketEvents } from '../src/wire';

const line = (n: number, slot: string, state: Line['state'], more: Partial<Line> = {}): Line => ({
  n,
  slot,
  quantity: 2,
  tote: 'A',
  item: null,
  by: 'either',
  state,
  done: 0,
  ...more,
});
const visit = (...lines: Line[]): Visit => ({
  job: 'j1',
  rack: 'K1',
  robot: 'r1',
  since: null,
  face: null,
  lines,
  pieces_left: 0,
  expected_end: null,
});
const station = (more: Partial<Station> = {}): Station => ({
  ...readStation('{"now":"2026-01-01T00:00:00Z","id":"S1"}')!,
  totes: ['A', 'tub-7', 'B'].map((id, i) => ({ id, right_m: (i - 1) / 2, out_m: 1 })),
  visit: visit(line(1, 'C3', 'lit', { tote: 'B' }), line(2, 'B2', 'open')),
  ...more,
});

describe('lines', () => {
  const now = visit(
    line(1, 'A1', 'done', { done: 2 }),
    line(2, 'B1', 'lit', { done: 1 }),
    line(3, 'A1', 'open'),
    line(4, 'C1', 'short'),
  );
  test('the lit line, the one after it and what is left are told apart', () => {
    expect([litOf(now)?.n, nextOf(now)?.n, linesLeft(now)]).toEqual([2, 3, 2]);
    expect(now.lines.map(leftOf)).toEqual([0, 1, 2, 0]);
    expect([litOf(null), nextOf(null)]).toEqual([null, null]);
  });
  test('a line that was taken back comes in its order again', () => {
    expect(nextOf(visit(line(1, 'A1', 'undone'), line(2, 'B1', 'lit'), line(3, 'C1', 'open')))?.n).toBe(1);
  });
  test('a slot with several lines is marked by the most urgent of them', () => {
    expect([...slotMarks(now)]).toEqual([
      ['A1', 'next'],
      ['B1', 'lit'],
      ['C1', 'short'],
    ]);
  });
  test('what is said to last counts down between two messages, and never below nothing', () => {
    expect([countdown(14.2, 700), countdown(1, 5_000)]).toEqual([13.5, 0]);
  });
});

describe('undo', () => {
  let changes: Changes;
  beforeEach(() => {
    changes = new Changes();
  });
  const hear = (...lines: Line[]): number | undefined => {
    changes.hear(visit(...lines));
    return changes.target(visit(...lines))?.n;
  };
  test('there is nothing to take back in the beginning', () => {
    expect(hear(line(1, 'A1', 'lit'), line(2, 'B1', 'open'))).toBeUndefined();
  });
  test('it takes back what was changed last, whoever did it and in whatever order', () => {
    hear(line(1, 'A1', 'lit'), line(2, 'B1', 'open'));
    expect(hear(line(1, 'A1', 'lit'), line(2, 'B1', 'short'))).toBe(2);
    expect(hear(line(1, 'A1', 'done', { done: 2 }), line(2, 'B1', 'short'))).toBe(1);
  });
  test('the pieces of the lit line go before the line that was over before them', () => {
    hear(line(1, 'A1', 'done', { done: 2 }), line(2, 'B1', 'lit'));
    expect(hear(line(1, 'A1', 'done', { done: 2 }), line(2, 'B1', 'lit', { done: 1 }))).toBe(2);
  });
  test('what was taken back is not taken back again, but the change before it is', () => {
    hear(line(1, 'A1', 'done', { done: 2 }), line(2, 'B1', 'lit'));
    hear(line(1, 'A1', 'done', { done: 2 }), line(2, 'B1', 'done', { done: 2 }));
    expect(hear(line(1, 'A1', 'done', { done: 2 }), line(2, 'B1', 'undone'))).toBe(1);
    expect(hear(line(1, 'A1', 'undone'), line(2, 'B1', 'undone'))).toBeUndefined();
  });
  test('a page that was opened late takes back the pieces of the lit line, else the last line that is over', () => {
    expect(hear(line(1, 'A1', 'lit', { done: 1 }), line(2, 'B1', 'done', { done: 2 }))).toBe(1);
    changes = new Changes();
    expect(hear(line(1, 'A1', 'short'), line(2, 'B1', 'done', { done: 2 }), line(3, 'C1', 'lit'))).toBe(2);
  });
  test('another rack begins anew', () => {
    hear(line(1, 'A1', 'done', { done: 2 }));
    const other = { ...visit(line(1, 'A1', 'lit')), job: 'j2' };
    changes.hear(other);
    expect(changes.target(other)).toBeNull();
  });
});

describe('keys and scans', () => {
  /** Types keys so many milliseconds apart, and waits. */
  const typed = (gap: number, ...all: string[]): Pressed[] => {
    const keys = new Keys();
    const out = all.flatMap((key, i) => keys.press(key, i * gap));
    return [...out, ...keys.settle(all.length * gap + GAP_MS)];
  };
  test('characters faster than anybody types, with Enter after them, are a scan', () => {
    expect(typed(8, 'Shift', 'C', '3', 'Enter')).toEqual([{ kind: 'scan', text: 'C3' }]);
  });
  test('a scan fires no key that happens to be in it', () => {
    expect(typed(8, 'M', 'U', 'P', '+', 'Enter')).toEqual([{ kind: 'scan', text: 'MUP+' }]);
  });
  test('a person who types is no scanner: each key is one', () => {
    expect(typed(120, 'm', 'u', 'Enter')).toEqual(['m', 'u', 'Enter'].map((key) => ({ kind: 'key', key })));
  });
  test('one key is known to be one when nothing follows it', () => {
    const keys = new Keys();
    expect(keys.press('m', 0)).toEqual([]);
    expect(keys.settle(GAP_MS - 1)).toEqual([]);
    expect(keys.settle(GAP_MS)).toEqual([{ kind: 'key', key: 'm' }]);
    expect(keys.settle(9 * GAP_MS)).toEqual([]);
  });
  test('several quick characters without Enter are neither key nor scan', () => {
    expect(typed(8, 'C', '3')).toEqual([]);
  });
  test('Enter that comes late after a burst is Enter alone', () => {
    const keys = new Keys();
    keys.press('C', 0);
    keys.press('3', 10);
    expect(keys.press('Enter', 400)).toEqual([{ kind: 'key', key: 'Enter' }]);
  });
  test('a press that follows too soon, or before the answer, is not another one', () => {
    const once = new Once();
    expect([once.begin(0, SAME_PRESS_MS), once.begin(1_000, SAME_PRESS_MS)]).toEqual([true, false]);
    once.over();
    expect(once.begin(SAME_PRESS_MS - 1, SAME_PRESS_MS)).toBe(false);
    expect(once.begin(SAME_PRESS_MS, SAME_PRESS_MS)).toBe(true);
  });
});

describe('what a scan means', () => {
  test('the lit slot is one piece of its line, also in small letters', () => {
    expect(judge(' c3 ', station(), null)).toMatchObject({ kind: 'piece', line: { n: 1 } });
  });
  test('any other slot is a mistake, though a later line needs it and though the rack has no such slot', () => {
    for (const is of ['B2', 'Z9']) {
      expect(judge(is, station(), null)).toEqual({ kind: 'mistake', mistake: { kind: 'wrong_slot', is, right: 'C3' } });
    }
  });
  test('the tote of the lit line is right, and any other one is a mistake', () => {
    expect(judge('B', station(), null)).toEqual({ kind: 'right tote', tote: 'B' });
    const mistake = { kind: 'wrong_tote', is: 'tub-7', right: 'B' };
    expect(judge('TUB-7', station(), null)).toEqual({ kind: 'mistake', mistake });
  });
  test('after a piece was scanned its own tote is right, though another line is lit by then', () => {
    expect(judge('A', station(), 'A')).toEqual({ kind: 'right tote', tote: 'A' });
    expect(judge('B', station(), 'A')).toMatchObject({ kind: 'mistake', mistake: { is: 'B', right: 'A' } });
  });
  test('one character that names no tote was a key', () => {
    expect(judge('M', station(), null)).toBeNull();
  });
  test('what names nothing here is said to be unknown, and without a lit line there is nothing to confirm', () => {
    expect(judge('4006381333931', station(), null)).toEqual({ kind: 'unknown', text: '4006381333931' });
    for (const text of ['C3', 'A']) expect(judge(text, station({ visit: null }), null)).toEqual({ kind: 'nothing' });
  });
  test('a warning of the server says what would be right', () => {
    const slot = { kind: 'wrong_slot', slot: 'B2', tote: null } as const;
    const tote = { kind: 'wrong_tote', slot: null, tote: 'A' } as const;
    expect(warned(station({ warnings: [slot] }))).toEqual({ kind: 'wrong_slot', is: 'B2', right: 'C3' });
    expect(warned(station({ warnings: [tote] }))).toEqual({ kind: 'wrong_tote', is: 'A', right: 'B' });
    expect(warned(station())).toBeNull();
  });
});

describe('the drawing', () => {
  const face = { columns: 4, heights_m: [0.4, 0.8, 1.6], width_m: 0.8 };
  test('rows reach halfway to the next one, and none below the floor', () => {
    const edges = rowEdges([0.4, 0.8, 1.6]).flat();
    expect(edges.map((y) => Number(y.toFixed(3)))).toEqual([0.2, 0.6, 0.6, 1.2, 1.2, 2]);
    expect(rowEdges([0.1])).toEqual([[0, 0.25]]);
  });
  test('A1 is on the left and lowest, and all slots are to scale', () => {
    const { slots, body } = draw(face, []);
    expect(slots.map(({ name }) => name).join(' ')).toBe('A1 B1 C1 D1 A2 B2 C2 D2 A3 B3 C3 D3');
    expect(Math.min(...slots.map(({ x }) => x))).toBe(slots[0]!.x);
    expect(Math.max(...slots.map(({ y }) => y))).toBe(slots[0]!.y);
    expect(slots[0]!.width).toBeCloseTo(0.2);
    expect([body.width, body.height].map((m) => Number(m.toFixed(3)))).toEqual([0.8, 1.8]);
  });
  test('totes are below the rack, left and right as they stand, and one behind another below it', () => {
    const { totes, view, body } = draw(face, [
      { id: 'right', right_m: 0.9, out_m: 1 },
      { id: 'left', right_m: -0.9, out_m: 1 },
      { id: 'behind', right_m: 0.8, out_m: 1.5 },
    ]);
    const [left, right, behind] = totes;
    expect(totes.map(({ name }) => name)).toEqual(['left', 'right', 'behind']);
    expect(left!.x).toBeLessThan(right!.x);
    expect(left!.y).toBe(right!.y);
    expect(behind!.y).toBeGreaterThanOrEqual(right!.y + right!.height);
    expect(left!.y).toBeGreaterThan(body.y + body.height);
    expect(view[0]).toBeLessThan(left!.x);
    expect(view[0] + view[2]).toBeGreaterThan(right!.x + right!.width);
  });
  test('a rack of which no slots are known is drawn all the same', () => {
    expect(draw(null, []).slots).toEqual([]);
    expect(draw(null, []).body.height).toBeGreaterThan(1);
  });
  test('the likelier the hand goes to a slot, the wider its outline', () => {
    expect(reachWidth(0.01)).toBe(0);
    expect(reachWidth(0.9)).toBeGreaterThan(reachWidth(0.3));
  });
});

describe('the link', () => {
  let [time, lost]: [number, boolean[]] = [0, []];
  let timers: { at: number; run: () => void }[] = [];
  let sockets: { events: SocketEvents; isOpen: boolean }[] = [];
  let link: StationLink;
  const pass = (ms: number): void => {
    const until = time + ms;
    for (;;) {
      const next = timers.filter(({ at }) => at <= until).sort((a, b) => a.at - b.at)[0];
      if (!next) break;
      timers = timers.filter((one) => one !== next);
      time = next.at;
      next.run();
    }
    time = until;
  };
  const say = (now: string): void => sockets.at(-1)!.events.message(JSON.stringify({ now, id: 'S1' }));
  beforeEach(() => {
    [time, lost, timers, sockets] = [0, [], [], []];
    link = new StationLink({
      open: (events) => {
        const socket = { events, isOpen: true };
        sockets.push(socket);
        return {
          close: () => {
            socket.isOpen = false;
          },
        };
      },
      clock: {
        now: () => time,
        after: (ms, run) => {
          const timer = { at: time + ms, run };
          timers.push(timer);
          return timer;
        },
        cancel: (timer) => {
          timers = timers.filter((one) => one !== timer);
        },
      },
      random: () => 1,
      hear: (text) => readStation(text)?.now ?? null,
      onLost: (wasOpen) => lost.push(wasOpen),
    });
    link.start();
  });
  test('what is shown is old before the first message, and new after it', () => {
    expect(link.isOld).toBe(true);
    say('1');
    expect(link.isOld).toBe(false);
  });
  test('it is old after three seconds without a message', () => {
    say('1');
    pass(OLD_MS - 1);
    expect(link.isOld).toBe(false);
    pass(1);
    expect([link.isOld, link.age_ms]).toEqual([true, OLD_MS]);
  });
  test('messages that say the same time again are no news', () => {
    say('1');
    for (let i = 0; i < 4; i++) {
      pass(1_000);
      say('1');
    }
    expect(link.isOld).toBe(true);
    say('2');
    expect(link.isOld).toBe(false);
  });
  test('a closed socket makes it old at once, and another one is opened', () => {
    say('1');
    sockets[0]!.events.closed();
    expect([link.isOld, lost]).toEqual([true, [true]]);
    pass(500);
    expect(sockets.length).toBe(2);
    say('2');
    expect(link.isOld).toBe(false);
  });
  test('it waits longer each time, and says that no socket opened', () => {
    sockets[0]!.events.closed();
    pass(500);
    sockets[1]!.events.closed();
    pass(999);
    expect([sockets.length, lost]).toEqual([2, [false, false]]);
    pass(1);
    expect(sockets.length).toBe(3);
  });
  test('a silent socket is given up, and what it still says is not heard', () => {
    say('1');
    pass(DEAD_MS + 500);
    expect(sockets[0]!.isOpen).toBe(false);
    sockets[0]!.events.message('{"now":"9","id":"S1"}');
    expect(link.isOld).toBe(true);
  });
  test('what is no message is not heard', () => {
    expect(['', 'null', '[]', '{"id":"S1"}'].map(readStation)).toEqual([null, null, null, null]);
  });
});

test('who signs in comes back to the station', () => {
  expect(signInAt({ pathname: '/station/S1', search: '' })).toBe('/sign-in?back=%2Fstation%2FS1');
});

describe('the piece that nobody has seen in its tote', () => {
  const left = { job: 'j1', line: line(2, 'C3', 'lit', { tote: 'B', done: 1 }) };

  test('it is asked about only when it should have been seen by now, and the answer is for what is left', () => {
    const answers: unknown[] = [];
    const asks = new Asks((change) => answers.push(change));
    asks.show(station({ unconfirmed: left }), 1_000);
    expect(asks.box.hidden).toBe(true);
    asks.show(station({ unconfirmed: left }), 2_100);
    expect(asks.box.hidden).toBe(false);
    expect(asks.box.textContent).toContain('C3');
    for (const button of asks.box.querySelectorAll('button')) button.click();
    expect(answers).toEqual([{ done: 1 }, { short: true }]);
    asks.show(station(), 2_200);
    expect(asks.box.hidden).toBe(true);
    asks.show(station({ unconfirmed: { ...left, job: 'j2' } }), 2_300);
    expect(asks.box.hidden).toBe(true);
  });
});
