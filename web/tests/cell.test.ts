// A work cell at a moment of a recording.
import { expect, test } from 'vitest';
import { cellAt } from '../src/places/cellthen';
import { readReel } from '../src/replay/frames';

const line = (n: number, state: string, done: number) => ({
  n,
  slot: 'C3',
  tote: 'B',
  quantity: 2,
  item: null,
  by: 'either',
  state,
  done,
});
const cell = (lines: unknown[], ends_s: number[] | null) => ({
  lines,
  ends_s,
  warnings: [],
  arm: null,
  ends: { visits: 3, held: 1, off_s: 2 },
});
const reel = readReel([
  '{"reel":1,"name":"cells","start":null,"map":null}',
  '{"at":0,"key":{}}',
  JSON.stringify({
    at: 0,
    cells: { S1: cell([line(1, 'lit', 0), line(2, 'open', 0)], [20, 30, 40]), S2: cell([], null) },
  }),
  JSON.stringify({ at: 4, cells: { S1: cell([line(1, 'done', 2), line(2, 'lit', 1)], [16, 18, 25]) } }),
]);

test('a cell is as it was when it had changed last, and its end is counted from the moment that is shown', () => {
  const before = cellAt(reel.cells, 2, 'S1');
  expect(before?.visit).toMatchObject({ pieces_left: 4, expected_end: { p10: 18, p50: 28, p90: 38 } });
  const after = cellAt(reel.cells, 20, 'S1');
  expect(after?.visit).toMatchObject({ pieces_left: 1, expected_end: { p10: 0, p50: 0, p90: 5 } });
  expect(after?.visit?.lines.map(({ state }) => state)).toEqual(['done', 'lit']);
});

test('a cell that has not changed since is found in an older line, and one without a visit has none', () => {
  expect(cellAt(reel.cells, 20, 'S2')).toMatchObject({ has_cell: true, visit: null, ends: { visits: 3 } });
});

test('nothing is shown before the first line, or of a station without a cell', () => {
  expect(cellAt(reel.cells, -1, 'S1')).toBeNull();
  expect(cellAt(reel.cells, 20, 'S9')).toBeNull();
});
