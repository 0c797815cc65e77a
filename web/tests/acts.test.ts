// Drawing, closing, tables of jobs and the planner's picture, without a page around them.
import { describe, expect, it } from 'vitest';
import { buildClosure } from '../src/places/closureform';
import { readJobs, type Known } from '../src/jobs/csv';
import { lookAgain, lookAt, lookWords, marks, place, rows, when } from '../src/timelines/gantt';
import { around, corner, headingOf, rectangle } from '../src/floor/scene/sketch';
import type { Point, Strip } from '../src/wire';

const NOW = new Date('2031-01-31T12:00:00Z');
const KNOWN: Known = {
  rack: new Set(['K1', 'K2']),
  station: new Set(['W1']),
  node: new Set(['A1']),
  robot: new Set(['robot-1']),
};

describe('drawing', () => {
  it('makes an upright rectangle of two corners in any order', () => {
    expect(rectangle([3, 1], [1, 2])).toEqual([
      [1, 1],
      [3, 1],
      [3, 2],
      [1, 2],
    ]);
    expect(around(rectangle([3, 1], [1, 2]))).toEqual([1, 1, 3, 2]);
  });
  it('takes a rectangle without area for a slip of the hand', () => {
    expect(corner('rectangle', [[1, 1]], [1, 5])).toEqual({ kind: 'more', corners: [[1, 5]] });
    expect(corner('rectangle', [[1, 1]], [2, 5]).kind).toBe('done');
  });
  it('takes a place and a direction for a pose, and no click twice in the same place', () => {
    const first = corner('pose', [], [4, 2.5]);
    expect(first).toEqual({ kind: 'more', corners: [[4, 2.5]] });
    expect(corner('pose', [[4, 2.5]], [4.01, 2.5])).toEqual(first);
    expect(corner('pose', [[4, 2.5]], [4, 3.504])).toEqual({
      kind: 'done',
      outline: [
        [4, 2.5],
        [4, 3.5],
      ],
    });
    expect(headingOf([4, 2.5], [4, 3.5])).toBeCloseTo(Math.PI / 2);
    expect(headingOf([4, 2.5], [3, 2.5])).toBeCloseTo(Math.PI);
  });
  it('closes a polygon at its first corner, but not before it has three', () => {
    const three: Point[] = [
      [0, 0],
      [2, 0],
      [2, 2],
    ];
    expect(corner('polygon', three, [0.01, 0])).toEqual({ kind: 'done', outline: three });
    expect(corner('polygon', three.slice(0, 2), [0, 0.01])).toEqual({ kind: 'more', corners: three.slice(0, 2) });
    expect(corner('polygon', three, [0, 2])).toEqual({ kind: 'more', corners: [...three, [0, 2]] });
  });
  it('takes one point where one is wanted', () => {
    expect(corner('point', [], [1.234, 2])).toEqual({ kind: 'done', outline: [[1.23, 2]] });
  });
});

describe('closing an area', () => {
  const outline = rectangle([0, 0], [1, 1]);
  const BLANK = { reason: '', binds: 'both', begins: '', lasts: '', daily: false } as const;
  it('closes at once and until opened where no times are given', () => {
    const built = buildClosure({ ...BLANK, reason: ' oil ' }, outline, NOW);
    expect(built).toEqual({ kind: 'ready', area: { outline, reason: 'oil', binds: 'both' } });
  });
  it('counts minutes from now, and the length from the beginning', () => {
    const built = buildClosure({ ...BLANK, reason: 'oil', begins: '10', lasts: '5' }, outline, NOW);
    expect(built).toMatchObject({ area: { from: '2031-01-31T12:10:00.000Z', until: '2031-01-31T12:15:00.000Z' } });
  });
  it('wants a reason, and minutes that are some', () => {
    const built = buildClosure({ ...BLANK, reason: ' ', begins: 'soon', lasts: '0' }, outline, NOW);
    expect(built.kind === 'wrong' && Object.keys(built.errors)).toEqual(['reason', 'begins', 'lasts']);
  });
  it('recurs every day from one time of day to another, in the time of the page', () => {
    const at = new Date(2031, 0, 31, 23, 50);
    const built = buildClosure(
      { ...BLANK, reason: 'mopping', binds: 'people', begins: '5', lasts: '20', daily: true },
      outline,
      at,
    );
    expect(built).toMatchObject({
      area: {
        binds: 'people',
        recurs: { from: '23:55', to: '00:15', utc_offset: Intl.DateTimeFormat().resolvedOptions().timeZone },
      },
    });
    expect(built.kind === 'ready' && built.area.until).toBeUndefined();
    const open = buildClosure({ ...BLANK, reason: 'mopping', daily: true }, outline, at);
    expect(open.kind === 'wrong' && Object.keys(open.errors)).toEqual(['lasts']);
  });
});

