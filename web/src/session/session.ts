// Signing in and out, and the way back to where one was.

/** Who the server takes this browser for. */
export interface Me {
  name: string;
  role: 'viewer' | 'operator' | 'integrator' | 'device' | 'admin';
  subject: string | null;
  /** `nothing`: the server needs no token. */
  by: 'session' | 'token' | 'nothing';
  expires: string | null;
}

/** Who is signed in, `nobody`, or why that is not known. */
export type Who = Me | 'nobody' | 'unreachable';

const PATIENCE_MS = 15_000;
/** Where pages kept a token before there were sessions. */
const TOKEN = 'giveway.token';

const ask = (method: string, body?: object): Promise<Response> =>
  fetch('/v1/session', {
    method, signal: AbortSignal.timeout(PATIENCE_MS),
    ...(body ? { headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) } : {}),
  });

export async function whoAmI(): Promise<Who> {
  try {
    const answer = await ask('GET');
    if (answer.ok) return (await answer.json()) as Me;
    return answer.status === 401 ? 'nobody' : 'unreachable';
  } catch {
    return 'unreachable';
  }
}

/** Signs in; what is wrong, in words for people, or null. */
export async function signIn(token: string): Promise<string | null> {
  const given = token.trim();
  if (given === '') return 'Enter the token.';
  try {
    const answer = await ask('POST', { token: given });
    if (answer.status === 401) return 'This token is wrong, has expired or was revoked.';
    if (!answer.ok) {
      const problem = (await answer.json().catch(() => ({}))) as { detail?: string };
      return problem.detail ?? `The server answered ${answer.status}.`;
    }
  } catch {
    return 'The server cannot be reached.';
  }
  return (await whoAmI()) === 'nobody' ? 'The browser did not keep the cookie. Allow cookies for this page.' : null;
}

/** What the identity provider is called with which people sign in here; null if there is none. */
export async function providerName(): Promise<string | null> {
  try {
    const answer = await fetch('/v1/session/oidc', { signal: AbortSignal.timeout(PATIENCE_MS) });
    return answer.ok ? ((await answer.json()) as { name: string | null }).name : null;
  } catch {
    return null;
  }
}

/** Where the browser is to go to sign in with the identity provider, or what is wrong, in words for people. */
export async function wayToProvider(back: string): Promise<{ address: string } | { error: string }> {
  try {
    const answer = await fetch('/v1/session/oidc', {
      method: 'POST', signal: AbortSignal.timeout(PATIENCE_MS), headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ back }),
    });
    const said = (await answer.json().catch(() => ({}))) as { address?: string; detail?: string };
    return answer.ok && said.address ? { address: said.address } : { error: said.detail ?? `The server answered ${answer.status}.` };
  } catch {
    return { error: 'The server cannot be reached.' };
  }
}

/** Why the way to the identity provider and back signed nobody in, by the server's word for it. */
const REFUSALS = new Map([
  ['stale', 'That took too long, was begun in another browser or was done before. Try again.'],
  ['denied', 'The identity provider did not sign you in. Try again, or ask whoever runs it.'],
  ['unreachable', 'The identity provider does not answer as it should. Sign in with a token meanwhile, or try again later; the log of the server says what is wrong.'],
  ['untrusted', 'What the identity provider said of you cannot be trusted. Ask whoever runs this server: its log says what is wrong.'],
  ['no_role', 'You are known to the identity provider, but none of your groups may use this server. Ask whoever runs it for a group that may.'],
]);

/** What to say to somebody whom the server sent back here; null if it sent nobody. */
export function refusalIn(search: string): string | null {
  const word = new URLSearchParams(search).get('refused');
  return word === null ? null : REFUSALS.get(word) ?? 'The identity provider did not sign you in. Try again.';
}

/** Signs out; whether the server has said so. */
export async function signOut(): Promise<boolean> {
  try {
    return (await ask('DELETE')).ok;
  } catch {
    return false;
  }
}

/** A token that an earlier version kept in this tab becomes a session; whether there was one that holds. */
export async function adoptToken(): Promise<boolean> {
  try {
    const token = sessionStorage.getItem(TOKEN);
    if (token === null) return false;
    const wrong = await signIn(token);
    sessionStorage.removeItem(TOKEN);
    return wrong === null;
  } catch {
    // A page may be shown where nothing can be kept.
    return false;
  }
}

/** The address of the page that asks for a token and then comes back here. */
export const signInAt = ({ pathname, search, hash }: Pick<Location, 'pathname' | 'search' | 'hash'>): string =>
  `/sign-in?${new URLSearchParams({ back: pathname + search + hash })}`;

/** Where to go on after signing in: a page of this server, and no other. */
export function wayBack(search: string, origin: string): string {
  const back = new URLSearchParams(search).get('back') ?? '/';
  if (!URL.canParse(back, origin)) return '/';
  const url = new URL(back, origin);
  return back.startsWith('/') && url.origin === origin && url.pathname !== '/sign-in' ? url.pathname + url.search + url.hash : '/';
}
