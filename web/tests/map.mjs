// The map first: its height, the full screen, the wall view, finding, addresses, tablets, refusals and undo, in a real
// browser against a real server that this test starts itself: node tests/map.mjs PATH-TO-GIVEWAY
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
  console.error('Say where the program is: node tests/map.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-map-`);
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

await page.goto(url);
await drawn();
const map = await ask('/v1/map');

await check('The map keeps its size whatever is shown below it', async () => {
  const sizes = [];
  for (const name of ['Jobs', 'Robots', 'Timelines', 'Charts', 'Encounters', 'Audit']) {
    await tab(name).click();
    await page.waitForTimeout(400);
    const { width, height } = await host.boundingBox();
    sizes.push(`${width} × ${height}`);
  }
  assert(new Set(sizes).size === 1, sizes.join(', '));
  await tab('Jobs').click();
  return sizes[0];
});
await check(
  'The splitter shares the height by keys and by pointer, is put back by a double click, and is remembered',
  async () => {
    const share = async () => Number(await separator.getAttribute('aria-valuenow'));
    const height = async () => (await host.boundingBox()).height;
    const [usual, before] = [await share(), await height()];
    await separator.focus();
    await page.keyboard.press('ArrowDown');
    assert((await share()) === usual + 2 && (await height()) > before, 'an arrow does not move it');
    for (const [key, end] of [
      ['Home', 'min'],
      ['End', 'max'],
    ]) {
      await page.keyboard.press(key);
      assert(
        (await share()) === Number(await separator.getAttribute(`aria-value${end}`)),
        `${key} leads to ${await share()}`,
      );
    }
    const box = await separator.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2 - 150, { steps: 5 });
    await page.mouse.up();
    const [dragged, to] = [await share(), await separator.boundingBox()];
    assert(Math.abs(to.y - (box.y - 150)) < 12, `it was dragged by ${box.y - to.y} px instead of 150`);
    await page.reload();
    await drawn();
    assert((await share()) === dragged, `${dragged} became ${await share()} with a reload`);
    await separator.dblclick();
    assert((await share()) === usual, `a double click leads to ${await share()}`);
    return `${before} px at ${usual} %, ${dragged} % after the drag`;
  },
);
await check('The map fills the screen by a button and by a key, and Escape leaves', async () => {
  const full = async () => (await host.boundingBox()).height > 840;
  await button('Full screen').click();
  await until('a map that fills the screen', full, 10);
  assert((await page.getByRole('banner').count()) === 0 && !(await tab('Jobs').isVisible()), 'something else is there');
  await page.waitForTimeout(300);
  await both('map-full');
  await page.keyboard.press('Escape');
  await until('a map of its usual size', async () => !(await full()), 10);
  await host.focus();
  await page.keyboard.press('f');
  await until('a map that fills the screen', full, 10);
  await page.keyboard.press('f');
  await until('a map of its usual size', async () => !(await full()), 10);
});
await check(
  'The view for a wall needs no hand: an address, large figures, alarms in words; Escape leaves',
  async () => {
    await open('#wall');
    const wall = page.getByRole('region', { name: 'Figures for the wall' });
    await wall.getByText('No alarms.').or(wall.locator('li b')).first().waitFor({ timeout: PATIENCE });
    await post('/v1/fleet/stop');
    await wall.getByText(/stopped by hand/).waitFor({ timeout: PATIENCE });
    const jobs = await wall.locator('[data-figure="waiting"]').innerText();
    assert(/^[\d,]+$/.test(jobs) && /^[\d,]+$/.test(await wall.locator('[data-figure="delivered"]').innerText()), jobs);
    const px = await wall
      .locator('[data-figure="delivered"]')
      .evaluate((dd) => parseFloat(getComputedStyle(dd).fontSize));
    assert(px >= 40, `the figures are ${px} px high`);
    assert(!(await tab('Jobs').isVisible()) && (await find.count()) === 0, 'there are tabs or a field');
    await page.waitForTimeout(600);
    await both('map-wall');
    await page.keyboard.press('Escape');
    await tab('Jobs').waitFor({ timeout: PATIENCE });
    assert((await hash()) === '', await hash());
    await post('/v1/fleet/resume');
    await button('Wall view').click();
    await wall.waitFor({ timeout: PATIENCE });
    assert((await hash()) === '#wall', await hash());
    await page.goBack();
    await tab('Jobs').waitFor({ timeout: PATIENCE });
    return `figures of ${px} px`;
  },
);
await check('The legend is folded at first, and neither folded nor open it covers the floor', async () => {
  await button('Show the whole floor').click();
  const legend = page.locator('details.legend');
  assert(!(await legend.evaluate((one) => one.open)), 'it is open at first');
  for (const state of ['folded', 'open']) {
    if (state === 'open') await legend.locator('summary').click();
    await page.waitForTimeout(700);
    const [x, y, scale] = (await shown('view')).split(' ').map(Number);
    const below = (await shown('turned')) === 'true' ? map.bounds[2] - x : y - map.bounds[1];
    const box = await host.boundingBox();
    // With half a station at the edge.
    const foot = box.y + (below + 0.62) * scale + box.height / 2;
    const top = (await legend.boundingBox()).y;
    assert(foot <= top, `${state}: the floor ends at ${foot.toFixed()} px, the legend begins at ${top.toFixed()}`);
  }
  await page.screenshot({ path: `${SHOTS}map-legend.png` });
  await legend.locator('summary').click();
});
await check(
  'Finding goes by parts and without case, shows kinds, by keys alone, and says if there is nothing',
  async () => {
    const id = (await robots())[4].id;
    await find.fill(id.toUpperCase());
    await found.first().waitFor({ timeout: PATIENCE });
    assert((await found.first().innerText()).startsWith(id), await found.first().innerText());
    const number = /\d+$/.exec(id)[0];
    await find.fill(number);
    const kinds = () => found.evaluateAll((all) => [...new Set(all.map((one) => one.dataset.kind))]);
    await until('several kinds', async () => (await kinds()).length > 1, 10);
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    const second = found.nth(1);
    assert(
      (await second.getAttribute('aria-selected')) === 'true' &&
        (await find.getAttribute('aria-activedescendant')) === 'found-1',
      'the second one is not active',
    );
    await both('map-find');
    const name = await second.locator('b').innerText();
    await page.keyboard.press('Enter');
    await page.locator('.card h2').filter({ hasText: name }).waitFor({ timeout: PATIENCE });
    await find.fill('no such thing');
    await page
      .getByRole('status')
      .filter({ hasText: 'Nothing is called “no such thing”.' })
      .waitFor({ timeout: PATIENCE });
    await page.keyboard.press('Escape');
    assert((await find.inputValue()) === '', 'Escape leaves the text');
    return `${number}: ${name}`;
  },
);
await check(
  'Jobs are found by id and by reference, people by name, racks, stations, places and closed areas',
  async () => {
    const { id } = await post('/v1/jobs', {
      kind: 'deliver',
      rack: map.racks[40].id,
      station: map.stations[0].id,
      reference: 'Order 4711',
    });
    for (const text of [id, 'Order 4711']) {
      await find.fill(text);
      await page.keyboard.press('Enter');
      const job = page.getByRole('region', { name: 'Job', exact: true });
      await job.getByRole('heading', { name: `Job ${id}`, exact: true }).waitFor({ timeout: PATIENCE });
      assert((await hash()).includes(`job/${id}`), await hash());
      await job.getByRole('button', { name: 'Close' }).click();
    }
    await context.request.delete(new URL(`/v1/jobs/${id}`, url).href);
    // It covers a place: one that covers nothing is refused.
    const area = await post('/v1/closures', {
      outline: [
        [0, 0],
        [0.3, 0],
        [0.3, 0.3],
      ],
      reason: 'Paint is drying',
    });
    await until('the area', async () => (await closures.getByText('Paint is drying').count()) > 0, 20);
    const charger = map.nodes.find((n) => n.kind === 'charger').id;
    const expected = [
      [map.racks[3].id, 'Rack'],
      [map.stations[1].id, 'Station'],
      [charger, 'Charger'],
      ['drying paint', 'Closed area'],
      [map.nodes.find((n) => n.kind === 'aisle').id, 'Aisle'],
    ];
    const worker = (await ask('/v1/workers')).items[0];
    if (worker) expected.push([worker.name, 'Person']);
    for (const [text, word] of expected) {
      await find.fill(text);
      await found.filter({ hasText: word }).first().waitFor({ timeout: PATIENCE });
    }
    await page.keyboard.press('Escape');
    await context.request.delete(new URL(`/v1/closures/${area.id}`, url).href);
    return expected.map(([text, word]) => `${text}: ${word}`).join(', ');
  },
);
await check('A robot that was found shows its name', async () => {
  await find.fill((await robots())[2].id);
  await page.keyboard.press('Enter');
  await page.waitForTimeout(600);
  const scale = Number((await shown('view')).split(' ')[2]);
  await card.getByRole('button', { name: 'Close' }).click();
  await page.waitForTimeout(600);
  assert(scale >= 28 && Number(await shown('names')) > 0, `at ${scale} px/m there are ${await shown('names')} names`);
  await button('Show the whole floor').click();
  return `${scale} px/m`;
});
await check(
  'An address chooses a thing and a tab, Back and Forward go through them, and an unknown one says so',
  async () => {
    const [first, second] = (await robots()).map((r) => r.id);
    await open(`#robot/${first}&tab/robots`);
    await card.getByRole('heading', { name: first, exact: true }).waitFor({ timeout: PATIENCE });
    await page.getByRole('region', { name: 'Robots', exact: true }).waitFor({ timeout: PATIENCE });
    await find.fill(second);
    await page.keyboard.press('Enter');
    await card.getByRole('heading', { name: second, exact: true }).waitFor({ timeout: PATIENCE });
    assert((await hash()) === `#robot/${second}&tab/robots`, await hash());
    await tab('Jobs').click();
    assert((await hash()) === `#robot/${second}`, await hash());
    await page.goBack();
    await page.getByRole('region', { name: 'Robots', exact: true }).waitFor({ timeout: PATIENCE });
    await page.goBack();
    await card.getByRole('heading', { name: first, exact: true }).waitFor({ timeout: PATIENCE });
    await page.goForward();
    await card.getByRole('heading', { name: second, exact: true }).waitFor({ timeout: PATIENCE });
    for (const [address, label, title] of [
      ['#station/', 'Station', map.stations[0].id],
      ['#rack/', 'Rack', map.racks[1].id],
      ['#place/', 'Place', map.nodes.find((n) => n.kind === 'charger').id],
    ]) {
      await open(address + encodeURIComponent(title));
      await page
        .getByRole('region', { name: label, exact: true })
        .getByRole('heading', { name: title, exact: true })
        .waitFor({ timeout: PATIENCE });
    }
    await open('#robot/robot-999');
    await messages
      .getByRole('alert')
      .filter({ hasText: 'There is no robot robot-999 on this floor.' })
      .waitFor({ timeout: PATIENCE });
    await page.waitForTimeout(200);
    await both('map-unknown');
    await messages.getByRole('button', { name: 'Dismiss the message' }).click();
    await open('#nonsense');
    await messages.getByRole('alert').filter({ hasText: '“nonsense”' }).waitFor({ timeout: PATIENCE });
    await open('#job/j999999');
    await page.getByRole('region', { name: 'Job', exact: true }).getByRole('alert').waitFor({ timeout: PATIENCE });
    await open('');
  },
);
await check('An address of the past opens the past, and Back leads to the present', async () => {
  const id = (await robots())[0].id;
  await open(`#robot/${id}`);
  await until('some seconds of the past', async () => ((await ask('/v1/past')).spans[0]?.to_s ?? 0) > 8, 40);
  await page.evaluate(() => {
    location.hash = '#replay?from=2&to=6';
  });
  await page.getByRole('status').filter({ hasText: 'Replay: this is the past' }).waitFor({ timeout: PATIENCE });
  await page.goBack();
  await page
    .getByRole('status')
    .filter({ hasText: 'Replay: this is the past' })
    .waitFor({ state: 'detached', timeout: PATIENCE });
  await card.getByRole('heading', { name: id, exact: true }).waitFor({ timeout: PATIENCE });
  assert((await hash()) === `#robot/${id}`, await hash());
  await open('');
});
await check('What was done is undone by a button, by keys, and for a robot, a floor and an area alike', async () => {
  const undo = messages.getByRole('button', { name: 'Undo' });
  const id = (await robots())[1].id;
  const one = async () => (await robots()).find((r) => r.id === id);
  await open(`#robot/${id}`);
  await card.getByRole('button', { name: 'Pause this robot' }).click();
  await messages.getByText(`Paused a robot: ${id}`).waitFor({ timeout: PATIENCE });
  // With the focus the offer stays for as long as the pictures take.
  await undo.focus();
  await both('map-undo');
  await undo.click();
  await until('a robot that goes on', async () => (await one()).activity !== 'paused', 20);
  await card.getByRole('button', { name: 'Out of service' }).click();
  await messages.getByText(`Took a robot out of service: ${id}`).waitFor({ timeout: PATIENCE });
  await host.focus();
  await page.keyboard.press('Control+z');
  await until('a robot in service', async () => !(await one()).maintenance, 20);
  await card.getByRole('button', { name: 'Close' }).click();
  // To undo a stop asks first, as each start of all robots does; to undo a start does not.
  await button('Stop all robots').click();
  await messages.getByText('Stopped all robots').waitFor({ timeout: PATIENCE });
  await undo.click();
  await page.getByRole('dialog').getByRole('button', { name: 'Resume all robots' }).click();
  await messages.getByText('Resumed all robots').waitFor({ timeout: PATIENCE });
  await undo.focus();
  await page.keyboard.press('Enter');
  await until('a stopped floor', async () => (await ask('/v1/fleet')).stopped !== null, 20);
  await post('/v1/fleet/resume');
  await until(
    'a floor without alarm',
    async () => (await page.getByText('All robots are stopped by hand', { exact: true }).count()) === 0,
    20,
  );
  const area = {
    outline: [
      [0, 0],
      [0.3, 0],
      [0.3, 0.3],
    ],
    reason: 'Paint',
  };
  // The list may show the area that was just opened for a moment longer, so each button is named by its area.
  const openAgain = (id) =>
    closures.getByRole('button', { name: `Open ${id} again`, exact: true }).click({ timeout: PATIENCE });
  const closed = async () => (await ask('/v1/closures')).items.filter((c) => c.state === 'closed');
  const first = (await post('/v1/closures', area)).id;
  await openAgain(first);
  await messages.getByText(`Opened an area: ${first}`, { exact: true }).waitFor({ timeout: PATIENCE });
  await undo.click();
  await until('the area again', async () => (await closed()).some((c) => c.reason === 'Paint' && c.id !== first), 20);
  await openAgain((await closed()).find((c) => c.reason === 'Paint').id);
  await until('no area', async () => (await closed()).length === 0, 20);
  await messages.getByRole('button', { name: 'Dismiss the message' }).click();
});
await check('The offer to undo ends after ten seconds, but not while it has the focus', async () => {
  const id = (await robots())[3].id;
  await open(`#robot/${id}`);
  await card.getByRole('button', { name: 'Pause this robot' }).click();
  await messages.getByRole('button', { name: 'Undo' }).focus();
  await page.waitForTimeout(11_000);
  assert(await messages.getByRole('button', { name: 'Undo' }).isVisible(), 'it went although it had the focus');
  await host.focus();
  await messages.getByRole('button', { name: 'Undo' }).waitFor({ state: 'detached', timeout: 15_000 });
  await card.getByRole('button', { name: 'Resume this robot' }).click();
  await card.getByRole('button', { name: 'Pause this robot' }).waitFor({ timeout: PATIENCE });
});
await check('What is refused is said beside what asked for it', async () => {
  await page.reload();
  await drawn();
  const id = (await robots())[0].id;
  // A job that waits for another one can be cancelled for as long as this takes.
  const first = await post('/v1/jobs', {
    kind: 'deliver',
    rack: map.racks[0].id,
    station: map.stations[0].id,
    pick_s: 3600,
  });
  const second = await post('/v1/jobs', {
    kind: 'deliver',
    rack: map.racks[1].id,
    station: map.stations[0].id,
    after: [first.id],
  });
  const area = await post('/v1/closures', {
    outline: [
      [0, 0],
      [0.3, 0],
      [0.3, 0.3],
    ],
    reason: 'Paint',
  });
  // Each refusal has a number, so that an earlier one is not taken for it.
  let asked = 0;
  await page.route('**/v1/**', (route) => {
    if (route.request().method() === 'GET') return route.continue();
    asked += 1;
    const detail = `The test refuses this, number ${asked}.`;
    return route.fulfill({
      status: 409,
      contentType: 'application/problem+json',
      body: JSON.stringify({ title: 'No', status: 409, detail }),
    });
  });
  const refused = async (where, act) => {
    const before = asked;
    await act();
    await until('a request', () => asked > before, 20);
    await where
      .getByRole('alert')
      .filter({ hasText: `number ${asked}.` })
      .waitFor({ timeout: PATIENCE });
  };
  const told = [];
  await find.fill(id);
  await page.keyboard.press('Enter');
  for (const name of [
    /^(Pause|Resume) this robot$/,
    /^(Remove from|Keep on) the floor$/,
    /^(Out of|Back in) service$/,
  ]) {
    await refused(card, () => card.getByRole('button', { name }).click());
  }
  await card.getByRole('button', { name: 'Close' }).click();
  told.push('robot');
  await find.fill(map.stations[0].id);
  await page.keyboard.press('Enter');
  const station = page.getByRole('region', { name: 'Station', exact: true });
  await refused(station, () => station.getByRole('button', { name: 'Pause the station' }).click());
  await station.getByRole('button', { name: 'Close' }).click();
  told.push('station');
  const table = page.getByRole('region', { name: 'Table of jobs' });
  await table.getByRole('button', { name: `Cancel ${second.id}` }).click({ timeout: PATIENCE });
  const dialog = page.getByRole('dialog');
  await refused(dialog, () => dialog.getByRole('button', { name: 'Cancel the job' }).click());
  await page.screenshot({ path: `${SHOTS}map-refused.png` });
  await dialog.getByRole('button', { name: 'Keep it' }).click();
  await table.getByRole('button', { name: second.id, exact: true }).click();
  const job = page.getByRole('region', { name: 'Job', exact: true });
  await refused(job, () => job.getByLabel('Priority, 0 to 9').selectOption('9'));
  await job.getByRole('button', { name: 'Close' }).click();
  told.push('cancelled job', 'priority');
  const form = page.getByRole('form', { name: 'New job' });
  await form.getByLabel('Rack', { exact: true }).fill(map.racks[2].id);
  await form.getByLabel('Station', { exact: true }).fill(map.stations[0].id);
  await refused(form, () => form.getByRole('button', { name: 'Submit job' }).click());
  told.push('new job');
  await button('Many jobs from a table').click();
  await dialog
    .getByLabel('Or paste it here')
    .fill(`kind,rack,station\ndeliver,${map.racks[2].id},${map.stations[0].id}\n`);
  await refused(dialog, () => dialog.getByRole('button', { name: 'Submit 1 job' }).click());
  await dialog.getByRole('button', { name: 'Close' }).click();
  told.push('many jobs');
  await closures.getByRole('button', { name: 'Close a polygon' }).focus();
  await page.keyboard.press('Enter');
  await page.getByRole('application', { name: 'Drawing on the floor' }).waitFor({ timeout: PATIENCE });
  for (const key of ['Enter', 'ArrowRight', 'ArrowRight', 'Enter', 'ArrowUp', 'ArrowUp', 'Enter', 'Enter'])
    await page.keyboard.press(key);
  const closing = closures.getByRole('form', { name: 'Close an area' });
  await closing.getByLabel('Why').fill('cleaning');
  await refused(closing, () => closing.getByRole('button', { name: 'Close the area' }).click());
  await closing.getByRole('button', { name: 'Do not close it' }).click();
  const line = closures.getByRole('listitem').filter({ hasText: 'Paint' });
  await refused(line, () => line.getByRole('button', { name: `Open ${area.id} again` }).click());
  told.push('closed area', 'opened area');
  await tab('Robots').click();
  const panel = page.getByRole('region', { name: 'Robots', exact: true });
  await panel.getByRole('checkbox', { name: `Select ${id}`, exact: true }).check();
  await refused(panel, () =>
    panel
      .getByRole('button', { name: /^(Pause|Resume)$/ })
      .and(page.locator(':enabled'))
      .first()
      .click(),
  );
  told.push('several robots');
  await refused(page.locator('header'), () => button('Stop all robots').click());
  await button('Evacuate').click();
  await refused(page.locator('header'), () => dialog.getByRole('button', { name: 'Evacuate now' }).click());
  told.push('stop', 'evacuation');
  await page.unroute('**/v1/**');
  for (const one of [second, first]) await context.request.delete(new URL(`/v1/jobs/${one.id}`, url).href);
  await context.request.delete(new URL(`/v1/closures/${area.id}`, url).href);
  await page.reload();
  await drawn();
  return told.join(', ');
});
await check('From afar there are no routes but that of the chosen robot, with either painter', async () => {
  for (const painter of ['webgl', 'canvas2d']) {
    const small = await (await browser.newContext({ viewport: { width: 390, height: 844 } })).newPage();
    listen(small, complaints, isRefusal);
    await small.goto(`${url}/?painter=${painter}`);
    await drawn(small);
    await until('routes', async () => Number(await shown('routes', small)) > 0, 60);
    await small.getByRole('application', { name: 'Map of the floor' }).focus();
    for (let i = 0; i < 4; i++) await small.keyboard.press('-');
    await until('no routes', async () => Number(await shown('routes', small)) === 0, 10);
    await small.screenshot({ path: `${SHOTS}map-far-${painter}.png` });
    await until(
      'the route of one robot',
      async () => {
        const driving = (await robots()).find((r) => r.activity === 'driving');
        if (!driving) return false;
        await small.evaluate((id) => {
          location.hash = `#robot/${id}`;
        }, driving.id);
        for (let i = 0; i < 8; i++) await small.getByRole('button', { name: 'Zoom out' }).click();
        await small.waitForTimeout(400);
        return Number((await shown('view', small)).split(' ')[2]) < 10 && Number(await shown('routes', small)) > 0;
      },
      30,
    );
    await small.close();
  }
});
for (const [width, height, hand] of [
  [820, 1180, true],
  [1180, 820, true],
  [390, 844, true],
]) {
  await check(
    `At ${width} × ${height} map and list are both usable by finger, and nothing scrolls sideways`,
    async () => {
      const other = await browser.newContext({ viewport: { width, height }, hasTouch: hand });
      const tablet = await other.newPage();
      listen(tablet, complaints, isRefusal);
      await tablet.goto(url);
      await drawn(tablet);
      const told = [];
      for (const name of ['Jobs', 'Robots', 'Timelines', 'Charts', 'Encounters']) {
        await tablet
          .getByRole('group', { name: 'What is shown below the floor' })
          .getByRole('button', { name, exact: true })
          .click();
        await tablet.waitForTimeout(600);
        const over = await tablet.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert(over <= 0, `${name}: it is ${over} px too wide`);
        const small = await tablet.evaluate(() =>
          [...document.querySelectorAll('#app :is(button, input, select, summary)')].flatMap((one) => {
            const target = one.matches('[type="checkbox"], [type="radio"]') ? (one.closest('label') ?? one) : one;
            const { width: w, height: h } = target.getBoundingClientRect();
            // What is out of sight is no target; links in a line of text are as high as that.
            if (
              !one.checkVisibility({ visibilityProperty: true }) ||
              one.closest('.hidden') ||
              w < 2 ||
              one.matches('[type="range"]')
            )
              return [];
            return h < 39.5 || (w < 39.5 && !one.matches('.link'))
              ? [`${one.getAttribute('aria-label') ?? one.innerText} ${Math.round(w)} × ${Math.round(h)}`]
              : [];
          }),
        );
        assert(small.length === 0, `${name}: too small: ${small.slice(0, 6).join('; ')}`);
      }
      const box = await tablet.getByRole('application', { name: 'Map of the floor' }).boundingBox();
      assert(
        box.height >= 280 && box.width >= 0.6 * Math.min(width, 1100) - 20,
        `the map is ${box.width} × ${box.height}`,
      );
      if (width > 640) {
        const list = await tablet.locator('.below').boundingBox();
        assert(list.height >= 180 && list.y + 180 <= height, `the list is ${list.height} high from ${list.y}`);
        told.push(`list ${Math.round(list.height)} px`);
      }
      await tablet.getByRole('button', { name: 'Jobs', exact: true }).click();
      await both(`map-${width}`, tablet);
      await other.close();
      return [`map ${Math.round(box.width)} × ${Math.round(box.height)}`, ...told].join(', ');
    },
  );
}
await check('Nothing was complained about', async () => {
  assert(complaints.length === 0, complaints.join('; '));
});
await stop();
await finish(browser);
