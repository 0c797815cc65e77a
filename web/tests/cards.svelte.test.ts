// Cards as the page shows them, mounted as a browser would.
import { flushSync, mount, unmount } from 'svelte';
import { describe, expect, test } from 'vitest';
import type { Drawing, Picked } from '../src/floor';
import PickedCard from '../src/page/PickedCard.svelte';
import { Chances } from '../src/people';
import ClosureForm from '../src/places/ClosureForm.svelte';
import { Notices } from '../src/parts/notices.svelte';
import { EMPTY, reduce, type Answer, type FloorMap, type Mirror, type Point } from '../src/wire';
import { linkedRequests } from '../src/wire/linked';
import { robot, snapshot, worker } from './samples';

const map: FloorMap = {
  name: 'm',
  bounds: [0, 0, 9, 9],
  footprint_m: 1,
  lanes: [],
  stations: [],
  racks: [],
  obstacles: [],
  walkable: [],
  nodes: [{ id: 'N1', x: 1, y: 1, kind: 'storage' }],
};
const mirrorOf = (more: Parameters<typeof snapshot>[0]): Mirror => {
  const reduced = reduce(EMPTY, snapshot(more));
  if (reduced.kind === 'gap') throw new Error('a snapshot never leaves a gap');
  return reduced.mirror;
};

/** A card whose subject can be changed, with a server that refuses everything. */
function card(first: Picked, mirror: Mirror) {
  const refused = (): Promise<Answer<never>> =>
    Promise.resolve({ kind: 'refused', problem: { title: 'No.', status: 409 } });
  const api = {
    why: refused,
    pause: refused,
    resume: refused,
    maintain: refused,
    workAgain: refused,
    retire: refused,
    robot: refused,
    robotHistory: refused,
    linked: linkedRequests(refused),
    assign: refused,
    clear: refused,
    narrow: refused,
    worker: refused,
    station: refused,
    stationDetail: refused,
  };
  let drawing: Drawing | null = null;
  const props = $state({
    picked: first,
    mirror,
    map,
    source: { tense: 'now', api } as const,
    chances: new Chances(),
    notices: new Notices(),
    onDraw: (asked: Drawing) => {
      drawing = asked;
    },
    frame: { kept: 'chosen', lines: [], since: 'page', onCentre: () => {}, onClose: () => {} } as const,
    onPick: () => {},
    onJob: () => {},
  });
  const target = document.createElement('div');
  const mounted = mount(PickedCard, { target, props });
  flushSync();
  const button = (words: string): HTMLButtonElement | undefined =>
    [...target.querySelectorAll('button')].find((one) => one.textContent?.trim() === words);
  const pick = (picked: Picked): void => {
    props.picked = picked;
    flushSync();
  };
  return { target, draws: () => drawing!, button, pick, close: () => unmount(mounted) };
}

describe('the card of what is chosen', () => {
  test('a place that was chosen for one person is not offered for the next', async () => {
    const shown = card({ kind: 'worker', id: 'w1' }, mirrorOf({ workers: [worker('w1'), worker('w2')] }));
    shown.button('Send somewhere')!.click();
    shown.draws().onDone([[1, 1]]);
    flushSync();
    expect(shown.button('Send to N1')).toBeDefined();
    shown.pick({ kind: 'worker', id: 'w2' });
    expect(shown.target.querySelector('h2')!.textContent).toBe('w2');
    expect(shown.button('Send to N1')).toBeUndefined();
    expect(shown.button('Send somewhere')).toBeDefined();
    await shown.close();
  });
  test('what went wrong with one robot is not said of the next', async () => {
    const shown = card({ kind: 'robot', id: 'r1' }, mirrorOf({ robots: [robot('r1'), robot('r2')] }));
    shown.button('Pause this robot')!.click();
    await expect
      .poll(() => {
        flushSync();
        return shown.target.querySelector('[role=alert]')?.textContent;
      })
      .toBe('No.');
    shown.pick({ kind: 'robot', id: 'r2' });
    expect(shown.target.querySelector('[role=alert]')).toBeNull();
    await shown.close();
  });
});

describe('the form for a closed area', () => {
  test('an outline that nobody talks about any more is taken off the floor', async () => {
    let [drawing, sketch]: [Drawing | null, readonly Point[] | null] = [null, null];
    const draws = (): Drawing => drawing!;
    const target = document.createElement('div');
    const never = (): Promise<never> => new Promise(() => {});
    const mounted = mount(ClosureForm, {
      target,
      props: {
        closures: [],
        api: { close: never, previewClosure: never, reopen: never },
        notices: new Notices(),
        onPick: () => {},
        onDraw: (asked: Drawing) => {
          drawing = asked;
        },
        onSketch: (outline: readonly Point[] | null) => {
          sketch = outline;
        },
      },
    });
    flushSync();
    target.querySelector<HTMLButtonElement>('.draw button')!.click();
    draws().onDone([
      [0, 0],
      [1, 0],
      [1, 1],
    ]);
    flushSync();
    expect(sketch).toHaveLength(3);
    // The past is shown instead, for instance.
    await unmount(mounted);
    expect(sketch).toBeNull();
  });
});
