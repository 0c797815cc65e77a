// Which languages there are, and which one is used: the one that was chosen on this device, else the browser's.

/** Each by its own name, so that whoever reads only that language finds it. */
export const LANGUAGES = { en: 'English', de: 'Deutsch', es: 'Español', zh: '简体中文' } as const;
export type Language = keyof typeof LANGUAGES;

const KEY = 'giveway.language';
const isKnown = (word: string | null): word is Language => word !== null && Object.hasOwn(LANGUAGES, word);

/** The first of the wanted languages (BCP 47, such as `de-AT`) that there is; English where there is none. */
export function languageFor(wanted: readonly string[]): Language {
  return wanted.map((tag) => tag.toLowerCase().split('-')[0] ?? '').find(isKnown) ?? 'en';
}

export function chosenLanguage(): Language {
  let stored: string | null = null;
  try {
    stored = localStorage.getItem(KEY);
  } catch {
    // Storage may be forbidden; the browser's language is used then.
  }
  return isKnown(stored) ? stored : languageFor(navigator.languages);
}

/** Remembers a choice. The page must be drawn anew. */
export function chooseLanguage(language: Language): void {
  try {
    localStorage.setItem(KEY, language);
  } catch {
    // The choice then lasts as long as the page.
  }
}

let current: Language = 'en';

/** Puts the page into a language; tells the browser, screen readers and spelling checkers. */
export function applyLanguage(language: Language): void {
  current = language;
  document.documentElement.lang = language === 'zh' ? 'zh-Hans' : language;
}
/** The language that the page is in. */
export const spoken = (): Language => current;
