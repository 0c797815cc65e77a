// The table of robots: its lines, which of them are wanted, and in which order. Pure.
import { activityOf, ageOf, onFloor, type Activity, type Alarm, type MapNode, type Mirror, type Robot } from '../wire';
import { activityWords, said } from '../words';

export interface RobotLine {
  readonly id: string;
  readonly kind: string;
  readonly activity: Activity;
  readonly age_s: number | null;
  readonly job: string | null;
  /** The name of the node on which it is. */
  readonly place: string | null;
  readonly battery: number;
  readonly alarms: readonly Alarm[];
  readonly why: string | null;
  readonly robot: Robot;
}

export const ROBOT_SORTS = ['id', 'kind', 'activity', 'age', 'job', 'place', 'battery', 'alarms'] as const;
export type RobotSort = (typeof ROBOT_SORTS)[number];
export interface RobotOrder {
  readonly by: RobotSort;
  readonly way: 'up' | 'down';
}

/** What begins with the largest where it is sorted by for the first time. */
const DOWN_FIRST: readonly RobotSort[] = ['age', 'alarms'];

/** Robots as they are named: robot-2 before robot-10. */
const natural = new Intl.Collator('en', { numeric: true });

export function linesOf(mirror: Mirror, places: readonly MapNode[]): RobotLine[] {
  const alarms = new Map<string, Alarm[]>();
  for (const alarm of mirror.alarms) {
    if (alarm.subject_kind === 'robot' && alarm.subject)
      alarms.set(alarm.subject, [...(alarms.get(alarm.subject) ?? []), alarm]);
  }
  return onFloor(mirror).map((robot) => ({
    id: robot.id,
    kind: robot.kind,
    activity: activityOf(robot),
    age_s: ageOf(mirror, robot),
    job: robot.job,
    // What is granted begins where the robot is.
    place: places[robot.granted[0] ?? robot.held[0] ?? -1]?.id ?? null,
    battery: robot.battery,
    alarms: alarms.get(robot.id) ?? [],
    why: robot.why === null ? null : said(robot.why),
    robot,
  }));
}

/** The lines that are at something and have every word of a search in one of their cells. */
export function wantedOf(lines: readonly RobotLine[], only: Activity | null, search: string): RobotLine[] {
  const words = search
    .toLowerCase()
    .split(/\s+/)
    .filter((word) => word !== '');
  return lines.filter((line) => {
    if (only !== null && line.activity !== only) return false;
    const cells = [
      line.id,
      line.kind,
      activityWords(line.activity),
      line.job,
      line.place,
      line.why,
      ...line.alarms.map((a) => said(a)),
    ];
    const text = cells.filter(Boolean).join(' ').toLowerCase();
    return words.every((word) => text.includes(word));
  });
}

export function sortedBy(lines: readonly RobotLine[], { by, way }: RobotOrder): RobotLine[] {
  const of = (line: RobotLine): string | number | null => {
    switch (by) {
      case 'age':
        return line.age_s;
      case 'alarms':
        return line.alarms.length;
      case 'activity':
        return activityWords(line.activity);
      default:
        return line[by];
    }
  };
  const sign = way === 'up' ? 1 : -1;
  return lines.toSorted((a, b) => {
    const [left, right] = [of(a), of(b)];
    const same = natural.compare(a.id, b.id);
    // What has none stands below what has one, whichever way it is sorted.
    if (left === null || right === null) return left === right ? same : left === null ? 1 : -1;
    const order =
      typeof left === 'number' && typeof right === 'number'
        ? left - right
        : natural.compare(String(left), String(right));
    return sign * order || same;
  });
}

/** The order after a click on a heading. */
export function turned(order: RobotOrder, by: RobotSort): RobotOrder {
  if (order.by === by) return { by, way: order.way === 'up' ? 'down' : 'up' };
  return { by, way: DOWN_FIRST.includes(by) ? 'down' : 'up' };
}
