// The tools of the map editor: what they make of a map file.
import { describe, expect, test } from 'vitest';
import { changes } from '../src/editor/diff';
import { readDxf } from '../src/editor/dxf';
import {
  along,
  drawBlock,
  drawLane,
  drawOutline,
  drawPlace,
  drawStation,
  erase,
  eraseArea,
  moveNode,
  nodeAt,
  renameNode,
  setKind,
  snapped,
} from '../src/editor/edit';
import { EMPTY, kindsOf, readFile, writeFile, type FileCell, type MapFile } from '../src/editor/file';
import { begin, put, redo, undo } from '../src/editor/history';
import { whole, zoomed } from '../src/editor/view';
import files from '../fixtures/map.json';

const spot = (x: number, y: number) => ({ x, y });
const id = (map: MapFile, x: number, y: number): string => nodeAt(map, spot(x, y))!.id;
const between = (map: MapFile, a: string, b: string) =>
  map.lanes.filter((l) => (l.from === a && l.to === b) || (l.from === b && l.to === a));

describe('an aisle', () => {
  test('has a node at every point of the grid, and lanes both ways between them', () => {
    const map = drawLane(EMPTY, spot(0, 0), spot(3, 0), true, 1);
    expect(map.nodes.map((n) => [n.x, n.y])).toEqual([
      [0, 0],
      [1, 0],
      [2, 0],
      [3, 0],
    ]);
    expect(map.lanes).toHaveLength(3);
    expect(map.lanes.every((l) => l.both)).toBe(true);
  });
  test('that crosses another one shares its node', () => {
    const map = drawLane(drawLane(EMPTY, spot(0, 0), spot(2, 0), true, 1), spot(1, -1), spot(1, 1), true, 1);
    expect(map.nodes).toHaveLength(5);
  });
  test('drawn one-way over a two-way one takes its place, in the direction of drawing', () => {
    const both = drawLane(EMPTY, spot(0, 0), spot(1, 0), true, 1);
    const map = drawLane(both, spot(1, 0), spot(0, 0), false, 1);
    expect(map.lanes).toEqual([{ from: id(map, 1, 0), to: id(map, 0, 0) }]);
  });
  test('off the grid, or slanting, is one lane', () => {
    expect(along(spot(0, 0), spot(3, 4), 1)).toHaveLength(2);
    expect(along(spot(0, 0), spot(3, 0), null)).toHaveLength(2);
    expect(along(spot(0, 0), spot(1.5, 0), 0.5)).toHaveLength(4);
  });
});

describe('racks', () => {
  const racks = drawBlock(drawLane(EMPTY, spot(0, 0), spot(3, 0), true, 1), spot(1, 1), spot(2, 2), 1);
  test('fill a rectangle with storage places, one rack each', () => {
    expect(racks.storage).toHaveLength(4);
    expect(new Set(racks.racks.map((r) => r.id)).size).toBe(4);
  });
  test('are joined to the aisle beside them for robots, and to one another for robots without a rack', () => {
    expect(between(racks, id(racks, 1, 1), id(racks, 1, 0))[0]!.for).toEqual(['loaded', 'unloaded']);
    expect(between(racks, id(racks, 1, 1), id(racks, 2, 1))[0]!.for).toEqual(['unloaded']);
    expect(between(racks, id(racks, 1, 2), id(racks, 1, 0))).toEqual([]);
  });
  test('are joined to an aisle that is drawn later, too', () => {
    const map = drawLane(racks, spot(0, 3), spot(3, 3), true, 1);
    expect(between(map, id(map, 2, 2), id(map, 2, 3))).toHaveLength(1);
  });
  test('drawn over an aisle take its lanes away', () => {
    const map = drawBlock(drawLane(EMPTY, spot(0, 0), spot(3, 0), true, 1), spot(1, 0), spot(2, 0), 1);
    expect(between(map, id(map, 0, 0), id(map, 1, 0))[0]!.for).toEqual(['loaded', 'unloaded']);
    expect(between(map, id(map, 1, 0), id(map, 2, 0))[0]!.for).toEqual(['unloaded']);
  });
});