describe('jobs from a table', () => {
  it('says why a text is no table', () => {
    const why = (text: string): string => {
      const read = readJobs(text, KNOWN, NOW);
      return read.kind === 'unreadable' ? read.why : '';
    };
    expect(why('kind,rack\n')).toBe('There is no job below the first line.');
    expect(why('kind,rack,Rack\nreturn,K1,K2\n')).toBe('Two columns are named “Rack”: keep one.');
    expect(why('kind,rack\nreturn,"K1\n')).toContain('Line 2');
    expect(why('kind,rack\nreturn,R\uFFFDgal\n')).toContain('UTF-8');
  });
  it('takes a key, and refuses the same one twice', () => {
    const read = readJobs(
      `kind,rack,key\nreturn,K1,o-1\nreturn,K2,o-1\nreturn,K2,\nreturn,K2,${'é'.repeat(128)}\n`,
      KNOWN,
      NOW,
    );
    if (read.kind !== 'table') throw new Error(read.why);
    expect(read.lines.map((l) => [l.key?.slice(0, 3) ?? null, l.job === null, l.errors.join(' ')])).toEqual([
      ['o-1', false, ''],
      ['o-1', true, 'Line 2 has the key “o-1” already.'],
      [null, false, ''],
      ['ééé', true, 'The key is longer than 255 characters.'],
    ]);
    const more = readJobs('kind;rack;;\nreturn;K1;;\nreturn;K2;x\n', KNOWN, NOW);
    expect(more.kind === 'table' && more.lines.map((l) => l.errors)).toEqual([[], ['3 cells, but 2 columns.']]);
  });
  it('makes a job of each line that is right', () => {
    const read = readJobs(
      'kind,rack,station,priority,pick_s,reference\nDeliver,K1,W1,5,12,"order 4711, line 1"\nreturn,K2,,,,\n',
      KNOWN,
      NOW,
    );
    expect(read.kind === 'table' && read.lines.map((l) => l.job)).toEqual([
      { kind: 'deliver', rack: 'K1', station: 'W1', priority: 5, pick_s: 12, reference: 'order 4711, line 1' },
      { kind: 'return', rack: 'K2', priority: 0 },
    ]);
  });
  it('says for each line what is wrong, and makes no job of it', () => {
    const read = readJobs(
      'kind,rack,station,robot\ndeliver,K9,W1,\nfly,K1,,\npark,,,robot-1\ndeliver,K1,,robot-1\n',
      KNOWN,
      NOW,
    );
    if (read.kind !== 'table') throw new Error(read.why);
    expect(read.lines.map((l) => [l.line, l.job === null, l.errors.join(' ')])).toEqual([
      [2, true, 'There is no rack “K9”.'],
      [3, true, '“fly” is not a kind of job; use one of deliver, return, relocate, charge, park, go.'],
      [4, false, ''],
      [5, true, 'Name a station. A deliver job has no robot.'],
    ]);
  });
  it('refuses a table without columns that it knows', () => {
    expect(readJobs('K1,W1\n', KNOWN, NOW).kind).toBe('unreadable');
    expect(readJobs('kind,colour\ndeliver,red\n', KNOWN, NOW)).toMatchObject({
      why: expect.stringContaining('“colour”'),
    });
    expect(readJobs('', KNOWN, NOW).kind).toBe('unreadable');
  });
});

