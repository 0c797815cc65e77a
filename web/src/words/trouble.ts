// What went wrong with a request, in words.
import { said } from '../language';
import { t } from './say';
import { PAST, type Answer, type Problem } from '../wire';

/** What a problem or a wrong field says is wrong; empty where it says nothing. */
export const detailOf = ({ detail, code, args }: Pick<Problem, 'detail' | 'code' | 'args'>): string =>
  said({ text: detail ?? '', ...(code === undefined ? {} : { code }), ...(args === undefined ? {} : { args }) });

/** Null where nothing did. */
export function trouble(answer: Answer<unknown>): string | null {
  if (answer.kind === 'ok') return null;
  if (answer.kind === 'unreachable') return t('trouble.unreachable');
  const { problem } = answer;
  if (problem === PAST) return t('trouble.past');
  return detailOf(problem) || said(problem.title) || t('trouble.status', { status: String(problem.status) });
}
