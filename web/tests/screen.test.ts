// Which of present and past is on the screen.
import { expect, test } from 'vitest';
import { Live, type LiveApi } from '../src/page/live.svelte';
import { Screen } from '../src/page/screen.svelte';
import { FileRecording } from '../src/replay/recording';
import { readReel } from '../src/replay/frames';
import { EMPTY, type FloorMap, type Mirror } from '../src/wire';
import { robot, snapshot } from './samples';

const map: FloorMap = {
  name: 'then',
  bounds: [0, 0, 9, 9],
  footprint_m: 1,
  nodes: [],
  lanes: [],
  stations: [],
  racks: [],
  obstacles: [],
  walkable: [],
};
const recording = (): FileRecording =>
  new FileRecording(
    readReel([
      JSON.stringify({ reel: 1, name: 'lab', start: null, map }),
      `{"at":0,"key":${JSON.stringify(snapshot({ robots: [robot('r1')] }))}}`,
    ]),
  );
/** A server that never answers. */
const silent = {
  map: () => new Promise(() => {}),
  kinds: () => new Promise(() => {}),
  openLive: () => ({ close: () => {} }),
} as unknown as LiveApi;
const at = (time_s: number): Mirror => ({ ...EMPTY, version: time_s, time_s });

test('the floor sees one of present and past, and the present again from where it is by then', () => {
  const [tenses, seen]: [string[], [number, string][]] = [[], []];
  const live = new Live(silent);
  const screen = new Screen(live, (tense) => {
    tenses.push(tense);
  });
  screen.watch((mirror, how) => {
    seen.push([mirror.time_s, how]);
  });
  live.onMirror(at(1), 'glide');
  expect([screen.link.kind, screen.map.kind]).toEqual(['connecting', 'loading']);

  screen.play(recording());
  live.onMirror(at(2), 'glide');
  expect([screen.link.kind, screen.map]).toEqual(['replay', { kind: 'ready', value: map }]);

  screen.goLive();
  live.onMirror(at(3), 'glide');
  // The link has shown nothing of its own yet, so the jump is to an empty floor.
  expect(seen).toEqual([
    [1, 'glide'],
    [0, 'jump'],
    [3, 'glide'],
  ]);
  expect([screen.replay, screen.map.kind, tenses]).toEqual([null, 'loading', ['then', 'now']]);
});
test('what was remembered of the present is not said of the past, nor the other way round', () => {
  const screen = new Screen(new Live(silent), () => {});
  const { story } = screen.memory;
  screen.play(recording());
  const { story: then } = screen.memory;
  screen.goLive();
  expect(new Set([story, then, screen.memory.story]).size).toBe(3);
});
test('who left the floor hears of nothing, and does not silence who came after', () => {
  const live = new Live(silent);
  const screen = new Screen(live, () => {});
  const [first, second]: [number[], number[]] = [[], []];
  const leave = screen.watch((mirror) => {
    first.push(mirror.time_s);
  });
  screen.watch((mirror) => {
    second.push(mirror.time_s);
  });
  leave();
  live.onMirror(at(4), 'glide');
  expect([first, second]).toEqual([[], [4]]);
});
