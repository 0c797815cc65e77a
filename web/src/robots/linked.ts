// Robots of other vendors: the standard's words as people read them, what an action needs, how messages are listed.
// Pure.
import type { KindFigure, NewAction, SaidMessage, UnlistedRobot } from '../wire';
import { t, wordsBy } from '../words';

/** The link of robots that speak VDA 5050. */
export const MQTT_LINK = 'mqtt';

const MODES: Readonly<Record<string, string>> = wordsBy({
  AUTOMATIC: 'linked.mode.automatic',
  SEMIAUTOMATIC: 'linked.mode.semiautomatic',
  MANUAL: 'linked.mode.manual',
  SERVICE: 'linked.mode.service',
  TEACHIN: 'linked.mode.teachin',
  STARTUP: 'linked.mode.startup',
  INTERVENED: 'linked.mode.intervened',
});
const E_STOPS: Readonly<Record<string, string>> = wordsBy({
  NONE: 'linked.e-stop.none',
  AUTOACK: 'linked.e-stop.autoack',
  MANUAL: 'linked.e-stop.manual',
  REMOTE: 'linked.e-stop.remote',
});
const LEVELS: Readonly<Record<string, string>> = wordsBy({
  WARNING: 'linked.level.warning',
  URGENT: 'linked.level.urgent',
  CRITICAL: 'linked.level.critical',
  FATAL: 'linked.level.fatal',
});
export const FIGURE_WORDS = wordsBy<KindFigure['figure']>({
  speed: 'linked.figure.speed',
  acceleration: 'linked.figure.acceleration',
  turning: 'linked.figure.turning',
  outline: 'linked.figure.outline',
  payload: 'linked.figure.payload',
});
export const ORIGIN_WORDS = wordsBy<KindFigure['origin']>({
  file: 'linked.origin.file',
  factsheet: 'linked.origin.factsheet',
  default: 'linked.origin.default',
});
const STATUSES: Readonly<Record<string, string>> = wordsBy({
  SENT: 'linked.status.sent',
  WAITING: 'linked.status.waiting',
  INITIALIZING: 'linked.status.initializing',
  RUNNING: 'linked.status.running',
  PAUSED: 'linked.status.paused',
  RETRIABLE: 'linked.status.retriable',
  FINISHED: 'linked.status.finished',
  FAILED: 'linked.status.failed',
});
// A newer server may say something this page has no words for; then its own word is shown.
export const modeWords = (mode: string): string => MODES[mode] ?? mode;
export const eStopWords = (eStop: string): string => E_STOPS[eStop] ?? eStop;
export const levelWords = (level: string): string => LEVELS[level] ?? level;
export const statusWords = (status: string): string => STATUSES[status] ?? status;

/** Whether the robot drives on with an error of this level. */
export const isMild = (level: string): boolean => level === 'WARNING' || level === 'URGENT';
/** Whether nothing more will happen with an action. */
export const isSettled = (status: string): boolean => status === 'FINISHED' || status === 'FAILED';

export interface ActionErrors {
  type?: string | undefined;
  parameters?: string | undefined;
}
/** Types of actions that most robots know, which are offered; Giveway itself sends pauses and cancels. */
export const KNOWN_TYPES = [
  'stateRequest',
  'factsheetRequest',
  'logReport',
  'initPosition',
  'startCharging',
  'stopCharging',
  'clearInstantActions',
] as const;
const EXAMPLE_TYPE = 'stateRequest';
export const EXAMPLE_PARAMETERS = '{"reason": "shift"}';

/** What somebody wrote as an action, or what is wrong with it. */
export function actionOf(type: string, parameters: string): { action: NewAction } | { errors: ActionErrors } {
  const errors: ActionErrors = {};
  if (type.trim() === '') errors.type = t('linked.action.type.wrong', { example: EXAMPLE_TYPE });
  const read = parameters.trim() === '' ? {} : objectOf(parameters);
  if (read === null) errors.parameters = t('linked.action.parameters.wrong', { example: EXAMPLE_PARAMETERS });
  if (read === null || errors.type !== undefined) return { errors };
  return { action: { type: type.trim(), ...(Object.keys(read).length > 0 ? { parameters: read } : {}) } };
}
function objectOf(text: string): Record<string, unknown> | null {
  try {
    const read: unknown = JSON.parse(text);
    return typeof read === 'object' && read !== null && !Array.isArray(read) ? (read as Record<string, unknown>) : null;
  } catch {
    return null;
  }
}

export interface Line extends SaidMessage {
  /** The same for the same message however many came since. */
  readonly key: string;
}
/** Messages with the newest first. */
export function newestFirst(messages: readonly SaidMessage[]): Line[] {
  const times = new Map<string, number>();
  return messages
    .map((one) => {
      const same = `${one.at} ${one.to_robot} ${one.topic} ${one.text.length}`;
      const nth = (times.get(same) ?? 0) + 1;
      times.set(same, nth);
      return { ...one, key: `${same} ${nth}` };
    })
    .reverse();
}
/** JSON on several lines; a text that is cut off, or no JSON, as it is. */
export function laidOut(text: string): string {
  try {
    return JSON.stringify(JSON.parse(text), null, 2);
  } catch {
    return text;
  }
}

/** A name for a robot that has none yet: its serial number, as far as names may have its signs. */
export const nameFor = ({ serial }: Pick<UnlistedRobot, 'serial'>): string =>
  serial
    .replace(/[^A-Za-z0-9._-]+/g, '-')
    .replace(/^-+|-+$/g, '')
    .slice(0, 64);
