// The server's sentences in the languages of the dashboard.
import { describe, expect, test } from 'vitest';
import { patternsOf, translated } from '../src/language/sentences';
import de from '../src/language/said/de.json';
import en from '../src/language/said/patterns.json';
import es from '../src/language/said/es.json';
import zh from '../src/language/said/zh.json';

const places = (text: string): string => [...new Set(text.match(/\{\d\}/g) ?? [])].sort().join();

describe.each([['de', de], ['es', es], ['zh', zh]])('in %s', (_, texts) => {
  test('every sentence has a translation with the same placeholders', () => {
    expect(texts.length).toBe(en.length);
    for (const [i, text] of texts.entries()) expect(`${en[i]}: ${places(text)}`).toBe(`${en[i]}: ${places(en[i]!)}`);
  });
  test('every sentence is translated, whatever is in its places', () => {
    const patterns = patternsOf(en, texts);
    for (const [i, text] of en.entries()) {
      const filled = (one: string): string => one.replace(/\{(\d)\}/g, (__, place: string) => `x${place}`);
      expect(translated(filled(text), patterns)).toBe(filled(texts[i]!));
    }
  });
});

test('sentences within sentences are translated, and what is not known stays', () => {
  const patterns = patternsOf(en, de);
  const german = (text: string): string => translated(text, patterns);
  expect(german('waiting for A12, held by robot-7')).toBe('wartet auf A12; dort ist robot-7');
  expect(german('robot-3: no telemetry')).toBe('robot-3: keine Meldungen');
  expect(german('robot-3 sends no reports; 14 robots wait for it.')).toBe('robot-3 meldet sich nicht; 14 Roboter warten darauf.');
  expect(german('waiting for rack K1, which is on robot-2 (no telemetry)')).toBe('wartet auf Regal K1; es ist auf robot-2 (keine Meldungen)');
  expect(german('something that nobody has translated')).toBe('something that nobody has translated');
});
