// What went wrong with a request, in words.
import { said } from '../language';
import { t } from './say';
import { PAST, type Answer } from '../wire';

/** Null where nothing did. */
export function trouble(answer: Answer<unknown>): string | null {
  if (answer.kind === 'ok') return null;
  if (answer.kind === 'unreachable') return t('trouble.unreachable');
  const { problem } = answer;
  if (problem === PAST) return t('trouble.past');
  return said(problem.detail ?? problem.title) || t('trouble.status', { status: String(problem.status) });
}
