// The tools: what each is called, by which key, and what it makes of a press at `a` that ends at `b`.
import {
  drawBlock,
  drawLane,
  drawOutline,
  drawPlace,
  drawStation,
  erase,
  eraseArea,
  moveNode,
  nodeAt,
  type Spot,
} from './edit';
import type { MapFile } from './file';

export interface Tool {
  readonly id: string;
  readonly key: string;
  readonly label: string;
  /** What to do with it. */
  readonly hint: string;
  /** The map after it was used; the same map where it has no effect. */
  readonly use: (map: MapFile, a: Spot, b: Spot, pitch: number | null) => MapFile;
  /** How what is being drawn looks meanwhile. */
  readonly trace: 'line' | 'box' | 'none';
}

/** How near a node or a lane must be to be meant, metres. */
export const grip = (pitch: number | null): number => (pitch ?? 1) * 0.4;

const isOnePlace = (a: Spot, b: Spot): boolean => Math.hypot(a.x - b.x, a.y - b.y) < 0.02;

export const TOOLS: readonly Tool[] = [
  {
    id: 'select',
    key: 'v',
    label: 'Select and move',
    trace: 'line',
    hint: 'Press a place to see what it is; drag it to move it.',
    use: (map, a, b, pitch) => {
      const node = nodeAt(map, a, grip(pitch));
      return node === null || isOnePlace(a, b) ? map : moveNode(map, node.id, b);
    },
  },
  {
    id: 'lane',
    key: 'l',
    label: 'Aisle',
    trace: 'line',
    hint: 'Drag from one end to the other: robots drive it both ways. What lies beside it is joined to it.',
    use: (map, a, b, pitch) => (isOnePlace(a, b) ? map : drawLane(map, a, b, true, pitch)),
  },
  {
    id: 'oneway',
    key: 'o',
    label: 'One-way lane',
    trace: 'line',
    hint: 'Drag in the direction in which robots drive.',
    use: (map, a, b, pitch) => (isOnePlace(a, b) ? map : drawLane(map, a, b, false, pitch)),
  },
  {
    id: 'block',
    key: 'b',
    label: 'Racks',
    trace: 'box',
    hint: 'Drag a rectangle: a storage place with a rack at every point of the grid. Each needs an aisle beside it.',
    use: (map, a, b, pitch) => drawBlock(map, a, b, pitch),
  },
  {
    id: 'station',
    key: 's',
    label: 'Station',
    trace: 'line',
    hint: 'Press beside an aisle; or drag from the station to the end of its queue.',
    use: (map, a, b, pitch) => drawStation(map, a, b, pitch),
  },
  {
    id: 'charger',
    key: 'c',
    label: 'Charger',
    trace: 'none',
    hint: 'Press beside an aisle.',
    use: (map, _, b, pitch) => drawPlace(map, b, 'charger', pitch),
  },
  {
    id: 'parking',
    key: 'p',
    label: 'Parking place',
    trace: 'none',
    hint: 'Press beside an aisle.',
    use: (map, _, b, pitch) => drawPlace(map, b, 'parking', pitch),
  },
  {
    id: 'exit',
    key: 'x',
    label: 'Door for people',
    trace: 'none',
    hint: 'Press on an aisle.',
    use: (map, _, b, pitch) => drawPlace(map, b, 'exit', pitch),
  },
  {
    id: 'obstacle',
    key: 'k',
    label: 'Obstacle',
    trace: 'box',
    hint: 'Drag a rectangle that stands in people’s way.',
    use: (map, a, b) => drawOutline(map, a, b, 'obstacles'),
  },
  {
    id: 'walkable',
    key: 'w',
    label: 'Floor for people',
    trace: 'box',
    hint: 'Drag a rectangle on which people may walk.',
    use: (map, a, b) => drawOutline(map, a, b, 'walkable'),
  },
  {
    id: 'erase',
    key: 'e',
    label: 'Erase',
    trace: 'box',
    hint: 'Press a place, a lane or an obstacle; or drag a rectangle around what is to go.',
    use: (map, a, b, pitch) => (isOnePlace(a, b) ? erase(map, a, grip(pitch)) : eraseArea(map, a, b)),
  },
];
