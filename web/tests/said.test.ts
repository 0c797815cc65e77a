// The server's sentences in the languages of the dashboard. A test of the server compares their codes and places with
// its list.
import { afterEach, describe, expect, test } from 'vitest';
import { applyLanguage } from '../src/language/choice';
import { asSaid, sameSaid } from '../src/language';
import { saidBy, type Said } from '../src/language/said';
import de from '../src/language/said/de.json';
import es from '../src/language/said/es.json';
import zh from '../src/language/said/zh.json';

const silent: Said = { code: 'silent', args: {}, text: 'sends no telemetry' };
const rack: Said = {
  code: 'rack_on',
  args: { rack: 'K1', robot: { code: 'robot_in_trouble', args: { robot: 'robot-2', reason: silent }, text: '' } },
  text: 'waits for rack K1, which is on robot-2 (sends no telemetry)',
};
afterEach(() => applyLanguage('en'));

describe.each([
  ['de', de],
  ['es', es],
  ['zh', zh],
])('in %s', (_, texts) => {
  test('no text has a number in a place, as it had when patterns were matched', () => {
    expect(Object.values(texts).filter((text) => /\{\d\}/.test(text))).toEqual([]);
  });
});

test('places are filled by name, and sentences within sentences are translated', () => {
  applyLanguage('de');
  const german = (sentence: Said | string): string => saidBy(de, sentence);
  const waits: Said = {
    code: 'waits_for',
    args: { place: 'A12', robot: 'robot-7' },
    text: 'waits for A12, held by robot-7',
  };
  expect(german(waits)).toBe('wartet auf A12; dort ist robot-7');
  expect(german(rack)).toBe('wartet auf Regal K1; es ist auf robot-2 (sendet keine Meldungen)');
  const waiting: Said = { code: 'robots_wait_for_it', args: { robots: 1400 }, text: '; 1400 robots wait for it' };
  const alarm: Said = {
    code: 'robot_silent',
    args: { robot: 'robot-3', waiting },
    text: 'robot-3 sends no reports; 1400 robots wait for it.',
  };
  expect(german(alarm)).toBe('robot-3 meldet sich nicht; 1.400 Roboter warten darauf.');
  expect(german({ ...alarm, args: { robot: 'robot-3', waiting: '' } })).toBe('robot-3 meldet sich nicht.');
});
test('names in a list have commas in between, sentences semicolons, as the language has them', () => {
  const paused: Said = { code: 'robots_paused', args: { robots: ['r1', 'r2'] }, text: 'paused by hand: r1, r2.' };
  applyLanguage('es');
  expect(saidBy(es, paused)).toBe('en pausa manual: r1, r2.');
  applyLanguage('zh');
  expect(saidBy(zh, paused)).toBe('已人工暂停：r1，r2。');
  const wrong = (field: string): Said => ({ code: 'field_is_wrong', args: { field, detail: silent }, text: '' });
  expect(saidBy(zh, { code: 'fields_are_wrong', args: { errors: [wrong('a'), wrong('b')] }, text: '' })).toBe(
    'a：没有发送遥测数据；b：没有发送遥测数据',
  );
});
test('what has no code or no translation stays English', () => {
  const old = 'waiting for A12, held by robot-7';
  expect([saidBy(de, old), saidBy(de, { text: old }), saidBy(de, { code: null, args: {}, text: old })]).toEqual([
    old,
    old,
    old,
  ]);
  expect(saidBy(de, { code: 'of_a_newer_server', args: {}, text: 'new' })).toBe('new');
  expect(saidBy({}, rack)).toBe(rack.text);
});
test('a message has a sentence, the text of one, or none; two say the same if their texts do', () => {
  expect([asSaid('old'), asSaid(silent), asSaid(null), asSaid({ code: 'x' })]).toEqual(['old', silent, null, null]);
  expect([
    sameSaid(silent, { ...silent }),
    sameSaid(silent, 'sends no telemetry'),
    sameSaid(silent, null),
    sameSaid(null, null),
  ]).toEqual([true, true, false, true]);
});
