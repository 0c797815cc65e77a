// Robots that wander about the toy floor, and jobs that are done by the clock. It plans nothing and
// proves nothing: it is there so that the page has something to show.
import { ToyPeople } from './toypeople.mjs';

const SPEED = 1.2;
const BATTERY_PER_M = 0.0004;

/** A reason as the server says it. */
const waitsFor = (place, robot) => ({
  code: 'waits_for',
  args: { place, robot },
  text: `waits for ${place}, held by ${robot}`,
});

export class ToyFleet {
  constructor({ map, neighbours }, count, people) {
    this.people = new ToyPeople({ map, neighbours }, people);
    Object.assign(this, { map, neighbours, time: 0, jobs: [], deliveries: 0, keys: new Map(), alarms: [] });
    const storage = map.nodes
      .map((n, i) => [n, i])
      .filter(([n]) => n.kind === 'storage')
      .map(([, i]) => i);
    this.taken = new Map();
    this.racks = map.racks.map((r) => ({ id: r.id, node: r.node, robot: null }));
    this.stations = map.stations.map((s) => ({ id: s.id, robot: null, queue: [], served: 0 }));
    this.robots = Array.from({ length: count }, (_, k) => {
      const node = storage[Math.floor((k * storage.length) / count)];
      this.taken.set(node, k);
      const { x, y } = map.nodes[node];
      return {
        wire: {
          id: `robot-${k + 1}`,
          x,
          y,
          heading: 0,
          speed: 0,
          state: 'idle',
          doing: 'idle',
          rack: null,
          job: null,
          battery: 0.1 + 0.9 * Math.abs(Math.sin(k * 12.9898)),
          granted: [],
          held: [],
          why: null,
          passes: null,
        },
        node,
        way: [],
        wait: Math.random() * 3,
        stuck: 0,
      };
    });
    const failed = this.robots[Math.floor(count / 2)];
    failed.wire.state = failed.wire.doing = 'failed';
    this.alarms.push({
      id: 'a1',
      text: `${failed.wire.id} reports a motor fault at ${map.nodes[failed.node].id}`,
      since_s: 0,
    });
  }

  step(dt) {
    this.time += dt;
    this.people.step(dt);
    this.robots.forEach((robot, k) => robot.wire.state !== 'failed' && this.#drive(robot, k, dt));
    this.#work();
    this.robots.forEach(({ wire }) => this.#note(wire));
  }

  /** What a robot is at, and since when. */
  #note(w) {
    const activity =
      w.state === 'failed'
        ? 'failed'
        : w.why !== null
          ? 'waiting'
          : w.speed > 0
            ? 'driving'
            : w.rack
              ? 'handling'
              : 'idle';
    if (w.activity !== activity) Object.assign(w, { activity, since: new Date(this.time * 1_000).toISOString() });
  }

  #drive(robot, k, dt) {
    const w = robot.wire;
    robot.wait -= dt;
    if (robot.way.length === 0) {
      w.speed = 0;
      if (robot.wait > 0) return;
      this.#arrive(robot);
      return;
    }
    const next = robot.way[0];
    const owner = this.taken.get(next);
    if (owner !== undefined && owner !== k) {
      const other = this.robots[owner].wire;
      Object.assign(w, {
        speed: 0,
        granted: [robot.node],
        held: robot.way.slice(0, 5),
        why: waitsFor(this.map.nodes[next].id, other.id),
      });
      robot.stuck += dt;
      w.state = robot.stuck > 2 ? 'interrupted' : w.state;
      if (robot.stuck > 4) {
        robot.stuck = 0;
        robot.way = this.#route(robot.node, this.#somewhere(w.rack !== null), w.rack !== null, next);
      }
      return;
    }
    this.taken.set(next, k);
    robot.stuck = 0;
    const to = this.map.nodes[next];
    const [dx, dy] = [to.x - w.x, to.y - w.y];
    const far = Math.hypot(dx, dy);
    const step = Math.min(far, SPEED * dt);
    if (far > 1e-6)
      Object.assign(w, { x: w.x + (dx / far) * step, y: w.y + (dy / far) * step, heading: Math.atan2(dy, dx) });
    Object.assign(w, { speed: SPEED, why: null, battery: Math.max(0.05, w.battery - step * BATTERY_PER_M) });
    w.state = w.rack ? 'busy' : w.doing === 'to_rack' ? 'busy' : 'free';
    w.granted = [robot.node, ...robot.way.slice(0, 3)];
    w.held = robot.way.slice(3, 9);
    if (far <= step + 1e-6) {
      this.taken.delete(robot.node);
      robot.node = robot.way.shift();
    }
  }

