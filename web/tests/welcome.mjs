// The first minute of somebody who starts the program with nothing and opens the page: what it is, and three things to
// try; then what the page of an operator offers beside that: what closing an aisle does, before it is closed. node
// tests/welcome.mjs PATH-TO-GIVEWAY
import { mkdtempSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import {
  PATIENCE,
  assert,
  assertAccessible,
  check,
  finish,
  isRefusal,
  listen,
  openBrowser,
  until,
} from './chromium.mjs';
import { serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/welcome.mjs target/debug/giveway');
  process.exit(2);
}
const SHOTS = fileURLToPath(new URL('./shots/', import.meta.url));
await mkdir(SHOTS, { recursive: true });
const { url, stop } = await serve(program, null, mkdtempSync(`${tmpdir()}/giveway-welcome-`));
const browser = await openBrowser();
const complaints = [];
/** A first visit, with the map and the robots on the screen. */
async function visit(width, height, colorScheme) {
  const page = await (await browser.newContext({ viewport: { width, height }, colorScheme })).newPage();
  listen(page, complaints, isRefusal);
  await page.goto(url);
  await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
    timeout: PATIENCE,
  });
  return page;
}
const page = await visit(1440, 900, 'light');
const ask = async (path) => (await page.request.get(new URL(path, url).href)).json();
const line = page.getByRole('region', { name: 'What is happening now' });
const things = page.getByRole('region', { name: 'Three things to try' });
const alarms = page.getByRole('region', { name: 'Alarms', exact: true });
const closures = page.getByRole('region', { name: 'Closed areas' });
const host = page.getByRole('application', { name: 'Map of the floor' });
const seen = (name) => page.locator('canvas[data-robots]').getAttribute(`data-${name}`);

