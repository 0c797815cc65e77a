// The map file as it is written (docs/maps.md), and what its nodes are for.
export type User = 'loaded' | 'unloaded' | 'people';
export type Corner = readonly [number, number];
export interface FileNode {
  readonly id: string;
  readonly x: number;
  readonly y: number;
}
export interface FileLane {
  readonly from: string;
  readonly to: string;
  readonly both?: boolean;
  readonly length_m?: number;
  readonly speed_limit_mps?: number;
  readonly for?: readonly User[];
  readonly kinds?: readonly string[];
}
export interface FileRack {
  readonly id: string;
  readonly node: string;
  readonly load?: string;
  readonly weight_kg?: number;
  readonly type?: string;
}
/** `[x, y, z]`, z above the floor. */
export type Place = readonly [number, number, number];
export interface FileCell {
  readonly workplace: readonly Corner[];
  readonly opening: { readonly outline: readonly Corner[]; readonly from_m: number; readonly to_m: number };
  readonly totes: readonly { readonly id: string; readonly at: Place }[];
  readonly arm?: { readonly base: Place; readonly heading_deg?: number; readonly kind: string };
}
export interface FileStation {
  readonly id: string;
  readonly node: string;
  readonly queue?: readonly string[];
  readonly pick_s: number;
  readonly cell?: FileCell;
}
export interface FileRackType {
  readonly id: string;
}
export interface MapFile {
  readonly giveway_map: 1;
  readonly name: string;
  readonly footprint_m: number;
  readonly nodes: readonly FileNode[];
  readonly lanes: readonly FileLane[];
  readonly storage: readonly string[];
  readonly rack_types: readonly FileRackType[];
  readonly racks: readonly FileRack[];
  readonly stations: readonly FileStation[];
  readonly chargers: readonly string[];
  readonly parking: readonly string[];
  readonly exits: readonly string[];
  readonly walkable: readonly (readonly Corner[])[];
  readonly obstacles: readonly (readonly Corner[])[];
  readonly marks: readonly FileNode[];
}
export type Kind = 'aisle' | 'storage' | 'station' | 'queue' | 'charger' | 'parking' | 'exit';
export const KIND_WORDS: Record<Kind, string> = {
  aisle: 'open floor',
  storage: 'storage place',
  station: 'station',
  queue: 'waiting place of a station',
  charger: 'charger',
  parking: 'parking place',
  exit: 'door for people',
};

const LISTS = [
  'nodes',
  'lanes',
  'storage',
  'rack_types',
  'racks',
  'stations',
  'chargers',
  'parking',
  'exits',
  'walkable',
  'obstacles',
  'marks',
] as const;

export const EMPTY: MapFile = {
  giveway_map: 1,
  name: 'new floor',
  footprint_m: 0.9,
  nodes: [],
  lanes: [],
  storage: [],
  rack_types: [],
  racks: [],
  stations: [],
  chargers: [],
  parking: [],
  exits: [],
  walkable: [],
  obstacles: [],
  marks: [],
};

/** A map file from its text, with every list that it leaves out; a sentence where it is none. */
export function readFile(text: string): MapFile | string {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch (error) {
    return `This is no map file: ${error instanceof Error ? error.message : String(error)}`;
  }
  if (typeof value !== 'object' || value === null || !('giveway_map' in value))
    return 'This is no map file: it has no "giveway_map".';
  if (value.giveway_map !== 1) return 'This map file has a version that this page does not know.';
  const map = { ...EMPTY, ...(value as Partial<MapFile>) };
  for (const list of LISTS) if (!Array.isArray(map[list])) return `This is no map file: "${list}" is not a list.`;
  const odd = map.nodes.find((n) => typeof n?.id !== 'string' || !Number.isFinite(n.x) || !Number.isFinite(n.y));
  if (odd) return `This is no map file: a node is ${JSON.stringify(odd)}.`;
  const corner = (c: unknown): boolean => Array.isArray(c) && c.length === 2 && c.every((v) => Number.isFinite(v));
  if (![...map.walkable, ...map.obstacles].every((o) => Array.isArray(o) && o.every(corner)))
    return 'This is no map file: an outline is not a list of [x, y].';
  return map;
}

/** The text of a map file, one node or lane a line; lists that are empty and may be left out are. */
export function writeFile(map: MapFile): string {
  const rows = (list: readonly unknown[]): string => `[\n${list.map((item) => JSON.stringify(item)).join(',\n')}\n]`;
  const lists = LISTS.filter((list) => map[list].length > 0 || list === 'nodes' || list === 'lanes');
  const head = `"giveway_map":1,\n"name":${JSON.stringify(map.name)},\n"footprint_m":${map.footprint_m}`;
  return `{\n${[head, ...lists.map((list) => `"${list}":${rows(map[list])}`)].join(',\n')}\n}\n`;
}

/** What every node is for. */
export function kindsOf(map: MapFile): Map<string, Kind> {
  const kinds = new Map<string, Kind>(map.nodes.map((n) => [n.id, 'aisle']));
  const put = (ids: readonly string[], kind: Kind) => ids.forEach((id) => kinds.has(id) && kinds.set(id, kind));
  put(map.storage, 'storage');
  put(map.chargers, 'charger');
  put(map.parking, 'parking');
  put(map.exits, 'exit');
  for (const station of map.stations) {
    put([station.node], 'station');
    put(station.queue ?? [], 'queue');
  }
  return kinds;
}

/** The smallest rectangle around everything, metres; a small floor where there is nothing. */
export function boundsOf(map: MapFile): { x0: number; y0: number; x1: number; y1: number } {
  const points: Corner[] = [
    ...map.nodes.map((n): Corner => [n.x, n.y]),
    ...map.obstacles.flat(),
    ...map.walkable.flat(),
  ];
  if (points.length === 0) return { x0: 0, y0: 0, x1: 12, y1: 8 };
  let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of points) {
    x0 = Math.min(x0, x);
    y0 = Math.min(y0, y);
    x1 = Math.max(x1, x);
    y1 = Math.max(y1, y);
  }
  return { x0, y0, x1, y1 };
}
