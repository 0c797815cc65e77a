// Signing in on a page, in a real browser against a server that needs a token: node tests/signin.mjs PATH_TO_GIVEWAY
// A 401 leads to the page that asks for the token and back; the audit says who did what; signing out ends it.
import { spawn } from 'node:child_process';
import { mkdir, mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import {
  PATIENCE,
  assert,
  assertAccessible,
  assertOneLine,
  check,
  finish,
  isLostLink,
  isRefusal,
  listen,
  openBrowser,
} from './chromium.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/signin.mjs PATH_TO_GIVEWAY');
  process.exit(2);
}
const ADMIN = 'a-token-for-the-sign-in-test';
const SCENARIO = fileURLToPath(new URL('../../scenarios/lab.json', import.meta.url));
const SHOTS = fileURLToPath(new URL('./shots/', import.meta.url));
await mkdir(SHOTS, { recursive: true });
const folder = await mkdtemp(join(tmpdir(), 'giveway-signin-'));
const server = await start();
const ask = (method, path, body) =>
  fetch(new URL(path, server.url), {
    method,
    headers: { authorization: `Bearer ${ADMIN}`, 'content-type': 'application/json' },
    ...(body ? { body: JSON.stringify(body) } : {}),
  });
const made = await (await ask('POST', '/v1/tokens', { name: 'night shift', role: 'operator' })).json();

const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
listen(
  page,
  complaints,
  (message) => isRefusal(message) || isLostLink(message) || /status of 401/.test(message.text()),
);
const field = page.getByLabel('Access token');
const signIn = page.getByRole('button', { name: 'Sign in' });
const audit = page.getByRole('region', { name: 'Audit', exact: true });
const robots = () =>
  page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, { timeout: PATIENCE });

