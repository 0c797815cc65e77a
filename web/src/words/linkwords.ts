// The state of the link in words: short for the bar, long for the veil over the floor.
import { span } from './format';
import { t } from './say';
import type { LinkState } from '../wire';

export function linkWords(link: LinkState, age: number | null): { short: string; veil: string | null } {
  const time = span(age ?? 0);
  switch (link.kind) {
    case 'replay':
      return { short: t('link.replay'), veil: null };
    case 'live':
      return { short: t('link.live'), veil: null };
    case 'connecting':
      return { short: t('link.connecting'), veil: t('link.connecting.veil') };
    case 'slow':
      return { short: t('link.slow'), veil: t('link.slow.veil', { time }) };
    case 'still':
      return { short: t('link.still'), veil: t('link.still.veil', { time }) };
    case 'lost':
      return { short: t('link.lost'), veil: age === null ? t('link.unreachable') : t('link.lost.veil', { time }) };
  }
}
