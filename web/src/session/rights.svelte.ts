// What whoever is signed in may do. The server decides; the page only leaves out what would be refused.
import type { Act } from '../wire';
import { whoIsHere, type Me } from './session';

let me = $state.raw<Me | null>(null);

/** Asks who is here. As long as that is not known, nothing is left out. */
export async function learnRights(who: () => Promise<Me | 'nobody' | 'unreachable'> = whoIsHere): Promise<void> {
  const answer = await who();
  if (typeof answer === 'object') me = answer;
}
/** Whether whoever is here may do this. An older server does not say: then it refuses by itself. */
export const may = (act: Act): boolean => me?.may?.includes(act) ?? true;
/** In which role, once that is known. */
export const roleHere = (): Me['role'] | null => me?.role ?? null;
/** Whoever has signed in with a name of their own need not type it. */
export const nameHere = (): string | null => (me !== null && me.by !== 'nothing' ? me.name : null);
