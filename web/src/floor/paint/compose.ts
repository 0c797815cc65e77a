// What the floor looks like: puts the scene onto sheets, layer by layer, and only those that changed.
// Ways and resting racks change with a patch; robots, people and words with every frame. From afar a robot is one mark
// in the colour of its state, without its route; names come where there is room for them (labels.ts).
import { t, timeOfDay } from '../../words';
import type { Cell } from './heatmap';
import { around } from '../scene/sketch';
import type { Alarm, Closure, Vehicle } from '../../wire';
import { putHeat, type Forecast } from './heat';
import type { Palette } from './palette';
import type { Person } from '../scene/people';
import { Labels, stationTitle } from './labels';
import { LOOKS, LOW_BATTERY, robotNear, type Look, type Paths, type Scene } from '../scene/scene';
import { inkOf, KIND, Sheet, Words, type Kind } from './sheet';
import { inSight, type View } from '../scene/view';

/** What is in the side panel: an index into the scene each, or -1, and a place without one. */
export interface Chosen {
  robot: number;
  person: number;
  place: readonly [x: number, y: number] | null;
  /** Robots of other looks are pale: an index into LOOKS, or -1. */
  look: number;
}

/** Words at a place, above everything. */
export interface Note {
  text: string;
  x: number;
  y: number;
}

/** From when on robots will keep out of the areas that are announced. */
export function announced(closures: readonly Closure[]): Note[] {
  return closures
    .filter((c) => c.state === 'announced')
    .map(({ outline, from }) => {
      const [x0, , x1, y1] = around(outline);
      return { text: t('floor.closes', { time: timeOfDay(from ?? null).slice(0, 5) }), x: (x0 + x1) / 2, y: y1 };
    });
}

/** Sizes in metres; gauge and ring go around a robot's mark. */
export const SIZE = {
  rack: 0.42,
  carried: 0.46,
  gauge: 0.12,
  ring: 0.28,
  person: 0.4,
  place: 0.72,
  granted: 0.12,
  held: 0.07,
  ahead: 0.1,
  area: 0.9,
} as const;
/** Pixels per metre below which the floor is seen from afar. */
export const FAR_BELOW = 10;
/** Pixels per metre from which on names and gauges appear. */
export const NAMES_FROM = 28;
const RACK_NAMES_FROM = 52;
const NODE_NAMES_FROM = 62;
const GAUGES_FROM = 28;
const WORD_PX = 11;
const NODE_WORD_PX = 9.5;
/** From afar, cells of about this size show where robots wait together: from so many robots on. */
const CROWD_PX = 30;
const CROWD_FROM = 2;
/** Least radii in pixels: what needs a person stays visible on a whole floor. */
const LEAST: Record<Look, number> = {
  idle: 2.2,
  driving: 2.4,
  handling: 2.4,
  picking: 2.4,
  queueing: 2.4,
  charging: 2.2,
  waiting: 4,
  paused: 4,
  stopped: 4,
  out_of_service: 3,
  offline: 5,
  failed: 5,
};
/** Looks in whose middle the floor is seen. */
const HOLLOW: readonly Look[] = ['idle', 'picking', 'queueing', 'out_of_service', 'offline'];
/** Looks whose mark says so much that it leaves no room for where the robot faces. */
const FACELESS: readonly Look[] = ['failed', 'charging', 'paused', 'stopped', 'out_of_service', 'offline'];
/** Of a person's mark, metres: never so small that it is lost among the robots. */
export const personRadius = (scale: number): number => Math.max(SIZE.person, 6 / scale);
const PERSON_REACH = 1.35;
/** How much of a vehicle's length is its body; the rest are the forks. */
const BODY_SHARE = 0.62;
/** From afar: what needs a person is no disc. */
const ON_ITS_CORNER: readonly Look[] = ['waiting', 'offline'];
const SQUARE: readonly Look[] = ['failed', 'stopped', 'paused', 'out_of_service'];
const WAITING = LOOKS.indexOf('waiting');

