// What people are called: one name each, chosen by the right of whoever looks.
import { afterEach, expect, test } from 'vitest';
import { actDid, actDo, learnNames, learnNumbers, personName, said } from '../src/words';
import { ACTS } from '../src/wire';

const floor = [
  { id: 'w1', name: 'worker-7e31' },
  { id: 'w12', name: 'worker-99aa' },
];
const SENTENCES = [
  'worker-7e31 (w1) is lost: 3 robots wait.',
  'gives way to worker w1',
  'worker-7e31 is lost: robots stop around the last known position',
];
afterEach(() => {
  learnNumbers([]);
  learnNames(new Map());
});

test('whoever may see names sees them in every sentence, and nothing else for the same person', () => {
  learnNumbers(floor);
  learnNames(
    new Map([
      ['worker-7e31', 'picker-7'],
      ['worker-99aa', 'Anna Berg'],
    ]),
  );
  expect(SENTENCES.map(said)).toEqual([
    'picker-7 is lost: 3 robots wait.',
    'gives way to worker picker-7',
    'picker-7 is lost: robots stop around the last known position',
  ]);
  expect(['w1', 'w12', 'w2', 'robot-1'].map(personName)).toEqual(['picker-7', 'Anna Berg', 'w2', 'robot-1']);
});
test('all others see the pseudonym everywhere, and no number', () => {
  learnNumbers(floor);
  expect(SENTENCES.map(said)).toEqual([
    'worker-7e31 is lost: 3 robots wait.',
    'gives way to worker-7e31',
    'worker-7e31 is lost: robots stop around the last known position',
  ]);
  expect(personName('w1')).toBe('worker-7e31');
});
test('every act has a word for doing it and one for having done it', () => {
  for (const act of ACTS)
    expect(
      [actDo(act), actDid(act)].every((words) => words !== '' && !words.includes('act.')),
      act,
    ).toBe(true);
  expect([actDo('close_area'), actDid('close_area'), actDid('close_area', 'c1')]).toEqual([
    'Close the area',
    'Closed an area',
    'Closed an area: c1',
  ]);
});
