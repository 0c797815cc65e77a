// Of which stretch of time a report is.
import { expect, test } from 'vitest';
import { spanOf, typed } from '../src/report';

const now = new Date(2027, 2, 1, 14, 30);
const none = { from: '', to: '' };

test('days are those of the reader, and end at midnight', () => {
  expect(spanOf('today', now, none)).toEqual({ from: new Date(2027, 2, 1), to: now });
  expect(spanOf('yesterday', now, none)).toEqual({ from: new Date(2027, 1, 28), to: new Date(2027, 2, 1) });
  expect(spanOf('eight', now, none)).toEqual({ from: new Date(2027, 2, 1, 6, 30), to: now });
});

test('what is typed is taken as it is, and nothing where it is no time', () => {
  const own = { from: typed(new Date(2027, 0, 9, 6, 5)), to: '2027-01-09T14:00' };
  expect(own.from).toBe('2027-01-09T06:05');
  expect(spanOf('own', now, own)).toEqual({ from: new Date(2027, 0, 9, 6, 5), to: new Date(2027, 0, 9, 14) });
  expect(spanOf('own', now, { ...own, to: '' })).toBeNull();
});