describe('a station', () => {
  const aisle = drawLane(EMPTY, spot(0, 0), spot(4, 0), true, 1);
  test('beside an aisle is joined to it', () => {
    const map = drawStation(aisle, spot(2, 1), spot(2, 1), 1);
    expect(map.stations).toEqual([{ id: 'W1', node: id(map, 2, 1), pick_s: 8 }]);
    expect(between(map, id(map, 2, 1), id(map, 2, 0))[0]!.both).toBe(true);
  });
  test('with a queue is entered at the end of the queue and left beside it', () => {
    const map = drawStation(aisle, spot(1, 1), spot(3, 1), 1);
    const [node, near, last] = [id(map, 1, 1), id(map, 2, 1), id(map, 3, 1)];
    expect(map.stations[0]).toMatchObject({ node, queue: [near, last] });
    expect(between(map, last, id(map, 3, 0))).toEqual([{ from: id(map, 3, 0), to: last, for: ['loaded', 'unloaded'] }]);
    expect(between(map, near, last)).toEqual([{ from: last, to: near, for: ['loaded', 'unloaded'] }]);
    expect(between(map, node, id(map, 1, 0))).toEqual([{ from: node, to: id(map, 1, 0), for: ['loaded', 'unloaded'] }]);
    expect(between(map, near, id(map, 2, 0))).toEqual([]);
    expect(kindsOf(map).get(last)).toBe('queue');
  });
  test('that becomes something else takes its queue’s role along', () => {
    const map = drawStation(aisle, spot(1, 1), spot(2, 1), 1);
    const plain = setKind(map, id(map, 1, 1), 'parking', 1);
    expect(plain.stations).toEqual([]);
    expect(kindsOf(plain).get(id(plain, 2, 1))).toBe('aisle');
  });
});

describe('what is drawn can be changed', () => {
  const map = drawStation(
    drawBlock(drawLane(EMPTY, spot(0, 0), spot(3, 0), true, 1), spot(1, 1), spot(1, 1), 1),
    spot(2, 1),
    spot(2, 1),
    1,
  );
  test('a place goes with its lanes, its rack and its role', () => {
    const rest = erase(map, spot(1, 1), 0.3);
    expect([rest.storage, rest.racks, rest.nodes.length]).toEqual([[], [], map.nodes.length - 1]);
    expect(rest.lanes.every((l) => l.from !== id(map, 1, 1) && l.to !== id(map, 1, 1))).toBe(true);
  });
  test('a lane goes alone, an obstacle where nothing else is', () => {
    expect(erase(map, spot(0.5, 0.1), 0.3).lanes).toHaveLength(map.lanes.length - 1);
    const walled = drawOutline(map, spot(5, 5), spot(7, 6), 'obstacles');
    expect(walled.obstacles).toHaveLength(1);
    expect(erase(walled, spot(6, 5.5), 0.3).obstacles).toEqual([]);
    expect(eraseArea(walled, spot(-1, -1), spot(9, 9)).nodes).toEqual([]);
    expect(drawOutline(map, spot(5, 5), spot(5, 6), 'obstacles')).toBe(map);
  });
  test('a place is moved unless another one is there, and renamed everywhere', () => {
    const moved = moveNode(map, id(map, 2, 1), spot(2, 2));
    expect(nodeAt(moved, spot(2, 2))?.id).toBe(id(map, 2, 1));
    expect(moveNode(map, id(map, 2, 1), spot(1, 1))).toBe(map);
    const named = renameNode(map, id(map, 2, 1), 'pick');
    expect(named.stations[0]!.node).toBe('pick');
    expect(named.lanes.some((l) => l.from === 'pick' || l.to === 'pick')).toBe(true);
    expect(renameNode(map, id(map, 2, 1), id(map, 1, 1))).toBe(map);
  });
  test('and everything is undone and done again', () => {
    let steps = put(put(begin(EMPTY), map), { ...map, name: 'x' });
    expect(put(steps, steps.now)).toBe(steps);
    steps = undo(undo(undo(steps)));
    expect(steps.now).toBe(EMPTY);
    expect(redo(redo(redo(steps))).now.name).toBe('x');
  });
});

