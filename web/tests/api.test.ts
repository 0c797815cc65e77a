// Requests to the public API: files that a link cannot fetch, and the past, which cannot be changed.
import { afterEach, expect, test, vi } from 'vitest';
import { Api } from '../src/wire';

const answer = (body: string, status: number, type: string): void => {
  vi.stubGlobal(
    'fetch',
    vi.fn(() => Promise.resolve(new Response(body, { status, headers: { 'content-type': type } }))),
  );
};
afterEach(() => {
  vi.unstubAllGlobals();
  sessionStorage.clear();
});

test('no request bears a token: the browser adds the cookie of the session', async () => {
  const api = new Api();
  expect(api.encountersFile({ worker: 'w1' })).toBe('/v1/encounters?worker=w1&format=csv');
  answer('[]', 200, 'application/json');
  await api.kinds();
  const [path, { headers }] = vi.mocked(fetch).mock.calls[0] as [string, { headers: Record<string, string> }];
  expect([path, Object.keys(headers)]).toEqual(['/v1/kinds', ['Accept']]);
});
test('an answer 401 is told to the page', async () => {
  const api = new Api();
  api.onLocked = vi.fn();
  answer('{"title":"A token is needed"}', 401, 'application/problem+json');
  await api.map();
  expect(api.onLocked).toHaveBeenCalledOnce();
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
test('what is taken without a word back is done, whichever status says so', async () => {
  for (const status of [202, 204]) {
    vi.stubGlobal(
      'fetch',
      vi.fn(() => Promise.resolve(new Response(null, { status }))),
    );
    expect(await new Api().seenAt('w1', { x: 1, y: 2, accuracy_m: 0.2 })).toEqual({ kind: 'ok', value: null });
  }
});
