// What is different between two maps, by names: what the next start of a server would carry over.
import type { FileLane, MapFile } from './file';

export interface Change {
  readonly what: string;
  readonly added: string[];
  readonly removed: string[];
  readonly changed: string[];
}

function compared<T>(what: string, old: readonly T[], fresh: readonly T[], name: (one: T) => string): Change {
  const [before, after] = [old, fresh].map((list) => new Map(list.map((one) => [name(one), JSON.stringify(one)])));
  return {
    what,
    added: [...after!.keys()].filter((key) => !before!.has(key)),
    removed: [...before!.keys()].filter((key) => !after!.has(key)),
    changed: [...after!].filter(([key, text]) => before!.has(key) && before!.get(key) !== text).map(([key]) => key),
  };
}

/** Changes by subject; subjects without one are left out. */
export function changes(old: MapFile, fresh: MapFile): Change[] {
  const lane = (l: FileLane): string => `${l.from}–${l.to}`;
  const id = (one: { id: string }): string => one.id;
  const self = (name: string): string => name;
  const all = [
    compared('nodes', old.nodes, fresh.nodes, id),
    compared('lanes', old.lanes, fresh.lanes, lane),
    compared('stations', old.stations, fresh.stations, id),
    compared('types of racks', old.rack_types, fresh.rack_types, id),
    compared('racks', old.racks, fresh.racks, id),
    compared('storage places', old.storage, fresh.storage, self),
    compared('chargers', old.chargers, fresh.chargers, self),
    compared('parking places', old.parking, fresh.parking, self),
    compared('doors', old.exits, fresh.exits, self),
    compared('obstacles', old.obstacles, fresh.obstacles, (o) => JSON.stringify(o)),
    compared('floors for people', old.walkable, fresh.walkable, (o) => JSON.stringify(o)),
  ];
  return all.filter((c) => c.added.length + c.removed.length + c.changed.length > 0);
}