describe('map files', () => {
  test('are read as they are written, with what the editor does not draw', () => {
    const map = {
      ...drawPlace(EMPTY, spot(0, 0.5), 'charger', 1),
      lanes: [{ from: 'n1', to: 'n1', length_m: 2, kinds: ['lifter'] }],
    };
    expect(readFile(writeFile(map))).toEqual(map);
  });
  test('keep the work cells of stations, which move with them, and the types of racks', () => {
    const map = drawPlace(drawLane(EMPTY, spot(0, 0), spot(4, 0), true, 1), spot(2, 1), 'station', 1);
    const cell: FileCell = {
      workplace: [
        [1.5, 2],
        [2.5, 2],
        [2, 3],
      ],
      opening: {
        outline: [
          [1.5, 1.6],
          [2.5, 1.6],
          [2, 1.7],
        ],
        from_m: 0.2,
        to_m: 2,
      },
      totes: [{ id: 'A', at: [1.5, 3, 0.9] }],
      arm: { base: [3, 2, 0.8], kind: 'ur5' },
    };
    const types = [{ id: 'shelf', columns: 4, heights_m: [0.4], width_m: 0.8 }];
    const whole: MapFile = { ...map, rack_types: types, stations: [{ ...map.stations[0]!, cell }] };
    expect(readFile(writeFile(whole))).toEqual(whole);
    const moved = moveNode(whole, map.stations[0]!.node, spot(2.5, 1)).stations[0]!.cell!;
    expect([moved.workplace, moved.opening.outline[0], moved.totes[0]!.at, moved.arm!.base]).toEqual([
      [
        [2, 2],
        [3, 2],
        [2.5, 3],
      ],
      [2, 1.6],
      [2, 3, 0.9],
      [3.5, 2, 0.8],
    ]);
  });
  test('that are none are refused with a sentence', () => {
    const wrong = [
      '{',
      '[]',
      '{"giveway_map":2}',
      '{"giveway_map":1,"nodes":3}',
      '{"giveway_map":1,"nodes":[{"id":1}]}',
      '{"giveway_map":1,"obstacles":[[1]]}',
    ];
    for (const text of wrong) expect(readFile(text), text).toMatch(/^This /);
    expect(readFile(JSON.stringify(files))).toMatch(/no "giveway_map"/);
  });
  test('are compared by names', () => {
    const old = drawLane(EMPTY, spot(0, 0), spot(2, 0), true, 1);
    expect(changes(old, old)).toEqual([]);
    const fresh = moveNode(drawPlace(old, spot(0, 1), 'charger', 1), id(old, 2, 0), spot(3, 0));
    expect(changes(old, fresh).map((c) => [c.what, c.added.length, c.removed.length, c.changed.length])).toEqual([
      ['nodes', 1, 0, 1],
      ['lanes', 1, 0, 0],
      ['chargers', 1, 0, 0],
    ]);
  });
});

test('the grid catches what is near it, and without a grid places are kept to the centimetre', () => {
  expect(snapped(spot(1.26, -0.24), 0.5)).toEqual(spot(1.5, 0));
  expect(snapped(spot(1.2649, 2), null)).toEqual(spot(1.26, 2));
});

test('a DXF drawing gives its lines and polylines, and nothing of its blocks', () => {
  const text = [
    '0',
    'SECTION',
    '2',
    'BLOCKS',
    '0',
    'LINE',
    '10',
    '9',
    '20',
    '9',
    '11',
    '8',
    '21',
    '8',
    '0',
    'ENDSEC',
    '0',
    'SECTION',
    '2',
    'ENTITIES',
    '0',
    'LINE',
    '8',
    '0',
    '10',
    '1',
    '20',
    '2',
    '30',
    '0',
    '11',
    '3',
    '21',
    '4',
    '31',
    '0',
    '0',
    'CIRCLE',
    '10',
    '5',
    '20',
    '5',
    '40',
    '1',
    '0',
    'LWPOLYLINE',
    '90',
    '3',
    '70',
    '1',
    '10',
    '0',
    '20',
    '0',
    '10',
    '4',
    '20',
    '0',
    '10',
    '4',
    '20',
    '2',
    '0',
    'ENDSEC',
    '0',
    'EOF',
  ];
  for (const end of ['\n', '\r\n']) {
    expect(readDxf(text.join(end))).toEqual([
      [
        [1, 2],
        [3, 4],
      ],
      [
        [0, 0],
        [4, 0],
        [4, 2],
        [0, 0],
      ],
    ]);
  }
  expect(readDxf('not a drawing')).toEqual([]);
});

test('all of a map is in sight, and zooming keeps its point', () => {
  const map = drawLane(EMPTY, spot(0, 0), spot(10, 0), true, 1);
  const sight = whole(map, 0.5);
  expect(sight).toEqual({ x: -2, y: -3.5, w: 14, h: 7 });
  const near = zoomed(sight, 0.5, { x: 0, y: 0 });
  expect([near.x, near.y, near.w, near.h]).toEqual([-1, -1.75, 7, 3.5]);
});
