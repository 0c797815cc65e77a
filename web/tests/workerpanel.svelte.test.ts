// The panel of a person names the robots that went another way for them, and no others.
import { flushSync, mount, unmount } from 'svelte';
import { expect, test } from 'vitest';
import WorkerPanel from '../src/people/WorkerPanel.svelte';
import { EMPTY, reduce, type Replanned } from '../src/wire';
import { robot, snapshot, worker } from './samples';

const because = (kind: Replanned['kind'], id: string | null): Replanned => ({ kind, id, at: '1970-01-01T00:00:00Z' });

test('robots that went another way for a person are named, in a recording as well as now', () => {
  const robots = [
    robot('r1', { replanned: because('worker', 'w1') }),
    robot('r2', { replanned: because('worker', 'w2') }),
    robot('r3', { replanned: because('closure', 'w1') }),
    robot('r4'),
    robot('r5', { replanned: because('worker', 'w1') }),
  ];
  const reduced = reduce(EMPTY, snapshot({ robots, workers: [worker('w1'), worker('w3')] }));
  if (reduced.kind === 'gap') throw new Error('a snapshot never leaves a gap');
  const shown = (id: string): string => {
    const target = document.createElement('div');
    const frame = { kept: 'chosen', lines: [], since: 'replay', onCentre: () => {}, onClose: () => {} } as const;
    const source = { tense: 'then', replay: {} } as never;
    const mounted = mount(WorkerPanel, {
      target,
      props: { id, mirror: reduced.mirror, places: [], since: null, samples: [], frame, source, onDraw: () => {} },
    });
    flushSync();
    const text = target.textContent ?? '';
    void unmount(mounted);
    return text;
  };
  expect(shown('w1')).toMatch(/another way for this person: r1,? (and )?r5/);
  expect(shown('w3')).not.toContain('another way');
});
