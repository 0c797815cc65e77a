// What people do, in one list of words: the button that does it, what undo takes back, the audit and the report say the
// same.
import type { Act } from '../wire';
import { t } from './say';

/** As a button says it: what it will do. */
export const actDo = (act: Act): string => t(`act.${act}`, { form: 'do' });
/** As it is told afterwards, with what was done to. */
export function actDid(act: Act, subject: string | null = null): string {
  const did = t(`act.${act}`, { form: 'did' });
  return subject === null ? did : t('act.of', { did, subject });
}
