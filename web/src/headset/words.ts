// The words of this page, in the language of its wearer.
import type english from './messages/en.json';
import {
  applyLanguage, chosenLanguage, duration, metres as metresIn, sayIn, seconds as secondsIn,
  type Compiled, type Language, type Say,
} from '../language';

export type Key = keyof typeof english;
const FILES = import.meta.glob<Compiled>('./messages/*.json', { import: 'default' });

let [language, say]: [Language, Say<Key> | null] = ['en', null];

/** Loads the messages of a language. To be awaited before anything is said. */
export async function learn(wanted: Language = chosenLanguage()): Promise<void> {
  const load = FILES[`./messages/${wanted}.json`];
  if (!load) throw new Error(`no messages in ${wanted}`);
  [language, say] = [wanted, sayIn<Key>(wanted, await load())];
  applyLanguage(wanted);
  document.title = t('page.title');
}

export const t: Say<Key> = (key, values) => {
  if (!say) throw new Error('learn() a language first');
  return say(key, values);
};
export const spoken = (): Language => language;
export const metres = (m: number): string => metresIn(language, m);
export const seconds = (s: number): string => secondsIn(language, s);
export { duration };
