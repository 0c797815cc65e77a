// Signing in and out, and the way back to where one was.
import type { Act } from '../wire';

/** Who the server takes this browser for. */
export interface Me {
  name: string;
  role: 'viewer' | 'operator' | 'integrator' | 'device' | 'admin';
  subject: string | null;
  /** `nothing`: the server needs no token. */
  by: 'session' | 'token' | 'nothing';
  expires: string | null;
  /** What it may do besides reading; an older server does not say. */
  may?: readonly Act[];
}

/** Who is signed in, `nobody`, or why that is not known. */
export type Who = Me | 'nobody' | 'unreachable';

/** Those who run the floor, and so may know who its people are. */
const TOLD_NAMES: readonly Me['role'][] = ['operator', 'admin'];
/** Whether this browser may see the names of people; null if that is not known. */
export const mayName = (who: Who): boolean | null => (typeof who === 'object' ? TOLD_NAMES.includes(who.role) : null);

const PATIENCE_MS = 15_000;
/** Where pages kept a token before there were sessions. */
const TOKEN = 'giveway.token';

const ask = (method: string, body?: object): Promise<Response> =>
  fetch('/v1/session', {
    method,
    signal: AbortSignal.timeout(PATIENCE_MS),
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

let asked: Promise<Who> | null = null;
/** The same, asked once for all parts of a page: whoever signs in or out gets another page. */
export function whoIsHere(): Promise<Who> {
  asked ??= whoAmI().then((who) => {
    if (typeof who === 'string') asked = null;
    return who;
  });
  return asked;
}

/** Why somebody is not signed in. */
export type Refusal =
  | { kind: 'empty' | 'wrong' | 'no-cookie' | 'unreachable' }
  | { kind: 'said'; text: string }
  | { kind: 'status'; status: number };

/** Signs in; what is wrong, or null. */
export async function tryToken(token: string): Promise<Refusal | null> {
  const given = token.trim();
  if (given === '') return { kind: 'empty' };
  try {
    const answer = await ask('POST', { token: given });
    if (answer.status === 401) return { kind: 'wrong' };
    if (!answer.ok) {
      const problem = (await answer.json().catch(() => ({}))) as { detail?: string };
      return problem.detail ? { kind: 'said', text: problem.detail } : { kind: 'status', status: answer.status };
    }
  } catch {
    return { kind: 'unreachable' };
  }
  return (await whoAmI()) === 'nobody' ? { kind: 'no-cookie' } : null;
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

/** Where the browser is to go to sign in with the identity provider, or what is wrong. */
export async function wayToProvider(back: string): Promise<{ address: string } | { refusal: Refusal }> {
  try {
    const answer = await fetch('/v1/session/oidc', {
      method: 'POST',
      signal: AbortSignal.timeout(PATIENCE_MS),
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({ back }),
    });
    const said = (await answer.json().catch(() => ({}))) as { address?: string; detail?: string };
    if (answer.ok && said.address) return { address: said.address };
    return { refusal: said.detail ? { kind: 'said', text: said.detail } : { kind: 'status', status: answer.status } };
  } catch {
    return { refusal: { kind: 'unreachable' } };
  }
}

/** Why the way to the identity provider and back signed nobody in. */
const SENT_BACK = ['stale', 'denied', 'unreachable', 'untrusted', 'no_role'] as const;
export type SentBack = (typeof SENT_BACK)[number];

/** Why the server sent somebody back here; null if it sent nobody. What else an address says is never shown. */
export function sentBackIn(search: string): SentBack | null {
  const word = new URLSearchParams(search).get('refused');
  return word === null ? null : (SENT_BACK.find((known) => known === word) ?? 'denied');
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
    const wrong = await tryToken(token);
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
  return back.startsWith('/') && url.origin === origin && url.pathname !== '/sign-in'
    ? url.pathname + url.search + url.hash
    : '/';
}
