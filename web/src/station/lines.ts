// Which line is picked now, which one comes next, and what is left. Pure.
import type { Line, Visit } from './state';

/** Whether nothing more is to be picked. */
export const isOver = ({ state }: Line): boolean => state === 'done' || state === 'short';
/** Pieces that are still to be picked. */
export const leftOf = (line: Line): number => (isOver(line) ? 0 : line.quantity - line.done);
export const litOf = (visit: Visit | null): Line | null => visit?.lines.find(({ state }) => state === 'lit') ?? null;
/** The line that is lit after the one that is lit now: lines that were taken back come in their order again. */
export const nextOf = (visit: Visit | null): Line | null =>
  visit?.lines.find((line) => !isOver(line) && line.state !== 'lit') ?? null;
export const linesLeft = (visit: Visit): number => visit.lines.filter((line) => !isOver(line)).length;

export type Mark = 'lit' | 'next' | 'open' | 'short' | 'done';
/** What counts more where several lines are of one slot or one tote. */
const RANK: readonly Mark[] = ['lit', 'next', 'open', 'short', 'done'];

function markOf(line: Line, next: Line | null): Mark {
  if (line.state === 'lit' || line.state === 'done' || line.state === 'short') return line.state;
  return line.n === next?.n ? 'next' : 'open';
}

/** How the slots of a visit are marked; those without a line are not. */
export function slotMarks(visit: Visit | null): ReadonlyMap<string, Mark> {
  const marks = new Map<string, Mark>();
  const next = nextOf(visit);
  for (const line of visit?.lines ?? []) {
    const [mark, before] = [markOf(line, next), marks.get(line.slot)];
    if (before === undefined || RANK.indexOf(mark) < RANK.indexOf(before)) marks.set(line.slot, mark);
  }
  return marks;
}

/** Seconds that are left of what was said some time ago; never less than none. */
export const countdown = (in_s: number, age_ms: number): number => Math.max(0, in_s - age_ms / 1000);

/** In which order lines were changed, as far as this page has seen it, so that undo takes back the last change. */
export class Changes {
  #job: string | null = null;
  #known = new Map<number, string>();
  #order: number[] = [];

  hear(visit: Visit | null): void {
    if (visit?.job !== this.#job) [this.#job, this.#known, this.#order] = [visit?.job ?? null, new Map(), []];
    // What happened before this page was opened is taken in the order of the lines, the lit one last.
    const isLit = ({ state }: Line): number => Number(state === 'lit');
    const lines = [...(visit?.lines ?? [])].sort((a, b) => isLit(a) - isLit(b) || a.n - b.n);
    for (const line of lines) {
      const now = `${line.done} ${isOver(line) ? line.state : ''}`;
      if (this.#known.get(line.n) === now) continue;
      this.#known.set(line.n, now);
      this.#order = this.#order.filter((n) => n !== line.n);
      if (line.done > 0 || isOver(line)) this.#order.push(line.n);
    }
  }

  /** The line that undo takes back; null where nothing can be. */
  target(visit: Visit | null): Line | null {
    const last = this.#order.at(-1);
    return visit?.lines.find(({ n }) => n === last) ?? null;
  }
}