describe('the picture of what the planner sees', () => {
  const strip: Strip = {
    id: 'R1',
    x: 0,
    y: 0,
    holds: [
      { by: 'robot-1', kind: 'robot', from_s: -2, to_s: 3, granted: true, conflict: false },
      { by: 'robot-2', kind: 'robot', from_s: 5, to_s: null, granted: false, conflict: false },
      { by: 'robot-3', kind: 'robot', from_s: 3, to_s: 4, granted: false, conflict: true },
    ],
    conditions: [{ by: 'w1', kind: 'worker', from_s: 0, to_s: 2, effect: 'closed', limit_mps: null, price_s: null }],
    regions: [
      { of: 'w1', kind: 'worker', region: 2, from_s: 0, to_s: 4 },
      { of: 'robot-1', kind: 'robot', region: 3, from_s: -2, to_s: null },
    ],
  };
  it('puts now a little inside and what is for ever up to the end', () => {
    const [row] = rows([strip], 60);
    const of = (by: string) => row!.bars.find((b) => b.by === by)!;
    expect(place(0, 60)).toBeCloseTo((5 / 65) * 100);
    expect(of('robot-1').left).toBeCloseTo((3 / 65) * 100);
    expect(of('robot-2').left + of('robot-2').width).toBe(100);
    expect(row!.bars.map((b) => b.look)).toEqual(['closed', 'conflict', 'granted', 'held']);
  });
  it('shows safety regions below all else if they are wanted, region 2 on region 3', () => {
    const bars = rows([strip], 60, true)[0]!.bars;
    expect(bars.map((b) => b.look)).toEqual(['region3', 'region2', 'closed', 'conflict', 'granted', 'held']);
    expect(bars[0]!.words).toBe('R1: in region 3 of robot-1 (robots are slow in it), from now on');
    expect(bars[1]!.words).toBe('R1: in region 2 of w1 (nothing is planned into it), from now to +4.0 s');
    expect(bars[1]).toMatchObject({ by: 'w1', kind: 'worker' });
  });
  it('leaves out what is over, and says the rest in words', () => {
    const old: Strip = { ...strip, conditions: [], holds: [{ ...strip.holds[0]!, from_s: -9, to_s: -6 }] };
    expect(rows([old], 60)[0]!.bars).toEqual([]);
    expect(rows([strip], 60)[0]!.bars.at(-1)!.words).toBe('R1: robot-2 holds it but may not enter yet, from +5.0 s on');
    expect(when(-1, 2)).toBe('from now to +2.0 s');
  });
  it('keeps looking at the same holder while bars come and go, and at the place where nobody is left', () => {
    const of = (holds: Strip['holds']) =>
      rows(
        [
          { ...strip, conditions: [], holds },
          { ...strip, id: 'R2', conditions: [], holds: [] },
        ],
        60,
      );
    const [first, second] = strip.holds;
    const before = of(strip.holds);
    const look = lookAt(
      before[0]!,
      before[0]!.bars.findIndex((b) => b.by === 'robot-2'),
    );
    expect(lookAgain(of([second!]), look)).toMatchObject({ row: 'R1', index: 0, bar: { by: 'robot-2' } });
    expect(lookAgain(of([first!]), look)?.bar?.by, 'what took its place').toBe(first!.by);
    expect(lookWords(lookAgain(of([]), look)!)).toMatch(/^R1: free/);
    expect(lookWords(lookAt(before[1]!, 3))).toMatch(/^R2: free/);
    expect(lookAgain([], look)).toBeNull();
  });
  it('has four to nine marks', () => {
    for (const ahead of [15, 30, 60, 120]) expect(marks(ahead).length).toBeGreaterThanOrEqual(4);
    for (const ahead of [15, 30, 60, 120]) expect(marks(ahead).length).toBeLessThanOrEqual(9);
  });
});
