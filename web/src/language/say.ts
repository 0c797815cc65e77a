// A page's messages in one language. They are compiled when the page is built, so that no parser has to be loaded: a
// message without placeholders is a string, any other the tree that the parser of ICU messages makes of it.
import { IntlMessageFormat } from 'intl-messageformat';
import { applyLanguage, chosenLanguage, spoken, type Language } from './choice';

type Tree = ConstructorParameters<typeof IntlMessageFormat>[0];
export type Compiled = Readonly<Record<string, Tree>>;
export type Values = Readonly<Record<string, string | number>>;
/** A message by its key, with what its placeholders stand for. */
export type Say<Key extends string> = (key: Key, values?: Values) => string;

/** Messages of a page in a language. A formatter is made when its message is needed for the first time. */
export function sayIn<Key extends string>(language: Language, messages: Compiled): Say<Key> {
  const made = new Map<string, IntlMessageFormat>();
  return (key, values) => {
    const message = messages[key];
    if (message === undefined) throw new Error(`no message "${key}" in ${language}`);
    if (typeof message === 'string') return message;
    let formatter = made.get(key);
    if (!formatter) made.set(key, (formatter = new IntlMessageFormat(message, language)));
    return String(formatter.format(values));
  };
}

/** Messages by their file: `…/LANGUAGE.json`. */
type Files = Readonly<Record<string, () => Promise<Compiled>>>;

export interface PageMessages<Key extends string> {
  /** Loads the messages of a language and puts the page into it. To be awaited before anything is said. */
  learn(wanted?: Language): Promise<void>;
  /** Loads those that a page needs later, in the same language. */
  learnMore(): Promise<void>;
  t: Say<Key>;
}

function loaded(files: Files, language: Language): Promise<Compiled> {
  const file = Object.entries(files).find(([path]) => path.endsWith(`/${language}.json`));
  if (!file) throw new Error(`no messages in ${language}`);
  return file[1]();
}

/** The messages of a page, from its files, and those that it needs later. */
export function messagesOf<Key extends string>(files: Files, later: Files = {}): PageMessages<Key> {
  let known: Record<string, Tree> = {};
  let say: Say<Key> | null = null;
  return {
    async learn(wanted = chosenLanguage()) {
      known = { ...(await loaded(files, wanted)) };
      say = sayIn<Key>(wanted, known);
      applyLanguage(wanted);
    },
    async learnMore() {
      Object.assign(known, await loaded(later, spoken()));
    },
    t: (key, values) => {
      if (!say) throw new Error('learn() a language first');
      return say(key, values);
    },
  };
}
