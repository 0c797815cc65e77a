// Names of people in place of pseudonyms, for those who may see them: feeds have pseudonyms alone.
import { mayName, type Who } from '../session';
import type { Api, Mirror } from '../wire';
import { learnNames, learnNumbers } from '../words';

/** A name that was not known may have come since; so may one have been erased. */
const AGAIN_MS = 5_000;
const FRESH_MS = 60_000;

export class PeopleNames {
  #api: Pick<Api, 'people'>;
  #who: () => Promise<Who>;
  #now: () => number;
  /** By pseudonym: in a recording, the id of a worker may be that of somebody who has gone since. */
  #names: ReadonlyMap<string, string> = new Map();
  /** Whether nothing says yet that this browser may not see names. */
  #may = true;
  #asking = false;
  #askedAt = -Infinity;
  /** The last table and what is shown of it, which is the same as long as the table is. */
  #last: { from: Mirror['workers']; shown: Mirror['workers'] } | null = null;

  constructor(api: Pick<Api, 'people'>, who: () => Promise<Who>, now: () => number = () => performance.now()) {
    this.#api = api;
    this.#who = who;
    this.#now = now;
  }

  /** The floor with the names that are known. Asks for those that are not. */
  shown(mirror: Mirror): Mirror {
    const { workers } = mirror;
    if (workers.rows.length === 0) return mirror;
    const isKnown = workers.rows.every(({ name }) => name === '' || this.#names.has(name));
    const age = this.#now() - this.#askedAt;
    if (this.#may && !this.#asking && age > (isKnown ? FRESH_MS : AGAIN_MS)) void this.#ask();
    return this.called(mirror);
  }

  /** The same of the past, for which nothing is asked. */
  called(mirror: Mirror): Mirror {
    const { workers } = mirror;
    if (workers.rows.length === 0) return mirror;
    if (this.#last?.from !== workers) {
      learnNumbers(workers.rows);
      const rows = workers.rows.map((worker) => ({ ...worker, name: this.#names.get(worker.name) ?? worker.name }));
      this.#last = { from: workers, shown: { ...workers, rows } };
    }
    return { ...mirror, workers: this.#last.shown };
  }

  async #ask(): Promise<void> {
    this.#asking = true;
    // A request that is sure to be refused would only fill the browser's log.
    const may = mayName(await this.#who());
    if (may === false) this.#may = false;
    if (may === true) await this.#learn();
    [this.#asking, this.#askedAt] = [false, this.#now()];
  }

  async #learn(): Promise<void> {
    const names = new Map<string, string>();
    let cursor: string | null = null;
    do {
      const answer: Awaited<ReturnType<Api['people']>> = await this.#api.people(cursor);
      if (answer.kind === 'refused') this.#may = false;
      if (answer.kind !== 'ok') break;
      for (const person of answer.value.items) names.set(person.pseudonym, person.name);
      cursor = answer.value.next;
      if (cursor !== null) continue;
      [this.#names, this.#last] = [names, null];
      learnNames(names);
    } while (cursor !== null);
  }
}
