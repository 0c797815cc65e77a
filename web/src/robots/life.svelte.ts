// What the server knows of one robot: asked while its card is open, so that it does not depend on how long this page
// was.
import { poll } from '../parts';
import type { Api, RobotDetail, RobotEvent } from '../wire';
import { replanCause, said, t, wordsBy, trouble } from '../words';

export type LifeApi = Pick<Api, 'robot' | 'robotHistory'>;

const EVERY_MS = 3_000;

export class RobotLife {
  detail = $state.raw<RobotDetail | null>(null);
  events = $state.raw<readonly RobotEvent[]>([]);
  next = $state.raw<string | null>(null);
  wrong = $state.raw<string | null>(null);
  #api: LifeApi;
  #id: string;
  /** What was asked for beyond the first page. */
  #older: readonly RobotEvent[] = [];

  constructor(api: LifeApi, id: string) {
    this.#api = api;
    this.#id = id;
  }

  /** Keeps it fresh; returns what ends that. To be called in an effect. */
  keep(): () => void {
    return poll(async (over) => {
      const [detail, page] = await Promise.all([this.#api.robot(this.#id), this.#api.robotHistory(this.#id, null)]);
      if (over()) return null;
      if (detail.kind === 'ok') this.detail = detail.value;
      if (page.kind === 'ok') this.#show(page.value.items, page.value.next);
      this.wrong = trouble(detail) ?? trouble(page);
      return EVERY_MS;
    });
  }

  async more(): Promise<void> {
    if (this.next === null) return;
    const page = await this.#api.robotHistory(this.#id, this.next);
    if (page.kind !== 'ok') return;
    this.#older = [...this.#older, ...page.value.items];
    this.events = unique([...this.events, ...page.value.items]);
    this.next = page.value.next;
  }

  #show(newest: readonly RobotEvent[], next: string | null): void {
    // A job moves up in the list when its state changes, so its older entry is dropped.
    const before = this.#older.length === 0 ? [] : this.events;
    this.events = unique([...newest, ...before]);
    if (this.#older.length === 0) this.next = next;
  }
}

function unique(events: readonly RobotEvent[]): RobotEvent[] {
  const seen = new Set<string>();
  return events.filter((e) => {
    const key = e.id ?? `${e.at} ${e.what}`;
    return !seen.has(key) && seen.add(key);
  });
}

const CHANGES: Readonly<Record<string, string>> = wordsBy({
  joined: 'robot.change.joined',
  failed: 'robot.change.failed',
  repaired: 'robot.change.repaired',
  fenced: 'robot.change.fenced',
  paused: 'robot.change.paused',
  resumed: 'robot.change.resumed',
  fleet_stopped: 'robot.change.fleet_stopped',
  fleet_resumed: 'robot.change.fleet_resumed',
  out_of_service: 'robot.change.out_of_service',
  back_in_service: 'robot.change.back_in_service',
  leaving: 'robot.change.leaving',
  left: 'robot.change.left',
  returned: 'robot.change.returned',
});

/** The first nodes of a way. */
const MOST_NODES = 5;
const way = (nodes: readonly string[] = []): string =>
  nodes.slice(0, MOST_NODES).join(' ') + (nodes.length > MOST_NODES ? ' …' : '');

/** What happened, in words; a newer server may say something this page has no words for. */
export function eventWords(e: RobotEvent): string {
  switch (e.kind) {
    case 'job':
      return `${e.text ?? t('robot.job')} ${e.id ?? ''}: ${e.what}`;
    case 'alarm':
      return e.ended === null ? alarmWords(e) : t('robot.alarm.over', { alarm: alarmWords(e) });
    case 'replan': {
      const cause = e.cause ? replanCause(e.cause) : e.what;
      return `${t('story.replanned', { cause })}: ${way(e.was)} → ${way(e.now)}`;
    }
    case 'change':
      return CHANGES[e.what] ?? e.what.replaceAll('_', ' ');
  }
}

function alarmWords({ text, code, args, what }: RobotEvent): string {
  return text === null
    ? what
    : said({ text, ...(code === undefined ? {} : { code }), ...(args === undefined ? {} : { args }) });
}
