// Reels: what is read of a file, whether seeking and playing come to the same, and what is said of what cannot be read.
import { describe, expect, test } from 'vitest';
import { FileRecording, ServerRecording } from '../src/replay/recording';
import { snap } from '../src/replay/spans';
import type { Api } from '../src/wire/api';
import { readReel } from '../src/replay/frames';
import { Replay } from '../src/replay/replay.svelte';
import { replayRoute } from '../src/replay/route';
import { seek, type Shown } from '../src/replay/seek';
import { subjectOf } from '../src/replay/subject';
import { linesOf } from '../src/replay/unpack';
import { EMPTY, reduce, type Mark } from '../src/wire';
import { HeldThen } from '../src/timelines/held';
import { jobsUnderWay } from '../src/jobs/waited';
import { chainOf } from '../src/why/chain';
import { moment, momentOf } from '../src/words/moments';
import type { FloorMap, Strip } from '../src/wire';
import { robot, snapshot } from './samples';

const map: FloorMap = {
  name: 'm',
  bounds: [0, 0, 9, 9],
  footprint_m: 1,
  nodes: [],
  lanes: [],
  stations: [],
  racks: [],
  obstacles: [],
  walkable: [],
};
const header = (more: object = {}) => JSON.stringify({ reel: 1, name: 'lab', start: null, map, ...more });

/** A robot that goes 100 mm along x five times a second, with a key frame every two seconds. */
function reelLines(seconds: number): string[] {
  const lines = [header()];
  for (let i = 0; i <= seconds * 5; i++) {
    const [at, x] = [i / 5, i / 10];
    const patch = { type: 'patch', base: i, version: i + 1, time_s: at, moves: [0, 100, 0] };
    if (i > 0) lines.push(`{"at":${at},"patch":${JSON.stringify(patch)}}`);
    const whole = snapshot({ version: i + 1, time_s: at, robots: [robot('r1', { x })] });
    if (i % 10 === 0) lines.push(`{"at":${at},"key":${JSON.stringify(whole)}}`);
    if (i === 7)
      lines.push(
        '{"at":1.4,"mark":{"at_s":1.4,"kind":"deviation","words":"w1 left the path","who":["w1"],"place":null}}',
      );
  }
  return lines;
}
const place = (shown: Shown | null) => shown?.mirror.robots.rows[0]?.x;

describe('a bookmark', () => {
  const mark = (kind: Mark['kind'], who: string[]): Mark => ({ at_s: 1, kind, words: '', who, place: null });
  const reduced = reduce(EMPTY, snapshot({ robots: [robot('r1', {})] }));
  const shown = reduced.kind === 'gap' ? EMPTY : reduced.mirror;
  test('is about the worker, also where the moment that is shown does not have them yet', () => {
    expect(subjectOf(mark('deviation', ['w1']), EMPTY)).toEqual({ kind: 'worker', id: 'w1' });
    expect(subjectOf(mark('encounter', ['w1', 'r1']), shown)).toEqual({ kind: 'worker', id: 'w1' });
    expect(subjectOf(mark('replan', ['r1', 'w1']), EMPTY)).toEqual({ kind: 'robot', id: 'r1' });
    expect(subjectOf(mark('failure', ['r1']), EMPTY)).toEqual({ kind: 'robot', id: 'r1' });
  });
  test('that is an alarm picks whom the floor has, and nothing else', () => {
    expect(subjectOf(mark('alarm', ['r1']), shown)).toEqual({ kind: 'robot', id: 'r1' });
    expect(subjectOf(mark('alarm', ['J7']), shown)).toBeNull();
    expect(subjectOf(mark('closure', []), shown)).toBeNull();
  });
});

