// Numbers and words as people read them.
import { describe, expect, test } from 'vitest';
import { clock, count, doing, metres, micros, percent, roughly, span, timeOfDay } from '../src/words/format';
import { linkWords } from '../src/words/linkwords';
import type { Doing } from '../src/wire/types';

describe('formatting', () => {
  test('plan times take the unit that fits', () => {
    expect([0, 850, 1_240, 34_000, 2_500_000].map(micros)).toEqual(['0 µs', '850 µs', '1.2 ms', '34 ms', '2.5 s']);
    expect(micros(Number.NaN)).toBe('–');
  });

  test('spans round down and never go below nothing', () => {
    expect([-3, 12.9, 75, 3_700].map(span)).toEqual(['0 s', '12 s', '1 min 15 s', '1 h 1 min']);
  });

  test('a rough span has one unit, and a distance the one that fits', () => {
    expect([3, 75, 3_700].map(roughly)).toEqual(['3 s', '1 min', '1 h']);
    expect([0.4, 999, 1_250].map(metres)).toEqual(['0 m', '999 m', '1.3 km']);
  });
  test('the floor clock counts hours beyond a day', () => {
    expect([0, 3_661, 90_000].map(clock)).toEqual(['00:00:00', '01:01:01', '25:00:00']);
  });

  test('counts are grouped and shares are percent', () => {
    expect(count(12_345.6)).toBe('12,346');
    expect(percent(0.834)).toBe('83 %');
  });

  test('a time that is missing or no time is a dash', () => {
    expect(timeOfDay(null)).toBe('–');
    expect(timeOfDay('soon')).toBe('–');
    expect(timeOfDay('2026-01-02T03:04:05Z')).toMatch(/^\d\d:04:05$/);
  });

  test('a doing this page has no words for is shown as the server says it', () => {
    expect(doing('picking')).toBe('at the station for picking');
    expect(doing('being_washed' as Doing)).toBe('being washed');
  });
});

describe('the words for the link', () => {
  test('only a live link has no veil', () => {
    expect(linkWords({ kind: 'live' }, 0)).toEqual({ short: 'Live', veil: null });
    expect(linkWords({ kind: 'still' }, 18).veil).toBe('The floor’s clock has stopped; this picture is 18 s old');
    expect(linkWords({ kind: 'slow' }, 3).veil).toBe('The link is slow; this picture is 3 s old');
  });

  test('a lost link says how old the data is', () => {
    const lost = { kind: 'lost', attempt: 3, retryAt: 0 } as const;
    expect(linkWords(lost, 12).veil).toBe('Connection lost; this picture is 12 s old');
    expect(linkWords(lost, null).veil).toBe('The server cannot be reached');
  });
});
