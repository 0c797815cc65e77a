// What a worker hears, and when: the task with its place, "you are there", "done", the next one, and warnings. Each is
// said once; what was said can be said again. It makes sentences and no sound.
import { joined, taskText, type Ended, type Shown, type Task } from './guide';
import { t } from './words';

/** What there is to talk about now. */
export interface Topic {
  shown: Shown;
  /** The assignment that guidance is for. */
  assignment: string | null;
  /** What the worker is to do, once it is known. */
  task: Task | null;
  /** The assignment that the wearer reported as done and the fleet accepted. */
  finished: string | null;
  /** How the assignment ended that guidance was for last, once the server has said so. */
  ended: Ended | null;
}
export interface Utterance {
  text: string;
  /** It silences what is being said. */
  urgent: boolean;
}

/** Whoever walks along the edge of the path leaves it again and again: the same words are not said so soon. */
const SAME_MS = 10_000;
/** Between two tasks there may be a moment without one. */
const PAUSE_MS = 2_000;
/** What comes next waits so long for the word how the last task ended. */
const HOLD_MS = 1_500;
const WARNINGS: readonly Shown['kind'][] = ['stop', 'lost', 'offline', 'deviating', 'redirected'];

export class Announcer {
  /** The warning that stands, and when each was said last. */
  #warned = '';
  #saidAt = new Map<string, number>();
  #wasConnected = false;
  /** The assignment that was told, and whether "you are there" was said for it. */
  #told: { id: string; there: boolean } | null = null;
  #endedAt: number | null = null;
  /** Since when guidance is no longer for the assignment that was told. */
  #overSince: number | null = null;

  /** What is to be said, if anything is new. */
  next(topic: Topic, now: number): Utterance | null {
    const warning = this.#warning(topic.shown, now);
    const work = this.#work(topic, now);
    const text = joined(warning, work);
    return text === '' ? null : { text, urgent: topic.shown.kind === 'stop' || topic.shown.kind === 'lost' };
  }

  /** What stands now, for somebody who did not catch it. */
  again({ shown, assignment, task }: Topic): string {
    const hasTask = task !== null && task.id === assignment;
    if (!isGuided(shown) || shown.kind === 'idle' || !hasTask) return sentences(shown);
    const more = shown.kind === 'following' ? shown.why : sentences(shown);
    return joined(
      t('sentence', { text: taskText(task) }),
      shown.arrived ? t('sentence', { text: t('task.there') }) : '',
      more,
    );
  }

  #warning(shown: Shown, now: number): string {
    if (!WARNINGS.includes(shown.kind)) {
      const isBack = this.#warned.startsWith('offline');
      [this.#warned, this.#wasConnected] = ['', true];
      return isBack ? t('voice.connected') : '';
    }
    // A page that has just been opened is not connected yet, which is nothing to warn of.
    if (shown.kind === 'offline' && !this.#wasConnected) return '';
    this.#wasConnected = true;
    // The seconds of a wait count down: they make no new warning.
    const key = `${shown.kind} ${shown.why}`;
    if (key === this.#warned) return '';
    this.#warned = key;
    const isUrgent = shown.kind === 'stop' || shown.kind === 'lost';
    if (!isUrgent && now - (this.#saidAt.get(key) ?? -Infinity) < SAME_MS) return '';
    this.#saidAt.set(key, now);
    // The task itself is told apart from the warning.
    return shown.kind === 'redirected' || shown.kind === 'deviating'
      ? joined(t('sentence', { text: shown.title }), shown.why)
      : sentences(shown);
  }

  #work(topic: Topic, now: number): string {
    const { shown, assignment, task } = topic;
    if (!isGuided(shown)) return '';
    const end = this.#end(topic, now);
    if (end === null) return '';
    let said = end;
    if (assignment === null) {
      if (this.#endedAt === null || now - this.#endedAt < PAUSE_MS) return said;
      this.#endedAt = null;
      return joined(said, t('task.none'));
    }
    if (task === null || task.id !== assignment) return said;
    if (this.#told === null) {
      const words = taskText(task);
      said = joined(said, t('sentence', { text: this.#endedAt === null ? words : t('task.next', { task: words }) }));
      [this.#told, this.#endedAt] = [{ id: assignment, there: false }, null];
    }
    if (shown.arrived && this.#told !== null && !this.#told.there) {
      this.#told.there = true;
      said = joined(said, t('sentence', { text: t('task.there') }));
    }
    return said;
  }

  /** What there is to say of an assignment that guidance is no longer for; null while that is not known. */
  #end({ assignment, finished, ended }: Topic, now: number): string | null {
    const told = this.#told;
    if (told === null || told.id === assignment) {
      this.#overSince = null;
      return '';
    }
    this.#overSince ??= now;
    const how = finished === told.id ? 'done' : ended?.id === told.id ? ended.how : null;
    if (how === null && now - this.#overSince < HOLD_MS) return null;
    [this.#told, this.#endedAt, this.#overSince] = [null, now, null];
    if (how === null) return '';
    return t(how === 'done' ? 'task.done' : 'task.cancelled');
  }
}

/** Whether guidance says what the worker has to do, rather than that something is wrong. */
const isGuided = ({ kind }: Shown): boolean => ['idle', 'following', 'deviating', 'redirected'].includes(kind);
const sentences = ({ title, detail }: Shown): string => joined(t('sentence', { text: title }), detail);
