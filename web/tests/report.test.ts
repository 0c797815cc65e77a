// Of which stretch of time a report is.
import { expect, test } from 'vitest';
import { lateJobs, spanOf, typed } from '../src/report';
import type { Job } from '../src/wire';

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

test('late jobs are the deliveries done after their deadline in a time, page by page, the latest first', async () => {
  const job = (id: string, more: Partial<Job> = {}): Job => ({
    id,
    kind: 'deliver',
    rack: 'K1',
    station: 'P',
    node: null,
    robot: null,
    priority: 0,
    state: 'done',
    why: null,
    created: '2027-03-01T06:00:00Z',
    deadline: '2027-03-01T07:00:00Z',
    updated: '2027-03-01T07:10:00Z',
    ...more,
  });
  const pages = [
    { items: [job('j5'), job('j4', { updated: '2027-03-01T06:50:00Z' }), job('j3', { deadline: null })], next: 'j3' },
    {
      items: [
        job('j2', { updated: '2027-03-01T09:00:00Z' }),
        job('j1', { kind: 'go' }),
        job('j0', { updated: '2027-03-02T01:00:00Z' }),
      ],
      next: null,
    },
  ];
  const asked: unknown[] = [];
  const api = {
    jobsDone: async (since: string, cursor: string | null) => {
      asked.push([since, cursor]);
      return { kind: 'ok' as const, value: pages[asked.length - 1]! };
    },
  };
  const late = await lateJobs(api, '2027-03-01T00:00:00Z', '2027-03-02T00:00:00Z');
  expect([late?.jobs.map((j) => j.id), late?.complete]).toEqual([['j2', 'j5'], true]);
  expect(asked).toEqual([
    ['2027-03-01T00:00:00Z', null],
    ['2027-03-01T00:00:00Z', 'j3'],
  ]);
  const broken = { jobsDone: async () => ({ kind: 'unreachable' as const }) };
  expect(await lateJobs(broken, '2027-03-01T00:00:00Z', '2027-03-02T00:00:00Z')).toBeNull();
});
