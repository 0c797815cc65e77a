// The map of the floor: nodes, lanes, stations, racks, marks, and the kinds of robots that may join.

export type NodeKind = 'aisle' | 'storage' | 'station' | 'queue' | 'charger' | 'parking' | 'exit';
export type Traveller = 'loaded' | 'unloaded' | 'people';
export type Point = [x: number, y: number];
/** Metres and radians in a right-handed frame with y up; only the screen flips y. */
export interface FloorMap {
  /** Names what is in it; earlier recordings do not say. */
  version?: string;
  name: string;
  bounds: [x0: number, y0: number, x1: number, y1: number];
  footprint_m: number;
  nodes: MapNode[];
  lanes: Lane[];
  stations: { id: string; node: number; queue: number[] }[];
  racks: { id: string; node: number }[];
  obstacles: Point[][];
  walkable: Point[][];
  /** Marks on the floor, by which headsets find where they are; none where a file does not say. */
  marks?: readonly { name: string; x: number; y: number }[];
  /** The kinds of robots that may join; empty where a file does not say. */
  kinds?: readonly RobotKind[];
}
/** An outline around the point on which a robot turns, metres. */
export type Footprint = { square_m: number } | { circle_m: number } | { polygon_m: Point[] };
export interface RobotKind {
  name: string;
  /** Null for the square that the map gives. */
  footprint: Footprint | null;
  footprint_loaded: Footprint | null;
}
export interface MapNode {
  id: string;
  x: number;
  y: number;
  kind: NodeKind;
}
export interface Lane {
  from: number;
  to: number;
  both: boolean;
  for: Traveller[];
}
