// The jobs list: the newest jobs, refreshed when the live counts say that something changed, with the
// jobs submitted from this page kept on top until they are over and seen.
import type { Api, Job, JobState } from '../wire';
import { isOver, t, trouble } from '../words';

const SOONEST_MS = 1_000;
const AT_LEAST_EVERY_MS = 5_000;
const OWN_KEPT = 5;
/** The server's index of references has runs of this many characters. */
export const SHORTEST_PART = 3;

export class Jobs {
  items = $state.raw<Job[]>([]);
  own = $state.raw<Job[]>([]);
  state = $state<JobState | 'any'>('any');
  /** A part of the reference of the jobs that are shown; empty for all. */
  part = $state('');
  next = $state.raw<string | null>(null);
  trouble = $state.raw<string | null>(null);
  #api: Pick<Api, 'jobs' | 'job' | 'cancel'>;
  #older: Job[] = [];
  #timer: ReturnType<typeof setTimeout> | undefined;
  #askedAt = 0;
  #dueAt = Infinity;
  #asking = 0;

  constructor(api: Pick<Api, 'jobs' | 'job' | 'cancel'>) {
    this.#api = api;
  }

  start(): void {
    void this.#refresh();
  }

  stop(): void {
    clearTimeout(this.#timer);
  }

  /** Something changed on the floor: ask soon, but not more often than once a second. */
  nudge(): void {
    if (this.#asking === 0 && this.#askedAt > 0)
      this.#plan(Math.max(0, this.#askedAt + SOONEST_MS - performance.now()));
  }

  /** Shows jobs whose reference has this in it; all as long as it is too short. */
  search(text: string): void {
    const part = text.trim().length < SHORTEST_PART ? '' : text.trim();
    if (part === this.part) return;
    this.part = part;
    this.#older = [];
    void this.#refresh();
  }

  show(state: JobState | 'any'): void {
    this.state = state;
    this.#older = [];
    void this.#refresh();
  }

  async more(): Promise<void> {
    if (this.next === null) return;
    const answer = await this.#api.jobs(this.state, this.next, this.part);
    if (answer.kind !== 'ok') return;
    this.#older = unique([...this.#older, ...this.items, ...answer.value.items]);
    this.items = this.#older;
    this.next = answer.value.next;
  }

  submitted(job: Job): void {
    this.own = [job, ...this.own.filter((j) => j.id !== job.id)].slice(0, OWN_KEPT);
    void this.#refresh();
  }

  /** A job is other than it was listed. */
  changed(job: Job): void {
    this.own = this.own.map((j) => (j.id === job.id ? job : j));
    void this.#refresh();
  }

  async cancel(id: string): Promise<string | null> {
    const answer = await this.#api.cancel(id);
    await this.#refresh();
    if (answer.kind === 'ok') return null;
    return answer.kind === 'unreachable' ? t('jobs.cancel.unsure') : trouble(answer);
  }

  async #refresh(): Promise<void> {
    const turn = ++this.#asking;
    clearTimeout(this.#timer);
    this.#dueAt = Infinity;
    this.#askedAt = performance.now();
    const { state, part } = this;
    const answer = await this.#api.jobs(state, null, part);
    // The filter may have changed while the answer was under way; then another answer is coming.
    if (turn === this.#asking && state === this.state && part === this.part) {
      if (answer.kind === 'ok') {
        this.trouble = null;
        if (this.#older.length === 0) this.next = answer.value.next;
        this.items = unique([...answer.value.items, ...this.#older]);
        await this.#refreshOwn(answer.value.items);
      } else {
        this.trouble = answer.kind === 'unreachable' ? t('jobs.stale') : trouble(answer);
      }
    }
    if (turn !== this.#asking) return;
    this.#asking = 0;
    this.#plan(AT_LEAST_EVERY_MS);
  }

  async #refreshOwn(newest: Job[]): Promise<void> {
    this.own = await Promise.all(
      this.own.map(async (job) => {
        const seen = newest.find((j) => j.id === job.id);
        if (seen || isOver(job.state)) return seen ?? job;
        const answer = await this.#api.job(job.id);
        return answer.kind === 'ok' ? answer.value : job;
      }),
    );
  }

  #plan(ms: number): void {
    const due = performance.now() + ms;
    if (due >= this.#dueAt) return;
    clearTimeout(this.#timer);
    this.#dueAt = due;
    this.#timer = setTimeout(() => void this.#refresh(), ms);
  }
}

function unique(jobs: Job[]): Job[] {
  return [...new Map(jobs.toReversed().map((j) => [j.id, j])).values()].toReversed();
}
