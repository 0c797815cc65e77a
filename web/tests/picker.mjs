// A picker for tests: where the slots and totes of a station are, and a scripted headset whose right hand moves there.
import { readFileSync } from 'node:fs';

/** Milliseconds between two poses. */
const BEAT_MS = 25;
/** Where the hand rests. Places are metres to the right of the rack's middle, towards the picker, above the floor. */
export const REST = [0.2, 0.95, 0.95];

/** A station of a map as its picker sees it, and the racks that have slots. */
export function bench(file, id) {
  const map = JSON.parse(readFileSync(file, 'utf8'));
  const { node, cell } = map.stations.find((one) => one.id === id);
  const stands = map.nodes.find((one) => one.id === node);
  const racks = map.racks.filter(({ type }) => type);
  const shelf = map.rack_types.find((type) => type.id === racks[0].type);
  const { outline } = cell.opening;
  const middle = [0, 1].map((i) => outline.reduce((sum, p) => sum + p[i], 0) / outline.length);
  const length = Math.hypot(middle[0] - stands.x, middle[1] - stands.y);
  const out = [(middle[0] - stands.x) / length, (middle[1] - stands.y) / length];
  const right = [-out[1], out[0]];
  const cells = [shelf.width_m / shelf.columns, shelf.width_m / 2];
  return {
    racks,
    totes: cell.totes.map((tote) => tote.id),
    onMap: ([r, o, z]) => [stands.x + right[0] * r + out[0] * o, stands.y + right[1] * r + out[1] * o, z],
    /** How far behind the rack's face a place is; negative before it. */
    deep: ([, o]) => shelf.face_m - o,
    /** A place in a slot, so deep behind the face. */
    slot: (name, deep) => {
      const [column, row] = [name.charCodeAt(0) - 65, Number(name.slice(1)) - 1];
      return [(column + 0.5) * cells[0] - cells[1], shelf.face_m - deep, shelf.heights_m[row]];
    },
    tote: (name) => {
      const [x, y, z] = cell.totes.find((tote) => tote.id === name).at;
      const [dx, dy] = [x - stands.x, y - stands.y];
      return [dx * right[0] + dy * right[1], dx * out[0] + dy * out[1], z];
    },
  };
}

/** A headset in a page of its own, which says all the time where its wearer and the right hand are. */
export class Headset {
  #page;
  #bench;
  #hand = REST;

  constructor(page, at) {
    [this.#page, this.#bench] = [page, at];
  }

  /** Connects, also once more. */
  async connect(url, worker) {
    await this.#page.goto(`${url}/openapi.json`);
    await this.#page.evaluate(
      ([id, first, ms]) =>
        new Promise((ready) => {
          const socket = new WebSocket(`${location.origin.replace('http', 'ws')}/v1/workers/${id}/feed`);
          const headset = { socket, cells: [], way: [first], sent: [] };
          globalThis.headset = headset;
          let [now, seq, isKnown] = [null, 0, false];
          const say = (message) => {
            if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
          };
          socket.onopen = () => say({ type: 'hello', versions: [2, 1], frame: 'map' });
          socket.onmessage = ({ data }) => {
            const message = JSON.parse(data);
            const t = performance.now();
            if (message.type === 'ping') say({ type: 'pong', id: message.id, t1: t, t2: t });
            if (message.type === 'cell') headset.cells.push(message);
            if (message.type === 'clock') isKnown = true;
          };
          setInterval(() => {
            // No pose counts before the server knows the clock of the headset.
            if (!isKnown) return;
            now = headset.way.shift() ?? now;
            seq += 1;
            headset.sent.push({ at: Date.now(), deep: now.deep });
            // A hand trembles: one that is exactly where it was is no hand.
            const r = now.joints.map(([x, height, ...more]) => [x, height + (seq % 2) / 2000, ...more]);
            const pose = { at: now.at, heading: 0, hands: { l: null, r } };
            say({ type: 'pose', epoch: 1, seq, t: performance.now(), ...pose });
            ready();
          }, ms);
        }),
      [worker, this.#pose(this.#hand), BEAT_MS],
    );
  }

  /** It goes without a goodbye, as one with an empty battery does. */
  async dies() {
    await this.#page.evaluate(() => globalThis.headset.socket.close());
  }

  /** What it was told about the station. */
  cells() {
    return this.#page.evaluate(() => globalThis.headset.cells);
  }

  /** Every pose that was sent: when, and how deep behind the rack's face the hand was. */
  sent() {
    return this.#page.evaluate(() => globalThis.headset.sent);
  }

  /** Moves the hand from place to place, in so many seconds each, and stays at the last one. */
  async moves(...legs) {
    const smooth = (t) => t * t * (3 - 2 * t);
    const way = legs.flatMap(([to, seconds]) => {
      const [n, from] = [Math.round((seconds * 1000) / BEAT_MS), this.#hand];
      this.#hand = to;
      return Array.from({ length: n }, (_, i) => from.map((k, axis) => k + (to[axis] - k) * smooth((i + 1) / n)));
    });
    await this.#page.evaluate(
      (poses) =>
        new Promise((done) => {
          const { way: left } = globalThis.headset;
          left.push(...poses);
          const look = setInterval(() => {
            if (left.length > 0) return;
            clearInterval(look);
            done();
          }, 5);
        }),
      way.map((at) => this.#pose(at)),
    );
  }
  #into = (slot) => [
    [this.#bench.slot(slot, -0.35), 0.6],
    [this.#bench.slot(slot, 0.12), 0.5],
    [this.#bench.slot(slot, 0.12), 0.5],
  ];
  enters(slot) {
    return this.moves(...this.#into(slot));
  }
  leaves(slot) {
    return this.moves([this.#bench.slot(slot, -0.35), 0.5]);
  }
  grasps(slot) {
    return this.moves(...this.#into(slot), [this.#bench.slot(slot, -0.35), 0.5]);
  }
  puts(tote) {
    return this.moves([this.#bench.tote(tote), 0.8], [this.#bench.tote(tote), 0.3]);
  }
  rests() {
    return this.moves([REST, 0.6]);
  }

  #pose(at) {
    const joint = (back) => {
      const [x, y, height] = this.#bench.onMap([at[0], at[1] + back, at[2]]);
      return [x, height, -y, 0.01];
    };
    // The wrist, then the joints of the hand, of which thumb and index finger end where it grasps.
    const joints = Array.from({ length: 25 }, (_, i) => joint(i === 0 ? 0.17 : i === 4 || i === 9 ? 0 : 0.09));
    const stands = this.#bench.onMap([0, 1.1, 0]).slice(0, 2);
    return { deep: this.#bench.deep(at), at: stands, joints };
  }
}
