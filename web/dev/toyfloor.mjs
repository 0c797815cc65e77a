// A toy floor for the mock server: aisles around pairs of storage columns, stations along the bottom,
// chargers and parking along the left and right. One node per metre.
export function toyFloor(width, height) {
  const nodes = [];
  const at = new Map();
  const put = (x, y, kind) => {
    at.set(`${x},${y}`, nodes.length);
    nodes.push({ id: `N${String(x).padStart(2, '0')}-${String(y).padStart(2, '0')}`, x: x + 0.5, y: y + 0.5, kind });
  };
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) put(x, y, kindOf(x, y, width, height));
  }
  const index = (x, y) => at.get(`${x},${y}`);
  const lanes = [];
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      for (const [nx, ny] of [
        [x + 1, y],
        [x, y + 1],
      ]) {
        if (nx >= width || ny >= height) continue;
        const [a, b] = [nodes[index(x, y)], nodes[index(nx, ny)]];
        const under = a.kind === 'storage' || b.kind === 'storage';
        // The ring around the floor is one-way, so that arrows can be looked at.
        const ring = ny === y && (y === 4 || y === height - 1);
        lanes.push({
          from: ring && y === 4 ? index(nx, ny) : index(x, y),
          to: ring && y === 4 ? index(x, y) : index(nx, ny),
          both: !ring,
          for: under ? ['unloaded'] : ['loaded', 'unloaded', 'people'],
        });
      }
    }
  }
  const stations = [];
  nodes.forEach((node, i) => {
    if (node.kind !== 'station') return;
    const x = Math.floor(node.x);
    stations.push({ id: `P${stations.length + 1}`, node: i, queue: [1, 2, 3].map((dx) => index(x + dx, 1)) });
  });
  const racks = [];
  nodes.forEach((node, i) => {
    if (node.kind === 'storage' && (i * 7919) % 10 < 7) racks.push({ id: `K${racks.length + 1}`, node: i });
  });
  return {
    map: {
      name: 'Toy floor',
      bounds: [-1, -1, width + 1, height + 1],
      footprint_m: 0.9,
      nodes,
      lanes,
      stations,
      racks,
      obstacles: [
        [
          [-1, height],
          [width + 1, height],
          [width + 1, height + 1],
          [-1, height + 1],
        ],
      ],
      walkable: [
        [
          [-0.6, -0.6],
          [width + 0.6, -0.6],
          [width + 0.6, height],
          [-0.6, height],
        ],
      ],
    },
    neighbours: neighbours(nodes.length, lanes),
  };
}

function kindOf(x, y, width, height) {
  if (y === 1 && x >= 5 && x < width - 5) {
    const k = (x - 5) % 6;
    return k === 0 ? 'station' : k <= 3 ? 'queue' : 'aisle';
  }
  if (x === 0 && y > 5 && y < height - 3 && y % 2 === 0) return 'charger';
  if (x === width - 1 && y > 5 && y < height - 3) return 'parking';
  if (x === width - 1 && y === 0) return 'exit';
  const inBlock = x > 2 && x < width - 3 && y > 4 && y < height - 1;
  return inBlock && (x - 3) % 3 !== 2 && (y - 5) % 6 !== 5 ? 'storage' : 'aisle';
}

function neighbours(count, lanes) {
  const list = Array.from({ length: count }, () => []);
  for (const { from, to, both } of lanes) {
    list[from].push(to);
    if (both) list[to].push(from);
  }
  return list;
}
