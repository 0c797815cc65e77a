// What a dashboard is told, for a test to read: its pages keep the state of the floor from the messages of their own
// live link, so that a test knows the same robots and people that the page draws. docs/api.md says what the messages
// mean.

/** Lets every page of a context keep that state in `globalThis.floor`. */
export async function tap(context) {
  await context.addInitScript(() => {
    const floor = { version: null, time_s: 0, robots: [], workers: [], closures: [], counters: {} };
    globalThis.floor = floor;
    /** Lists of numbers by row: how many rows were skipped, then so many numbers of that row. */
    const numbers = (list, rows, size, put) => {
      for (let k = 0, i = 0; k + size < (list ?? []).length; k += size + 1, i++) {
        i += list[k];
        if (rows[i]) put(rows[i], list.slice(k + 1, k + 1 + size));
      }
    };
    const rows = (table, changes) => {
      for (const change of changes ?? []) {
        const known = table.find((row) => row.id === change.id);
        if (known) Object.assign(known, change);
        else table.push({ ...change });
      }
    };
    const take = (message) => {
      if (message.type === 'snapshot') return void Object.assign(floor, message);
      if (message.type !== 'patch' || message.base !== floor.version) return;
      rows(floor.robots, message.robots);
      rows(floor.workers, message.workers);
      numbers(message.moves, floor.robots, 2, (robot, [dx, dy]) => {
        robot.x = (Math.round(robot.x * 1_000) + dx) / 1_000;
        robot.y = (Math.round(robot.y * 1_000) + dy) / 1_000;
      });
      for (const [i, left, granted, stay, ...after] of message.ways ?? []) {
        const robot = floor.robots[i];
        if (!robot) continue;
        const way = [...robot.granted, ...robot.held].slice(left, left + stay).concat(after);
        [robot.granted, robot.held] = [way.slice(0, granted), way.slice(granted)];
      }
      numbers(message.walks, floor.workers, 4, (worker, [x, y]) => {
        [worker.x, worker.y] = [x, y].map((n) => (n === null ? null : n / 1_000));
      });
      Object.assign(floor.counters, message.counters);
      floor.closures = message.closures ?? floor.closures;
      [floor.version, floor.time_s] = [message.version, message.time_s ?? floor.time_s];
    };
    globalThis.WebSocket = class extends WebSocket {
      constructor(address, ...more) {
        const url = new URL(address, location.href);
        // As text, which is read without a wait.
        url.searchParams.delete('packed');
        super(url, ...more);
        if (url.pathname === '/v1/live') this.addEventListener('message', ({ data }) => take(JSON.parse(data)));
      }
    };
  });
}
