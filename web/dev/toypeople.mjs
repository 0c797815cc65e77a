// People who stroll about the toy floor, each with a path, and now and then off it.
const SPEED = 1.1;
const STATES = [
  [9, 'following'],
  [11, 'deviating'],
  [14, 'redirected'],
  [15, 'stop'],
  [18, 'following'],
  [20, 'idle'],
];

export class ToyPeople {
  constructor({ map, neighbours }, count) {
    const aisles = map.nodes
      .map((n, i) => [n, i])
      .filter(([n]) => n.kind === 'aisle')
      .map(([, i]) => i);
    Object.assign(this, { map, neighbours, time: 0 });
    this.people = Array.from({ length: count }, (_, k) => {
      const node = aisles[Math.floor(((k + 0.5) * aisles.length) / count)];
      const { x, y } = map.nodes[node];
      return { node, way: [], before: -1, shift: k * 1.7, x, y, heading: 0, id: `w${k + 1}`, name: `Worker ${k + 1}` };
    });
  }

  step(dt) {
    this.time += dt;
    for (const p of this.people) {
      while (p.way.length < 8) this.#extend(p);
      if (this.#state(p) === 'stop') continue;
      const to = this.map.nodes[p.way[0]];
      const [dx, dy] = [to.x - p.x, to.y - p.y];
      const far = Math.hypot(dx, dy);
      const step = Math.min(far, SPEED * dt);
      if (far > 1e-6)
        Object.assign(p, { x: p.x + (dx / far) * step, y: p.y + (dy / far) * step, heading: Math.atan2(dy, dx) });
      if (far <= step + 1e-6) p.node = p.way.shift();
    }
  }

  #extend(p) {
    const [from, before] = [p.way.at(-1) ?? p.node, p.way.at(-2) ?? -1];
    const open = this.neighbours[from].filter((n) => this.map.nodes[n].kind === 'aisle');
    const on = open.filter((n) => n !== before);
    const straight = on.find((n) => n - from === from - before);
    p.way.push(
      straight !== undefined && Math.random() < 0.8
        ? straight
        : (on[Math.floor(Math.random() * on.length)] ?? open[0] ?? from),
    );
  }

  #state(p) {
    const phase = (this.time + p.shift) % 20;
    return STATES.find(([until]) => phase < until)[1];
  }

  view() {
    return this.people.map((p, k) => {
      const state = this.#state(p);
      const [x, y] = [round(p.x + (state === 'deviating' ? 0.4 : 0)), round(p.y)];
      const ahead = p.way.map((n) => [this.map.nodes[n].x, this.map.nodes[n].y]);
      return {
        id: p.id,
        name: p.name,
        presence: k % 7 === 6 ? 'stale' : 'tracked',
        x,
        y,
        heading: round(p.heading),
        speed: state === 'stop' ? 0 : SPEED,
        accuracy: 0.12,
        regions: [1.24, 1.85, 3.1],
        state,
        reason: state === 'deviating' ? 'you left the path' : null,
        path: state === 'idle' ? [] : [[x, y], ...ahead],
        assignment: state === 'idle' ? null : `a${k + 1}`,
        goals: ahead.slice(-1).map(([gx, gy]) => ({ x: gx, y: gy, p: 0.8 })),
        undecided: 0.1,
        elsewhere: 0.1,
      };
    });
  }
}

const round = (n) => Math.round(n * 1000) / 1000;
