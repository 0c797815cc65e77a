// The display of a picking station in a real browser, against a real server that this test starts itself, kills in the
// middle of a visit and starts again: node tests/station.mjs PATH_TO_GIVEWAY. Each check prints a sentence.
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
  isLostLink,
  isRefusal,
  listen,
  openBrowser,
  until,
} from './chromium.mjs';
import { FAST, QUICK, serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/station.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
const MAP = HERE('../../maps/stations.json');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-station-`);
const scenario = {
  giveway_scenario: 1,
  name: 'cells',
  robots: 4,
  period_ms: 100,
  jobs: 'none',
  map: MAP,
  fleet: QUICK,
};
writeFileSync(`${scratch}/cells.json`, JSON.stringify(scenario));

// A rack with slots, and what is taken from it: five lines, each confirmed in another way.
const map = JSON.parse(readFileSync(MAP, 'utf8'));
const S1 = map.stations.find((one) => one.id === 'S1');
const [tote, other] = S1.cell.totes.map(({ id }) => id);
const [rack, second] = map.racks.filter(({ type }) => type);
const face = map.rack_types.find(({ id }) => id === rack.type);
const lines = [
  { slot: 'C3', quantity: 1, tote, item: 'M6 bolts' },
  { slot: 'B2', quantity: 1, tote: other, item: 'Washers, steel, 6.4 mm' },
  { slot: 'A1', quantity: 2, tote },
  { slot: 'C2', quantity: 3, tote: other, item: 'Cable ties, black, 200 mm' },
  { slot: 'B3', quantity: 1, tote },
];

let server = await serve(program, `${scratch}/cells.json`, scratch, 0, FAST);
const { url } = server;
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints, (message) => isRefusal(message) || isLostLink(message));
await page.addInitScript(() => {
  globalThis.tones = 0;
  const begin = OscillatorNode.prototype.start;
  OscillatorNode.prototype.start = function (...when) {
    globalThis.tones += 1;
    return begin.apply(this, when);
  };
});
const ask = async (path) => (await context.request.get(url + path)).json();
const post = async (path, data) => {
  const answer = await context.request.post(url + path, { data });
  assert(answer.ok(), `${path}: ${answer.status()} ${await answer.text()}`);
  return answer.json();
};
const deliver = ({ id }, wanted) =>
  post('/v1/jobs', { kind: 'deliver', rack: id, station: 'S1', pick_s: 900, lines: wanted });
const states = async () => (await ask('/v1/stations/S1')).visit?.lines.map((one) => `${one.state} ${one.done}`) ?? [];
const becomes = (n, state) => until(`line ${n} ${state}`, async () => (await states())[n - 1] === state, 30);

const act = (name) => page.locator(`[data-act="${name}"]`);
const slot = (name) => page.locator(`.slot[data-name="${name}"]`);
const inTote = (name) => page.locator(`.tote[data-name="${name}"]`);
const isLit = async (name) => {
  await page.locator(`#station[data-link="live"][data-lit="${name}"]`).waitFor({ timeout: PATIENCE });
  // A line that has just been lit cannot be confirmed yet: nobody has read it.
  await page.waitForTimeout(600);
};
/** A scanner types faster than Playwright may on a busy machine. */
const scan = (text) =>
  page.evaluate((all) => {
    for (const key of [...all, 'Enter']) {
      document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
    }
  }, text);
const fits = async (look) => {
  const over = await page.evaluate(() => {
    const { scrollWidth, scrollHeight } = document.documentElement;
    const main = document.querySelector('main');
    return [scrollWidth - innerWidth, scrollHeight - innerHeight, main.scrollHeight - main.clientHeight];
  });
  assert(
    over.every((px) => px <= 0),
    `${look} is too large by ${over.join(', ')} px`,
  );
};
const looks = async (name) => {
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    await page.waitForTimeout(300);
    await page.screenshot({ path: `${SHOTS}station-${name}-${colorScheme}.png` });
    await assertAccessible(page, `${name}, ${colorScheme}`);
    await fits(`${name}, ${colorScheme}`);
  }
};

