// Names of places on the map.
import type { MapNode } from '../../wire';

/** The name of the nearest place. */
export function placeNear(nodes: readonly MapNode[], x: number, y: number): string | null {
  let best: { id: string | null; far: number } = { id: null, far: Infinity };
  for (const n of nodes) {
    const far = Math.hypot(n.x - x, n.y - y);
    if (far < best.far) best = { id: n.id, far };
  }
  return best.id;
}