  #arrive(robot) {
    const w = robot.wire;
    const here = this.map.nodes[robot.node];
    const carried = this.racks.find((r) => r.robot === w.id);
    const standing = this.racks.find((r) => r.node === robot.node);
    if (carried && here.kind === 'storage' && !standing) {
      Object.assign(carried, { node: robot.node, robot: null });
      Object.assign(w, { rack: null, doing: 'idle', state: 'idle', job: null, granted: [robot.node], held: [] });
      this.deliveries += 1;
      robot.wait = 1 + Math.random() * 2;
      if (Math.random() < 0.5) return;
    } else if (!carried && standing && w.doing === 'to_rack') {
      Object.assign(standing, { node: null, robot: w.id });
      Object.assign(w, { rack: standing.id, doing: 'carrying', state: 'busy' });
    } else if (!carried) {
      w.doing = 'to_rack';
    }
    if (w.doing === 'idle') w.doing = 'going';
    robot.way = this.#route(robot.node, this.#somewhere(w.rack !== null), w.rack !== null);
    robot.wait = 0.6;
  }

  #somewhere(loaded) {
    const nodes = this.map.nodes;
    for (;;) {
      const i = Math.floor(Math.random() * nodes.length);
      const rack = this.racks.some((r) => r.node === i);
      if (nodes[i].kind === 'storage' && rack !== loaded) return i;
    }
  }

  #route(from, to, loaded, avoid = -1) {
    const before = new Map([[from, -1]]);
    const queue = [from];
    for (const node of queue) {
      if (node === to) break;
      for (const next of this.neighbours[node]) {
        const under = loaded && next !== to && this.map.nodes[next].kind === 'storage';
        if (before.has(next) || under || next === avoid) continue;
        before.set(next, node);
        queue.push(next);
      }
    }
    if (!before.has(to)) return [];
    const way = [];
    for (let n = to; n !== from; n = before.get(n)) way.unshift(n);
    return way;
  }

  #work() {
    const ages = [
      [1, 'waiting'],
      [2, 'assigned'],
      [5, 'carrying'],
      [6, 'queued'],
      [8, 'picking'],
      [Infinity, 'done'],
    ];
    for (const job of this.jobs) {
      if (job.state === 'cancelled' || job.state === 'done') continue;
      const age = this.time - job.since;
      job.state = ages.find(([until]) => age < until)[1];
      if (job.state !== 'waiting') job.robot ??= this.robots[(job.since % 7) | 0].wire.id;
      job.updated = new Date().toISOString();
    }
    const newest = this.jobs.at(-1);
    if (!newest || this.time - newest.since > 2.5) {
      const pick = (list) => list[Math.floor(Math.random() * list.length)].id;
      this.submit({
        kind: 'deliver',
        rack: pick(this.racks),
        station: pick(this.stations),
        priority: Math.floor(Math.random() * 3),
      });
    }
    if (this.jobs.length > 400) this.jobs.shift();
  }

  submit(job) {
    const now = new Date().toISOString();
    this.made = (this.made ?? 0) + 1;
    const made = {
      id: `j${this.made}`,
      rack: null,
      station: null,
      node: null,
      robot: null,
      deadline: null,
      ...job,
      state: 'waiting',
      why: null,
      created: now,
      updated: now,
      since: this.time,
    };
    this.jobs.push(made);
    return made;
  }

  view() {
    const of = (...states) => this.jobs.filter((j) => states.includes(j.state)).length;
    return {
      time_s: round(this.time),
      robots: this.robots.map(({ wire }) => ({
        ...wire,
        x: round(wire.x),
        y: round(wire.y),
        heading: round(wire.heading),
        battery: round(wire.battery),
      })),
      racks: this.racks.map((r) => ({ ...r })),
      stations: this.stations,
      workers: this.people.view(),
      closures: [
        {
          id: 'c1',
          outline: [
            [3, 3],
            [7, 3],
            [7, 4.5],
            [3, 4.5],
          ],
          reason: 'spill',
        },
      ],
      jobs: {
        waiting: of('waiting'),
        active: of('assigned', 'carrying', 'queued', 'picking'),
        done: of('done'),
        cancelled: of('cancelled'),
        failed: 0,
      },
      counters: {
        robot_deliveries: this.deliveries,
        human_deliveries: 0,
        deliveries_per_hour: this.time > 5 ? (this.deliveries / this.time) * 3600 : 0,
        encounters: 0,
        plan_us_p50: 180 + 40 * Math.sin(this.time),
        plan_us_p99: 2400,
        step_us_p99: 5100,
      },
      alarms: this.alarms,
    };
  }
}

const round = (n) => Math.round(n * 1000) / 1000;
