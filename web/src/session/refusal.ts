// Why somebody is not signed in, in words.
import { t, wordsBy } from '../words';
import type { Refusal, SentBack } from './session';

export function refusalWords(refusal: Refusal): string {
  switch (refusal.kind) {
    case 'empty':
      return t('session.token.empty');
    case 'wrong':
      return t('session.token.wrong');
    case 'no-cookie':
      return t('session.no-cookie');
    case 'unreachable':
      return t('trouble.unreachable');
    case 'status':
      return t('trouble.status', { status: String(refusal.status) });
    case 'said':
      return refusal.text;
  }
}

const SENT_BACK = wordsBy<SentBack>({
  stale: 'session.provider.stale',
  denied: 'session.provider.denied',
  unreachable: 'session.provider.unreachable',
  untrusted: 'session.provider.untrusted',
  no_role: 'session.provider.no-role',
});

/** Why the identity provider signed nobody in. */
export const sentBackWords = (why: SentBack): string => SENT_BACK[why];
