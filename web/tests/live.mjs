// The page in a real browser against a real, running server: node tests/live.mjs URL
// Each check prints a sentence; the last line counts them. CHROMIUM names the browser to use.
import { mkdir } from 'node:fs/promises';
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

const url = process.argv[2];
if (!url) {
  console.error('Say where the server is: node tests/live.mjs http://127.0.0.1:8080');
  process.exit(2);
}
const SHOTS = fileURLToPath(new URL('./shots/', import.meta.url));
const JOB_DONE_MS = 240_000;
const WRONG_RACK = 'no-such-rack';

await mkdir(SHOTS, { recursive: true });
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
const complaints = [];
const page = await context.newPage();
watch(page);

const canvas = page.locator('canvas[data-robots]');
const read = (name) => canvas.getAttribute(`data-${name}`);
const form = page.getByRole('form', { name: 'New job' });
const jobsTable = page.getByRole('region', { name: 'Table of jobs' });

await check('The page opens and draws robots', async () => {
  await page.goto(url);
  await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
    timeout: PATIENCE,
  });
  return `${await read('robots')} robots, ${await read('racks')} racks, painted with ${await read('painter')}`;
});
await check('The link is live and the floor keeps changing', async () => {
  await page.getByRole('status').filter({ hasText: 'Live' }).waitFor({ timeout: PATIENCE });
  const before = Number(await read('version'));
  await page.waitForFunction((v) => Number(document.querySelector('canvas')?.dataset.version) > v, before, {
    timeout: PATIENCE,
  });
  return `version ${before} to ${await read('version')}`;
});
await check('The counters agree with the robots drawn', async () => {
  await page
    .getByRole('heading', { name: `${Number(await read('robots')).toLocaleString('en')} robots` })
    .waitFor({ timeout: PATIENCE });
});
await page.screenshot({ path: `${SHOTS}dark.png` });

