// Requests to the public API: files that a link cannot fetch, and the past, which cannot be changed.
import { afterEach, expect, test, vi } from 'vitest';
import { LiveEncounters } from '../src/encounters/live.svelte';
import { Api } from '../src/wire';

const answer = (body: string, status: number, type: string): void => {
  vi.stubGlobal('fetch', vi.fn(() => Promise.resolve(new Response(body, { status, headers: { 'content-type': type } }))));
};
afterEach(() => {
  vi.unstubAllGlobals();
  sessionStorage.clear();
});

test('without a token the table of encounters is a plain link; with one it is fetched as a file', async () => {
  const api = new Api();
  expect(api.encountersFile({ worker: 'w1' })).toEqual({ href: '/v1/encounters?worker=w1&format=csv', fetch: null });
  api.token = 'secret';
  answer('id,worker\n', 200, 'text/csv; charset=utf-8');
  const got = await api.encountersFile({}).fetch!();
  expect(got.kind === 'ok' && (await got.value.text())).toBe('id,worker\n');
  const [path, { headers }] = vi.mocked(fetch).mock.calls[0] as [string, { headers: Record<string, string> }];
  expect([path, headers['Authorization']]).toEqual(['/v1/encounters?format=csv', 'Bearer secret']);
});
test('a table of encounters that does not come says so', async () => {
  const api = new Api();
  api.token = 'secret';
  answer('{"title":"No","detail":"The disk is full."}', 503, 'application/problem+json');
  const shown = new LiveEncounters(api);
  shown.csv!.take(new MouseEvent('click', { cancelable: true }));
  await expect.poll(() => shown.wrong).toBe('The disk is full.');
});
test('while the past is shown, only the stop of all robots is sent to the present', async () => {
  const api = new Api();
  api.shows = 'past';
  answer('{}', 200, 'application/json');
  for (const sent of [api.resumeFleet(), api.pause('robot-1'), api.evacuate()]) {
    expect(await sent).toMatchObject({ kind: 'refused', problem: { status: 409 } });
  }
  expect(fetch).not.toHaveBeenCalled();
  expect((await api.stopFleet()).kind).toBe('ok');
  expect(vi.mocked(fetch).mock.calls[0]![0]).toBe('/v1/fleet/stop');
  expect((await api.map()).kind).toBe('ok');
});