await check('Whoever names no station of this floor is offered those that there are', async () => {
  await page.goto(`${url}/station/nowhere`);
  await page.getByRole('heading', { name: 'There is no station nowhere' }).waitFor({ timeout: PATIENCE });
  await assertAccessible(page, 'no such station');
  await page.getByRole('link', { name: 'S1', exact: true }).click();
  await page.locator('#station[data-link="live"]').waitFor({ timeout: PATIENCE });
  return page.url().replace(url, '');
});
await check('Before a rack comes, the display says so', async () => {
  await page.getByText('No rack is here').first().waitFor({ timeout: PATIENCE });
  assert(await act('done').isDisabled(), 'something could be done');
  await looks('none');
});
const job = await deliver(rack, lines);
await check('It says which rack comes', async () => {
  await page.locator('.next', { hasText: rack.id }).waitFor({ timeout: PATIENCE });
  return page.locator('.next').innerText();
});
await check('When the rack is there, the first slot and its tote are lit, and the next line is marked', async () => {
  await until(`${job.id} at S1`, async () => (await ask(`/v1/jobs/${job.id}`)).state === 'picking');
  await isLit('C3');
  const marks = await Promise.all([slot('C3'), slot('B2'), inTote(tote)].map((one) => one.getAttribute('data-mark')));
  assert(marks.join() === 'lit,next,lit', `the marks are ${marks.join()}`);
  assert((await slot('C3').innerHTML()).includes('>1<'), 'the slot does not say how many');
  await page.getByText('M6 bolts').first().waitFor();
  await page.screenshot({ path: `${SHOTS}station.png` });
  return (await page.locator('.big').innerText()).replaceAll(/\s+/g, ' ');
});
await check('The face is to scale', async () => {
  // Both at once: the rack may be drawn anew at any time.
  const boxes = await page.evaluate(() =>
    ['A1', 'B2'].map((name) => {
      const { x, y, height } = document.querySelector(`.slot[data-name="${name}"] .ground`).getBoundingClientRect();
      return { x, y, height };
    }),
  );
  const [dx, dy] = [boxes[1].x - boxes[0].x, boxes[0].y + boxes[0].height / 2 - boxes[1].y - boxes[1].height / 2];
  assert(dx > 0 && dy > 0, 'B2 is not to the right of A1 and above it');
  const wanted = face.width_m / face.columns / (face.heights_m[1] - face.heights_m[0] || 1);
  // The lowest row may end at the floor, below which nothing is drawn.
  assert(Math.abs(dx / dy / wanted - 1) < 0.15, `${(dx / dy).toFixed(2)} instead of ${wanted.toFixed(2)}`);
});
for (const [width, height] of [
  [1920, 1080],
  [768, 1024],
  [1280, 800],
]) {
  await check(`At ${width} × ${height} nothing has to be scrolled, in both themes`, async () => {
    await page.setViewportSize({ width, height });
    await looks(`lit-${width}`);
  });
}
await check('The button Done confirms the line, and the next one is lit', async () => {
  await act('done').dblclick();
  await becomes(1, 'done 1');
  await isLit('B2');
  assert((await states())[1] === 'lit 0', `two clicks were more than one: ${await states()}`);
});
await check('Enter confirms a line, too', async () => {
  await page.keyboard.press('Enter');
  await becomes(2, 'done 1');
  await isLit('A1');
});
await check('A scan of another slot is a mistake that is seen and heard, and confirms nothing', async () => {
  const before = await page.evaluate(() => globalThis.tones);
  await scan('B3');
  await page.locator('#station[data-mistake="wrong_slot"]').waitFor({ timeout: PATIENCE });
  assert((await slot('B3').locator('.cross').count()) === 1, 'the wrong slot has no cross');
  assert((await page.getByRole('alert').first().innerText()).includes('B3'), 'it is not said');
  await page.screenshot({ path: `${SHOTS}station-mistake.png` });
  assert((await page.evaluate(() => globalThis.tones)) > before, 'it makes no sound');
  await page.locator('#station[data-mistake=""]').waitFor({ timeout: PATIENCE });
  assert((await states())[2] === 'lit 0', (await states()).join());
});
await check('A scan of the lit slot confirms one piece, and the tote is checked', async () => {
  await scan('A1');
  await becomes(3, 'lit 1');
  await scan(other);
  await page.locator('#station[data-mistake="wrong_tote"]').waitFor({ timeout: PATIENCE });
  await scan(tote);
  await page.getByText(`Tote ${tote} is right`).waitFor({ timeout: PATIENCE });
  await page.locator('#station[data-mistake=""]').waitFor({ timeout: 500 });
  await scan('A1');
  await becomes(3, 'done 2');
  await isLit('C2');
});
await check('What is missing is said with a key, and undone with a button that names the slot', async () => {
  await page.keyboard.press('m');
  await becomes(4, 'short 0');
  await isLit('B3');
  await page.getByRole('button', { name: 'Undo C2' }).click();
  await isLit('C2');
  assert((await states())[3] === 'lit 0', (await states()).join());
  await act('plus').click();
  await becomes(4, 'lit 1');
});
await check('The station is paused and goes on with one key', async () => {
  await page.keyboard.press('p');
  await page.getByText('Paused since').waitFor({ timeout: PATIENCE });
  await looks('paused');
  await page.keyboard.press('p');
  await page.getByText('Paused since').waitFor({ state: 'hidden', timeout: PATIENCE });
});
let before = [];
await check('A server that was killed is said plainly, and nothing can be pressed', async () => {
  before = await page.locator('.lines li').allInnerTexts();
  await server.kill();
  await page.getByText('No connection for').waitFor({ timeout: PATIENCE });
  await page.getByText('What you see is old').waitFor({ timeout: PATIENCE });
  assert((await act('done').isDisabled()) && (await act('pause').isDisabled()), 'buttons can be pressed');
  await looks('old');
  return page.locator('.old').innerText();
});
await check('When it is back, the same lines are there, and the display went on by itself', async () => {
  server = await serve(program, `${scratch}/cells.json`, scratch, new URL(url).port, FAST);
  await isLit('C2');
  const after = await page.locator('.lines li').allInnerTexts();
  assert(after.join('|') === before.join('|'), `${after.join('; ')} instead of ${before.join('; ')}`);
  assert((await states())[3] === 'lit 1', (await states()).join());
  return after.map((one) => one.replaceAll(/\s+/g, ' ')).join('; ');
});
await deliver(second, [{ slot: 'A1', quantity: 2, tote }]);
await check('With the last line the visit ends', async () => {
  await act('done').click();
  await isLit('B3');
  await page.keyboard.press(' ');
  await until(`${job.id} done`, async () => (await ask(`/v1/jobs/${job.id}`)).state === 'done');
});
await check('A rack is let go only after a question', async () => {
  await isLit('A1');
  const { visit } = await ask('/v1/stations/S1');
  await act('release').click();
  await page.getByRole('dialog', { name: `Let rack ${second.id} go?` }).waitFor({ timeout: PATIENCE });
  await looks('release');
  await page.getByRole('button', { name: 'Keep it here' }).click();
  assert((await ask('/v1/stations/S1')).visit.job === visit.job, 'it has gone');
  await act('release').click();
  await page.getByRole('button', { name: 'Let it go' }).click();
  await until(`${visit.job} done`, async () => (await ask(`/v1/jobs/${visit.job}`)).state === 'done');
});
await check('Nothing was complained about', () => assert(complaints.length === 0, complaints.join(' | ')));

await server.stop();
await finish(browser);
