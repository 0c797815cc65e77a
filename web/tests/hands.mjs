// Hands of a scripted headset at a picking station, in a real browser against a real server that this test starts
// itself and kills in the middle of a visit: node tests/hands.mjs PATH_TO_GIVEWAY. They confirm lines without a click,
// and a wrong slot is shown before the hand is in. Where the headset or the server goes, nothing is confirmed, and the
// page goes on. Each check prints a sentence.
import { mkdtempSync, writeFileSync } from 'node:fs';
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
  listen,
  openBrowser,
  until,
} from './chromium.mjs';
import { Headset, bench } from './picker.mjs';
import { QUICK, serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/hands.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
const MAP = HERE('../../maps/stations.json');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-hands-`);
const scenario = { giveway_scenario: 1, name: 'hands', robots: 4, period_ms: 50, jobs: 'none', map: MAP, fleet: QUICK };
writeFileSync(`${scratch}/hands.json`, JSON.stringify(scenario));
let server = await serve(program, `${scratch}/hands.json`, scratch);
const { url } = server;
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints, isLostLink);
// What the page shows as wrong, and when it does.
await page.addInitScript(() => {
  globalThis.wrongs = [];
  new MutationObserver((all) => {
    const { mistake } = all.at(-1).target.dataset;
    if (mistake === '' || mistake === all[0].oldValue) return;
    const { name } = document.querySelector('[data-wrong]')?.dataset ?? {};
    globalThis.wrongs.push({ kind: mistake, name, at: Date.now() });
  }).observe(document, { subtree: true, attributeFilter: ['data-mistake'], attributeOldValue: true });
});
const ask = async (path) => (await context.request.get(url + path)).json();
const post = async (path, data) => {
  const answer = await context.request.post(url + path, { data });
  assert(answer.ok(), `${path}: ${answer.status()} ${await answer.text()}`);
  return answer.json();
};
const station = page.locator('#station');
const shows = (attribute, value, more = '') =>
  page.locator(`#station[data-${attribute}="${value}"]${more}`).waitFor({ timeout: PATIENCE });
const isLit = async (slot) => {
  await shows('lit', slot, '[data-link="live"]');
  // A line that has just been lit cannot be confirmed yet: nobody has read it.
  await page.waitForTimeout(600);
};
const isCalm = () => shows('mistake', '');
const states = async () => (await ask('/v1/stations/S1')).visit?.lines.map((one) => `${one.state} ${one.done}`) ?? [];
const becomes = (n, state) => until(`line ${n} ${state}`, async () => (await states())[n - 1] === state, 30);

const S1 = bench(MAP, 'S1');
const [first, second, third] = S1.totes;
const worker = await post('/v1/workers', { name: 'picker' });
const headset = new Headset(await context.newPage(), S1);
await headset.connect(url, worker.id);
/** What the page has shown as wrong since then, and where the hand was in the last pose before. */
const wrongsSince = async (begin) => {
  const [all, sent] = [await page.evaluate(() => globalThis.wrongs), await headset.sent()];
  const before = ({ at }) => sent.findLast((pose) => pose.at <= at);
  return all.filter(({ at }) => at >= begin).map((one) => ({ ...one, deep: before(one).deep }));
};
/** Lets the hand go into a wrong slot again and again meanwhile, as a warning ends after two seconds. */
const whileWrong = async (slot, run) => {
  let goesOn = true;
  const reaches = (async () => {
    while (goesOn) {
      await headset.moves([S1.slot(slot, 0.1), 0.4], [S1.slot(slot, -0.35), 0.4]);
    }
  })();
  try {
    await shows('mistake', 'wrong_slot');
    await run();
    assert((await station.getAttribute('data-mistake')) === 'wrong_slot', 'it is not wrong any more');
  } finally {
    goesOn = false;
    await reaches;
  }
};
const cm = (m) => `${Math.round(Math.abs(m) * 100)} cm ${m < 0 ? 'before' : 'behind'} the face`;

const job = await post('/v1/jobs', {
  kind: 'deliver',
  rack: S1.racks[0].id,
  station: 'S1',
  pick_s: 900,
  lines: [
    { slot: 'C3', quantity: 1, tote: second },
    { slot: 'A2', quantity: 1, tote: first },
    { slot: 'D4', quantity: 1, tote: third },
    { slot: 'B3', quantity: 2, tote: second },
    { slot: 'C2', quantity: 1, tote: first },
  ],
});
await page.goto(`${url}/station/S1`);
await until('the rack at S1', async () => (await ask(`/v1/jobs/${job.id}`)).state === 'picking');
await isLit('C3');

await check('The server asks for hands where somebody stands in a workplace, and says what is lit', async () => {
  await headset.rests();
  await until('a message about the station', async () => (await headset.cells()).at(-1)?.hands === true, 5);
  const cell = (await headset.cells()).at(-1);
  const isRight = cell.station === 'S1' && cell.slot.id === 'C3' && cell.tote.id === second && cell.pieces === 1;
  assert(isRight, JSON.stringify(cell));
});
await check('The page shows where the hand most likely goes, before it is there', async () => {
  const seen = page.locator('[data-reach="C3"]').first().waitFor({ state: 'attached', timeout: PATIENCE });
  await headset.moves([S1.slot('C3', -0.35), 0.6], [S1.slot('C3', -0.1), 0.4]);
  await seen;
  await headset.rests();
});
await check('A hand from the lit slot to its tote confirms the line without a click; nothing is wrong', async () => {
  await headset.grasps('C3');
  assert((await station.getAttribute('data-lit')) === 'C3', 'a grasp confirms nothing');
  await headset.puts(second);
  await shows('lit', 'A2');
  await page.getByText('Your hands confirm the line', { exact: true }).waitFor({ timeout: PATIENCE });
  const wrongs = await wrongsSince(0);
  assert(wrongs.length === 0, `it was shown as wrong: ${JSON.stringify(wrongs)}`);
});
await check('A hand on its way to a far slot turns the page to wrong while it is before the rack', async () => {
  await headset.moves([S1.slot('C4', -0.35), 0.6]);
  const begin = Date.now();
  await headset.moves([S1.slot('C4', 0.12), 1.6]);
  await headset.leaves('C4');
  const [wrong] = await wrongsSince(begin);
  assert(wrong?.kind === 'wrong_slot' && wrong.name === 'C4', `the page showed ${JSON.stringify(wrong)}`);
  assert(wrong.deep < 0, `the hand was ${cm(wrong.deep)}`);
  const told = (await headset.cells()).map(({ warning }) => warning?.slot);
  assert(told.includes('C4'), `the headset was told ${JSON.stringify(told)}`);
  const into = (await headset.sent()).find(({ at, deep }) => at >= begin && deep >= 0);
  return `${cm(wrong.deep)}, ${into.at - wrong.at} ms before the hand was in`;
});
await check('A hand in the slot beside the lit one turns it to wrong before it comes out with a piece', async () => {
  await isCalm();
  const begin = Date.now();
  await headset.enters('B2');
  const out = Date.now();
  await headset.leaves('B2');
  const [wrong] = await wrongsSince(begin);
  assert(wrong?.kind === 'wrong_slot' && wrong.name === 'B2', `the page showed ${JSON.stringify(wrong)}`);
  assert(wrong.at < out, `the hand was on its way out, ${cm(wrong.deep)}`);
  assert((await states())[1] === 'lit 0', 'a wrong slot confirms nothing');
  return `${cm(wrong.deep)}, ${out - wrong.at} ms before it went out`;
});
await check('What is wrong can be read from afar and hides nothing, in both themes', async () => {
  await whileWrong('B2', async () => {
    for (const colorScheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme });
      await page.waitForTimeout(300);
      await page.screenshot({ path: `${SHOTS}station-hand-wrong-${colorScheme}.png` });
      await assertAccessible(page, `wrong, ${colorScheme}`);
    }
    const boxes = await page.evaluate(() => {
      const box = (of) => document.querySelector(of).getBoundingClientRect().toJSON();
      const [slot, name, cross] = ['ground', 'name', 'cross'].map((one) => box(`[data-wrong] .${one}`));
      return { slot, name, cross, big: box('.named') };
    });
    const { slot, name, cross, big } = boxes;
    assert(name.left >= slot.left && name.right <= slot.right && name.top >= slot.top, JSON.stringify(boxes));
    assert(name.top + name.height * 0.8 <= cross.top, `the cross covers the name: ${JSON.stringify(boxes)}`);
    assert(big.height > 100, `the name is ${big.height} px high`);
    assert((await page.locator('.named').innerText()).includes('B2'), 'the name is not there');
    assert((await page.locator('[data-reach="B2"]').count()) === 0, 'the slot has another outline, too');
  });
});
await check('The card of the station shows lines, the lit one, the end, and the warning while it is on', async () => {
  const dashboard = await context.newPage();
  listen(dashboard, complaints);
  await dashboard.goto(`${url}/#station/S1`);
  const card = dashboard.getByRole('region', { name: 'Station', exact: true });
  const fact = (name) => card.locator('dl > div', { has: dashboard.getByText(name, { exact: true }) }).locator('dd');
  await fact('Lines').waitFor({ timeout: PATIENCE });
  const told = await Promise.all(['Lines', 'Lit', 'Expected end'].map((name) => fact(name).innerText()));
  assert(told[0] === '1 of 5 over, 5 pieces left' && told[1] === `A2 → ${first}, 1 piece`, told.join('; '));
  assert(/^in .*\d.* \(.*\d.* to .*\d.*\)$/.test(told[2]), told[2]);
  await isCalm();
  const warning = card.getByText('A hand goes to the wrong slot B2');
  await warning.waitFor({ state: 'detached', timeout: PATIENCE });
  await whileWrong('B2', async () => {
    await warning.waitFor({ timeout: PATIENCE });
    await dashboard.screenshot({ path: `${SHOTS}station-card-warning.png` });
    await assertAccessible(dashboard, 'the card with a warning');
  });
  await warning.waitFor({ state: 'detached', timeout: PATIENCE });
  await dashboard.close();
  return told.join('; ');
});
await check('The headset goes with a piece in the hand: nothing is confirmed, and a key goes on', async () => {
  await isCalm();
  await headset.grasps('A2');
  await headset.dies();
  await page.waitForTimeout(4_000);
  assert((await page.locator('[data-reach]').count()) === 0, 'the page still shows where the hand goes');
  assert((await states()).slice(0, 2).join() === 'done 1,lit 0', (await states()).join());
  await isLit('A2');
  await page
    .getByText('Hands are not followed now: confirm with the button', { exact: true })
    .waitFor({ timeout: PATIENCE });
  await page.screenshot({ path: `${SHOTS}station-without-headset.png` });
  await page.keyboard.press('Enter');
  await becomes(2, 'done 1');
  await isLit('D4');
});
await check('A tap on Done confirms a line', async () => {
  const tablet = await browser.newContext({ viewport: { width: 768, height: 1024 }, hasTouch: true });
  const touched = await tablet.newPage();
  listen(touched, complaints);
  await touched.goto(`${url}/station/S1`);
  await touched.locator('#station[data-link="live"][data-lit="D4"]').waitFor({ timeout: PATIENCE });
  await touched.waitForTimeout(600);
  const { x, y, width, height } = await touched.locator('[data-act="done"]').boundingBox();
  assert(height >= 44 && width >= 44, `the button is ${width} × ${height} px`);
  await touched.touchscreen.tap(x + width / 2, y + height / 2);
  await becomes(3, 'done 1');
  await isLit('B3');
  assert((await states())[3] === 'lit 0', 'one tap was more than one');
  await tablet.close();
});
await check('A headset that comes back confirms again', async () => {
  await headset.connect(url, worker.id);
  await headset.rests();
  await headset.grasps('B3');
  await headset.puts(second);
  await becomes(4, 'lit 1');
});
const ALL = 'done 1,done 1,done 1,lit 1,open 0';
await check('A server that is killed while a hand holds a piece is said, and the page comes back alone', async () => {
  await page.evaluate(() => {
    globalThis.isSamePage = true;
  });
  await headset.grasps('B3');
  await server.kill();
  await page.getByText('No connection for').waitFor({ timeout: PATIENCE });
  assert(await page.locator('[data-act="done"]').isDisabled(), 'a line could be confirmed');
  server = await serve(program, `${scratch}/hands.json`, scratch, new URL(url).port);
  await isLit('B3');
  await page.getByText('No connection for').waitFor({ state: 'hidden', timeout: PATIENCE });
  assert(await page.evaluate(() => globalThis.isSamePage), 'it was loaded anew');
  const after = (await states()).join();
  assert(after === ALL, after);
  return after;
});
await check('The piece that the hand held then confirms nothing, and the next one does', async () => {
  await headset.connect(url, worker.id);
  await headset.puts(second);
  await page.waitForTimeout(1_000);
  assert((await states()).join() === ALL, (await states()).join());
  await headset.rests();
  await headset.grasps('B3');
  await headset.puts(second);
  await becomes(4, 'done 2');
  await isLit('C2');
});
await check('The rack leaves at the last grasp, and the page asks about a piece not seen in its tote', async () => {
  await headset.grasps('C2');
  await page.getByText(`Is the last piece of C2 in tote ${first}?`).waitFor({ timeout: PATIENCE });
  assert((await ask(`/v1/jobs/${job.id}`)).state === 'done', 'the rack is not wanted any more');
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    await page.waitForTimeout(300);
    await page.screenshot({ path: `${SHOTS}station-asks-${colorScheme}.png` });
    await assertAccessible(page, `asks, ${colorScheme}`);
  }
  const yes = page.getByRole('button', { name: 'In the tote' });
  const { y, height } = await yes.boundingBox();
  const no = await page.locator('.asks').getByRole('button', { name: 'Missing' }).boundingBox();
  assert(height >= 44, `the answer is ${height} px high, too small for a finger`);
  assert(no.y === y, 'the answers are not side by side');
  await yes.click();
  await until('an answer', async () => (await ask('/v1/stations/S1')).unconfirmed === null, 20);
});
await check('The visit has ended with each line confirmed once', async () => {
  const { lines } = await ask(`/v1/jobs/${job.id}`);
  const picked = lines.map(({ state, done, quantity }) => `${state} ${done} of ${quantity}`);
  const wanted = [1, 1, 1, 2, 1].map((n) => `done ${n} of ${n}`);
  assert(picked.join() === wanted.join(), picked.join());
});
await check('Nothing was complained about', () => assert(complaints.length === 0, complaints.join(' | ')));
await server.stop();
await finish(browser);
