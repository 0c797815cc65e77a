// Alarms on the page, against a real server that this test starts itself, on whose floor robots break down:
// node tests/alarms.mjs PATH-TO-GIVEWAY
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
  console.error('Say where the program is: node tests/alarms.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-alarms-`);
const scenario = JSON.parse(readFileSync(HERE('../../scenarios/lab.json'), 'utf8'));
// Two robots, which break down soon after they set off and stay broken.
Object.assign(scenario, {
  map: HERE('../../maps/lab.json'),
  robots: 2,
  workers: undefined,
  faults: { failures_per_hour: 1000, repair_s: 100000 },
});
writeFileSync(`${scratch}/alarms.json`, JSON.stringify(scenario));
const { url, stop } = await serve(program, `${scratch}/alarms.json`, scratch);
const browser = await openBrowser();
const context = await browser.newContext({
  viewport: { width: 1440, height: 900 },
  colorScheme: 'dark',
  permissions: ['notifications'],
});
// What the page would sound and show, since a browser without a window does neither.
await context.addInitScript(() => {
  globalThis.shown = [];
  globalThis.tones = 0;
  const start = OscillatorNode.prototype.start;
  OscillatorNode.prototype.start = function (...args) {
    globalThis.tones += 1;
    return start.apply(this, args);
  };
  globalThis.Notification = class {
    static permission = 'granted';
    static requestPermission = async () => 'granted';
    constructor(title) {
      globalThis.shown.push(title);
    }
  };
});
const page = await context.newPage();
const complaints = [];
listen(page, complaints, isRefusal);
const ask = async (path) => (await context.request.get(new URL(path, url).href)).json();
const active = async () => (await ask('/v1/alarms')).items;
const alarms = page.getByRole('region', { name: 'Alarms', exact: true });
const failed = alarms.locator('li[data-alarm="robot_failed"]').first();

await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
  timeout: PATIENCE,
});