await check(
  'One line says what happens: robots, racks, people among them, and somebody who is given way to',
  async () => {
    await line
      .getByText(/\d+ robots bring racks to \d+ stations\. \d+ people walk among them/)
      .waitFor({ timeout: PATIENCE });
    await line.getByText(/\d+ robots? gives? way to somebody now/).waitFor({ timeout: 4 * PATIENCE });
    return line.innerText();
  },
);
await check(
  'It is the middle of a shift: deliveries, jobs that wait and people are there, and charts begin before the visit',
  async () => {
    const done = (await ask('/v1/jobs?state=done&limit=5')).items;
    assert(
      done.length > 0 && (await ask('/v1/jobs?state=waiting&limit=5')).items.length > 0,
      `${done.length} jobs are done`,
    );
    assert(Number(await seen('people')) > 0, 'nobody is on the floor');
    await page.getByRole('button', { name: 'Charts', exact: true }).click();
    const drawn = page
      .getByRole('region', { name: 'Charts', exact: true })
      .locator('[data-chart="deliveries"] polyline')
      .first();
    await drawn.waitFor({ state: 'attached', timeout: PATIENCE });
    const points = (await drawn.getAttribute('points')).trim().split(/\s+/).length;
    assert(points > 10, `the chart has ${points} points`);
    await page.screenshot({ path: `${SHOTS}first-charts.png` });
    await page.getByRole('button', { name: 'Jobs', exact: true }).click();
    return `${points} points`;
  },
);
for (const [width, height, colorScheme] of [
  [1440, 900, 'light'],
  [1440, 900, 'dark'],
  [390, 844, 'light'],
]) {
  await check(
    `The three things are there at once, and the page is accessible (${width} px, ${colorScheme})`,
    async () => {
      const other = await visit(width, height, colorScheme);
      const three = other.getByRole('region', { name: 'Three things to try' });
      await three.getByRole('link', { name: 'Walk in yourself' }).waitFor({ timeout: PATIENCE });
      for (const name of ['Let somebody lose a headset', 'Close an aisle'])
        await three.getByRole('button', { name }).waitFor({ timeout: PATIENCE });
      const over = await other.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert(over <= 0, `it is ${over} px too wide`);
      if (width > 1000) {
        const { y, height: high } = await three.boundingBox();
        assert(y + high < height, 'one has to scroll to them');
        // The floor is what one looks at: it fills its pane as far as its shape lets it.
        const [, , scale] = (await other.locator('canvas[data-robots]').getAttribute('data-view'))
          .split(' ')
          .map(Number);
        const {
          bounds: [x0, y0, x1, y1],
        } = await ask('/v1/map');
        const pane = await other.getByRole('application', { name: 'Map of the floor' }).boundingBox();
        const used = ((x1 - x0) * (y1 - y0) * scale * scale) / (pane.width * pane.height);
        assert(used > 0.3, `the floor uses ${(100 * used).toFixed()} % of its pane`);
      }
      await assertAccessible(other, 'the first minute');
      await other.waitForTimeout(600);
      await other.screenshot({ path: `${SHOTS}first-${width > 1000 ? colorScheme : 'phone'}.png` });
      await other.context().close();
    },
  );
}
await check(
  'Jobs are sorted by a heading, found by a part of their reference, and one that is late says by how much',
  async () => {
    const { racks, stations } = await ask('/v1/map');
    const order = {
      kind: 'deliver',
      rack: racks[0].id,
      station: stations[0].id,
      pick_s: 600,
      deadline: new Date(Date.now() + 1_000).toISOString(),
    };
    for (const reference of ['ORDER-4711-A', 'ORDER-4711-B']) {
      const answer = await page.request.post(new URL('/v1/jobs', url).href, { data: { ...order, reference } });
      assert(answer.ok(), await answer.text());
    }
    const table = page.getByRole('region', { name: 'Table of jobs' });
    const rows = table.locator('tbody tr');
    await table.getByRole('button', { name: 'Deadline' }).click();
    await table
      .getByText(/^late by \d+/)
      .nth(1)
      .waitFor({ timeout: PATIENCE });
    assert(
      (await table.locator('th[aria-sort="ascending"]').innerText()).startsWith('Deadline'),
      'it is sorted by something else',
    );
    await page.screenshot({ path: `${SHOTS}jobs-light.png` });
    const search = page.getByRole('searchbox', { name: 'Search jobs by a part of their reference' });
    await search.fill('4711-b');
    await until(
      'one job',
      async () => (await rows.count()) === 1 && (await rows.first().innerText()).includes('ORDER-4711-B'),
      20,
    );
    await search.fill('');
    await until('all jobs', async () => (await rows.count()) > 2, 20);
  },
);
await check(
  'Before an aisle is closed the page says what that cuts off and which jobs it meets; those may pass first',
  async () => {
    const effect = closures.getByRole('status', { name: 'What this does' });
    const map = await ask('/v1/map');
    const station = map.stations[0];
    const node = map.nodes.find((n) => n.id === station.id);
    await things.getByRole('button', { name: 'Close an aisle' }).click();
    await page.getByRole('application', { name: 'Drawing on the floor' }).waitFor({ timeout: PATIENCE });
    // Round a station, with all its ways.
    const at = await onScreen(node.x, node.y);
    await page.mouse.move(at[0] - 45, at[1] - 45);
    await page.mouse.down();
    await page.mouse.move(at[0] + 45, at[1] + 45, { steps: 5 });
    await page.mouse.up();
    await effect.getByText(/Closes \d+ places?/).waitFor({ timeout: PATIENCE });
    await effect.getByText(new RegExp(`Cuts off stations? .*${station.id}`)).waitFor({ timeout: PATIENCE });
    await effect.scrollIntoViewIfNeeded();
    for (const theme of ['Light', 'Dark']) {
      await page.getByLabel('Theme').selectOption({ label: theme });
      await closures.getByRole('button', { name: 'Close the area' }).scrollIntoViewIfNeeded();
      await page.waitForTimeout(400);
      await page.screenshot({ path: `${SHOTS}closing-effect-${theme.toLowerCase()}.png` });
      await assertAccessible(page, `closing, ${theme}`);
    }
    await page.getByLabel('Theme').selectOption({ label: 'Light' });
    // Sooner or later a robot is on its way through it.
    await closures.getByLabel('Let them pass first').check({ timeout: 4 * PATIENCE });
    const words = (await effect.innerText()).replaceAll(/\s+/g, ' ');
    await closures.getByLabel('Why').fill('the floor is wet');
    await closures.getByRole('button', { name: 'Close the area' }).click();
    await closures.getByText(/c\d+ is announced/).waitFor({ timeout: PATIENCE });
    await closures.getByRole('button', { name: /^Open c\d+ again$/ }).click();
    await closures.getByText(/is open again/).waitFor({ timeout: PATIENCE });
    return words;
  },
);
await check(
  'Somebody loses a headset: it is seen where, an alarm calls, and has what can be done as buttons',
  async () => {
    await things.getByRole('button', { name: 'Let somebody lose a headset' }).click();
    await page
      .getByRole('region', { name: 'Messages' })
      .getByText(/headset is silent now/)
      .waitFor({ timeout: PATIENCE });
    const lost = alarms.locator('li[data-alarm="worker_lost"]').filter({ hasText: 'Visitor' });
    await lost.waitFor({ timeout: 2 * PATIENCE });
    await line.getByText(/lost: robots keep out/).waitFor({ timeout: PATIENCE });
    await lost.scrollIntoViewIfNeeded();
    await page.screenshot({ path: `${SHOTS}first-lost.png` });
    await lost.getByRole('button', { name: /^Nobody is there/ }).click();
    const dialog = page.getByRole('dialog', { name: 'Who looks after it?' });
    await dialog.getByLabel('Your name').fill('Ben');
    await page.keyboard.press('Enter');
    await until(
      'nobody',
      async () => (await ask('/v1/workers')).items.every((w) => w.name !== 'Visitor' || w.presence === 'absent'),
      20,
    );
    await lost.waitFor({ state: 'detached', timeout: PATIENCE });
  },
);
await check('Whoever walks in is in the hall, in this window', async () => {
  await things.getByRole('link', { name: 'Walk in yourself' }).click();
  await page.waitForURL(/\/headset\?twin$/, { timeout: PATIENCE });
  await page.locator('#headset[data-twin="window"][data-link="live"]').waitFor({ timeout: PATIENCE });
  await page.waitForFunction(() => Number(document.querySelector('#headset').dataset.robots) > 0, null, {
    timeout: PATIENCE,
  });
  await page.waitForTimeout(600);
  await page.screenshot({ path: `${SHOTS}first-walk.png` });
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);
await stop();
await finish(browser);

/** Where a place of the map is on the screen, as the page shows it. */
async function onScreen(x, y) {
  const { x: left, y: top, width, height } = await host.boundingBox();
  const [midX, midY, scale] = (await seen('view')).split(' ').map(Number);
  const [right, up] = (await seen('turned')) === 'true' ? [y - midY, midX - x] : [x - midX, y - midY];
  return [left + width / 2 + right * scale, top + height / 2 - up * scale];
}
