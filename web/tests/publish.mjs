// A map is published from the editor, in a real browser: node tests/publish.mjs PATH_TO_GIVEWAY
// What changes is shown with its place, the dashboard goes on with the new map, a second editor is warned, what stands
// in the way is marked, and a server with tokens wants somebody to sign in.
import { mkdirSync, mkdtempSync } from 'node:fs';
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
  until,
} from './chromium.mjs';
import { FAST, serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/publish.mjs PATH_TO_GIVEWAY');
  process.exit(2);
}
const ADMIN = 'a-token-for-the-publish-test';
const SCENARIO = fileURLToPath(new URL('../../scenarios/lab.json', import.meta.url));
const SHOTS = fileURLToPath(new URL('./shots/', import.meta.url));
mkdirSync(SHOTS, { recursive: true });
const scratch = () => mkdtempSync(join(tmpdir(), 'giveway-publish-'));
const browser = await openBrowser();
const complaints = [];
/** While the map is changed the server answers 503, and the browser logs that. */
const isMeant = (message) => isRefusal(message) || isLostLink(message) || /status of (401|503)/.test(message.text());

/** An editor in a browser of its own. */
async function open(url) {
  const page = await (
    await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'light' })
  ).newPage();
  listen(page, complaints, isMeant);
  await page.goto(new URL('/editor', url).href);
  const sheet = page.getByRole('application');
  const tool = (name) => page.getByRole('navigation', { name: 'Tools' }).getByRole('button', { name });
  const panel = page.getByRole('group', { name: 'Publish this map' });
  const section = page.locator('section', { has: page.getByRole('heading', { name: 'Put it to use' }) });
  return {
    page,
    panel,
    said: section.getByRole('status'),
    load: async () => {
      await page.getByRole('button', { name: 'Open the server’s map' }).click();
      await page
        .getByText(/^\d+ places, /)
        .filter({ hasNotText: /^0 places/ })
        .waitFor({ timeout: PATIENCE });
      await page.getByRole('button', { name: 'Fit' }).click();
    },
    press: async (name, [x, y]) => {
      await tool(name).click();
      const box = await sheet.boundingBox();
      const [left, top, wide] = (await sheet.getAttribute('viewBox')).split(' ').map(Number);
      const scale = box.width / wide;
      await page.mouse.click(box.x + (x - left) * scale, box.y + (-y - top) * scale);
    },
    compare: async () => {
      await page.getByRole('button', { name: 'Publish …' }).click();
      await panel.waitFor({ timeout: PATIENCE });
    },
  };
}

const server = await serve(program, SCENARIO, scratch(), 0, FAST);
const map = async () => (await fetch(new URL('/v1/map', server.url))).json();
const first = await open(server.url);
const second = await open(server.url);
const dashboard = await (await browser.newContext({ viewport: { width: 1400, height: 900 } })).newPage();
listen(dashboard, complaints, isMeant);
const robots = () =>
  dashboard.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
    timeout: PATIENCE,
  });
const delivered = async () =>
  (await (await fetch(new URL('/metrics', server.url))).text()).match(/^giveway_robot_deliveries\D* (\d+)/m)?.[1];

await check('What publishing would change is listed, and marked on the sheet', async () => {
  await dashboard.goto(server.url);
  await robots();
  await first.load();
  await second.load();
  await first.press('Parking place', [7, 0]);
  await first.compare();
  await first.panel.getByText('The server runs the map with which it was started.').waitFor();
  const change = first.panel.getByRole('button', { name: /^parking places added: / });
  await change.click();
  assert((await first.page.locator('circle.mark.shown').count()) === 1, 'it is not marked');
  await first.panel.getByRole('button', { name: /^lanes added: / }).waitFor();
  await assertAccessible(first.page, 'the editor before publishing');
  await first.page.screenshot({ path: `${SHOTS}editor-publish.png` });
});

await check('It is published, and the editor says which version it is', async () => {
  const before = await map();
  await first.panel.getByRole('button', { name: 'Publish now' }).click();
  await first.said.getByText(/^Published as version 1 \([0-9a-f]{8}\)\./).waitFor({ timeout: PATIENCE });
  const after = await map();
  assert(
    after.version !== before.version && after.nodes.length === before.nodes.length + 1,
    `${after.nodes.length} places`,
  );
  await assertAccessible(first.page, 'the editor after publishing');
});

await check('The dashboard goes on with the new map, and robots go on working', async () => {
  const { nodes } = await map();
  const added = nodes.find((n) => n.x === 7 && n.y === 0).id;
  await until('a live dashboard', async () => (await dashboard.locator('[data-link="live"]').count()) > 0, 30);
  await robots();
  await dashboard.getByLabel('Find on the floor').fill(added);
  await dashboard
    .getByRole('option', { name: new RegExp(added) })
    .first()
    .waitFor({ timeout: PATIENCE });
  const before = Number((await delivered()) ?? 0);
  await until('a delivery', async () => Number((await delivered()) ?? 0) > before, 120);
});

await check('An editor that began before is warned, and has to say that it replaces what others did', async () => {
  await second.press('Parking place', [7, 4]);
  await second.compare();
  await second.panel.getByRole('alert').getByText('Somebody published another map').waitFor();
  await second.panel.getByRole('button', { name: 'Publish over theirs' }).waitFor();
  await second.panel.getByRole('button', { name: 'Cancel', exact: true }).click();
  assert((await second.panel.count()) === 0, 'it is still there');
});

await check('What stands in the way is marked in its place, and cannot be published', async () => {
  const { racks, nodes } = await (await fetch(new URL('/v1/map', server.url))).json();
  await first.load();
  const rack = racks[5];
  await first.press('Erase', [nodes[rack.node].x, nodes[rack.node].y]);
  await first.compare();
  await first.panel
    .getByRole('heading', { name: /What is in the way|What would be lost/ })
    .first()
    .waitFor();
  const one = first.panel.getByRole('button', { name: new RegExp(`(In the way|Lost).*${rack.id}`) }).first();
  await one.click();
  assert((await first.page.locator('circle.mark.shown').count()) > 0, 'it is not marked');
  await first.page.screenshot({ path: `${SHOTS}editor-publish-refused.png` });
  const now = first.panel.getByRole('button', { name: 'Publish now' });
  assert((await now.count()) === 0 || (await now.isDisabled()), 'it could be published');
  await first.panel.getByRole('button', { name: 'Cancel', exact: true }).click();
});
await server.stop();

process.env.GIVEWAY_TOKEN = ADMIN;
const closed = await serve(program, SCENARIO, scratch(), 0, FAST);
await check('A server with tokens wants somebody to sign in, and then takes the map', async () => {
  const third = await open(closed.url);
  await third.page.getByRole('button', { name: 'Open the server’s map' }).click();
  await third.page.getByLabel('This server requires an access token').fill(ADMIN);
  await third.page.getByRole('button', { name: 'Sign in' }).click();
  await third.page.getByLabel('This server requires an access token').waitFor({ state: 'detached', timeout: PATIENCE });
  await third.load();
  await third.press('Parking place', [7, 0]);
  await third.compare();
  await third.panel.getByRole('button', { name: 'Publish now' }).click();
  await third.said.getByText(/^Published as version 1/).waitFor({ timeout: PATIENCE });
});
await closed.stop();
await check('The pages break no rule of the server and log no error', async () => {
  assert(complaints.length === 0, complaints.join(' | '));
});
await finish(browser);