await check('Who is not signed in is led to the page that asks for a token', async () => {
  await page.goto(new URL('/?from=bookmark', server.url).href);
  await field.waitFor({ timeout: PATIENCE });
  assert(new URL(page.url()).pathname === '/sign-in', page.url());
});
for (const [width, colorScheme] of [
  [1400, 'dark'],
  [820, 'light'],
  [390, 'light'],
  [390, 'dark'],
]) {
  await check(`That page is accessible and fits (${width} px, ${colorScheme})`, async () => {
    await page.setViewportSize({ width, height: 800 });
    await page.emulateMedia({ colorScheme });
    await assertAccessible(page, 'the page to sign in');
    await page.screenshot({ path: `${SHOTS}sign-in-${width}-${colorScheme}.png` });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert(wide <= width, `it is ${wide} px wide`);
  });
}
await check('A wrong token is refused in words', async () => {
  await page.setViewportSize({ width: 1400, height: 900 });
  await field.fill('wrong-token-of-nobody');
  await signIn.click();
  await page.getByRole('alert').getByText('This token is wrong').waitFor({ timeout: PATIENCE });
  await assertAccessible(page, 'the page to sign in, with an error');
  await page.screenshot({ path: `${SHOTS}sign-in-wrong.png` });
});
await check('The right one leads back to where one was, and the page says who is signed in', async () => {
  await field.fill(ADMIN);
  await signIn.click();
  await robots();
  assert(new URL(page.url()).search === '?from=bookmark', page.url());
  await page.getByText('configuration (admin)').waitFor({ timeout: PATIENCE });
  const cookies = await context.cookies();
  const one = cookies.find((c) => c.name.startsWith('giveway_session'));
  assert(one && one.httpOnly && one.sameSite === 'Strict' && !one.secure, JSON.stringify(cookies));
  const kept = await page.evaluate(() => JSON.stringify({ ...localStorage, ...sessionStorage }) + document.cookie);
  assert(!kept.includes(ADMIN) && !kept.includes(one.value), 'scripts see neither token nor cookie');
});
await check('The tab Audit says who did what', async () => {
  await page.getByRole('button', { name: 'Stop all robots' }).click();
  await page.getByRole('button', { name: 'Audit', exact: true }).click();
  const row = audit.getByRole('row').filter({ hasText: 'Stopped all robots' });
  for (let i = 0; i < 20 && (await row.count()) === 0; i++) {
    await audit.getByRole('button', { name: 'Show', exact: true }).click();
    await page.waitForTimeout(500);
  }
  const words = (await row.first().innerText()).replaceAll(/\s+/g, ' ');
  assert(/configuration admin Stopped all robots – done/.test(words), words);
  const signed = audit.getByRole('row').filter({ hasText: 'Signed in' });
  assert((await signed.count()) > 0, 'signing in is written down');
  // The banner offers it, and so does the alarm.
  await page.getByRole('button', { name: 'Resume all robots' }).first().click();
  await page.getByRole('dialog').getByRole('button', { name: 'Resume all robots' }).click();
  return words;
});
for (const [width, colorScheme] of [
  [1400, 'light'],
  [1400, 'dark'],
  [820, 'light'],
  [390, 'dark'],
]) {
  await check(`The dashboard with the audit is accessible (${width} px, ${colorScheme})`, async () => {
    await page.setViewportSize({ width, height: 900 });
    await page.emulateMedia({ colorScheme });
    await page.waitForTimeout(500);
    await assertAccessible(page, 'the audit');
    await page.screenshot({ path: `${SHOTS}audit-${width}-${colorScheme}.png` });
  });
}
await check('The bar on top is one line for who is signed in, in every language, now and in a replay', async () => {
  for (const locale of ['en-GB', 'de-DE', 'es-ES', 'zh-CN']) {
    for (const [hash, is] of [
      ['', '[data-link="live"]'],
      ['#replay', '.past'],
    ]) {
      const one = await browser.newContext({
        locale,
        storageState: await context.storageState(),
        viewport: { width: 1440, height: 900 },
      });
      const other = await one.newPage();
      await other.goto(`${server.url}/${hash}`);
      await other.locator(`header ${is}`).waitFor({ timeout: PATIENCE });
      await other.locator('.who').waitFor({ timeout: PATIENCE });
      await assertOneLine(other, `${locale} ${hash}`);
      await other.screenshot({
        path: `${SHOTS}sign-in-bar-${locale.slice(0, 2)}${hash.replace('#', '-')}.png`,
        clip: { x: 0, y: 0, width: 1440, height: 60 },
      });
      await one.close();
    }
  }
});
await check(
  'Names of people are asked for by those who may see them; a viewer, who may not, asks and logs nothing',
  async () => {
    assert((await ask('POST', '/v1/workers', { name: 'Anna' })).ok, 'not registered');
    const viewer = await (await ask('POST', '/v1/tokens', { name: 'the wall', role: 'viewer' })).json();
    // Which of the buttons below each role has.
    for (const [who, token, role, has] of [
      ['configuration', ADMIN, 'admin', '1,1,1,1,1'],
      ['night shift', made.token, 'operator', '1,1,1,1,0'],
      ['the wall', viewer.token, 'viewer', '0,0,0,0,0'],
    ]) {
      const one = await browser.newContext({ viewport: { width: 1440, height: 900 } });
      const other = await one.newPage();
      const [asked, logged] = [[], []];
      await other.goto(server.url);
      await other.getByLabel('Access token').fill(token);
      other.on('request', (request) => {
        if (/\/v1\/people/.test(request.url())) asked.push(request.url());
      });
      await other.getByRole('button', { name: 'Sign in' }).click();
      await other.locator('.who', { hasText: who }).waitFor({ timeout: PATIENCE });
      listen(other, logged);
      await other.reload();
      await other.getByRole('heading', { name: '1 person' }).waitFor({ timeout: PATIENCE });
      await other.waitForTimeout(2_000);
      assert(role === 'viewer' ? asked.length === 0 : asked.length > 0, `${who} asked ${asked.length} times`);
      assert(logged.length === 0, `${who}: ${logged.join(' | ')}`);
      // What a role cannot do is not shown, and who can is said.
      const offered = await Promise.all(
        ['Stop all robots', 'Evacuate', 'Submit job', 'Close a rectangle', 'Audit'].map((name) =>
          other.getByRole('button', { name, exact: true }).count(),
        ),
      );
      assert(offered.join() === has, `${who} is offered ${offered.join()}`);
      assert(
        (await other.getByText('An operator can stop robots').count()) === (role === 'viewer' ? 1 : 0),
        'who can, is not said',
      );
      await assertAccessible(other, `the dashboard of ${who}`);
      await other.screenshot({ path: `${SHOTS}role-${role}.png` });
      await one.close();
    }
  },
);
await check('Signing out leads to the page that asks for a token, and the session is over', async () => {
  await page.setViewportSize({ width: 1400, height: 900 });
  await page.getByRole('button', { name: 'Sign out' }).click();
  await field.waitFor({ timeout: PATIENCE });
  assert(
    (await context.request.get(new URL('/v1/robots', server.url).href)).status() === 401,
    'the cookie still holds',
  );
});
await check('A token that a tab has kept becomes a session', async () => {
  await page.evaluate((token) => sessionStorage.setItem('giveway.token', token), made.token);
  await page.goto(server.url);
  await robots();
  await page.getByText('night shift (operator)').waitFor({ timeout: PATIENCE });
  assert((await page.evaluate(() => sessionStorage.getItem('giveway.token'))) === null, 'it is still kept');
});
await check('A revoked token ends the session, and the page asks again', async () => {
  assert((await ask('DELETE', `/v1/tokens/${made.id}`)).status === 204, 'not revoked');
  await field.waitFor({ timeout: PATIENCE });
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await server.stop();
await rm(folder, { recursive: true, force: true });
await finish(browser);

/** Starts the program with a token of an administrator. */
async function start() {
  const child = spawn(
    program,
    ['serve', '--scenario', SCENARIO, '--listen', '127.0.0.1:0', '--database', join(folder, 'db.sqlite')],
    {
      env: { ...process.env, GIVEWAY_TOKEN: ADMIN, RUST_LOG: 'warn' },
      stdio: ['ignore', 'pipe', 'inherit'],
    },
  );
  const ended = new Promise((done) => {
    child.on('exit', done);
  });
  process.on('exit', () => child.kill('SIGKILL'));
  const url = await new Promise((found, failed) => {
    let text = '';
    child.stdout.on('data', (more) => {
      text += more;
      const line = /^Giveway is at (http:\/\/[^/]+)\/$/m.exec(text);
      if (line) found(line[1]);
    });
    child.on('exit', (code) => failed(new Error(`the server ended with ${code}: ${text}`)));
  });
  return {
    url,
    stop: async () => {
      child.kill('SIGKILL');
      await ended;
    },
  };
}
