// What the server says, in the language of the reader. A page in English loads no more than this.
import { spoken } from './choice';

let inLanguage: ((text: string) => string) | null = null;

/** Loads the sentences in the language of the page; there is nothing to load in English. The page works without them. */
export async function learnSaid(): Promise<void> {
  const language = spoken();
  inLanguage = null;
  if (language === 'en') return;
  try {
    inLanguage = await (await import('./sentences')).sentencesIn(language);
  } catch {
    // The server's sentences stay English then.
  }
}

/** What the server said, in the language of the reader; as it is where there is no translation. */
export const said = (text: string): string => inLanguage?.(text) ?? text;
