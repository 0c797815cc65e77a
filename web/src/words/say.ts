// The dashboard's messages, in the language of its reader. Those of panels that are fetched when somebody asks for them
// come with these panels.
import type english from './messages/en.json';
import type ofPanels from './panels/messages/en.json';
import { messagesOf, type Compiled } from '../language';

export type MessageKey = keyof typeof english | keyof typeof ofPanels;

export const { learn, learnMore, t } = messagesOf<MessageKey>(
  import.meta.glob<Compiled>('./messages/*.json', { import: 'default' }),
  import.meta.glob<Compiled>('./panels/messages/*.json', { import: 'default' }),
);

/** Words by a state, said when they are read: the language is known only then. */
export function wordsBy<K extends string>(keys: Record<K, MessageKey>): Readonly<Record<K, string>> {
  const said = Object.entries<MessageKey>(keys).map(
    ([state, key]) => [state, { get: () => t(key), enumerable: true }] as const,
  );
  return Object.defineProperties({}, Object.fromEntries(said)) as Record<K, string>;
}
/** A word that begins a line, within one: only its first letter is smaller, as German has nouns. */
export const within = (words: string): string => words.charAt(0).toLowerCase() + words.slice(1);