/** Ids of what has an alarm. */
export interface Alarmed {
  robot: ReadonlySet<string>;
  worker: ReadonlySet<string>;
  station: ReadonlySet<string>;
}
export function alarmedOf(alarms: readonly Alarm[]): Alarmed {
  const of = (kind: keyof Alarmed): Set<string> =>
    new Set(alarms.flatMap((a) => (a.subject_kind === kind && a.subject ? [a.subject] : [])));
  return { robot: of('robot'), worker: of('worker'), station: of('station') };
}

type Inks = ReturnType<typeof inksOf>;

function inksOf({ of: c, looks }: Palette) {
  return {
    looks: looks.map((css) => inkOf(css)),
    faint: inkOf(c.gauge, 0.4),
    rack: inkOf(c.rack),
    rackEdge: inkOf(c['rack-edge']),
    carried: inkOf(c.carried),
    under: inkOf(c.carried, 0.16),
    granted: inkOf(c.granted),
    held: inkOf(c.held),
    tick: inkOf(c.tick),
    floor: inkOf(c.floor),
    gauge: inkOf(c.gauge),
    track: inkOf(c.edge),
    low: inkOf(c.low),
    halo: inkOf(c.halo),
    label: inkOf(c.label),
    chosen: inkOf(c.chosen),
    person: inkOf(c.person),
    pale: inkOf(c.person, 0.35),
    ahead: inkOf(c.ahead),
    region: inkOf(c.region),
    stopping: inkOf(c.region, 0.3),
    keeping: inkOf(c.region, 0.55),
    slowing: inkOf(c.region, 0.9),
    off: inkOf(c.off),
    stop: inkOf(c.stop),
    heat: inkOf(c.heat),
    crowds: [0.25, 0.37, 0.5].map((opacity) => inkOf(looks[WAITING]!, opacity)),
    levels: (['heat-1', 'heat-2', 'heat-3', 'heat-4', 'heat-5'] as const).map((name) => inkOf(c[name], 0.78)),
  };
}

