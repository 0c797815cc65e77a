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

const unit = (language: Language, name: string, n: number, decimals: number, length: Length): string =>
  formatter(language, {
    style: 'unit', unit: name, unitDisplay: length, minimumFractionDigits: decimals, maximumFractionDigits: decimals,
  }).format(n);

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
