// Signing in: the way back, and a token that an earlier version kept.
import { afterEach, expect, test, vi } from 'vitest';
import { adoptToken, signIn, signInAt } from '../src/session';
import { sentBackWords } from '../src/session/refusal';
import { providerName, sentBackIn, wayBack, wayToProvider } from '../src/session/session';

const answers = (...list: (readonly [number, object])[]): void => {
  const all = list.map(([status, body]) => new Response(JSON.stringify(body), { status }));
  vi.stubGlobal(
    'fetch',
    vi.fn(() => Promise.resolve(all.shift()!)),
  );
};
afterEach(() => {
  vi.unstubAllGlobals();
  sessionStorage.clear();
});

test('the way to the page that signs in leads back to where one was', () => {
  const at = signInAt({ pathname: '/', search: '?replay=x&t=3', hash: '#a' });
  expect(wayBack(new URL(at, 'http://h').search, 'http://h')).toBe('/?replay=x&t=3#a');
});
test('the way back never leaves this server', () => {
  for (const back of [
    '//evil.example',
    'https://evil.example/',
    '/\\evil.example',
    'javascript:alert(1)',
    'x',
    '/sign-in',
    '',
  ]) {
    expect(wayBack(`?${new URLSearchParams({ back })}`, 'http://h'), back).toBe('/');
  }
  expect(wayBack('', 'http://h')).toBe('/');
});
test('a kept token becomes a session and is kept no longer', async () => {
  sessionStorage.setItem('giveway.token', 'secret');
  answers([201, {}], [200, { name: 'anna' }]);
  expect(await adoptToken()).toBe(true);
  expect(vi.mocked(fetch).mock.calls[0]).toMatchObject(['/v1/session', { method: 'POST', body: '{"token":"secret"}' }]);
  expect(sessionStorage.getItem('giveway.token')).toBe(null);
  expect(await adoptToken()).toBe(false);
  expect(fetch).toHaveBeenCalledTimes(2);
});
test('what is wrong is said: a wrong token, and a browser that keeps no cookie', async () => {
  expect(await signIn('  ')).toBe('Enter the token.');
  answers([401, {}]);
  expect(await signIn('wrong')).toContain('wrong, has expired');
  answers([201, {}], [401, {}]);
  expect(await signIn('right')).toContain('cookie');
  answers([201, {}], [200, { name: 'anna' }]);
  expect(await signIn('right')).toBe(null);
});
test('the page leads to the identity provider, and says what is wrong with it', async () => {
  answers([200, { name: 'Keycloak' }], [200, { address: 'https://login.example/authorize?x=1' }]);
  expect(await providerName()).toBe('Keycloak');
  expect(await wayToProvider('/?t=3')).toEqual({ address: 'https://login.example/authorize?x=1' });
  expect(vi.mocked(fetch).mock.calls[1]).toMatchObject([
    '/v1/session/oidc',
    { method: 'POST', body: '{"back":"/?t=3"}' },
  ]);
  answers([503, { detail: 'Keycloak does not answer.' }], [500, {}], [404, {}]);
  expect(await wayToProvider('/')).toEqual({ refusal: { kind: 'said', text: 'Keycloak does not answer.' } });
  expect(await wayToProvider('/')).toEqual({ refusal: { kind: 'status', status: 500 } });
  expect(await providerName()).toBe(null);
});
test('somebody who was sent back reads why, and never what an address says', () => {
  expect(sentBackIn('?back=/')).toBe(null);
  expect(sentBackIn('?refused=no_role&back=/')).toBe('no_role');
  expect(sentBackWords('no_role')).toContain('none of your groups');
  expect(sentBackIn('?refused=Call+0900-1234')).toBe('denied');
});
