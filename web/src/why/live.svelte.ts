// Why something waits now: asked again every second while it is shown.
import { poll } from '../parts';
import type { Api, Why, WhyLink } from '../wire';
import { said, span, t, timeOfDay, trouble } from '../words';
import type { WhyShown, WhyStep } from './shown';

const EVERY_MS = 1_000;

export class LiveWhy implements WhyShown {
  readonly label = t('robot.waits');
  wrong = $state.raw<string | null>(null);
  #why = $state.raw<Why | null>(null);
  #api: Pick<Api, 'why'>;
  #kind: 'robot' | 'job';
  #id: string;

  constructor(api: Pick<Api, 'why'>, kind: 'robot' | 'job', id: string) {
    [this.#api, this.#kind, this.#id] = [api, kind, id];
  }

  get title(): string {
    return t(this.#why?.waiting ? 'robot.waits' : 'why.robot');
  }

  get chain(): readonly WhyStep[] {
    const why = this.#why;
    return why !== null && (why.waiting || this.#kind === 'job') ? why.chain.map(stepOf) : [];
  }

  keep(): () => void {
    return poll(async (over) => {
      const answer = await this.#api.why(this.#kind, this.#id);
      if (over()) return null;
      if (answer.kind === 'ok') this.#why = answer.value;
      this.wrong = trouble(answer);
      return EVERY_MS;
    });
  }
}

function stepOf({ who, kind, text: sentence, ahead, by, by_kind, until, until_s }: WhyLink): WhyStep {
  const text = said(sentence);
  // Robots, jobs and workers that are waited for are links of the chain themselves.
  const beside = by !== null && by_kind !== null && by_kind !== 'robot' && by_kind !== 'job' && by_kind !== 'worker';
  const soon =
    until_s !== null && until_s >= 1 ? t('why.until', { time: timeOfDay(until), span: span(until_s) }) : t('why.soon');
  return {
    who,
    kind,
    text: ahead > 1 ? t('why.ahead', { text, count: ahead }) : text,
    until: until === null || until_s === null ? null : soon,
    by: beside ? { kind: by_kind, id: by } : null,
  };
}
