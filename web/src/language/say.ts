// A page's messages in one language. They are compiled when the page is built, so that no parser has to be loaded: a
// message without placeholders is a string, any other the tree that the parser of ICU messages makes of it.
import { IntlMessageFormat } from 'intl-messageformat';
import { applyLanguage, chosenLanguage, type Language } from './choice';

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

export interface PageMessages<Key extends string> {
  /** Loads the messages of a language and puts the page into it. To be awaited before anything is said. */
  learn(wanted?: Language): Promise<void>;
  t: Say<Key>;
}

/** The messages of a page, from its files: `./messages/LANGUAGE.json`. */
export function messagesOf<Key extends string>(files: Readonly<Record<string, () => Promise<Compiled>>>): PageMessages<Key> {
  let say: Say<Key> | null = null;
  return {
    async learn(wanted = chosenLanguage()) {
      const load = files[`./messages/${wanted}.json`];
      if (!load) throw new Error(`no messages in ${wanted}`);
      say = sayIn<Key>(wanted, await load());
      applyLanguage(wanted);
    },
    t: (key, values) => {
      if (!say) throw new Error('learn() a language first');
      return say(key, values);
    },
  };
}
