// What the server says in English sentences (why something waits, what is wrong and what to do, why something is refused) in
// the language of the reader. The sentences are the keys, as in gettext: `said/patterns.json` has their patterns, and the file
// of each language the translations in the same order. What has no pattern stays English.
import type { Language } from './choice';

type Texts = readonly string[];
const files = import.meta.glob<Texts>('./said/*.json', { import: 'default' });

interface Pattern {
  readonly shape: RegExp;
  /** Which placeholder each group of the shape is. */
  readonly order: readonly number[];
  readonly to: string;
}

/** Parts of sentences are sentences, too, so deep at most. */
const DEEP = 4;
/** So many sentences are remembered. */
const REMEMBERED = 4_000;

const PLACE = /\{(\d)\}/g;
const escaped = (text: string): string => text.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');
/** How much of a pattern is its own: the more, the earlier it is tried. The end of a sentence goes before its parts. */
const own = (text: string): number => text.replace(PLACE, '').length + (text.endsWith('.') ? 3 : 0);

/** The patterns of a language, those that say most first. */
export function patternsOf(english: Texts, translated: Texts): readonly Pattern[] {
  const all = english.map((from, i) => {
    const literals = from.split(PLACE).filter((_, k) => k % 2 === 0).map(escaped);
    const order = [...from.matchAll(PLACE)].map((found) => Number(found[1]));
    return { from, shape: new RegExp(`^${literals.join('(.+?)')}$`, 's'), order, to: translated[i]! };
  });
  return all.sort((a, b) => own(b.from) - own(a.from));
}

/** A sentence by these patterns; itself where it has none. */
export function translated(text: string, by: readonly Pattern[], deep = DEEP): string {
  for (const { shape, order, to } of by) {
    const found = shape.exec(text);
    if (!found) continue;
    const values = new Map(order.map((place, k) => [place, deep > 0 ? translated(found[k + 1]!, by, deep - 1) : found[k + 1]!]));
    return to.replace(PLACE, (_, place: string) => values.get(Number(place)) ?? '');
  }
  return text;
}

/** What says the server's sentences in a language. */
export async function sentencesIn(language: Language): Promise<(text: string) => string> {
  const file = (name: string): Promise<Texts> => files[`./said/${name}.json`]!();
  const patterns = patternsOf(await file('patterns'), await file(language));
  const known = new Map<string, string>();
  return (text) => {
    let words = known.get(text);
    if (words === undefined) {
      if (known.size >= REMEMBERED) known.clear();
      known.set(text, (words = translated(text, patterns)));
    }
    return words;
  };
}
