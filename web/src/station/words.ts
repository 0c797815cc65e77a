// The words of this page, in the language of its picker.
import type english from './messages/en.json';
import { duration, messagesOf, seconds as secondsIn, spoken, type Compiled } from '../language';

export type Key = keyof typeof english;

const messages = messagesOf<Key>(import.meta.glob<Compiled>('./messages/*.json', { import: 'default' }));
export const { learn, t } = messages;

/** From so many seconds on, minutes are easier to read. */
const LONG_S = 90;
/** How long something takes or took. */
export const time = (s: number): string => (s < LONG_S ? secondsIn(spoken(), s).replace(' ', '\u00a0') : duration(s));
/** A moment, as clocks on the wall show it. */
export const clockTime = (moment: string): string =>
  new Intl.DateTimeFormat(spoken(), { hour: '2-digit', minute: '2-digit' }).format(new Date(moment));
