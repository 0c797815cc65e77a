// Signing in with an identity provider, in a real browser: node tests/signon.mjs PATH_TO_GIVEWAY
// The provider is a small one of this file, at another site (127.0.0.1) than the server (localhost), as in life:
// cookies that are for one site alone must survive the way there and back.
import { spawn } from 'node:child_process';
import { createHash, createSign, generateKeyPairSync } from 'node:crypto';
import { mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import {
  PATIENCE,
  assert,
  assertAccessible,
  check,
  finish,
  isLostLink,
  isRefusal,
  listen,
  openBrowser,
} from './chromium.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/signon.mjs PATH_TO_GIVEWAY');
  process.exit(2);
}
const SCENARIO = fileURLToPath(new URL('../../scenarios/lab.json', import.meta.url));
const SHOTS = fileURLToPath(new URL('./shots/', import.meta.url));
await mkdir(SHOTS, { recursive: true });
const folder = await mkdtemp(join(tmpdir(), 'giveway-signon-'));
let claims = { preferred_username: 'anna', groups: ['shift-leads'] };
const provider = await startProvider();
const server = await start();

const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, colorScheme: 'light' });
const page = await context.newPage();
const complaints = [];
listen(
  page,
  complaints,
  (message) => isRefusal(message) || isLostLink(message) || /status of (401|503)/.test(message.text()),
);
const signIn = page.getByRole('button', { name: 'Sign in with the company' });
const onward = page.getByRole('link', { name: 'Go on as yourself' });
const at = (path) => new URL(path, server.url).href;

