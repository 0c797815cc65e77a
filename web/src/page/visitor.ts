// Somebody who comes to the floor, walks a few steps and whose headset then falls silent: what a lost person means, to
// be seen.
import type { Answer, Api, FloorMap, MapNode } from '../wire';

/** One step a second. */
const STEP_MS = 1_000;
const STEPS = 5;
const wait = (ms: number): Promise<void> =>
  new Promise((done) => {
    setTimeout(done, ms);
  });

/** Places one after the other along lanes that people may walk, from the middle of the floor on. */
export function stroll(map: FloorMap, steps: number): MapNode[] {
  const [x, y] = [(map.bounds[0] + map.bounds[2]) / 2, (map.bounds[1] + map.bounds[3]) / 2];
  const off = (node: MapNode): number => Math.hypot(node.x - x, node.y - y);
  const aisles = map.nodes.filter((node) => node.kind === 'aisle').toSorted((a, b) => off(a) - off(b));
  const first = aisles[0];
  if (!first) return [];
  const way = [first];
  while (way.length < steps) {
    const here = map.nodes.indexOf(way.at(-1)!);
    const next = map.lanes
      .flatMap((lane) => (lane.from === here ? [lane.to] : lane.both && lane.to === here ? [lane.from] : []))
      .map((n) => map.nodes[n]!)
      .find((node) => node.kind === 'aisle' && !way.includes(node));
    if (!next) break;
    way.push(next);
  }
  return way;
}

export class Visitor {
  #api: Pick<Api, 'enrol' | 'seenAt'>;
  #map: FloorMap;
  #step: (ms: number) => Promise<void>;

  constructor(api: Pick<Api, 'enrol' | 'seenAt'>, map: FloorMap, step: (ms: number) => Promise<void> = wait) {
    [this.#api, this.#map, this.#step] = [api, map, step];
  }

  /** Comes in, walks and falls silent; `seen` is told who it is once the floor knows where. */
  async walk(seen: (id: string) => void): Promise<Answer<unknown>> {
    const joined = await this.#api.enrol('Visitor');
    if (joined.kind !== 'ok') return joined;
    const { id } = joined.value;
    for (const [i, { x, y }] of stroll(this.#map, STEPS).entries()) {
      const answer = await this.#api.seenAt(id, { x, y, accuracy_m: 0.2 });
      if (answer.kind !== 'ok') return answer;
      if (i === 0) seen(id);
      await this.#step(STEP_MS);
    }
    return joined;
  }
}
