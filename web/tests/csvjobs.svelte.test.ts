// Many jobs from a table: one request for all of them, and what became of each beside its line.
import { flushSync, mount, unmount } from 'svelte';
import { describe, expect, test } from 'vitest';
import CsvJobs from '../src/jobs/CsvJobs.svelte';
import type { Answer, FloorMap, Job, JobBatch, JobPage, NewJob } from '../src/wire';

const map: FloorMap = {
  name: 'm',
  bounds: [0, 0, 9, 9],
  footprint_m: 1,
  lanes: [],
  obstacles: [],
  walkable: [],
  nodes: [{ id: 'N1', x: 1, y: 1, kind: 'storage' }],
  stations: [{ id: 'W1', node: 0, queue: [] }],
  racks: [
    { id: 'K1', node: 0 },
    { id: 'K2', node: 0 },
  ],
} as unknown as FloorMap;
const TABLE = 'kind,rack,station\ndeliver,K1,W1\ndeliver,K9,W1\nreturn,K2,\n';

/** The dialog with this table in it, and a server that answers so, one answer after the other. */
function dialog(answers: Answer<JobBatch>[], table = TABLE, open: JobPage[] = []) {
  const asked: { key: string; job: NewJob }[][] = [];
  const submitted: string[] = [];
  const looked: (string | null)[] = [];
  const api = {
    submitAll: (jobs: readonly { key: string; job: NewJob }[]) => {
      asked.push([...jobs]);
      return Promise.resolve(answers.shift()!);
    },
    jobsOpen: (cursor: string | null): Promise<Answer<JobPage>> => {
      looked.push(cursor);
      return Promise.resolve({ kind: 'ok', value: open[looked.length - 1] ?? { items: [], next: null } });
    },
    job: (id: string): Promise<Answer<Job>> => Promise.resolve({ kind: 'ok', value: { id } as Job }),
  };
  const target = document.createElement('div');
  const mounted = mount(CsvJobs, {
    target,
    props: {
      map,
      robots: [],
      api,
      onSubmitted: (job: Job) => {
        submitted.push(job.id);
      },
    },
  });
  const field = target.querySelector('textarea')!;
  field.value = table;
  field.dispatchEvent(new Event('input', { bubbles: true }));
  flushSync();
  const press = async (button: HTMLButtonElement): Promise<void> => {
    button.click();
    for (let i = 0; i < 20; i++) await Promise.resolve();
    flushSync();
  };
  const send = (): Promise<void> => press(target.querySelector<HTMLButtonElement>('button.main')!);
  const question = (): string => target.querySelector('[role="alert"]')?.textContent ?? '';
  const button = (text: string): HTMLButtonElement =>
    [...target.querySelectorAll('button')].find((b) => b.textContent!.includes(text))!;
  const line = (n: number): string =>
    target.querySelector(`tr[data-line="${n}"] td:last-child`)!.textContent!.replace(/\s+/g, ' ').trim();
  return { asked, submitted, looked, send, press, question, button, line, close: () => unmount(mounted) };
}

describe('many jobs from a table', () => {
  test('what is right goes in one request, and each line says what became of it', async () => {
    const problem = { title: 'A limit is reached', status: 429, detail: 'too many jobs are open' };
    const results = [
      { id: 'j7', new: true, problem: null },
      { id: null, new: false, problem },
    ];
    const d = dialog([{ kind: 'ok', value: { accepted: 1, refused: 1, results } }]);
    await d.send();
    expect(d.asked.map((jobs) => jobs.map((one) => one.job.rack))).toEqual([['K1', 'K2']]);
    expect([d.line(2), d.line(3), d.line(4)]).toEqual([
      'accepted as j7',
      'There is no rack “K9”.',
      'too many jobs are open',
    ]);
    expect(d.submitted).toEqual(['j7']);
    await d.close();
  });
  test('what is sent again after a lost answer has the same keys; what was accepted is not sent again', async () => {
    const ok = { id: 'j7', new: false, problem: null };
    const no = { id: null, new: false, problem: { title: 'No', status: 429, detail: 'later' } };
    const d = dialog([
      { kind: 'unreachable' },
      { kind: 'ok', value: { accepted: 1, refused: 1, results: [ok, no] } },
      { kind: 'ok', value: { accepted: 1, refused: 0, results: [{ ...ok, id: 'j8' }] } },
    ]);
    for (let i = 0; i < 3; i++) await d.send();
    const keys = d.asked.map((jobs) => jobs.map((one) => one.key));
    expect(keys[1]).toEqual(keys[0]);
    expect(keys[2]).toEqual([keys[0]![1]]);
    expect([d.line(2), d.line(4)]).toEqual(['accepted as j7', 'accepted as j8']);
    await d.close();
  });
  const AGAIN = 'kind,rack,station,reference,key\ndeliver,K1,W1,order-4711,\ndeliver,K2,W1,order-4712,\n';
  const page = (id: string, reference: string, next: string | null = null) =>
    ({ items: [{ id, reference } as Job], next }) as JobPage;
  const done = (...ids: string[]): Answer<JobBatch> => ({
    kind: 'ok',
    value: { accepted: ids.length, refused: 0, results: ids.map((id) => ({ id, new: true, problem: null })) },
  });
  test('a reference that is open already is asked about before anything is sent, and the others go alone', async () => {
    const d = dialog([done('j9')], AGAIN, [page('j2', 'another', 'more'), page('j3', 'order-4711')]);
    await d.send();
    expect([d.asked.length, d.looked]).toEqual([0, [null, 'more']]);
    expect(d.question()).toContain('“order-4711” is open already: j3.');
    await d.press(d.button('only the other 1'));
    expect(d.asked.map((jobs) => jobs.map((one) => one.job.reference))).toEqual([['order-4712']]);
    await d.close();
  });
  test('who says so gets a second job for a reference', async () => {
    const d = dialog([done('j9', 'j10')], AGAIN, [page('j3', 'order-4711')]);
    await d.send();
    await d.press(d.button('all the same'));
    expect(d.asked.map((jobs) => jobs.length)).toEqual([2]);
    await d.close();
  });
  test('a key of the table goes with the job, and answers the question', async () => {
    const d = dialog([done('j9')], 'kind,rack,station,reference,key\ndeliver,K1,W1,order-4711,k-1\n', [
      page('j3', 'order-4711'),
    ]);
    await d.send();
    expect([d.looked.length, d.asked.map((jobs) => jobs.map((one) => one.key))]).toEqual([0, [['k-1']]]);
    await d.close();
  });
});