await check('The page to sign in names the provider', async () => {
  await page.goto(at('/?from=bookmark'));
  await signIn.waitFor({ timeout: PATIENCE });
  assert(await page.getByLabel('Access token').isVisible(), 'a token can still be used');
});
for (const [width, colorScheme] of [
  [1400, 'dark'],
  [390, 'light'],
]) {
  await check(`That page is accessible and fits (${width} px, ${colorScheme})`, async () => {
    await page.setViewportSize({ width, height: 800 });
    await page.emulateMedia({ colorScheme });
    await assertAccessible(page, 'the page to sign in');
    await page.screenshot({ path: `${SHOTS}sign-on-${width}-${colorScheme}.png` });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert(wide <= width, `it is ${wide} px wide`);
  });
}
await check('The way to the provider leads back to where one was, signed in, over another site', async () => {
  await page.setViewportSize({ width: 1400, height: 900 });
  await signIn.click();
  await onward.waitFor({ timeout: PATIENCE });
  assert(new URL(page.url()).hostname === '127.0.0.1', page.url());
  await onward.click();
  await page.getByText('anna (operator)').waitFor({ timeout: PATIENCE });
  assert(new URL(page.url()).search === '?from=bookmark', page.url());
  await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
    timeout: PATIENCE,
  });
  const cookies = (await context.cookies(server.url)).filter((c) => c.name.startsWith('giveway'));
  assert(cookies.length === 1 && cookies[0].httpOnly && cookies[0].sameSite === 'Strict', JSON.stringify(cookies));
});
await check('Signing out leads to the page to sign in', async () => {
  await page.getByRole('button', { name: 'Sign out' }).click();
  await signIn.waitFor({ timeout: PATIENCE });
});
await check('Who has no group with a role is refused in words', async () => {
  claims = { preferred_username: 'eve', groups: ['everybody'] };
  await signIn.click();
  await onward.click();
  await page.getByRole('alert').getByText('none of your groups may use this server').waitFor({ timeout: PATIENCE });
  await assertAccessible(page, 'the page to sign in, with a refusal');
  await page.screenshot({ path: `${SHOTS}sign-on-refused.png` });
});
await check('While the provider is down the page says what to do', async () => {
  await provider.stop();
  await page.waitForTimeout(10_500); // What the server knows of the provider lasts so long.
  await signIn.click();
  await page.getByRole('alert').getByText('Sign in with a token meanwhile').waitFor({ timeout: PATIENCE });
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await server.stop();
await rm(folder, { recursive: true, force: true });
await finish(browser);

/** A provider that knows one person and asks for no password. */
async function startProvider() {
  const { publicKey, privateKey } = generateKeyPairSync('rsa', { modulusLength: 2048 });
  const codes = new Map();
  const encode = (value) =>
    Buffer.from(typeof value === 'string' ? value : JSON.stringify(value)).toString('base64url');
  const http = createServer((request, response) => {
    const url = new URL(request.url, issuer());
    const send = (body, type = 'application/json', status = 200) => {
      response
        .writeHead(status, { 'content-type': type, connection: 'close' })
        .end(typeof body === 'string' ? body : JSON.stringify(body));
    };
    if (url.pathname === '/.well-known/openid-configuration') {
      return send({
        issuer: issuer(),
        authorization_endpoint: `${issuer()}/authorize`,
        token_endpoint: `${issuer()}/token`,
        jwks_uri: `${issuer()}/keys`,
        response_types_supported: ['code'],
        subject_types_supported: ['public'],
        id_token_signing_alg_values_supported: ['RS256'],
      });
    }
    if (url.pathname === '/keys')
      return send({ keys: [{ ...publicKey.export({ format: 'jwk' }), kid: 'k1', use: 'sig', alg: 'RS256' }] });
    if (url.pathname === '/authorize') {
      const code = `code-${url.searchParams.get('state')}`;
      codes.set(code, { nonce: url.searchParams.get('nonce'), challenge: url.searchParams.get('code_challenge') });
      const answer = new URLSearchParams({ code, state: url.searchParams.get('state') });
      const back = `${url.searchParams.get('redirect_uri')}?${answer}`;
      return send(
        '<!doctype html><html lang="en"><title>Provider</title><link rel="icon" href="data:,">' +
          `<a href="${back.replaceAll('&', '&amp;')}">Go on as yourself</a>`,
        'text/html',
      );
    }
    let body = '';
    request.on('data', (part) => {
      body += part;
    });
    request.on('end', () => {
      const form = new URLSearchParams(body);
      const asked = codes.get(form.get('code'));
      codes.delete(form.get('code'));
      if (createHash('sha256').update(form.get('code_verifier')).digest('base64url') !== asked?.challenge)
        return send({ error: 'invalid_grant' }, undefined, 400);
      const now = Math.floor(Date.now() / 1000);
      const own = { iss: issuer(), aud: 'giveway', sub: '4711', nonce: asked.nonce, iat: now, exp: now + 60 };
      const signed = `${encode({ alg: 'RS256', kid: 'k1' })}.${encode({ ...own, ...claims })}`;
      const token = `${signed}.${createSign('RSA-SHA256').update(signed).sign(privateKey).toString('base64url')}`;
      return send({ access_token: 'x', token_type: 'Bearer', id_token: token });
    });
  });
  const issuer = () => `http://127.0.0.1:${http.address().port}`;
  await new Promise((done) => {
    http.listen(0, '127.0.0.1', done);
  });
  return {
    issuer: issuer(),
    stop: () =>
      new Promise((done) => {
        http.closeAllConnections();
        http.close(done);
      }),
  };
}

/** Starts the program with this provider. */
async function start() {
  const settings = join(folder, 'giveway.toml');
  await writeFile(
    settings,
    `[oidc]\nissuer = "${provider.issuer}"\nclient_id = "giveway"\nlabel = "the company"\n\n` +
      '[oidc.roles]\n"shift-leads" = "operator"\n',
  );
  const child = spawn(
    program,
    [
      'serve',
      '--config',
      settings,
      '--scenario',
      SCENARIO,
      '--listen',
      '127.0.0.1:0',
      '--database',
      join(folder, 'db.sqlite'),
    ],
    {
      env: { ...process.env, RUST_LOG: 'warn' },
      stdio: ['ignore', 'pipe', 'inherit'],
    },
  );
  const ended = new Promise((done) => {
    child.on('exit', done);
  });
  process.on('exit', () => child.kill('SIGKILL'));
  const port = await new Promise((found, failed) => {
    let text = '';
    child.stdout.on('data', (more) => {
      text += more;
      const line = /^Giveway is at http:\/\/[^/]+:(\d+)\/$/m.exec(text);
      if (line) found(line[1]);
    });
    child.on('exit', (code) => failed(new Error(`the server ended with ${code}: ${text}`)));
  });
  return {
    url: `http://localhost:${port}`,
    stop: async () => {
      child.kill('SIGKILL');
      await ended;
    },
  };
}
