// The language of a page: which ones there are, which one is used, its messages, and its numbers with their units.
// Messages are in ICU's format, so plurals follow the rules of each language.
export { chooseLanguage, LANGUAGES, languageFor, spoken, type Language } from './choice';
export { asSaid, learnSaid, said, sameSaid, type Said, type SaidArg } from './said';
export { messagesOf, sayIn, type Compiled, type PageMessages, type Say, type Values } from './say';
export {
  atMost,
  coordinate,
  duration,
  explained,
  listed,
  metres,
  number,
  quantity,
  seconds,
  significant,
  spelt,
  together,
  type Unit,
} from './measure';
