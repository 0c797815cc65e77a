// What the story of a robot and of a worker says of a replan and of a goal.
import './english';
import { describe, expect, test } from 'vitest';
import { Story } from '../src/cards/changes';
import { eventWords } from '../src/robots/life.svelte';
import { EMPTY, type Mirror, type Replanned, type Robot, type Worker } from '../src/wire';
import { robot, worker } from './samples';

const mirror = (version: number, robots: Robot[], workers: Worker[]): Mirror => ({
  ...EMPTY,
  version,
  time_s: version,
  robots: { ...EMPTY.robots, rows: robots },
  workers: { ...EMPTY.workers, rows: workers },
});
const because = (kind: Replanned['kind'], id: string | null, second: number): Replanned => ({
  kind,
  id,
  at: `2027-01-31T12:00:0${second}Z`,
});

describe('the story', () => {
  test('says because of whom a robot took another way, once for each time', () => {
    const story = new Story();
    const of = (replanned: Replanned | null): Robot => robot('robot-1', { replanned });
    const all = [
      null,
      because('worker', 'w1', 1),
      because('worker', 'w1', 1),
      because('closure', 'c3', 2),
      because('worker', 'w1', 3),
    ];
    all.forEach((replanned, i) => story.note(mirror(i + 1, [of(replanned)], [])));
    expect(story.of({ kind: 'robot', id: 'robot-1' }).map((line) => line.text)).toEqual([
      'took another way because of worker w1',
      'took another way because of closed area c3',
      'took another way because of worker w1',
    ]);
  });
  test('says where a worker is probably going when that changes, by the name of the place', () => {
    const story = new Story();
    story.places = [{ id: 'G3-4', x: 3, y: 4, kind: 'storage' } as unknown as Story['places'][number]];
    const at = (x: number, y: number, p: number): Worker => worker('w1', { goals: [{ x, y, p }] });
    [at(3, 4, 0.4), at(3, 4, 0.7), at(3, 4, 0.9), at(9, 9, 0.8)].forEach((w, i) => story.note(mirror(i + 1, [], [w])));
    expect(story.of({ kind: 'worker', id: 'w1' }).map((line) => line.text)).toEqual([
      'probably going to 9.0, 9.0 (80 %)',
      'probably going to G3-4 (70 %)',
    ]);
  });
  test('a robot history names the cause and both ways', () => {
    const event = {
      at: '',
      kind: 'replan',
      id: null,
      what: 'worker',
      text: null,
      ended: null,
      cause: { kind: 'worker', id: 'w1' },
      was: ['A', 'B', 'C', 'D', 'E', 'F'],
      now: ['A', 'X'],
    } as const;
    expect(eventWords({ ...event, was: [...event.was], now: [...event.now] })).toBe(
      'took another way because of worker w1: A B C D E … → A X',
    );
  });
});
