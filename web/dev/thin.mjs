// The mock's patches as `/v1/live?thin=true` has them: numbers by row for what changes all the time.
const NUMBERS = {
  robots: ['x', 'y', 'heading', 'speed', 'granted', 'held'],
  workers: ['x', 'y', 'heading', 'speed', 'path'],
};
const mm = (x) => Math.round(x * 1000);
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

export function thinPatch(old, now, version) {
  const patch = {
    type: 'patch',
    base: version,
    version: version + 1,
    time_s: now.time_s,
    jobs: now.jobs,
    counters: now.counters,
  };
  // Before each entry stands how many rows were passed over since the one before.
  const next = {};
  const add = (key, i, ...numbers) => {
    lists[key].push(i - (next[key] ?? 0), ...numbers);
    next[key] = i + 1;
  };
  const lists = { moves: [], turns: [], speeds: [], ways: [], walks: [], paths: [] };
  now.robots.forEach((r, i) => {
    const b = old.robots[i];
    if (r.x !== b.x || r.y !== b.y) add('moves', i, mm(r.x) - mm(b.x), mm(r.y) - mm(b.y));
    if (r.heading !== b.heading) add('turns', i, mm(r.heading));
    if (r.speed !== b.speed) add('speeds', i, Math.round(r.speed * 100));
    if (!same(r.granted, b.granted) || !same(r.held, b.held)) {
      lists.ways.push([i, b.granted.length + b.held.length, r.granted.length, 0, ...r.granted, ...r.held]);
    }
  });
  now.workers.forEach((w, i) => {
    add('walks', i, mm(w.x), mm(w.y), mm(w.heading), Math.round(w.speed * 100));
    if (!same(w.path, old.workers[i].path)) lists.paths.push([i, 0, ...w.path.flat().map(mm)]);
  });
  for (const [key, list] of Object.entries(lists)) if (list.length > 0) patch[key] = list;
  for (const key of ['robots', 'racks', 'stations', 'workers']) {
    const rows = now[key].map((row, i) => changes(old[key][i], row, NUMBERS[key] ?? [])).filter(Boolean);
    if (rows.length > 0) patch[key] = rows;
  }
  return patch;
}

function changes(before, now, besides) {
  const keys = Object.keys(now).filter((k) => k !== 'id' && !besides.includes(k) && !same(before[k], now[k]));
  return keys.length === 0 ? null : Object.fromEntries([['id', now.id], ...keys.map((k) => [k, now[k]])]);
}
