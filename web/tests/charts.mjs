// What the page shows over time, in a real browser against a real server that this test starts itself, with people on
// the floor: node tests/charts.mjs PATH-TO-GIVEWAY
// Charts, encounters, maps of heat, forecasts, and how somebody is seen.
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
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
  console.error('Say where the program is: node tests/charts.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-charts-`);
const { url, stop } = await serve(program, HERE('../../scenarios/people-3.json'), scratch);
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
// A report of seven years is meant to be refused.
listen(page, complaints, (message) => isRefusal(message) && message.location().url.includes('/v1/report'));
const ask = async (path) => (await context.request.get(new URL(path, url).href)).json();
const button = (name) => page.getByRole('button', { name, exact: true });
const charts = page.getByRole('region', { name: 'Charts', exact: true });
const system = page.getByRole('region', { name: 'System', exact: true });
const report = page.getByRole('region', { name: 'Report', exact: true });
const encounters = page.getByRole('region', { name: 'Encounters', exact: true });
const data = (name) => page.evaluate((n) => document.querySelector('canvas')?.dataset[n] ?? null, name);

await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.people) > 0, null, {
  timeout: 60_000,
});

await check('Where people may be lies on the floor, and can be put away', async () => {
  await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.forecasts) > 0, null, {
    timeout: PATIENCE,
  });
  await page.waitForTimeout(1_000);
  await page.screenshot({ path: `${SHOTS}forecast.png` });
  await page.getByText('Layers', { exact: true }).click();
  await page.getByLabel('Where people may be').selectOption('none');
  assert((await data('forecasts')) === '0', 'they are still there');
  await page.getByLabel('Where people may be').selectOption('all');
  await page.getByText('Layers', { exact: true }).click();
});
await check('The forecast of somebody who walks lies ahead, as the feed has it', async () => {
  const shape = await page.evaluate(
    () =>
      new Promise((done) => {
        const socket = new WebSocket(new URL('/v1/live', location.href.replace('http', 'ws')));
        socket.onmessage = (event) => {
          const message = JSON.parse(event.data);
          if (message.forecasts?.length > 0) {
            socket.close();
            done(message.forecasts[0]);
          }
        };
      }),
  );
  assert(new Set(shape.parts.map((p) => p.after_s)).size === 3, 'three moments ahead');
  for (const s of [1, 2, 4]) {
    const sum = shape.parts.filter((p) => p.after_s === s).reduce((a, p) => a + p.p, 0);
    assert(Math.abs(sum - 1) < 0.06, `the shares at ${s} s add up to ${sum}`);
  }
  return `${shape.parts.length} parts`;
});
await check('Somebody’s card shows where to over time, and how well the feed is', async () => {
  const id = (await ask('/v1/workers')).items[0].id;
  await page.getByLabel('Find on the floor').fill(id);
  await page.keyboard.press('Enter');
  const card = page.getByRole('region', { name: 'Person', exact: true });
  await card.getByText('Likely destinations over the last two minutes').waitFor({ timeout: PATIENCE });
  await card.getByText(/poses a second/).waitFor({ timeout: PATIENCE });
  await until('a drawing of it', async () => (await card.locator('svg polygon').count()) > 0, PATIENCE / 1_000);
  await card.screenshot({ path: `${SHOTS}person.png` });
  await page.screenshot({ path: `${SHOTS}person-page.png` });
  await assertAccessible(page, 'person');
  const words = (await card.locator('dl.wide').last().innerText()).replaceAll(/\s+/g, ' ');
  await card.getByRole('button', { name: 'Close' }).click();
  return words;
});
await check('A closed area that is announced is drawn in dashes with its time', async () => {
  const {
    bounds: [x0, y0, x1, y1],
  } = await ask('/v1/map');
  const at = (fx, fy) => [x0 + (x1 - x0) * fx, y0 + (y1 - y0) * fy];
  const area = (fx, from) => ({
    outline: [at(fx, 0.4), at(fx + 0.1, 0.4), at(fx + 0.1, 0.55), at(fx, 0.55)],
    reason: 'to be looked at',
    ...(from
      ? { from, until: new Date(Date.now() + 7_200_000).toISOString() }
      : { until: new Date(Date.now() + 3_600_000).toISOString() }),
  });
  const post = async (body) => (await context.request.post(new URL('/v1/closures', url).href, { data: body })).json();
  const made = [await post(area(0.25, new Date(Date.now() + 3_600_000).toISOString())), await post(area(0.6, null))];
  await page.getByText('Legend', { exact: true }).click();
  await page.getByRole('list', { name: 'Legend' }).getByText('Will be closed').waitFor({ timeout: PATIENCE });
  await page.waitForTimeout(800);
  await page.screenshot({ path: `${SHOTS}announced.png` });
  for (const { id } of made) await context.request.delete(new URL(`/v1/closures/${id}`, url).href);
});
await check('Charts have values after deliveries, and follow the pointer and the keys', async () => {
  await button('Charts').click();
  await until('a delivery in the history', async () =>
    (await ask('/v1/history?step=10')).buckets.some((b) => b.robot_deliveries > 0),
  );
  await charts.locator('[data-chart="deliveries"] polyline').first().waitFor({ state: 'attached', timeout: PATIENCE });
  const box = await charts.locator('[data-chart="deliveries"] .plot').boundingBox();
  await page.mouse.move(box.x + box.width - 20, box.y + box.height / 2);
  const pointed = await charts.getByRole('status').textContent();
  assert(/^\d\d:\d\d:\d\d: /.test(pointed), pointed);
  await page.mouse.move(5, 5);
  await page.getByRole('application', { name: 'Charts over time' }).focus();
  await page.keyboard.press('End');
  await page.keyboard.press('ArrowLeft');
  const words = await charts.getByRole('status').textContent();
  assert(/robots [\d,.]+/.test(words), words);
  const most = await charts.locator('[data-chart="deliveries"] .scale span').last().textContent();
  assert(Number(most.replaceAll(',', '')) > 1, `deliveries per hour reach to ${most}`);
  await page.screenshot({ path: `${SHOTS}charts.png` });
  await assertAccessible(page, 'charts');
  return words;
});
await check('An encounter comes as a row, shows its place, and can be seen again', async () => {
  await meet();
  await button('Encounters').click();
  const row = encounters.locator('[data-encounter]').first();
  await row.waitFor({ timeout: PATIENCE });
  await row.getByRole('button', { name: /show on the floor/ }).click();
  const replay = await row.getByRole('link', { name: /^Replay/ }).getAttribute('href');
  assert(/^#replay\?from=\d+&to=\d+$/.test(replay), replay);
  const table = await context.request.get(
    new URL(await encounters.getByRole('link', { name: 'Table (CSV)' }).getAttribute('href'), url).href,
  );
  assert((await table.text()).startsWith('id,worker,robot'), 'the table is none');
  await encounters.getByRole('button', { name: 'Closest' }).click();
  await page.waitForTimeout(700);
  await page.screenshot({ path: `${SHOTS}encounters.png` });
  await assertAccessible(page, 'encounters');
  const of = await encounters.getByLabel('What the fleet did');
  await of.selectOption('kept');
  await of.selectOption('');
  return `${(await row.innerText()).replaceAll(/\s+/g, ' ')} ${replay}`;
});
await check('Its replay lists it, too, and goes there', async () => {
  await encounters
    .locator('[data-encounter]')
    .first()
    .getByRole('link', { name: /^Replay/ })
    .click();
  const bar = page.getByRole('region', { name: 'Replay', exact: true });
  await bar.getByRole('button', { name: 'Encounters', exact: true }).click();
  const row = encounters.locator('[data-encounter]').first();
  await row.waitFor({ timeout: PATIENCE });
  const words = (await row.innerText()).replaceAll(/\s+/g, ' ');
  const seconds = (text) => text.split(':').reduce((sum, n) => sum * 60 + Number(n), 0);
  await row.getByRole('button', { name: /^Replay/ }).click();
  const shown = () => bar.locator('output b').innerText();
  await until(
    `a moment before ${words}`,
    async () => Math.abs(seconds(words.split(' ')[0]) - seconds(await shown()) - 5) < 4,
    PATIENCE / 1_000,
  );
  await button('Back to live').click();
  await button('Encounters').waitFor();
  return words;
});
await check('Maps of heat are put onto the floor, with what the colours mean', async () => {
  await button('Show the whole floor').click();
  await page.getByText('Layers', { exact: true }).click();
  for (const [name, shot] of [
    ['where robots waited', 'heat-waiting'],
    ['where robots met people', 'heat-encounters'],
  ]) {
    await page.getByLabel(name).check();
    await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.cells) > 0, null, {
      timeout: 60_000,
    });
    await page.getByRole('group', { name: 'Meaning of the colours' }).waitFor({ timeout: PATIENCE });
    await page.waitForTimeout(600);
    await page.screenshot({ path: `${SHOTS}${shot}.png` });
  }
  await assertAccessible(page, 'heat');
  const words = await page.getByRole('group', { name: 'Meaning of the colours' }).innerText();
  await page.getByLabel('none', { exact: true }).check();
  await page.waitForFunction(() => document.querySelector('canvas')?.dataset.cells === '0', null, {
    timeout: PATIENCE,
  });
  await page.getByText('Layers', { exact: true }).click();
  return words.replaceAll(/\s+/g, ' ');
});
await check('Figures over time come as a table, too', async () => {
  await button('Charts').click();
  await charts.getByLabel('As a table').check();
  const rows = charts.getByRole('region', { name: 'Table of figures over time' }).getByRole('row');
  await rows.nth(1).waitFor({ timeout: PATIENCE });
  const told = (await rows.count()) - 1;
  await assertAccessible(page, 'table of charts');
  await charts.getByLabel('As a table').uncheck();
  await button('1 day').click();
  await charts.locator('[data-chart="deliveries"]').waitFor();
  await page.waitForTimeout(600);
  await page.screenshot({ path: `${SHOTS}charts-day.png` });
  await button('15 min').click();
  return `${told} rows`;
});
await check('What planning takes is in a tab of its own', async () => {
  assert((await charts.locator('[data-chart="plans"]').count()) === 0, 'it is among the charts of the floor');
  await button('System').click();
  await page.waitForFunction(
    () => document.querySelector('[data-chart="plans"] [data-value="median"]')?.textContent !== '–',
    null,
    { timeout: PATIENCE },
  );
  await system.locator('[data-chart="steps"] polyline').first().waitFor({ state: 'attached', timeout: PATIENCE });
  await page.waitForTimeout(600);
  await page.screenshot({ path: `${SHOTS}system.png` });
  await assertAccessible(page, 'system');
});
await check('The file of an experiment shows its policies side by side', async () => {
  await button('Compare policies of an experiment').click();
  const file = `${scratch}/table.json`;
  const figures = (mean, sd) => ({
    total_deliveries: { mean, sd },
    encounters_per_worker_minute: { mean: mean / 100, sd: sd / 100 },
  });
  const pair = (mean, low, high) => ({
    total_deliveries: { mean, ci95: [low, high] },
    encounters_per_worker_minute: { mean: -mean / 100, ci95: [-high / 100, -low / 100] },
  });
  writeFileSync(
    file,
    JSON.stringify({
      law_violations: 0,
      scenarios: [1, 5].map((workers) => ({
        workers,
        arms: {
          nhir: figures(150 - workers, 9),
          shir: figures(155 - workers, 8),
          phir: figures(161 - workers, 7),
          giveway: figures(183 - workers, 6),
        },
        paired: { 'giveway-phir': pair(22, 17, 27), 'phir-nhir': pair(5, -3, 13) },
      })),
    }),
  );
  await system.getByLabel(/^Open the output/).setInputFiles(file);
  await system.getByText('giveway (running here)').first().waitFor({ timeout: PATIENCE });
  await page.screenshot({ path: `${SHOTS}experiment.png` });
  await assertAccessible(page, 'experiment');
  await system
    .getByLabel(/^Open the output/)
    .setInputFiles({ name: 'x.json', mimeType: 'application/json', buffer: Buffer.from('{}') });
  await system.getByRole('alert').waitFor({ timeout: PATIENCE });
  await button('Compare policies of an experiment').click();
});
await check('A report says what the lists say, on the screen, as a table and as JSON', async () => {
  await button('Report').click();
  await report.getByText('the server ran for').waitFor({ timeout: PATIENCE });
  // Jobs go on meanwhile: the same question once more, of a time that is over.
  const to = new Date().toISOString();
  const from = new Date(Date.now() - 3_600_000).toISOString();
  const words = await ask(`/v1/report?from=${from}&to=${to}`);
  const done = [];
  for (let cursor = ''; cursor !== null;) {
    const { items, next } = await ask(`/v1/jobs?state=done&limit=500${cursor && `&cursor=${cursor}`}`);
    done.push(
      ...items.filter(
        (job) =>
          job.kind === 'deliver' &&
          Date.parse(job.times.ended) >= Date.parse(from) &&
          Date.parse(job.times.ended) < Date.parse(to),
      ),
    );
    cursor = next;
  }
  assert(
    words.deliveries.done === done.length && done.length > 0,
    `it has ${words.deliveries.done} deliveries, the list ${done.length}`,
  );
  for (const { station, deliveries } of words.stations) {
    const listed = done.filter((job) => job.station === station).length;
    assert(deliveries === listed, `${station}: ${deliveries} and ${listed}`);
  }
  const shares = Object.values(words.robots.shares).reduce((sum, share) => sum + share, 0);
  assert(Math.abs(shares - 1) < 0.01, `the shares of robots add up to ${shares}`);
  const csv = page.waitForEvent('download');
  await report.getByRole('button', { name: 'CSV' }).click();
  const table = readFileSync(await (await csv).path(), 'utf8');
  assert(
    /^table,row,figure,value\r\n/.test(table) && /\r\nstations,[^,]+,deliveries,\d+\r\n/.test(table),
    table.slice(0, 300),
  );
  const file = page.waitForEvent('download');
  await report.getByRole('button', { name: 'JSON' }).click();
  assert(
    JSON.parse(readFileSync(await (await file).path(), 'utf8')).stations.length === words.stations.length,
    'the file has other stations',
  );
  await report.getByLabel('Of which time').selectOption('From – to');
  await report.getByRole('textbox', { name: 'From' }).fill('2020-01-01T00:00');
  await report.getByRole('button', { name: 'Show' }).click();
  await report.getByRole('alert').waitFor({ timeout: PATIENCE });
  await report.getByLabel('Of which time').selectOption('Last hour');
  await report.getByRole('alert').waitFor({ state: 'detached', timeout: PATIENCE });
  await page.waitForTimeout(300);
  await page.screenshot({ path: `${SHOTS}report.png` });
  await assertAccessible(page, 'report');
  await page.emulateMedia({ media: 'print' });
  await page.screenshot({ path: `${SHOTS}report-print.png`, fullPage: true });
  await page.emulateMedia({ media: 'screen' });
  return `${done.length} deliveries`;
});

