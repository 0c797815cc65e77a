// Why somebody is not signed in, in words.
import { t } from '../words';
import type { Refusal } from './session';

export function refusalWords(refusal: Refusal): string {
  switch (refusal.kind) {
    case 'empty': return t('session.token.empty');
    case 'wrong': return t('session.token.wrong');
    case 'no-cookie': return t('session.no-cookie');
    case 'unreachable': return t('trouble.unreachable');
    case 'status': return t('trouble.status', { status: String(refusal.status) });
    case 'said': return refusal.text;
  }
}
