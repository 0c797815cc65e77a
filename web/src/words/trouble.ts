// What went wrong with a request, in words.
import { t } from './say';
import { PAST, type Answer } from '../wire';

/** Null where nothing did. What the server gave as a reason is said as it said it. */
export function trouble(answer: Answer<unknown>): string | null {
  if (answer.kind === 'ok') return null;
  if (answer.kind === 'unreachable') return t('trouble.unreachable');
  const { problem } = answer;
  if (problem === PAST) return t('trouble.past');
  return (problem.detail ?? problem.title) || t('trouble.status', { status: String(problem.status) });
}