export class Composer {
  /** From the floor up. */
  readonly sheets = {
    racks: new Sheet(),
    amounts: new Sheet(),
    crowds: new Sheet(),
    heat: new Sheet(),
    regions: new Sheet(),
    ways: new Sheet(),
    robots: new Sheet(),
    people: new Sheet(),
  };
  readonly words = new Words();
  /** A map of heat; empty where none is shown. */
  cells: readonly Cell[] = [];
  /** What is written on the floor itself. */
  notes: readonly Note[] = [];
  alarmed: Alarmed = alarmedOf([]);
  #labels = new Labels(this.words);
  #crowds = new Map<number, number>();
  #inks: Inks;
  #done = {
    racks: -1,
    ways: -1,
    edges: -1,
    chosen: -1,
    hair: 0,
    forecasts: null as readonly Forecast[] | null,
    cells: null as readonly Cell[] | null,
  };

  constructor(palette: Palette) {
    this.#inks = inksOf(palette);
  }

  recolour(palette: Palette): void {
    this.#inks = inksOf(palette);
    Object.assign(this.#done, { racks: -1, ways: -1, forecasts: null, cells: null });
  }

  compose(scene: Scene, view: View, chosen: Chosen, forecasts: readonly Forecast[]): void {
    const done = this.#done;
    const hair = 1 / view.scale;
    const edges = view.scale > 9 ? 1 : 0;
    if (done.forecasts !== forecasts) this.#heat(forecasts);
    if (done.cells !== this.cells) this.#amounts();
    if (done.racks !== scene.rackTurn || done.edges !== edges) this.#racks(scene, edges);
    if (done.ways !== scene.wayTurn || done.hair !== hair || done.chosen !== chosen.robot)
      this.#ways(scene, hair, chosen.robot);
    Object.assign(done, {
      racks: scene.rackTurn,
      ways: scene.wayTurn,
      edges,
      chosen: chosen.robot,
      hair,
      forecasts,
      cells: this.cells,
    });
    this.#waitTogether(scene, view.scale);
    this.#regions(scene.people, hair, chosen.person);
    this.#robots(scene, view, chosen);
    this.#people(scene.people, hair, chosen.person);
    this.#names(scene, view, chosen);
  }

  #heat(forecasts: readonly Forecast[]): void {
    const sheet = this.sheets.heat;
    sheet.begin();
    putHeat(sheet, forecasts, this.#inks.heat);
  }

  #amounts(): void {
    const sheet = this.sheets.amounts;
    sheet.begin();
    for (const { x, y, size, level } of this.cells)
      sheet.put(KIND.box, x, y, size, size, this.#inks.levels[level] ?? 0);
  }

  #racks(scene: Scene, edges: number): void {
    const { rack, rackEdge } = this.#inks;
    const sheet = this.sheets.racks;
    sheet.begin();
    for (let i = 0; i < scene.racks; i++) {
      const x = scene.rackX[i]!;
      if (scene.rackOn[i]! >= 0 || Number.isNaN(x)) continue;
      sheet.put(KIND.box, x, scene.rackY[i]!, 2 * SIZE.rack, 2 * SIZE.rack, rack);
      if (edges) sheet.put(KIND.frame, x, scene.rackY[i]!, 2 * SIZE.rack, 2 * SIZE.rack, rackEdge, 0, 0.05);
    }
  }

  /** What is held is dashed, what is granted is solid: a robot may be anywhere on the latter at once. From afar only
   *  the route of the chosen robot is there. */
  #ways(scene: Scene, hair: number, chosen: number): void {
    const ink = this.#inks;
    const sheet = this.sheets.ways;
    sheet.begin();
    const dash = Math.max(0.5, 7 * hair);
    const lines = (paths: Paths, solid: boolean, width: number, colour: number, only = -1): void => {
      const first = only < 0 ? 0 : paths.from[only]!;
      const end = only < 0 ? paths.at.length / 4 : paths.from[only + 1]!;
      const kind = solid ? KIND.box : KIND.dashes;
      for (let k = 4 * first; k < 4 * end; k += 4) {
        sheet.line(kind, paths.at[k]!, paths.at[k + 1]!, paths.at[k + 2]!, paths.at[k + 3]!, width, colour, dash);
      }
    };
    if (hair * FAR_BELOW <= 1) {
      lines(scene.held, false, Math.max(SIZE.held, 0.9 * hair), ink.held);
      lines(scene.granted, true, Math.max(SIZE.granted, 1.6 * hair), ink.granted);
    }
    if (chosen < 0) return;
    lines(scene.held, false, Math.max(SIZE.held * 1.8, 2 * hair), ink.chosen, chosen);
    lines(scene.granted, true, Math.max(SIZE.granted * 1.5, 3 * hair), ink.chosen, chosen);
    const last = scene.held.from[chosen + 1]! > scene.held.from[chosen]! ? scene.held : scene.granted;
    const end = 4 * last.from[chosen + 1]!;
    if (end === 4 * last.from[chosen]!) return;
    const size = 2 * Math.max(0.3, 4 * hair);
    sheet.put(KIND.ring, last.at[end - 2]!, last.at[end - 1]!, size, size, ink.chosen, 0, Math.max(0.1, 2 * hair));
  }

  #regions(people: readonly Person[], hair: number, chosen: number): void {
    const ink = this.#inks;
    const sheet = this.sheets.regions;
    sheet.begin();
    for (let i = 0; i < people.length; i++) {
      const {
        x,
        y,
        area,
        regions: [stop, out, slow],
        path,
      } = people[i]!;
      for (const [ax, ay] of area)
        sheet.put(KIND.hatch, ax, ay, SIZE.area, SIZE.area, ink.keeping, 0, Math.max(0.3, 6 * hair));
      // Of a person who is lost, the places say it better than circles: they end at racks and walls.
      if (area.length === 0) {
        sheet.put(KIND.dashring, x, y, 2 * slow, 2 * slow, ink.slowing, 0, 1.5 * hair);
        sheet.put(KIND.hatch, x, y, 2 * out, 2 * out, ink.keeping, 0, Math.max(0.3, 6 * hair));
        sheet.put(KIND.ring, x, y, 2 * out, 2 * out, ink.region, 0, 1.2 * hair);
      }
      sheet.put(KIND.disc, x, y, 2 * stop, 2 * stop, ink.stopping);
      sheet.put(KIND.ring, x, y, 2 * stop, 2 * stop, ink.region, 0, 2 * hair);
      if (hair * FAR_BELOW > 1 && i !== chosen) continue;
      const colour = i === chosen ? ink.chosen : ink.ahead;
      const width = Math.max(SIZE.ahead, 1.8 * hair);
      for (let k = 1; k < path.length; k++) {
        const [[ax, ay], [bx, by]] = [path[k - 1]!, path[k]!];
        sheet.line(KIND.dashes, ax, ay, bx, by, width, colour, Math.max(0.6, 9 * hair));
      }
    }
  }

  #robots(scene: Scene, { scale }: View, chosen: Chosen): void {
    const ink = this.#inks;
    const sheet = this.sheets.robots;
    const hair = 1 / scale;
    sheet.begin();
    if (chosen.place) {
      const around = 2 * Math.max(SIZE.place, 8 * hair);
      sheet.put(KIND.frame, ...chosen.place, around, around, ink.chosen, 0, Math.max(0.09, 2 * hair));
    }
    if (chosen.robot >= 0) {
      const around = 2 * Math.max(scene.reach[chosen.robot]! + SIZE.ring, 8 * hair);
      sheet.put(
        KIND.ring,
        scene.x[chosen.robot]!,
        scene.y[chosen.robot]!,
        around,
        around,
        ink.chosen,
        0,
        Math.max(0.09, 2 * hair),
      );
    }
    const far = scale < FAR_BELOW;
    // Like after like, so that a painter can draw a run of them at once.
    for (let look = 0; look < LOOKS.length; look++) {
      for (let i = 0; i < scene.robots; i++) {
        if (scene.look[i] !== look) continue;
        if (far) this.#mark(scene, i, scale, chosen.look);
        else this.#body(scene, i, scale, chosen.look);
      }
    }
    if (!far)
      for (let i = 0; i < scene.robots; i++) {
        if (chosen.look < 0 || scene.look[i] === chosen.look) this.#tick(scene, i, hair);
      }
    for (let i = 0; i < scene.robots; i++) this.#battery(scene, i, scale);
    if (far) return;
    const edge = Math.max(0.09, hair);
    for (let i = 0; i < scene.racks; i++) {
      if (scene.rackOn[i]! < 0) continue;
      sheet.put(KIND.box, scene.rackX[i]!, scene.rackY[i]!, 2 * SIZE.carried, 2 * SIZE.carried, ink.under);
      sheet.put(KIND.frame, scene.rackX[i]!, scene.rackY[i]!, 2 * SIZE.carried, 2 * SIZE.carried, ink.carried, 0, edge);
    }
  }

  /** From afar: one mark in the colour of the state, and not a disc if the robot needs a person. */
  #mark(scene: Scene, i: number, scale: number, only: number): void {
    const { robots } = this.sheets;
    const look = scene.look[i]!;
    const word = LOOKS[look]!;
    const [x, y] = [scene.x[i]!, scene.y[i]!];
    const d = 2 * Math.max(scene.reach[i]!, LEAST[word] / scale);
    const colour = this.#inks.looks[look]!;
    if (only >= 0 && look !== only) robots.put(KIND.disc, x, y, d / 2, d / 2, this.#inks.faint);
    else if (ON_ITS_CORNER.includes(word)) robots.put(KIND.box, x, y, 0.85 * d, 0.85 * d, colour, Math.PI / 4);
    else if (SQUARE.includes(word)) robots.put(KIND.box, x, y, 0.9 * d, 0.9 * d, colour);
    else robots.put(KIND.disc, x, y, d, d, colour);
  }

  /** From afar: cells in which several robots wait, the more the darker. */
  #waitTogether(scene: Scene, scale: number): void {
    const sheet = this.sheets.crowds;
    const cells = this.#crowds;
    if (scale >= FAR_BELOW && sheet.count === 0) return;
    sheet.begin();
    if (scale >= FAR_BELOW) return;
    cells.clear();
    const size = Math.ceil(CROWD_PX / scale);
    for (let i = 0; i < scene.robots; i++) {
      if (scene.look[i] !== WAITING) continue;
      const key = Math.floor(scene.x[i]! / size) * 65_536 + Math.floor(scene.y[i]! / size);
      cells.set(key, (cells.get(key) ?? 0) + 1);
    }
    const { crowds } = this.#inks;
    for (const [key, robots] of cells) {
      if (robots < CROWD_FROM) continue;
      // Rows may be negative: the nearest whole number of columns, and what is left.
      const column = Math.round(key / 65_536);
      const row = key - column * 65_536;
      sheet.put(
        KIND.box,
        (column + 0.5) * size,
        (row + 0.5) * size,
        size,
        size,
        crowds[Math.min(robots - CROWD_FROM, crowds.length - 1)]!,
      );
    }
  }

  /** A shape of its own for each state, so that nobody needs the colours. */
  #body(scene: Scene, i: number, scale: number, only: number): void {
    const ink = this.#inks;
    const sheet = this.sheets.robots;
    const look = scene.look[i]!;
    const [x, y] = [scene.x[i]!, scene.y[i]!];
    const r = Math.max(scene.reach[i]!, LEAST[LOOKS[look]!] / scale);
    const d = 2 * r;
    const colour = ink.looks[look]!;
    if (only >= 0 && look !== only) return sheet.put(KIND.disc, x, y, r, r, ink.faint);
    const hollow = (): void => {
      sheet.put(KIND.disc, x, y, d, d, ink.floor);
      sheet.put(KIND.ring, x, y, d, d, colour, 0, 0.25 * r);
    };
    switch (LOOKS[look]!) {
      case 'driving':
        sheet.put(KIND.disc, x, y, d, d, colour);
        break;
      case 'handling':
        sheet.put(KIND.disc, x, y, d, d, colour);
        sheet.put(KIND.frame, x, y, r, r, ink.tick, 0, 0.18 * r);
        break;
      case 'idle':
        sheet.put(KIND.disc, x, y, d, d, ink.floor);
        sheet.put(KIND.ring, x, y, d, d, colour, 0, 0.32 * r);
        break;
      case 'picking':
        hollow();
        sheet.put(KIND.disc, x, y, d / 2, d / 2, colour);
        break;
      case 'queueing':
        hollow();
        sheet.put(KIND.box, x, y, r, 0.35 * r, colour, scene.heading[i]!);
        break;
      case 'charging':
        sheet.put(KIND.disc, x, y, d, d, colour);
        sheet.put(KIND.bolt, x, y, 1.5 * r, 1.5 * r, ink.tick);
        break;
      case 'waiting':
        sheet.put(KIND.box, x, y, 1.9 * r, 1.9 * r, ink.halo, Math.PI / 4);
        sheet.put(KIND.box, x, y, 1.6 * r, 1.6 * r, colour, Math.PI / 4);
        break;
      case 'paused':
        sheet.put(KIND.disc, x, y, d, d, colour);
        for (const side of [-1, 1]) sheet.put(KIND.box, x + 0.32 * side * r, y, 0.32 * r, r, ink.tick);
        break;
      case 'stopped':
        sheet.put(KIND.disc, x, y, d, d, colour);
        sheet.put(KIND.box, x, y, 0.75 * r, 0.75 * r, ink.tick);
        sheet.put(KIND.ring, x, y, 1.65 * r, 1.65 * r, ink.tick, 0, 0.14 * r);
        break;
      case 'out_of_service':
        hollow();
        sheet.put(KIND.cross, x, y, 1.2 * r, 1.2 * r, colour, 0, 0.22 * r);
        break;
      case 'offline':
        sheet.put(KIND.box, x, y, 1.7 * r, 1.7 * r, ink.floor, Math.PI / 4);
        sheet.put(KIND.frame, x, y, 1.6 * r, 1.6 * r, colour, Math.PI / 4, 0.3 * r);
        break;
      case 'failed':
        sheet.put(KIND.box, x, y, d, d, colour);
        sheet.put(KIND.cross, x, y, 1.5 * r, 1.5 * r, ink.tick, 0, 0.3 * r);
        break;
    }
  }

  /** Where it faces: a light line in a full shape, a beak on a hollow one. */
  #tick(scene: Scene, i: number, hair: number): void {
    const ink = this.#inks;
    const look = scene.look[i]!;
    const word = LOOKS[look]!;
    if (FACELESS.includes(word)) return;
    const hollow = HOLLOW.includes(word);
    const [x, y, turn] = [scene.x[i]!, scene.y[i]!, scene.heading[i]!];
    const [dx, dy] = [Math.cos(turn), Math.sin(turn)];
    const reach = scene.reach[i]!;
    const from = (hollow ? 0.7 : 0.16) * reach;
    const to = (hollow ? 1.3 : 0.95) * reach;
    this.sheets.robots.line(
      KIND.box,
      x + dx * from,
      y + dy * from,
      x + dx * to,
      y + dy * to,
      Math.max(0.1, hair),
      hollow ? ink.looks[look]! : ink.tick,
    );
  }

  #battery(scene: Scene, i: number, scale: number): void {
    const ink = this.#inks;
    const sheet = this.sheets.robots;
    const [x, y, left] = [scene.x[i]!, scene.y[i]!, scene.battery[i]!];
    const low = left < LOW_BATTERY;
    if (scale >= GAUGES_FROM) {
      const around = 2 * (scene.reach[i]! + SIZE.gauge);
      sheet.put(KIND.arc, x, y, around, around, ink.track, 0, 1);
      sheet.put(KIND.arc, x, y, around, around, low ? ink.low : ink.gauge, 0, left);
    } else if (low) {
      sheet.put(KIND.box, x + 0.35, y + 0.38, 0.34 + 2 / scale, 0.2 + 2 / scale, ink.halo);
      sheet.put(KIND.box, x + 0.35, y + 0.38, 0.34, 0.2, ink.low);
    }
  }

  #people(people: readonly Person[], hair: number, chosen: number): void {
    const ink = this.#inks;
    const sheet = this.sheets.people;
    const r = personRadius(1 / hair);
    const size = 2 * PERSON_REACH * r;
    sheet.begin();
    for (let i = 0; i < people.length; i++) {
      const { x, y, heading, vehicle, presence, state } = people[i]!;
      const reach = vehicle ? Math.max(vehicle.behind_m, vehicle.length_m - vehicle.behind_m) : SIZE.person;
      const ring = 2 * Math.max(reach + SIZE.ring, 12 * hair);
      if (i === chosen) sheet.put(KIND.ring, x, y, ring, ring, ink.chosen, 0, 2 * hair);
      if (vehicle) this.#vehicle(people[i]!, vehicle, hair);
      sheet.put(KIND.person, x, y, 1.25 * size, 1.25 * size, ink.halo, heading);
      if (presence !== 'lost')
        sheet.put(KIND.person, x, y, size, size, presence === 'tracked' ? ink.person : ink.pale, heading);
      if (presence !== 'tracked') sheet.put(KIND.person, x, y, size, size, ink.person, heading, 0.2 * r);
      if (state !== 'deviating' && state !== 'redirected' && state !== 'stop') continue;
      // A flag beside the mark: a diamond for a way that was left, a square for somebody told to stop.
      const colour = state === 'stop' ? ink.stop : ink.off;
      const turn = state === 'stop' ? 0 : Math.PI / 4;
      const flag = 1.1 * r;
      sheet.put(KIND.box, x + 1.1 * r, y + 1.1 * r, flag + 3 * hair, flag + 3 * hair, ink.halo, turn);
      if (state === 'redirected') sheet.put(KIND.frame, x + 1.1 * r, y + 1.1 * r, flag, flag, colour, turn, 0.3 * flag);
      else sheet.put(KIND.box, x + 1.1 * r, y + 1.1 * r, flag, flag, colour, turn);
    }
  }

  /** A vehicle to scale, seen from above: the body behind, two forks ahead; an outline while nobody knows the place.
   *  The mark of its driver comes on top, where the tag is. */
  #vehicle({ x, y, heading, presence }: Person, vehicle: Vehicle, hair: number): void {
    const ink = this.#inks;
    const sheet = this.sheets.people;
    const [along, across] = [Math.cos(heading), Math.sin(heading)];
    const { length_m: length, width_m: width, behind_m: behind } = vehicle;
    const body = BODY_SHARE * length;
    /** A box whose middle is so far from the rear end and to the left. */
    const part = (kind: Kind, from: number, left: number, l: number, w: number, colour: number, more = 0): void => {
      const ahead = from - behind;
      sheet.put(
        kind,
        x + ahead * along - left * across,
        y + ahead * across + left * along,
        l,
        w,
        colour,
        heading,
        more,
      );
    };
    const edge = Math.max(0.08, 1.5 * hair);
    part(KIND.box, length / 2, 0, length + 2 * edge, width + 2 * edge, ink.halo);
    part(KIND.frame, length / 2, 0, length, width, ink.person, edge);
    if (presence === 'lost') return;
    const colour = presence === 'tracked' ? ink.person : ink.pale;
    part(KIND.box, body / 2, 0, body, width, colour);
    for (const side of [-1, 1])
      part(KIND.box, (length + body) / 2, (side * width) / 4, length - body, width / 7, colour);
  }

  /** Names, in their order of precedence: what is chosen, what has an alarm, people, stations and closed areas, robots,
   *  racks, places. A name that would cover one before it is left out. */
  #names(scene: Scene, view: View, chosen: Chosen): void {
    const labels = this.#labels;
    const { scale } = view;
    const { alarmed } = this;
    const robot = (i: number): boolean =>
      labels.beside(scene.ids[i]!, scene.x[i]!, scene.y[i]!, Math.max(scale * 0.72, 13), WORD_PX);
    const person = (p: Person): boolean => labels.beside(p.title, p.x, p.y, Math.max(scale * 0.75, 16), WORD_PX);
    const { below, px } = stationTitle(scale);
    const station = (s: Scene['stations'][number]): boolean => labels.put(s.title, s.x, s.y, below, px);
    labels.begin(view);
    if (chosen.robot >= 0) robot(chosen.robot);
    if (chosen.person >= 0) person(scene.people[chosen.person]!);
    if (alarmed.robot.size > 0) {
      for (let i = 0; i < scene.robots; i++) if (i !== chosen.robot && alarmed.robot.has(scene.ids[i]!)) robot(i);
    }
    scene.people.forEach((p, i) => {
      if (i !== chosen.person && alarmed.worker.has(p.id)) person(p);
    });
    for (const s of scene.stations) if (alarmed.station.has(s.id)) station(s);
    scene.people.forEach((p, i) => {
      if (i !== chosen.person && !alarmed.worker.has(p.id)) person(p);
    });
    for (const s of scene.stations) if (!alarmed.station.has(s.id)) station(s);
    for (const n of this.notes) labels.put(n.text, n.x, n.y, -9, 12);
    if (scale >= NAMES_FROM) {
      for (let i = 0; i < scene.robots; i++) if (i !== chosen.robot && !alarmed.robot.has(scene.ids[i]!)) robot(i);
    }
    if (scale >= RACK_NAMES_FROM) {
      for (let i = 0; i < scene.racks; i++) {
        const [x, y] = [scene.rackX[i]!, scene.rackY[i]!];
        // A robot below the rack is worth more than the rack's name.
        if (scene.rackOn[i]! < 0 && nearlyInSight(view, x, y) && robotNear(scene, x, y, 0.6) < 0)
          labels.put(scene.rackIds[i]!, x, y, 0, WORD_PX);
      }
    }
    if (scale >= NODE_NAMES_FROM) {
      for (const { id, x, y } of scene.nodes) labels.put(id, x, y, scale * 0.34, NODE_WORD_PX, true);
    }
  }
}

/** False too for a place that is not a number. */
/** With what reaches into the picture from just outside of it. */
const nearlyInSight = (view: View, x: number, y: number): boolean => inSight(view, x, y, 50 / view.scale);
