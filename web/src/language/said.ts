// What the server says to people: why something waits, what is wrong and what to do, why something is refused. It comes
// with a code and what stands in its places; `said/` has each code in every language but English, which comes with it.
// A page in English loads nothing for it. A test of the server compares these files with its list of codes.
import { spoken } from './choice';
import { atMost, listed } from './measure';

export type SaidArg = string | number | Said | readonly SaidArg[];
/** A sentence of the server. Recordings of earlier versions have the text alone. */
export interface Said {
  readonly text: string;
  readonly code?: string | null;
  readonly args?: Readonly<Record<string, SaidArg>>;
}
type Texts = Readonly<Record<string, string>>;
const files = import.meta.glob<Texts>('./said/*.json', { import: 'default' });
const PLACE = /\{(\w+)\}/g;

let texts: Texts = {};

/** Loads the sentences in the language of the page; there is nothing to load in English. The page works without
 *  them. */
export async function learnSaid(): Promise<void> {
  const language = spoken();
  texts = {};
  if (language === 'en') return;
  try {
    texts = await files[`./said/${language}.json`]!();
  } catch {
    // The server's sentences stay English then.
  }
}

/** What the server said, in the language of the reader; in English where there is no translation. */
export const said = (sentence: Said | string): string => saidBy(texts, sentence);

/** The same by the texts of a language. */
export function saidBy(by: Texts, sentence: Said | string): string {
  if (typeof sentence === 'string') return sentence;
  const { code, args, text } = sentence;
  const translated = code && Object.hasOwn(by, code) ? by[code] : undefined;
  return translated?.replace(PLACE, (_, place: string) => shown(by, args?.[place])) ?? text;
}

function shown(by: Texts, arg: SaidArg | undefined): string {
  if (arg === undefined) return '';
  if (typeof arg === 'number') return atMost(spoken(), arg, 6);
  if (!Array.isArray(arg)) return saidBy(by, arg as string | Said);
  const all = (arg as readonly SaidArg[]).map((one) => shown(by, one));
  return arg.some((one) => typeof one === 'object') ? all.join(spoken() === 'zh' ? '；' : '; ') : listed(spoken(), all);
}

/** Whether two sentences say the same. */
export const sameSaid = (a: Said | string | null, b: Said | string | null): boolean => englishOf(a) === englishOf(b);
const englishOf = (sentence: Said | string | null): string | null =>
  sentence === null || typeof sentence === 'string' ? sentence : sentence.text;

/** A sentence from a message; null where there is none. */
export function asSaid(value: unknown): Said | string | null {
  if (typeof value === 'string') return value;
  return typeof value === 'object' && value !== null && typeof (value as Said).text === 'string'
    ? (value as Said)
    : null;
}
