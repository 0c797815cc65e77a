// What a person does on the page, in a real browser against a real, running server: node tests/acts.mjs URL
// Asks why, looks at timelines, closes an area, hands in a table of jobs. Run it with a scenario that has jobs.
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
  console.error('Say where the server is: node tests/acts.mjs http://127.0.0.1:8080');
  process.exit(2);
}
const SHOTS = fileURLToPath(new URL('./shots/', import.meta.url));
await mkdir(SHOTS, { recursive: true });
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints, isRefusal);

const ask = async (path) => (await context.request.get(new URL(path, url).href)).json();
const button = (name) => page.getByRole('button', { name, exact: true });
const host = () => page.getByRole('application', { name: 'Map of the floor' }).boundingBox();
const closures = page.getByRole('region', { name: 'Closed areas' });
const timelines = page.getByRole('region', { name: 'Timelines', exact: true });

await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
  timeout: PATIENCE,
});
const map = await ask('/v1/map');

await check('A job that comes after another says so, to the root', async () => {
  const post = async (job) => (await context.request.post(new URL('/v1/jobs', url).href, { data: job })).json();
  const [rack, other] = map.racks;
  const first = await post({ kind: 'deliver', rack: rack.id, station: map.stations[0].id, pick_s: 60 });
  const second = await post({ kind: 'deliver', rack: other.id, station: map.stations[0].id, after: [first.id] });
  const table = page.getByRole('region', { name: 'Table of jobs' });
  await table.getByRole('button', { name: second.id, exact: true }).click({ timeout: PATIENCE });
  const card = page.getByRole('region', { name: 'Job', exact: true });
  const chain = card.getByRole('region', { name: 'Why it waits' });
  await chain.getByText(`waits for ${first.id} to be over`).waitFor({ timeout: PATIENCE });
  await page.waitForTimeout(1_500);
  await page.screenshot({ path: `${SHOTS}why-job.png` });
  const words = (await chain.innerText()).replaceAll(/\s+/g, ' ');
  await card.getByRole('button', { name: 'Close' }).click();
  for (const job of [second, first]) await context.request.delete(new URL(`/v1/jobs/${job.id}`, url).href);
  return words;
});
await check('A robot that waits says for what, in its card', async () => {
  // A pick lasts until this test ends it, and another robot comes to the same station meanwhile.
  const station = map.stations[0].id;
  const jobs = [];
  for (const { id: rack } of map.racks.slice(0, 2)) {
    const data = { kind: 'deliver', rack, station, pick_s: 3600, priority: 9 };
    const answer = await (await context.request.post(new URL('/v1/jobs', url).href, { data })).json();
    assert(answer.id, `no job for ${rack}: ${answer.detail}`);
    jobs.push(answer.id);
  }
  let id = null;
  await until('a robot that waits', async () => {
    id = (await ask('/v1/robots')).items.find((r) => r.activity === 'queueing' && r.why !== null)?.id ?? null;
    return id !== null;
  });
  await page.getByLabel('Find on the floor').fill(id);
  await page.keyboard.press('Enter');
  const card = page.getByRole('region', { name: 'Robot', exact: true });
  await card.getByRole('heading', { name: id, exact: true }).waitFor({ timeout: PATIENCE });
  await page.waitForTimeout(800);
  await page.screenshot({ path: `${SHOTS}why-robot.png` });
  const words = (await card.innerText()).replaceAll(/\s+/g, ' ');
  assert(words.includes(station), words);
  await card.getByRole('button', { name: 'Close' }).click();
  for (const job of jobs) {
    await until(`an end of ${job}`, async () => {
      await context.request.post(new URL(`/v1/stations/${station}/done`, url).href);
      return (await ask(`/v1/jobs/${job}`)).state === 'done';
    });
  }
  return words;
});
await check('Timelines show who holds the places of what is drawn, and a click chooses the robot', async () => {
  await button('Timelines').click();
  await timelines.getByRole('button', { name: 'Draw an area' }).click();
  const box = await host();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x - 160, y - 70);
  await page.mouse.down();
  await page.mouse.move(x, y, { steps: 4 });
  await page.mouse.move(x + 160, y + 70, { steps: 4 });
  await page.mouse.up();
  const bars = timelines.locator('.bar[data-kind="robot"]');
  await bars.first().waitFor({ timeout: PATIENCE });
  await bars.first().hover({ force: true });
  const words = await timelines.getByRole('status').textContent();
  await page.waitForTimeout(1_200);
  await page.screenshot({ path: `${SHOTS}timelines.png` });
  // Bars come and go: read and click in one go.
  const by = await bars.first().evaluate((bar) => {
    bar.click();
    return bar.dataset.by;
  });
  await page.locator('.card').getByRole('heading', { name: by, exact: true }).waitFor({ timeout: PATIENCE });
  return words;
});
await check('Timelines are reached by keys, and there is a table of them', async () => {
  await page.getByRole('application', { name: 'Timelines of the area' }).focus();
  for (const key of ['ArrowDown', 'ArrowRight', 'ArrowDown', '+']) await page.keyboard.press(key);
  await timelines
    .getByRole('status')
    .filter({ hasText: /^\S+: / })
    .waitFor({ timeout: PATIENCE });
  await assertAccessible(page, 'timelines');
  await timelines.getByLabel('As a table').check();
  // Beside the head, as soon as a robot holds a place of the area.
  const rows = timelines.getByRole('region', { name: 'Table of timelines' }).getByRole('row');
  await rows.nth(1).waitFor({ timeout: PATIENCE });
  const holds = (await rows.count()) - 1;
  await timelines.getByLabel('As a table').uncheck();
  await button('Jobs').click();
  return `${holds} holds`;
});
await check('An area drawn by pointer is closed with a reason, and opened again by undo', async () => {
  await button('Show the whole floor').click();
  await closures.getByRole('button', { name: 'Close a rectangle' }).click();
  const box = await host();
  await page.mouse.move(box.x + box.width / 2 - 30, box.y + box.height / 2 - 25);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 30, box.y + box.height / 2 + 25, { steps: 5 });
  await page.mouse.up();
  await closures.getByRole('button', { name: 'Close the area' }).click();
  await closures.getByText('Say why').waitFor({ timeout: PATIENCE });
  await closures.getByLabel('Why').fill('oil on the floor');
  await closures.getByLabel('Lasts, minutes').fill('10');
  await page.screenshot({ path: `${SHOTS}closing.png` });
  await closures.getByRole('button', { name: 'Close the area' }).click();
  await closures.getByText(/c\d+ is closed/).waitFor({ timeout: PATIENCE });
  await closures.getByText('oil on the floor').waitFor({ timeout: PATIENCE });
  await page.waitForTimeout(600);
  await page.screenshot({ path: `${SHOTS}closed.png` });
  await button('Undo').click();
  await closures.getByText(/is open again/).waitFor({ timeout: PATIENCE });
  await closures.getByText('oil on the floor').waitFor({ state: 'detached', timeout: PATIENCE });
});
await check('An area is drawn by keys alone, announced, and opened from the list', async () => {
  await closures.getByRole('button', { name: 'Close a polygon' }).focus();
  await page.keyboard.press('Enter');
  await page.getByRole('application', { name: 'Drawing on the floor' }).waitFor({ timeout: PATIENCE });
  for (const key of ['Enter', 'ArrowRight', 'ArrowRight', 'Enter', 'ArrowUp', 'ArrowUp', 'Enter', 'Enter'])
    await page.keyboard.press(key);
  await closures.getByLabel('Why').fill('cleaning');
  await closures.getByLabel('Begins in, minutes').fill('30');
  await closures.getByLabel('Lasts, minutes').fill('5');
  await page.keyboard.press('Enter');
  await closures.getByText(/c\d+ is announced/).waitFor({ timeout: PATIENCE });
  await closures
    .getByRole('button', { name: /^Open c\d+ again$/ })
    .first()
    .click();
  await closures.getByText(/is open again/).waitFor({ timeout: PATIENCE });
});
await check('A table of jobs is read line by line, and only what is right is sent', async () => {
  await button('Many jobs from a table').click();
  const dialog = page.getByRole('dialog');
  const [rack, station] = [map.racks.at(-1).id, map.stations[0].id];
  await dialog
    .getByLabel('Or paste it here')
    .fill(`kind,rack,station\ndeliver,${rack},${station}\ndeliver,no-such-rack,${station}\nreturn,${rack},\n`);
  await dialog.getByText('There is no rack “no-such-rack”.').waitFor({ timeout: PATIENCE });
  await page.screenshot({ path: `${SHOTS}csv.png` });
  await dialog.getByRole('button', { name: 'Submit 2 jobs' }).click();
  await dialog.getByText('2 accepted').waitFor({ timeout: PATIENCE });
  await assertAccessible(page, 'table of jobs');
  const ids = (await dialog.getByText(/^accepted as j\d+$/).allTextContents()).map((t) => t.split(' ').at(-1));
  for (const id of ids) await context.request.delete(new URL(`/v1/jobs/${id}`, url).href);
  await dialog.getByRole('button', { name: 'Done' }).click();
  return ids.join(', ');
});
await check('One click stops all robots, everybody sees it, and they go on only after it was asked about', async () => {
  await button('Stop all robots').click();
  const banner = page.getByText('All robots are stopped by hand', { exact: true });
  await banner.waitFor({ timeout: PATIENCE });
  await page
    .getByRole('region', { name: 'Alarms' })
    .getByText(/stopped by hand/)
    .waitFor({ timeout: PATIENCE });
  await until('a floor on which all robots stand', async () =>
    (await ask('/v1/robots')).items.every((r) => r.speed === 0),
  );
  await page.waitForTimeout(400);
  await page.screenshot({ path: `${SHOTS}stopped.png` });
  await assertAccessible(page, 'stopped');
  // The banner offers it first; the alarm does, too.
  const resume = button('Resume all robots').first();
  await resume.click();
  await page.getByRole('dialog').getByRole('button', { name: 'Keep them stopped' }).click();
  assert((await ask('/v1/fleet')).stopped !== null, 'they went on although they were to stay');
  await resume.click();
  await page.getByRole('dialog').getByRole('button', { name: 'Resume all robots' }).click();
  await banner.waitFor({ state: 'detached', timeout: PATIENCE });
});
await check('One robot is paused and goes on again', async () => {
  const id = map.racks.length > 0 ? (await ask('/v1/robots')).items[0].id : '';
  await page.getByLabel('Find on the floor').fill(id);
  await page.keyboard.press('Enter');
  const card = page.getByRole('region', { name: 'Robot', exact: true });
  await card.getByRole('button', { name: 'Pause this robot' }).click();
  await card.getByRole('paragraph').filter({ hasText: 'paused by hand' }).waitFor({ timeout: PATIENCE });
  await page.screenshot({ path: `${SHOTS}paused.png` });
  await card.getByRole('button', { name: 'Resume this robot' }).click();
  await card.getByRole('button', { name: 'Pause this robot' }).waitFor({ timeout: PATIENCE });
  await card.getByRole('button', { name: 'Close' }).click();
  return id;
});
await check('A robot goes to maintenance, rests at a parking place, and comes back', async () => {
  const robots = async () => (await ask('/v1/robots')).items;
  const id = (await robots()).find((r) => r.state === 'idle')?.id ?? (await robots())[0].id;
  const one = async () => (await robots()).find((r) => r.id === id);
  await page.getByLabel('Find on the floor').fill(id);
  await page.keyboard.press('Enter');
  const card = page.getByRole('region', { name: 'Robot', exact: true });
  await card.getByRole('button', { name: 'Out of service' }).click();
  await card.getByRole('button', { name: 'Back in service' }).waitFor({ timeout: PATIENCE });
  for (let i = 0; i < 240 && (await one()).why?.code !== 'in_maintenance'; i++) await page.waitForTimeout(500);
  assert((await one()).why?.code === 'in_maintenance', `it says ${(await one()).why?.text}`);
  await page.screenshot({ path: `${SHOTS}maintenance.png` });
  await card.getByRole('button', { name: 'Back in service' }).click();
  await card.getByRole('button', { name: 'Out of service' }).waitFor({ timeout: PATIENCE });
  assert((await one()).why?.code !== 'in_maintenance', 'it is still in maintenance');
  await card.getByRole('button', { name: 'Close' }).click();
  return id;
});
await check('A waiting job gets another priority in its card', async () => {
  const post = async (job) => (await context.request.post(new URL('/v1/jobs', url).href, { data: job })).json();
  const first = await post({ kind: 'deliver', rack: map.racks[0].id, station: map.stations[0].id });
  const second = await post({ kind: 'deliver', rack: map.racks[1].id, station: map.stations[0].id, after: [first.id] });
  await button('Jobs').click();
  const table = page.getByRole('region', { name: 'Table of jobs' });
  await table.getByRole('button', { name: second.id, exact: true }).click({ timeout: PATIENCE });
  const card = page.getByRole('region', { name: 'Job', exact: true });
  await card.getByLabel('Priority, 0 to 9').selectOption('9');
  await table
    .locator(`[data-job="${second.id}"]`)
    .getByRole('cell', { name: '9', exact: true })
    .waitFor({ timeout: PATIENCE });
  assert((await ask(`/v1/jobs/${second.id}`)).priority === 9, 'the server has another priority');
  await card.getByRole('button', { name: 'Close' }).click();
  for (const job of [second, first]) await context.request.delete(new URL(`/v1/jobs/${job.id}`, url).href);
});
await check('A person is sent where somebody clicks', async () => {
  const worker = await (
    await context.request.post(new URL('/v1/workers', url).href, { data: { name: 'acts-test' } })
  ).json();
  await page
    .getByRole('combobox', { name: 'Find on the floor' })
    .or(page.getByLabel('Find on the floor'))
    .first()
    .waitFor();
  await page.waitForTimeout(1_000);
  await page.getByLabel('Find on the floor').fill(worker.id);
  await page.keyboard.press('Enter');
  const card = page.getByRole('region', { name: 'Person', exact: true });
  await card.getByRole('button', { name: 'Send somewhere' }).click();
  await page.getByRole('application', { name: 'Drawing on the floor' }).press('Enter');
  await card.getByLabel(/What to do at/).fill('count racks');
  await card.getByRole('button', { name: /^Send to/ }).click();
  await card
    .getByText(/a\d+: on the way/)
    .or(card.getByRole('alert'))
    .first()
    .waitFor({ timeout: PATIENCE });
  const words = (await card.getByRole('status').innerText()) + (await card.getByRole('alert').allInnerTexts()).join('');
  await card.getByRole('button', { name: 'Close' }).click();
  assert(/a\d+:/.test(words), words);
  return words;
});

await page.getByLabel('Theme').selectOption('light');
await page.setViewportSize({ width: 375, height: 740 });
await button('Timelines').click();
await timelines.getByRole('button', { name: 'Use the visible area' }).click();
await page.waitForTimeout(1_500);
await check('The page fits a phone without scrolling sideways', async () => {
  const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert(over <= 0, `it is ${over} px too wide`);
});
await page.screenshot({ path: `${SHOTS}acts-phone.png`, fullPage: true });
await check('axe finds nothing wrong (phone, light)', () => assertAccessible(page, 'phone'));
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);
await finish(browser);
