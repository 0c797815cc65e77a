// What the server says, in the language of the reader. A page in English loads no more than this.
import { spoken } from './choice';

let inLanguage: ((text: string) => string) | null = null;

/** Loads the sentences in the language of the page; there is nothing to load in English. */
export async function learnSaid(): Promise<void> {
  const language = spoken();
  inLanguage = language === 'en' ? null : await (await import('./sentences')).sentencesIn(language);
}

/** What the server said, in the language of the reader; as it is where nobody has translated it. */
export const said = (text: string): string => inLanguage?.(text) ?? text;
