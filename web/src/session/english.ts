// Signing in on a page that is in English alone. It loads messages only when there is something to say.
import { tryToken } from './session';

/** Signs in; what is wrong, in words for people, or null. */
export async function signIn(token: string): Promise<string | null> {
  const refusal = await tryToken(token);
  if (refusal === null) return null;
  const [{ learn }, { refusalWords }] = await Promise.all([import('../words'), import('./refusal')]);
  await learn('en');
  return refusalWords(refusal);
}