describe('a reel', () => {
  test('who goes on to the next bookmark sees how it came about, and is never taken back', () => {
    const replay = new Replay(new FileRecording(readReel(reelLines(40))), 0, null, () => {});
    const mark = (at_s: number): Mark => ({ at_s, kind: 'replan', words: '', who: [], place: null });
    const gone: number[] = [];
    for (const at of [30, 32, 33, 20]) {
      replay.goTo(mark(at));
      gone.push(replay.t);
    }
    expect(gone).toEqual([25, 27, 28, 15]);
    replay.seek(28);
    replay.goTo(mark(30));
    expect(replay.t).toBe(28);
  });
  test('seeking to a moment and playing up to it come to the same', () => {
    const { frames } = readReel(reelLines(20));
    let played: Shown | null = null;
    for (let t = 0; t <= 20; t += 0.07) {
      played = seek(frames, t, played);
      expect(place(played)).toBe(place(seek(frames, t, null)));
    }
    expect(place(seek(frames, 13.4, null))).toBeCloseTo(6.7);
  });

  test('playing glides over key frames, and keeps the order of rows', () => {
    const { frames } = readReel(reelLines(5));
    const before = seek(frames, 1.8, null);
    const after = seek(frames, 2.2, before);
    expect(after?.how).toBe('glide');
    expect(after?.mirror.robots.at).toBe(before?.mirror.robots.at);
    expect(seek(frames, 1, after)?.how).toBe('jump');
    expect(seek(frames, 1, seek(frames, 1.05, null))?.at).toBe(1);
  });

  test('before its beginning the first frame is shown, behind its end the last', () => {
    const { frames } = readReel(reelLines(3));
    expect(place(seek(frames, -5, null))).toBe(0);
    expect(place(seek(frames, 99, null))).toBe(1.5);
    const end = seek(frames, 99, null);
    expect(seek(frames, 120, end)).toBe(end);
  });

  test('a line that was cut off is left out, and the rest is shown', () => {
    const lines = reelLines(4);
    const cut = [...lines.slice(0, -1), lines.at(-1)!.slice(0, 40)];
    expect(readReel(cut).frames.length).toBe(readReel(lines).frames.length - 1);
  });

  test('bookmarks come in order, and unknown kinds are passed over', () => {
    const lines = [
      ...reelLines(2),
      '{"at":0.2,"mark":{"at_s":0.2,"kind":"stop","words":"","who":[],"place":null}}',
      '{"at":0.2,"mark":{"kind":"comet"}}',
    ];
    expect(readReel(lines).marks.map((m) => m.kind)).toEqual(['stop', 'deviation']);
  });

  test.each([
    ['nothing', [], 'This is not a recording'],
    ['another text', ['hello'], 'This is not a recording'],
    ['a recording', ['{"giveway_recording":1}'], '--reel OUT.reel'],
    ['a newer format', [header({ reel: 2 })], 'format 2'],
    ['only a header', [header()], 'cut off too soon'],
  ])('%s is refused in words', (_, lines, words) => {
    expect(() => readReel(lines)).toThrow(words);
  });

  test('a packed file that ends too soon gives what it has', async () => {
    const text = reelLines(60).join('\n');
    const packed = new Blob([text]).stream().pipeThrough(new CompressionStream('gzip'));
    const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
    const whole = await linesOf(new Blob([bytes]));
    expect(whole.length).toBe(reelLines(60).length - 1);
    const part = await linesOf(new Blob([bytes.slice(0, bytes.length / 2)]));
    expect(part.length).toBeGreaterThan(5);
    expect(part.length).toBeLessThan(whole.length);
    expect(whole.slice(0, part.length)).toEqual(part);
    expect(await linesOf(new Blob([`${text}\n`]))).toEqual(text.split('\n'));
  });

  test('a recording without a map is refused', () => {
    expect(() => new FileRecording(readReel([header({ map: null }), ...reelLines(2).slice(1)]))).toThrow('no map');
  });

  test('a moment without a frame becomes the next one with one', () => {
    const recording = {
      spans: [
        { from_s: 0, to_s: 10 },
        { from_s: 100, to_s: 200 },
      ],
    };
    expect([-3, 5, 50, 150, 900].map((t) => snap(recording, t))).toEqual([0, 5, 100, 150, 200]);
  });
});

