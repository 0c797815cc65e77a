// Numbers and words as people read them.
import { afterEach, describe, expect, test } from 'vitest';
import { quantity } from '../src/language';
import { PAST, type Answer } from '../src/wire';
import { learn, learnMore, trouble } from '../src/words';
import {
  clock,
  count,
  doing,
  listed,
  longSpan,
  metres,
  micros,
  percent,
  roughly,
  roundSpan,
  span,
  timeOfDay,
} from '../src/words/format';
import { linkWords } from '../src/words/linkwords';
import type { Doing } from '../src/wire';

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

describe('in other languages', () => {
  afterEach(async () => {
    await learn('en');
    await learnMore();
  });

  test('numbers and units are written as each language has them', () => {
    const all = (n: number, unit: Parameters<typeof quantity>[2], decimals: number): string[] =>
      (['en', 'de', 'es', 'zh'] as const).map((one) => quantity(one, n, unit, decimals));
    expect(all(1.5, 'm', 1)).toEqual(['1.5 m', '1,5 m', '1,5 m', '1.5米']);
    expect(all(83, '%', 0)).toEqual(['83 %', '83 %', '83 %', '83%']);
    expect(all(1_200, 'µs', 0)[1]).toBe('1.200 µs');
  });
  test('times are said in the language of the page', async () => {
    expect([longSpan(3_600), longSpan(86_400), longSpan(900)]).toEqual(['1 hour', '1 day', '15 min']);
    await learn('de');
    expect([span(75), roundSpan(7_200), longSpan(3_600), listed(['a', 'b'])]).toEqual([
      '1 min 15 s',
      '2 h',
      '1 Stunde',
      'a, b',
    ]);
    await learn('zh');
    expect([span(75), roughly(3_700), longSpan(86_400), listed(['a', 'b'])]).toEqual([
      '1分钟15秒',
      '1小时',
      '1天',
      'a，b',
    ]);
  });
});

describe('what went wrong with a request', () => {
  const refused = (title: string, detail?: string): Answer<never> => ({
    kind: 'refused',
    problem: { title, status: 502, ...(detail === undefined ? {} : { detail }) },
  });

  test('is said as the server says it, and in own words where it says nothing', () => {
    expect(trouble({ kind: 'ok', value: 1 })).toBeNull();
    expect(trouble({ kind: 'unreachable' })).toBe('The server cannot be reached.');
    expect(trouble(refused('No', 'rack K1 is not there'))).toBe('rack K1 is not there');
    expect(trouble(refused('No'))).toBe('No');
    expect(trouble(refused(''))).toBe('The server answered 502.');
    expect(trouble({ kind: 'refused', problem: PAST })).toContain('Go back to live');
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