await check('The first paint of a visitor who was never here is measured', async () => {
  const paints = [];
  for (let i = 0; i < 5; i++) {
    const visitor = await browser.newContext({ viewport: { width: 1440, height: 900 } });
    const first = await visitor.newPage();
    await first.goto(url);
    await first.waitForFunction(() => performance.getEntriesByName('first-contentful-paint').length > 0, null, {
      timeout: PATIENCE,
    });
    paints.push(await first.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0].startTime));
    await visitor.close();
  }
  paints.sort((a, b) => a - b);
  return `median ${Math.round(paints[2])} ms, longest ${Math.round(paints[4])} ms of five`;
});
const map = await (await context.request.get(new URL('/v1/map', url).href)).json();
await check('A job submitted through the form is accepted and carried out', async () => {
  const [rack, station] = [map.racks[0].id, map.stations[0].id];
  await form.getByLabel('Kind of job').selectOption('deliver');
  await form.getByLabel('Rack', { exact: true }).fill(rack);
  await form.getByLabel('Station', { exact: true }).fill(station);
  await form.getByLabel('Priority, 0 to 9').fill('9');
  await form.getByRole('button', { name: 'Submit job' }).click();
  const link = form.getByRole('link');
  await link.waitFor({ timeout: PATIENCE });
  const id = await link.textContent();
  const began = Date.now();
  const line = jobsTable.locator(`[data-job="${id}"]`);
  await line.waitFor({ timeout: PATIENCE });
  await page
    .waitForFunction(
      (job) => ['done', 'failed', 'cancelled'].includes(document.querySelector(`[data-job="${job}"]`)?.dataset.state),
      id,
      { timeout: JOB_DONE_MS },
    )
    .catch(async () => {
      throw new Error(`${id} is still ${await line.getAttribute('data-state')} after ${JOB_DONE_MS / 1000} s`);
    });
  assert((await line.getAttribute('data-state')) === 'done', `${id} ended as ${await line.textContent()}`);
  return `${id}, ${rack} to ${station}, done after ${Math.round((Date.now() - began) / 1000)} s`;
});
await check('A wrong rack is refused in words, beside the field', async () => {
  const rack = form.getByLabel('Rack', { exact: true });
  await rack.fill(WRONG_RACK);
  await form.getByRole('button', { name: 'Submit job' }).click();
  const error = form.locator('#job-rack-error');
  await error.waitFor({ timeout: PATIENCE });
  const words = (await error.textContent()) ?? '';
  assert(words.split(/\s+/).length >= 3 && !/[{}[\]]/.test(words), `these are no words: ${words}`);
  assert((await rack.getAttribute('aria-invalid')) === 'true', 'the field is not marked as wrong');
  return words;
});
await check('A job is cancelled only after it was asked about', async () => {
  await form.getByLabel('Rack', { exact: true }).fill(map.racks.at(-1).id);
  await form.getByRole('button', { name: 'Submit job' }).click();
  const link = form.getByRole('link');
  await link.waitFor({ timeout: PATIENCE });
  const id = await link.textContent();
  const line = jobsTable.locator(`[data-job="${id}"]`);
  const dialog = page.getByRole('dialog');
  await line.getByRole('button', { name: `Cancel ${id}` }).click({ timeout: PATIENCE });
  await dialog.getByRole('button', { name: 'Keep it' }).click();
  assert((await line.getAttribute('data-state')) !== 'cancelled', 'it was cancelled although it was to be kept');
  await line.getByRole('button', { name: `Cancel ${id}` }).click({ timeout: PATIENCE });
  await dialog.getByRole('button', { name: 'Cancel the job' }).click();
  await page.locator(`[data-job="${id}"][data-state="cancelled"]`).waitFor({ timeout: PATIENCE });
  return id;
});
await check('The map answers to the keyboard', async () => {
  const host = page.getByRole('application', { name: 'Map of the floor' });
  await host.focus();
  for (const key of ['+', '+', 'ArrowLeft', 'ArrowUp', '-', '0', 'Escape']) await page.keyboard.press(key);
  assert(await host.evaluate((element) => element === document.activeElement), 'the map lost the focus');
});
await check('A robot found by name shows what it is doing', async () => {
  const robot = (await (await context.request.get(new URL('/v1/robots', url).href)).json()).items[0].id;
  await page.getByLabel('Find on the floor').fill(robot);
  await page.keyboard.press('Enter');
  const panel = page.getByRole('region', { name: 'Robot', exact: true });
  await panel.getByRole('heading', { name: robot, exact: true }).waitFor({ timeout: PATIENCE });
  await page.waitForTimeout(1_000);
  await page.screenshot({ path: `${SHOTS}robot.png` });
  await panel.getByRole('button', { name: 'Close', exact: true }).click();
  await page.getByRole('button', { name: 'Show the whole floor' }).click();
});
await check('Keys choose one thing after the other, and Escape lets go', async () => {
  await page.getByRole('application', { name: 'Map of the floor' }).focus();
  const titles = [];
  for (const key of ['n', 'n', 'p']) {
    await page.keyboard.press(key);
    titles.push(await page.locator('.card h2').textContent({ timeout: PATIENCE }));
  }
  assert(titles[0] === titles[2] && titles[0] !== titles[1], `it went through ${titles.join(', ')}`);
  await page.keyboard.press('Escape');
  await page.locator('.card h2').waitFor({ state: 'detached', timeout: PATIENCE });
  return titles.slice(0, 2).join(', ');
});
await check('A station, a rack and a charger tell about themselves', async () => {
  const told = [];
  const charger = map.nodes.find((n) => n.kind === 'charger');
  for (const [id, label] of [
    [map.stations[0].id, 'Station'],
    [map.racks[0].id, 'Rack'],
    [charger.id, 'Place'],
  ]) {
    await page.getByLabel('Find on the floor').fill(id);
    await page.keyboard.press('Enter');
    const card = page.getByRole('region', { name: label, exact: true });
    await card.getByRole('heading', { name: id, exact: true }).waitFor({ timeout: PATIENCE });
    told.push(`${id}: ${(await card.locator('dl').innerText()).replaceAll(/\s+/g, ' ')}`);
  }
  await page.screenshot({ path: `${SHOTS}place.png` });
  return told.join('; ');
});
await check('At a station a pick is ended and picking is paused by hand', async () => {
  const station = map.stations[0].id;
  await page.getByLabel('Find on the floor').fill(station);
  await page.keyboard.press('Enter');
  const card = page.getByRole('region', { name: 'Station', exact: true });
  // A pick of an hour: it ends because the button says so.
  const data = { kind: 'deliver', rack: map.racks[0].id, station, pick_s: 3600, priority: 9 };
  const job = await (await context.request.post(new URL('/v1/jobs', url).href, { data })).json();
  const state = async () => (await (await context.request.get(new URL(`/v1/jobs/${job.id}`, url).href)).json()).state;
  await until(`${job.id} at the station`, async () => (await state()) === 'picking');
  await card.getByRole('button', { name: 'Pick done' }).click({ timeout: PATIENCE });
  await until(`${job.id} done`, async () => (await state()) === 'done');
  await card.getByRole('button', { name: 'Pause the station' }).click({ timeout: PATIENCE });
  await card.getByRole('button', { name: 'Resume the station' }).waitFor({ timeout: PATIENCE });
  await page.screenshot({ path: `${SHOTS}station-card.png` });
  await card.getByRole('button', { name: 'Resume the station' }).click();
  await card.getByRole('button', { name: 'Pause the station' }).waitFor({ timeout: PATIENCE });
  return `${job.id} ended by hand`;
});
await check('A click on the floor chooses what is there', async () => {
  await page.getByRole('button', { name: 'Show the whole floor' }).click();
  await page.getByLabel('Find on the floor').fill(map.stations[0].id);
  await page.keyboard.press('Enter');
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Close', exact: true }).click();
  // What was found is in the middle now.
  const box = await page.getByRole('application', { name: 'Map of the floor' }).boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.locator('.card h2').waitFor({ timeout: PATIENCE });
  const name = await page.locator('.card h2').textContent();
  await page.getByRole('button', { name: 'Close', exact: true }).click();
  await page.getByRole('button', { name: 'Show the whole floor' }).click();
  return name;
});
await accessible('dark');