describe('the past of a server', () => {
  test('is asked for by the minute, and again where it was still being written', async () => {
    let [end, now] = [90, 0];
    const settled = () => new Promise((done) => setTimeout(done, 20));
    const asked: number[][] = [];
    const api = {
      past: async () => ({
        kind: 'ok',
        value: {
          start: '2027-01-31T12:00:00Z',
          now_s: end,
          recording: false,
          spans: [{ from_s: 0, to_s: end }],
          bookmarks: [],
        },
      }),
      reel: async (from: number, to: number) => {
        asked.push([from, to]);
        const lines = reelLines(end).filter((line) => {
          const at = Number(/^\{"at":([\d.]+)/.exec(line)?.[1] ?? -1);
          return at < 0 || (at >= from && at <= to);
        });
        return { kind: 'ok', value: new Blob([`${lines.join('\n')}\n`]) };
      },
    } as unknown as Api;
    const recording = (await ServerRecording.open(api, () => now)) as ServerRecording;
    expect(recording.start).toBe(Date.UTC(2027, 0, 31, 12) / 1_000);
    expect(recording.frames(70)).toBeNull();
    await settled();
    expect(place(seek(recording.frames(70)!, 70, null))).toBeCloseTo(35);
    recording.frames(80);
    expect(asked).toEqual([[60, 120.5]]);
    end = 110;
    await recording.refresh();
    now += 3_000;
    recording.frames(105);
    await settled();
    expect(place(seek(recording.frames(105)!, 105, null))).toBeCloseTo(52.5);

    asked.length = 0;
    recording.between(30, 200);
    expect(asked, 'the minute before is not here yet; there is none after the end').toEqual([[0, 60.5]]);
    await settled();
    const joined = recording.between(30, 200);
    expect(recording.between(30, 200), 'nothing came meanwhile').toBe(joined);
    const times = joined.map((frame) => frame.at);
    expect(times).toEqual([...times].sort((a, b) => a - b));
    expect([times[0], times.at(-1)]).toEqual([0, 110]);
    let shown: Shown | null = null;
    for (const t of [58, 59.8, 60, 60.4, 60.6, 61, 109]) {
      shown = seek(joined, t, shown);
      expect(place(shown), `at ${t}`).toBeCloseTo(t / 2);
    }
  });
});

describe('addresses and times', () => {
  test('the address says from when to when', () => {
    expect(replayRoute('#replay?from=120&to=180.5')).toEqual({ from: 120, to: 180.5 });
    expect(replayRoute('#replay?from=-30')).toEqual({ from: -30, to: null });
    expect(replayRoute('#replay')).toEqual({ from: null, to: null });
    expect(replayRoute('#replay?from=soon')).toEqual({ from: null, to: null });
    expect(replayRoute('#jobs')).toBeNull();
  });

  test('a time of day is the latest one before the end', () => {
    const start = new Date(2027, 0, 31, 12, 0, 0).getTime() / 1_000;
    expect(momentOf(start, 7_200, '12:30')).toBe(1_800);
    expect(momentOf(start, 7_200, '14:00:01')).toBe(7_201 - 86_400);
    expect(momentOf(start, 7_200, 'noon')).toBeNull();
    expect(moment(start, 1_800)).toBe('12:30:00');
    expect(moment(null, 1_800)).toBe('00:30:00');
  });
});

describe('what frames say beyond the floor', () => {
  const places = [0, 1, 2].map((i) => ({ id: `N${i}`, x: i, y: 0, kind: 'aisle' as const }));
  const withPlaces = { ...map, nodes: places };
  /** One robot goes from place to place, one second each, and is promised the next; pictures five times a second. */
  function goingReel(): string[] {
    const lines = [header()];
    for (let i = 0; i <= 15; i++) {
      const on = Math.min(2, Math.floor(i / 5));
      const robots = [robot('r1', { granted: [on], held: on < 2 ? [on, on + 1] : [on] })];
      const whole = JSON.stringify(snapshot({ version: i + 1, time_s: i / 5, robots }));
      const patch = {
        type: 'patch',
        base: i,
        version: i + 1,
        time_s: i / 5,
        robots: [{ id: 'r1', granted: [on], held: on < 2 ? [on, on + 1] : [on] }],
      };
      if (i > 0) lines.push(`{"at":${i / 5},"patch":${JSON.stringify(patch)}}`);
      if (i % 10 === 0) lines.push(`{"at":${i / 5},"key":${whole}}`);
    }
    return lines;
  }

  const AREA = [0.5, -1, 2.5, 1];
  /** All is read in one slice, also on a busy machine. */
  const still = (): number => 0;
  const held = (strips: Strip[], id: string) =>
    strips
      .find((s) => s.id === id)
      ?.holds.map((h) => [h.by, h.granted, Math.round(h.from_s * 10) / 10, Math.round((h.to_s ?? 0) * 10) / 10]);

  test('who held a place from when to when', () => {
    const { nodes, whole } = new HeldThen().around(readReel(goingReel()).frames, withPlaces, AREA, 1, 60, still);
    expect(whole).toBe(true);
    expect(nodes.map((s) => s.id)).toEqual(['N1', 'N2']);
    expect(held(nodes, 'N1')).toEqual([
      ['r1', false, -0.8, -0.2],
      ['r1', true, 0, 0.8],
    ]);
    expect(held(nodes, 'N2')).toEqual([
      ['r1', false, 0, 0.8],
      ['r1', true, 1, 2],
    ]);
  });

  test('going on says the same as beginning anew, and so does going back', () => {
    const { frames } = readReel(goingReel());
    const reader = new HeldThen();
    for (const t of [0.4, 0.6, 1.6, 5.5, 6.3, 1, 2.2]) {
      const anew = new HeldThen().around(frames, withPlaces, AREA, t, 1, still);
      expect(reader.around(frames, withPlaces, AREA, t, 1, still), `at ${t}`).toEqual(anew);
    }
  });

  test('a large past is read in slices, and what was read is shown meanwhile', () => {
    let ms = 0;
    const slow = () => (ms += 15);
    const reader = new HeldThen();
    const { frames } = readReel(goingReel());
    const seen = [];
    for (let asked = 0; asked < 20; asked += 1) seen.push(reader.around(frames, withPlaces, AREA, 1, 60, slow));
    expect(seen[0]!.whole).toBe(false);
    expect(held(seen[0]!.nodes, 'N2'), 'not come to yet').toEqual([]);
    expect(seen.at(-1)).toEqual(new HeldThen().around(frames, withPlaces, AREA, 1, 60, still));
  });

  test('a chain leads from who waits to the root, and ends where it would turn round', () => {
    const said = (robots: ReturnType<typeof robot>[]) =>
      seek(readReel([header(), `{"at":0,"key":${JSON.stringify(snapshot({ robots }))}}`]).frames, 0, null)!.mirror;
    const mirror = said([
      robot('r-1', { why: 'waits for N2, held by r-2' }),
      robot('r-2', { why: 'waits for N3, held by r-3' }),
      robot('r-3', { doing: 'picking' }),
    ]);
    expect(chainOf(mirror, 'r-1').map((l) => l.who)).toEqual(['r-1', 'r-2', 'r-3']);
    expect(chainOf(mirror, 'r-3')).toEqual([]);
    const round = said([
      robot('r-1', { why: 'waits for N2, held by r-2' }),
      robot('r-2', { why: 'waits for N1, held by r-1' }),
    ]);
    expect(chainOf(round, 'r-1').map((l) => l.who)).toEqual(['r-1', 'r-2']);
  });

  test('jobs under way are in the order of their numbers', () => {
    const robots = [robot('r-1', { job: 'job-10' }), robot('r-2'), robot('r-3', { job: 'job-9' })];
    const mirror = seek(
      readReel([header(), `{"at":0,"key":${JSON.stringify(snapshot({ robots }))}}`]).frames,
      0,
      null,
    )!.mirror;
    expect(jobsUnderWay(mirror).map((r) => r.job)).toEqual(['job-9', 'job-10']);
  });
});
