// The page of a floor with people, for tests of the map and of what is done on it: a server, a browser, and what a user
// finds on the page.
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, assertAccessible, check, finish, isRefusal, listen, openBrowser } from './chromium.mjs';
import { serve } from './serve.mjs';

const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
export const SHOTS = HERE('./shots/');

/** Starts the server and opens the page; `end` checks that nothing was complained about, and stops both. */
export async function openFloor(program, name) {
  await mkdir(SHOTS, { recursive: true });
  const scratch = mkdtempSync(`${tmpdir()}/giveway-${name}-`);
  const scenario = JSON.parse(readFileSync(HERE('../../scenarios/people-3.json'), 'utf8'));
  Object.assign(scenario, { map: HERE('../../maps/thesis.json') });
  writeFileSync(`${scratch}/map.json`, JSON.stringify(scenario));
  const { url, stop } = await serve(program, `${scratch}/map.json`, scratch);
  const browser = await openBrowser();
  const complaints = [];
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, colorScheme: 'dark' });
  const page = await context.newPage();
  listen(page, complaints, isRefusal);

  const ask = async (path) => (await context.request.get(new URL(path, url).href)).json();
  const robots = async () => (await ask('/v1/robots')).items;
  const post = async (path, data) =>
    (await context.request.post(new URL(path, url).href, data === undefined ? {} : { data })).json().catch(() => null);
  const host = page.getByRole('application', { name: 'Map of the floor' });
  const find = page.getByRole('combobox', { name: 'Find on the floor' });
  const found = page.getByRole('listbox', { name: 'What was found' }).getByRole('option');
  const separator = page.getByRole('separator', { name: 'Height of the map' });
  const messages = page.getByRole('region', { name: 'Messages' });
  const closures = page.getByRole('region', { name: 'Closed areas' });
  const card = page.getByRole('region', { name: 'Robot', exact: true });
  const button = (name) => page.getByRole('button', { name, exact: true });
  const tab = (name) =>
    page.getByRole('group', { name: 'What is shown below the floor' }).getByRole('button', { name, exact: true });
  const hash = () => page.evaluate(() => location.hash);
  const drawn = (on = page) =>
    on.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, { timeout: PATIENCE });
  const shown = (name, on = page) => on.locator('canvas[data-robots]').getAttribute(`data-${name}`);
  const open = async (address) => {
    await page.goto('about:blank');
    await page.goto(`${url}/${address}`);
    await drawn();
  };
  /** Looks at both themes, on a picture and with axe. The page follows the system. */
  const both = async (name, on = page) => {
    for (const colorScheme of ['light', 'dark']) {
      await on.emulateMedia({ colorScheme });
      await on.waitForTimeout(300);
      await on.screenshot({ path: `${SHOTS}${name}-${colorScheme}.png` });
      await assertAccessible(on, `${name}, ${colorScheme}`);
    }
  };
  const end = async () => {
    await check('Nothing was complained about', async () => {
      assert(complaints.length === 0, complaints.join('; '));
    });
    await stop();
    await finish(browser);
  };

  await page.goto(url);
  await drawn();
  const map = await ask('/v1/map');
  return {
    url,
    browser,
    complaints,
    context,
    page,
    ask,
    robots,
    post,
    host,
    find,
    found,
    separator,
    messages,
    closures,
    card,
    button,
    tab,
    hash,
    drawn,
    shown,
    open,
    both,
    map,
    end,
  };
}
