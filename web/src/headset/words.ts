// The words of this page, in the language of its wearer.
import type english from './messages/en.json';
import {
  coordinate as coordinateIn,
  duration,
  messagesOf,
  metres as metresIn,
  seconds as secondsIn,
  spoken,
  type Compiled,
  type Language,
} from '../language';

export type Key = keyof typeof english;

const messages = messagesOf<Key>(import.meta.glob<Compiled>('./messages/*.json', { import: 'default' }));
export const { t } = messages;

/** Loads a language. To be awaited before anything is said. */
export async function learn(wanted?: Language): Promise<void> {
  await messages.learn(wanted);
  document.title = t('page.title');
}

export const metres = (m: number): string => metresIn(spoken(), m);
export const coordinate = (m: number): string => coordinateIn(spoken(), m);
export const seconds = (s: number): string => secondsIn(spoken(), s);
export { duration, spoken };