await page.getByLabel('Theme').selectOption('light');
await page.waitForTimeout(700);
await page.screenshot({ path: `${SHOTS}light.png` });
await accessible('light');

await page.setViewportSize({ width: 375, height: 740 });
await page.waitForTimeout(700);
await check('The page fits a phone without scrolling sideways', async () => {
  const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert(over <= 0, `it is ${over} px too wide`);
});
await page.screenshot({ path: `${SHOTS}phone.png`, fullPage: true });
await accessible('phone');
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

for (const painter of ['webgl', 'canvas2d'])
  await check(`The ${painter} painter draws the same floor`, async () => {
    const other = await context.newPage();
    watch(other);
    const address = new URL(url);
    address.searchParams.set('painter', painter);
    await other.setViewportSize({ width: 1440, height: 900 });
    await other.goto(address.href);
    await other.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
      timeout: PATIENCE,
    });
    const painted = await other.locator('canvas[data-robots]').evaluate((element) => ({ ...element.dataset }));
    assert(painted.painter === painter, `it was painted with ${painted.painter}`);
    assert(painted.robots === (await read('robots')), `it shows ${painted.robots} robots`);
    await other.waitForTimeout(1_000);
    await other.screenshot({ path: `${SHOTS}${painter}.png` });
    await other.close();
    assert(complaints.length === 0, complaints.join(' | '));
  });
await check('Who wants less motion sees robots where they were last seen, not sliding there', async () => {
  const still = await browser.newContext({ reducedMotion: 'reduce' });
  const other = await still.newPage();
  await other.goto(url);
  await other.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.version) > 0, null, {
    timeout: PATIENCE,
  });
  // From the first picture on something may jump or glide; before, neither is said.
  await other.waitForFunction(() => document.querySelector('canvas')?.dataset.motion !== undefined, null, {
    timeout: PATIENCE,
  });
  const motion = await other.locator('canvas[data-robots]').getAttribute('data-motion');
  assert(
    motion === 'jump' && (await read('motion')) === 'glide',
    `it is ${motion}, and ${await read('motion')} where motion is welcome`,
  );
  await still.close();
});
await check('A lost connection is said plainly and the data is shown as old', async () => {
  // Only what reaches this page is held back; the server goes on.
  const lost = await context.newPage();
  const silent = [];
  await lost.routeWebSocket(/\/v1\/live/, (socket) => {
    const server = socket.connectToServer();
    server.onMessage((message) => {
      if (silent.length === 0) socket.send(message);
    });
  });
  await lost.goto(url);
  await lost.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
    timeout: PATIENCE,
  });
  silent.push('from now on');
  await lost.getByText(/The link is slow; this picture is \d+ s old/).waitFor({ timeout: PATIENCE });
  await lost.screenshot({ path: `${SHOTS}slow.png` });
  await lost.getByText(/Connection lost; this picture is \d+ s old/).waitFor({ timeout: PATIENCE });
  await lost.close();
});

await check('The page speaks the language that is chosen, also after it is opened again', async () => {
  const other = await context.newPage();
  await other.goto(url);
  await other.getByLabel('Language').selectOption('de');
  await other.waitForFunction(() => document.documentElement.lang === 'de', null, { timeout: PATIENCE });
  await other.getByRole('heading', { name: /^(Alarme|\d+ Alarme?)\b/ }).waitFor({ timeout: PATIENCE });
  await other.reload();
  await other.waitForFunction(
    () => document.documentElement.lang === 'de' && Number(document.querySelector('canvas')?.dataset.robots) > 0,
    null,
    { timeout: PATIENCE },
  );
  await other.getByText(/^\d+ Roboter bring/).waitFor({ timeout: PATIENCE });
  await other.screenshot({ path: `${SHOTS}german.png` });
  await other.locator('header select').first().selectOption('en');
  await other.waitForFunction(() => document.documentElement.lang === 'en', null, { timeout: PATIENCE });
  await other.close();
});

await finish(browser);

function watch(one) {
  // The wrong rack below is meant to be refused.
  listen(one, complaints, (message) => isRefusal(message) && message.location().url.endsWith('/v1/jobs'));
}

async function accessible(look) {
  await check(`axe finds nothing wrong (${look})`, () => assertAccessible(page, look));
}
