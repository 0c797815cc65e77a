// Numbers with their units, as each language writes them; `long` spells the unit out, for a voice.
import type { Language } from './choice';

type Length = 'short' | 'long';
const made = new Map<string, Intl.NumberFormat>();

/** Formatters are slow to make, and few. */
function formatter(language: Language, options: Intl.NumberFormatOptions): Intl.NumberFormat {
  const key = language + JSON.stringify(options);
  let found = made.get(key);
  if (!found) made.set(key, (found = new Intl.NumberFormat(language, options)));
  return found;
}

export const number = (language: Language, n: number, decimals = 0): string =>
  formatter(language, { minimumFractionDigits: decimals, maximumFractionDigits: decimals }).format(n);

/** With so many digits behind the point at most. */
export const atMost = (language: Language, n: number, decimals: number): string =>
  formatter(language, { maximumFractionDigits: decimals }).format(n);

/** With so many digits that say something. */
export const significant = (language: Language, n: number, digits: number): string =>
  formatter(language, { maximumSignificantDigits: digits }).format(n);

const unit = (language: Language, name: string, n: number, decimals: number, length: Length): string =>
  formatter(language, {
    style: 'unit',
    unit: name,
    unitDisplay: length,
    minimumFractionDigits: decimals,
    maximumFractionDigits: decimals,
  }).format(n);

/** Units by their symbols; those that Chinese writes in words by what Intl calls them. */
const UNITS = {
  µs: null,
  ms: null,
  s: 'second',
  min: 'minute',
  h: 'hour',
  m: 'meter',
  km: 'kilometer',
  'm/s': 'meter-per-second',
  '%': 'percent',
} as const;
export type Unit = keyof typeof UNITS;

/** A number with its unit, for panels. The symbols are those of the SI, which languages in Latin script share: Intl
 *  would shorten words there, to “5 Sek.” and “5 secs”. */
export function quantity(language: Language, n: number, symbol: Unit, decimals = 0): string {
  const name = UNITS[symbol];
  if (language === 'zh' && name !== null) return unit(language, name, n, decimals, 'short');
  return `${number(language, n, decimals)} ${symbol}`;
}

/** Quantities that make one together, such as minutes and seconds. */
export const together = (language: Language, parts: readonly string[]): string =>
  parts.join(language === 'zh' ? '' : ' ');

/** Things one after the other, in a line. */
export const listed = (language: Language, parts: readonly string[]): string =>
  parts.join(language === 'zh' ? '，' : ', ');

/** Something, and what there is to say about it. */
export const explained = (language: Language, what: string, more: string): string =>
  `${what}${language === 'zh' ? '：' : ': '}${more}`;

/** Hours or days, spelt out. */
export const spelt = (language: Language, n: number, name: 'hour' | 'day'): string =>
  unit(language, name, n, 0, 'long');

/** How far, to the accuracy that a walker needs. */
export function metres(language: Language, m: number, length: Length = 'short'): string {
  if (m < 1) return unit(language, 'centimeter', m * 100, 0, length);
  return unit(language, 'meter', m, m < 10 && length === 'short' ? 1 : 0, length);
}

/** A coordinate of the map, to the centimetre. */
export const coordinate = (language: Language, m: number): string => unit(language, 'meter', m, 2, 'short');

export const seconds = (language: Language, s: number, length: Length = 'short'): string =>
  unit(language, 'second', Math.max(0, Math.round(s)), 0, length);

/** Minutes and seconds, as on a watch. */
export function duration(s: number): string {
  const whole = Math.max(0, Math.round(s));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}