await page.getByLabel('Theme').selectOption('light');
await page.waitForTimeout(600);
await page.screenshot({ path: `${SHOTS}charts-light.png` });
await check('axe finds nothing wrong (charts, light)', () => assertAccessible(page, 'light'));
await page.getByText('Layers', { exact: true }).click();
await page.getByLabel('where robots waited').check();
await page.waitForTimeout(1_200);
await page.screenshot({ path: `${SHOTS}heat-light.png` });
await page.setViewportSize({ width: 375, height: 740 });
await page.waitForTimeout(600);
await check('The page fits a phone without scrolling sideways', async () => {
  for (const tab of ['Encounters', 'Report', 'System', 'Charts']) {
    await button(tab).click();
    await page.waitForTimeout(600);
    const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert(over <= 0, `${tab}: it is ${over} px too wide`);
  }
});
await page.screenshot({ path: `${SHOTS}charts-phone.png`, fullPage: true });
await check('axe finds nothing wrong (phone, light)', () => assertAccessible(page, 'phone'));
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);
await stop();
await finish(browser);

/** Somebody with a tag appears in front of robots that drive until an encounter is over and recorded: the people of the
 *  scenario may walk about for long without one. */
async function meet() {
  const post = (path, data) => context.request.post(new URL(path, url).href, { data });
  const { id } = await (await post('/v1/workers', { name: 'visitor' })).json();
  await until('an encounter', async () => {
    if ((await ask('/v1/encounters?limit=1')).items.length > 0) return true;
    const robot = (await ask('/v1/robots')).items.find((r) => r.speed > 0.8);
    if (robot) {
      const at = {
        x: robot.x + 0.9 * Math.cos(robot.heading),
        y: robot.y + 0.9 * Math.sin(robot.heading),
        accuracy_m: 0.1,
      };
      for (let i = 0; i < 4; i++) {
        await post(`/v1/workers/${id}/position`, at);
        await page.waitForTimeout(250);
      }
    }
    await post(`/v1/workers/${id}/clear`, { by: 'tests' });
    return false;
  });
}

/** A server with people on the floor, on any port. */
