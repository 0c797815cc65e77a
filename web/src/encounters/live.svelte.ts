// The encounters that the server keeps: the newest, asked again and again, and older ones on demand.
import { poll } from '../parts';
import type { Api, Encounter } from '../wire';
import { t, timeOfDay, trouble } from '../words';
import { queryOf, replayOf } from './encounters';
import type { Again, EncountersShown } from './shown';

const EVERY_MS = 5_000;
const PAGE = 200;
type Asks = Pick<Api, 'encounters' | 'encountersFile' | 'history'>;

export class LiveEncounters implements EncountersShown {
  readonly title = t('encounters.title');
  readonly none = t('encounters.none');
  readonly note = null;
  worker = $state('');
  robot = $state('');
  wrong = $state.raw<string | null>(null);
  #api: Asks;
  #newest = $state.raw<readonly Encounter[]>([]);
  /** Older pages that were asked for stay below what comes in. */
  #older = $state.raw<readonly Encounter[]>([]);
  #next = $state.raw<string | null>(null);
  #started = $state.raw<string | null>(null);

  constructor(api: Asks) {
    this.#api = api;
  }

  get items(): readonly Encounter[] {
    return [...this.#newest, ...this.#older.filter((o) => !this.#newest.some((e) => e.id === o.id))];
  }

  get csv(): string {
    return this.#api.encountersFile(queryOf(this.worker, this.robot));
  }

  get older(): EncountersShown['older'] {
    const next = this.#next;
    return next === null ? null : () => this.#more(next);
  }

  when = (e: Encounter): string => timeOfDay(e.began);

  again(e: Encounter): Again {
    const replay = this.#started === null ? null : replayOf(e, this.#started);
    return replay ? { kind: 'link', href: replay.href } : { kind: 'never', why: t('encounters.before') };
  }

  keep(): () => void {
    const query = queryOf(this.worker, this.robot);
    this.#older = [];
    if (this.#started === null) void this.#askStart();
    return poll(async (over) => {
      const answer = await this.#api.encounters({ ...query, limit: String(PAGE) });
      if (over()) return null;
      if (answer.kind === 'ok') {
        this.#newest = answer.value.items;
        // A user who went back goes on from there.
        if (this.#older.length === 0) this.#next = answer.value.next;
      }
      this.wrong = trouble(answer);
      return EVERY_MS;
    });
  }

  async #askStart(): Promise<void> {
    const answer = await this.#api.history({ step: '600' });
    if (answer.kind === 'ok') this.#started = answer.value.started;
  }

  async #more(cursor: string): Promise<void> {
    const answer = await this.#api.encounters({ ...queryOf(this.worker, this.robot), limit: String(PAGE), cursor });
    this.wrong = trouble(answer);
    if (answer.kind !== 'ok') return;
    this.#older = [...this.#older, ...answer.value.items];
    this.#next = answer.value.next;
  }
}
