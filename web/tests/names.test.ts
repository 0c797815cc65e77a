// Names of people on the floor: for those who may see them, and for nobody else.
import { expect, test, vi } from 'vitest';
import { PeopleNames } from '../src/page/names';
import type { Me, Who } from '../src/session';
import { EMPTY, type Api, type Mirror, type Worker } from '../src/wire';

const worker = (id: string): Worker => ({ id, name: `worker-${id}` }) as Worker;
const floor = (...ids: string[]): Mirror => ({
  ...EMPTY,
  workers: { rows: ids.map(worker), at: new Map(ids.map((id, i) => [id, i])) },
});
const names = (mirror: Mirror): (string | null)[] => mirror.workers.rows.map((w) => w.name);
const admin = (): Promise<Who> =>
  Promise.resolve({ name: 'Eva', role: 'admin', subject: null, by: 'session', expires: null });
const settled = (): Promise<void> =>
  new Promise((done) => {
    setTimeout(done, 0);
  });

test('names take the place of pseudonyms when the server has told them, page by page', async () => {
  const pages = [
    { items: [{ id: 'w1', pseudonym: 'worker-w1', name: 'Anna' }], next: 'more' },
    { items: [{ id: 'w2', pseudonym: 'worker-w2', name: 'Ben' }], next: null },
  ];
  const people = vi.fn(() => Promise.resolve({ kind: 'ok' as const, value: pages.shift()! }));
  const known = new PeopleNames({ people } as unknown as Pick<Api, 'people'>, admin, () => 0);
  const mirror = floor('w1', 'w2', 'w3');
  expect(names(known.shown(mirror))).toEqual(['worker-w1', 'worker-w2', 'worker-w3']);
  await settled();
  expect(names(known.shown(mirror))).toEqual(['Anna', 'Ben', 'worker-w3']);
  expect(known.shown(mirror).workers).toBe(known.shown({ ...mirror, time_s: 9 }).workers);
  expect(people).toHaveBeenCalledTimes(2);
});

test('a server that does not tell names is asked once, one that cannot be reached again', async () => {
  const answers = [{ kind: 'unreachable' }, { kind: 'refused', problem: { title: 'no', status: 403 } }];
  const people = vi.fn(() => Promise.resolve(answers.shift()!));
  let now = 0;
  const known = new PeopleNames({ people } as unknown as Pick<Api, 'people'>, admin, () => now);
  for (let i = 0; i < 5; i++) {
    expect(names(known.shown(floor('w1')))).toEqual(['worker-w1']);
    await settled();
    now += 100_000;
  }
  expect(people).toHaveBeenCalledTimes(2);
});

test('an empty floor asks for no names', () => {
  const people = vi.fn();
  new PeopleNames({ people } as unknown as Pick<Api, 'people'>, admin).shown(floor());
  expect(people).not.toHaveBeenCalled();
});

test('names are asked for by those who may see them alone, and by nobody of whom that is not known', async () => {
  const whos: Who[] = ['unreachable', 'nobody', { ...((await admin()) as Me), role: 'viewer' }, await admin()];
  const [people, who] = [vi.fn(), vi.fn(() => Promise.resolve(whos.shift()!))];
  let now = 0;
  const known = new PeopleNames({ people } as unknown as Pick<Api, 'people'>, who, () => now);
  for (let i = 0; i < 5; i++) {
    expect(names(known.shown(floor('w1')))).toEqual(['worker-w1']);
    await settled();
    now += 100_000;
  }
  // A viewer stays one.
  expect(who).toHaveBeenCalledTimes(3);
  expect(people).not.toHaveBeenCalled();
});

test('another worker who has the id of one who was erased does not get that name in a recording', async () => {
  const people = vi.fn(() =>
    Promise.resolve({
      kind: 'ok' as const,
      value: { items: [{ id: 'w1', pseudonym: 'worker-new', name: 'Ben' }], next: null },
    }),
  );
  const known = new PeopleNames({ people } as unknown as Pick<Api, 'people'>, admin, () => 0);
  known.shown(floor('w1'));
  await settled();
  expect(names(known.shown(floor('w1')))).toEqual(['worker-w1']);
});
