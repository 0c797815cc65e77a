// Words: numbers, states and times as people read them, so that the same thing reads the same everywhere.
// It draws nothing and asks no server.
export * from './format';
export { learn, learnMore, t, within, wordsBy, type MessageKey } from './say';
export * from './linkwords';
export * from './moments';
export { actDid, actDo } from './acts';
export { learnSaid } from '../language';
export { learnNames, learnNumbers, nameOf, personName, said, withNames } from './people.svelte';
export { detailOf, trouble } from './trouble';
