// How people are called on this page. A name is chosen once, by the right of whoever looks: all that is shown asks
// here, so nobody has a name, a pseudonym and a number at the same time.
import { said as saidIn, type Said } from '../language';

/** Names by pseudonym, for those who may see names. A pseudonym stands for one person for ever, on whatever floor. */
let names = $state.raw<ReadonlyMap<string, string>>(new Map());
/** Pseudonyms by number, on the floor that is shown. */
let numbers = $state.raw<ReadonlyMap<string, string>>(new Map());

export function learnNames(known: ReadonlyMap<string, string>): void {
  names = known;
}
export function learnNumbers(workers: readonly { id: string; name: string }[]): void {
  const isKnown = workers.length === numbers.size && workers.every(({ id, name }) => numbers.get(id) === name);
  if (!isKnown) numbers = new Map(workers.map(({ id, name }) => [id, name]));
}

/** What stands for a pseudonym: the name, if that may be seen. */
export const nameOf = (pseudonym: string): string => names.get(pseudonym) ?? pseudonym;
/** What a person is called whom the server knows by a number, such as w1. */
export function personName(id: string): string {
  const pseudonym = numbers.get(id);
  return pseudonym === undefined ? id : nameOf(pseudonym);
}

/** A text with the one name of each person in it. */
export function withNames(text: string): string {
  if (numbers.size === 0) return text;
  let named = text;
  for (const [, id] of text.matchAll(/\((w\d+)\)/g)) {
    const pseudonym = numbers.get(id!);
    if (pseudonym !== undefined) named = named.replaceAll(`${pseudonym} (${id})`, nameOf(pseudonym));
  }
  named = named.replace(/\bworker (w\d+)\b/g, (words, id: string) =>
    numbers.has(id) ? `worker ${personName(id)}` : words,
  );
  for (const [pseudonym, name] of names) if (pseudonym !== name) named = named.replaceAll(pseudonym, name);
  return named;
}

/** What the server said, in the language of the reader, with people by their names. */
export const said = (sentence: Said | string): string =>
  withNames(saidIn(sentence)).replaceAll('worker worker-', 'worker-');
