// The state of the link in words: short for the bar, long for the veil over the floor.
import { span } from './format';
import type { LinkState } from '../wire';

export function linkWords(link: LinkState, age: number | null): { short: string; veil: string | null } {
  const old = age === null ? null : span(age);
  switch (link.kind) {
    case 'replay': return { short: 'Replay', veil: null };
    case 'live': return { short: 'Live', veil: null };
    case 'connecting': return { short: 'Connecting', veil: 'Connecting to the server' };
    case 'slow': return { short: 'Slow link', veil: `The link is slow; this picture is ${old ?? '0 s'} old` };
    case 'still': return { short: 'Clock stopped', veil: `The floor’s clock has stopped; this picture is ${old ?? '0 s'} old` };
    case 'lost': return {
      short: 'Connection lost',
      veil: old === null ? 'The server cannot be reached' : `Connection lost; this picture is ${old} old`,
    };
  }
}
