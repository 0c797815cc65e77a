// Which robot or worker a bookmark is about.
import { row, type Mark, type Mirror } from '../wire';

export interface Subject {
  kind: 'robot' | 'worker';
  id: string;
}

/** The one that a bookmark names first. The moment that is shown need not have it: a worker may come to the floor
 *  later. */
export function subjectOf(mark: Mark, shown: Mirror): Subject | null {
  const id = mark.who[0];
  if (id === undefined) return null;
  if (mark.kind === 'deviation' || mark.kind === 'encounter') return { kind: 'worker', id };
  if (mark.kind === 'replan' || mark.kind === 'failure' || mark.kind === 'stop') return { kind: 'robot', id };
  if (row(shown.workers, id)) return { kind: 'worker', id };
  return row(shown.robots, id) ? { kind: 'robot', id } : null;
}