await check('Sound and notifications are off until they are asked for, and are switched on by keys', async () => {
  const boxes = [alarms.getByLabel('Sound'), alarms.getByLabel('Notify')];
  for (const box of boxes) assert(!(await box.isChecked()), 'it is on from the start');
  for (const box of boxes) {
    await box.focus();
    await page.keyboard.press('Space');
    assert(await box.isChecked(), 'it is not switched on');
  }
});
let robot = '';
await check('A robot that breaks down is listed with how bad it is, for how long and what to do', async () => {
  await failed.waitFor({ timeout: 4 * PATIENCE });
  const words = (await failed.innerText()).replaceAll(/\s+/g, ' ');
  assert(/for \d+ (s|min)/.test(words) && /repair it/.test(words), words);
  robot = (await active()).find((a) => a.kind === 'robot_failed').subject.id;
  return words;
});
await check('The title of the tab counts it, and it made a sound and a notification', async () => {
  await page.waitForFunction(() => /^\(\d+\) Giveway$/.test(document.title), null, { timeout: PATIENCE });
  await page.waitForFunction(() => globalThis.tones > 0 && globalThis.shown.length > 0, null, { timeout: PATIENCE });
  return page.evaluate(() => globalThis.shown[0]);
});
await check('Its subject is chosen on the floor by a key', async () => {
  await failed.getByRole('button', { name: /^robot-\d+$/ }).focus();
  await page.keyboard.press('Enter');
  const card = page.getByRole('region', { name: 'Robot', exact: true });
  await card.getByRole('heading', { name: /^robot-\d+$/ }).waitFor({ timeout: PATIENCE });
  await page.waitForTimeout(600);
  await page.screenshot({ path: `${SHOTS}alarms.png` });
  await card.getByRole('button', { name: 'Close' }).click();
});
await check('It is acknowledged by keys alone, with a name that the server keeps', async () => {
  for (const theme of ['Light', 'Dark']) {
    await page.getByLabel('Theme').selectOption({ label: theme });
    await assertAccessible(page, `alarms, ${theme}`);
  }
  await failed.getByRole('button', { name: /^Acknowledge/ }).focus();
  await page.keyboard.press('Enter');
  const dialog = page.getByRole('dialog', { name: 'Who looks after it?' });
  await dialog.getByLabel('Your name').fill('Ben');
  await assertAccessible(page, 'asking for a name');
  await page.keyboard.press('Enter');
  await alarms.getByText('acknowledged by Ben').first().waitFor({ timeout: PATIENCE });
  await until(
    'an acknowledgement at the server',
    async () => (await active()).some((a) => a.acknowledged?.by === 'Ben'),
    20,
  );
  // The name is known now.
  for (let i = 0; i < 4 && (await alarms.getByRole('button', { name: /^Acknowledge/ }).count()) > 0; i++) {
    await alarms
      .getByRole('button', { name: /^Acknowledge/ })
      .first()
      .click();
    await page.waitForTimeout(800);
  }
});
const board = page.getByRole('region', { name: 'Alarm page' });
await check(
  'The alarm page has it: a note, a time put aside, the text for the next shift, all by one name',
  async () => {
    await alarms.getByRole('button', { name: 'All alarms' }).click();
    const row = board.locator('tr[data-alarm="robot_failed"]').first();
    await row.waitFor({ timeout: PATIENCE });
    await row.getByRole('button', { name: /^More/ }).click();
    await board.getByLabel('Note').fill('a wheel is loose');
    await board.getByRole('button', { name: 'Add a note' }).click();
    await board.getByText('a wheel is loose').waitFor({ timeout: PATIENCE });
    await board.getByLabel('Put aside because').fill('being mended');
    await board.getByRole('button', { name: 'Put aside', exact: true }).click();
    await board
      .getByText(/Put aside until .* by Ben: being mended/)
      .first()
      .waitFor({ timeout: PATIENCE });
    assert(
      (await active()).some((a) => a.shelved?.reason === 'being mended'),
      'the server does not know',
    );
    for (const theme of ['Light', 'Dark']) {
      await page.getByLabel('Theme').selectOption({ label: theme });
      await page.waitForTimeout(400);
      await page.screenshot({ path: `${SHOTS}alarm-page-${theme.toLowerCase()}.png` });
      await assertAccessible(page, `the alarm page, ${theme}`);
    }
    await board.getByRole('button', { name: 'Take back up' }).click();
    await until('an alarm that calls again', async () => (await active()).every((a) => a.shelved === null), 20);
    await board.getByRole('button', { name: 'Hand-over text' }).click();
    const shift = page.getByLabel('For the next shift');
    await shift.waitFor({ timeout: PATIENCE });
    const text = await shift.inputValue();
    assert(/acknowledged by Ben/.test(text) && /Ben: a wheel is loose/.test(text), text);
    await assertAccessible(page, 'the hand-over');
    await page.screenshot({ path: `${SHOTS}alarm-hand-over.png` });
    await page.keyboard.press('Escape');
  },
);
await check('The history has it, with who acknowledged it', async () => {
  await board.getByRole('button', { name: 'History' }).click();
  await board.locator('tr[data-alarm="robot_failed"]').first().waitFor({ timeout: PATIENCE });
  await board
    .getByText(/^Ben, /)
    .first()
    .waitFor({ timeout: PATIENCE });
  await board.getByLabel('Search alarms').fill('nothing has this in it');
  await board.getByText('No alarm matches.').waitFor({ timeout: PATIENCE });
  return robot;
});
await check(
  'A person who is lost has a way out: the area is shown, narrowed by a click, and cleared with a name',
  async () => {
    const post = (path, data) => context.request.post(new URL(path, url).href, { data });
    const worker = (await (await post('/v1/workers', { name: 'anna' })).json()).id;
    const seen = async () => ask(`/v1/workers/${worker}`);
    const place = (await ask('/v1/map')).nodes.find((n) => n.kind === 'aisle');
    assert(
      (await post(`/v1/workers/${worker}/position`, { x: place.x, y: place.y, accuracy_m: 0.1 })).ok(),
      'the position is not taken',
    );
    await until(
      'a lost worker in a wide area',
      async () => {
        const w = await seen();
        return w.presence === 'lost' && w.area.length > 20;
      },
      30,
    );
    const wide = (await seen()).area.length;
    // The floor has a pseudonym; the card has the name, for those who may see it.
    await page.getByLabel('Find on the floor').fill((await seen()).id);
    await page.keyboard.press('Enter');
    const form = page.getByRole('form', { name: 'Lost person' });
    await form.getByText(/Robots keep out of [1-9]\d* places/).waitFor({ timeout: PATIENCE });
    const name = form.getByLabel('Your name');
    assert((await name.inputValue()) === 'Ben', 'who acknowledged an alarm is known');
    await name.fill('');
    await form.getByRole('button', { name: 'Nobody is there' }).click();
    await form.getByText(/Say who you are/).waitFor({ timeout: PATIENCE });
    assert((await seen()).presence === 'lost', 'cleared without a name');
    await name.fill('Ben');
    for (const theme of ['Light', 'Dark']) {
      await page.getByLabel('Theme').selectOption({ label: theme });
      await page.waitForTimeout(600);
      await page.screenshot({ path: `${SHOTS}lost-${theme.toLowerCase()}.png` });
      await assertAccessible(page, `a lost person, ${theme}`);
    }
    await form.getByLabel('How near').selectOption({ label: 'within 1.5 m' });
    await page.getByRole('region', { name: 'Person', exact: true }).getByRole('button', { name: 'Centre' }).click();
    await page.waitForTimeout(1_000);
    await form.getByRole('button', { name: /is near…$/ }).click();
    const floor = await page.locator('canvas').first().boundingBox();
    await page.mouse.click(floor.x + floor.width / 2, floor.y + floor.height / 2);
    await form.getByText(/keep out of 1\.5 m/).waitFor({ timeout: PATIENCE });
    await until('a smaller area', async () => (await seen()).area.length < wide / 2, 20);
    const narrow = (await seen()).area.length;
    await form.getByRole('button', { name: 'Nobody is there' }).click();
    await until('nobody', async () => (await seen()).presence === 'absent', 20);
    return `${wide} places, then ${narrow}`;
  },
);
await check('On a phone the list is as usable', async () => {
  await page.setViewportSize({ width: 390, height: 800 });
  await failed.scrollIntoViewIfNeeded();
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert(wide <= 390, `the page is ${wide} px wide`);
  await assertAccessible(page, 'alarms on a phone');
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await stop();
await finish(browser);
