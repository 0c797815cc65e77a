// What a person may tell several robots at once. Each robot is told by a request of its own, a few at a time.
import { activityOf, newKey, type Act, type Answer, type Api, type Robot } from '../wire';
import { t, trouble } from '../words';

export type ActsApi = Pick<Api, 'pause' | 'resume' | 'maintain' | 'workAgain' | 'submit'>;

export interface RobotAct {
  readonly id: 'pause' | 'resume' | 'charge' | 'park' | 'out' | 'back';
  /** Whether it makes sense for a robot. */
  readonly fits: (robot: Robot) => boolean;
  readonly tell: (api: ActsApi, id: string) => Promise<Answer<unknown>>;
  /** What it is called elsewhere. */
  readonly act: Act;
  /** The id of the act that takes it back. */
  readonly undo?: string;
}

const inService = (robot: Robot): boolean => !robot.maintenance && !robot.leaving;

export const ROBOT_ACTS: readonly RobotAct[] = [
  {
    id: 'pause',
    act: 'pause_robot',
    fits: (robot) => activityOf(robot) !== 'paused',
    tell: (api, id) => api.pause(id),
    undo: 'resume',
  },
  {
    id: 'resume',
    act: 'resume_robot',
    fits: (robot) => activityOf(robot) === 'paused' || activityOf(robot) === 'failed',
    tell: (api, id) => api.resume(id),
    undo: 'pause',
  },
  {
    id: 'charge',
    act: 'submit_job',
    fits: inService,
    tell: (api, id) => api.submit({ kind: 'charge', robot: id, priority: 0 }, newKey()),
  },
  {
    id: 'park',
    act: 'submit_job',
    fits: inService,
    tell: (api, id) => api.submit({ kind: 'park', robot: id, priority: 0 }, newKey()),
  },
  {
    id: 'out',
    act: 'start_maintenance',
    fits: inService,
    tell: (api, id) => api.maintain(id),
    undo: 'back',
  },
  {
    id: 'back',
    act: 'end_maintenance',
    fits: (robot) => !inService(robot),
    tell: (api, id) => api.workAgain(id),
    undo: 'out',
  },
];

/** So many requests are under way at once. */
const AT_ONCE = 8;
/** So many refusals are shown with their reasons. */
const MOST_REASONS = 3;

export interface Told {
  readonly words: string;
  readonly wrong: boolean;
  /** The robots that did it. */
  readonly done: readonly string[];
}

/** Takes an act on some robots back; answers why it could not. Null where it cannot be taken back. */
export function undoOf(act: RobotAct, api: ActsApi, ids: readonly string[]): (() => Promise<string | null>) | null {
  const undo = ROBOT_ACTS.find((one) => one.id === act.undo);
  if (undo === undefined || ids.length === 0) return null;
  return async () => {
    const told = await tellAll(undo, api, ids);
    return told.wrong ? told.words : null;
  };
}

/** Tells robots one after the other, and says what came of it. */
export async function tellAll(act: RobotAct, api: ActsApi, ids: readonly string[]): Promise<Told> {
  const refused: string[] = [];
  const done: string[] = [];
  for (let i = 0; i < ids.length; i += AT_ONCE) {
    const some = ids.slice(i, i + AT_ONCE);
    const answers = await Promise.all(some.map((id) => act.tell(api, id)));
    answers.forEach((answer, k) => {
      const why = trouble(answer);
      if (why === null) done.push(some[k]!);
      else refused.push(`${some[k]}: ${why}`);
    });
  }
  if (refused.length === 0) return { words: t(`robots.${act.id}.done`, { count: ids.length }), wrong: false, done };
  const some = refused.slice(0, MOST_REASONS).join(' ');
  const more = refused.length - MOST_REASONS;
  const words = [
    t('robots.refused', { count: refused.length, all: ids.length }),
    some,
    more > 0 ? t('robots.refused.more', { count: more }) : '',
  ];
  return { words: words.filter(Boolean).join(' '), wrong: true, done };
}
