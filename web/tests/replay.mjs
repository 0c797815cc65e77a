// The past in a real browser: a page that is a file, a recording on the screen, and a server that keeps what happened:
// node tests/replay.mjs PROGRAM. It records a run with a person who leaves the path, and starts and kills servers
// itself.
import { execFile, spawn } from 'node:child_process';
import { mkdir, mkdtemp, readFile, rm, stat, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { promisify } from 'node:util';
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

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/replay.mjs target/debug/giveway');
  process.exit(2);
}
const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = here('./shots/');
const SECONDS = 150;
const LONG = 300;
/** Of the large hall, seconds: each of them takes its time to be worked out. */
const MANY = 30;

await mkdir(SHOTS, { recursive: true });
const folder = await mkdtemp(join(tmpdir(), 'giveway-replay-'));
const file = (name) => join(folder, name);
const giveway = (...words) => promisify(execFile)(program, words);
const browser = await openBrowser();
const context = await browser.newContext({
  viewport: { width: 1440, height: 900 },
  colorScheme: 'dark',
  acceptDownloads: true,
});
const complaints = [];
let page = await open();

const button = (name) => page.getByRole('button', { name, exact: true });
const bar = () => page.getByRole('region', { name: 'Replay', exact: true });
const bookmarks = () => page.getByRole('region', { name: 'Bookmarks' });
const charts = () => page.getByRole('region', { name: 'Charts', exact: true });
const badge = () => page.getByText('this is the past');
/** The moment that is shown, in seconds of the day. */
const moment = async () =>
  (await bar().locator('output b').innerText()).split(':').reduce((sum, n) => sum * 60 + Number(n), 0);
const drawn = () =>
  page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, { timeout: PATIENCE });
const version = () => page.evaluate(() => Number(document.querySelector('canvas')?.dataset.version));

await check('A run is recorded, and made into a reel and into a page', async () => {
  await giveway(
    'sim',
    here('../../scenarios/people-1.json'),
    '--duration',
    String(SECONDS),
    '--no-bound',
    '--record',
    file('run.jsonl.gz'),
  );
  await giveway('replay', file('run.jsonl.gz'), '--reel', file('run.reel'), '--page', file('run.html'));
  const [recording, reel, html] = await Promise.all(
    ['run.jsonl.gz', 'run.reel', 'run.html'].map(async (name) => (await stat(file(name))).size),
  );
  return `recording ${recording}, reel ${reel}, page ${html} bytes`;
});

await check('The page opens from the file and plays, without asking any network', async () => {
  const asked = [];
  page.on('request', (request) => asked.push(request.url()));
  await page.goto(pathToFileURL(file('run.html')).href);
  await drawn();
  await badge().waitFor({ timeout: PATIENCE });
  const [t, v] = [await moment(), await version()];
  await until('a later moment', async () => (await moment()) > t && (await version()) > v, PATIENCE / 1_000);
  assert(
    asked.every((url) => /^(file|data|blob):/.test(url)),
    asked.join(' '),
  );
  assert(
    (await page.getByRole('button', { name: /Stop all robots|Submit/ }).count()) === 0,
    'there is a button for the present',
  );
});
await check('Space stands still, arrow keys go five seconds, and the end is the end', async () => {
  await page.locator('body').press('Space');
  await button('Play').waitFor({ timeout: PATIENCE });
  const t = await moment();
  await page.locator('body').press('ArrowRight');
  assert(Math.abs((await moment()) - t - 5) <= 1, `from ${t} to ${await moment()}`);
  await page.getByRole('slider', { name: 'Moment' }).focus();
  await page.keyboard.press('End');
  assert((await moment()) >= SECONDS - 2, `the end is ${await moment()}`);
  await page.keyboard.press('Home');
  assert((await moment()) === 0, `the beginning is ${await moment()}`);
});
await check('A bookmark leads to the deviation, and shows who it was', async () => {
  const first = bookmarks()
    .getByRole('button', { name: /Off the path/ })
    .first();
  const words = (await first.innerText()).replaceAll(/\s+/g, ' ');
  await first.click();
  const at = words
    .split(' ')[0]
    .split(':')
    .reduce((sum, n) => sum * 60 + Number(n), 0);
  assert(Math.abs((await moment()) - (at - 5)) <= 1, `${words}, but it is ${await moment()}`);
  await page.getByRole('region', { name: 'Person', exact: true }).waitFor({ timeout: PATIENCE });
  await button('Play').click();
  await page
    .getByRole('region', { name: 'Person', exact: true })
    .getByText(/Off the path|On a new path|Told to stop/)
    .first()
    .waitFor({ timeout: PATIENCE });
  await page.screenshot({ path: `${SHOTS}replay-file.png` });
  const before = await moment();
  await button('Next bookmark').click();
  assert((await moment()) >= before, 'the next bookmark is not later');
  return words;
});
await check('The jobs of then are listed, and why their robots waited, down to the root', async () => {
  await button('Pause').click();
  await bar().getByRole('button', { name: 'Jobs', exact: true }).click();
  const list = page.getByRole('region', { name: 'Jobs at this moment' });
  const waits = () => list.locator('tbody tr', { hasText: /held by robot-/ }).first();
  const chain = page.getByRole('region', { name: 'Why it waited' }).getByRole('listitem');
  let words = '';
  // The robot that holds the place may drive by the moment at which this stops: such a chain has one link alone.
  for (let steps = 0; steps < 40 && (await chain.count()) < 2; steps++) {
    await page.locator('body').press('ArrowLeft');
    if (!(await waits().isVisible())) continue;
    words = (await waits().innerText()).replaceAll(/\s+/g, ' ');
    await waits().getByRole('button').click();
    await chain
      .nth(1)
      .waitFor({ timeout: 5000 })
      .catch(() => null);
  }
  assert(
    (await chain.count()) >= 2,
    `no robot waits for one that waits, at none of forty moments; the last is ${words}`,
  );
  await page.screenshot({ path: `${SHOTS}replay-jobs.png` });
  return `${words}: ${await chain.count()} links`;
});
await check('Timelines of then show who held the places on the screen', async () => {
  await bar().getByRole('button', { name: 'Timelines', exact: true }).click();
  await button('Use the visible area').click();
  const bars = page.getByRole('application', { name: 'Timelines of the area' }).locator('.bar');
  await bars.nth(20).waitFor({ timeout: PATIENCE });
  const looks = await bars.evaluateAll((all) => [...new Set(all.map((bar) => bar.dataset.look))].sort());
  assert(looks.join() === 'granted,held', `bars are ${looks.join()}`);
  await page.screenshot({ path: `${SHOTS}replay-timelines.png` });
  return `${await bars.count()} bars`;
});
await axe('a file with timelines, dark');
await check('Jobs that waited are listed below those under way, as of a moment', async () => {
  await then('Jobs');
  const waited = page.getByRole('table', { name: 'Jobs that waited then' }).locator('tbody tr');
  await waited.first().waitFor({ timeout: PATIENCE });
  const heading = await page.getByRole('heading', { name: /Jobs that waited for a robot/ }).innerText();
  assert(/^Jobs that waited for a robot: \d+ \(the list is as of \d\d:\d\d:\d\d/.test(heading), heading);
  const words = (await waited.first().innerText()).replaceAll(/\s+/g, ' ');
  assert(/^j\d+ \w+ \S+ → \S+ \d \d\d:\d\d:\d\d/.test(words), words);
  const under = new Set(
    await page
      .getByRole('table', { name: 'Jobs under way then' })
      .locator('tbody tr')
      .evaluateAll((all) => all.map((row) => row.dataset.job)),
  );
  const names = await waited.evaluateAll((all) => all.map((row) => row.dataset.waited));
  assert(
    names.every((name) => !under.has(name)),
    'a job is under way and waits',
  );
  await waited.first().scrollIntoViewIfNeeded();
  await page.screenshot({ path: `${SHOTS}replay-waiting.png` });
  return `${heading.replaceAll('\n', ' ')}: ${words}`;
});
await axe('a file with jobs, dark');
await then('Timelines');
await check('At 64 times the speed it comes to the end and stands', async () => {
  await bar().getByLabel('Speed').selectOption('64');
  await page.getByRole('slider', { name: 'Moment' }).press('Home');
  if (await button('Play').isVisible()) await button('Play').click();
  await button('Play').waitFor({ timeout: PATIENCE });
  assert((await moment()) >= SECONDS - 1, `it stands at ${await moment()}`);
});
await axe('a file, dark');
await page.emulateMedia({ colorScheme: 'light' });
await page.waitForTimeout(500);
await axe('a file, light');
await page.screenshot({ path: `${SHOTS}replay-file-light.png` });
await page.setViewportSize({ width: 390, height: 844 });
await page.waitForTimeout(500);
await check('It fits onto a phone', async () => {
  for (const one of ['Timelines', 'Jobs', 'Charts', 'Encounters']) {
    if (one !== 'Timelines') await then(one);
    await page.waitForTimeout(500);
    const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    await page.screenshot({ path: `${SHOTS}replay-phone-${one.toLowerCase()}.png`, fullPage: true });
    assert(over <= 0, `${one}: it is ${over} px too wide`);
  }
});
await page.close();

await check('Five minutes with a fleet whose robots meet people are made into a page', async () => {
  // The published method foresees people, and meets them more often than Giveway does.
  const scenario = JSON.parse(await readFile(here('../../scenarios/people-3.json'), 'utf8'));
  await writeFile(
    file('long.json'),
    JSON.stringify({ ...scenario, arm: 'phir', drain_s: 0, map: here('../../maps/thesis.json') }),
  );
  await giveway('sim', file('long.json'), '--duration', String(LONG), '--no-bound', '--reel', file('long.reel'));
  await giveway('replay', file('long.reel'), '--page', file('long.html'));
  page = await open();
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.goto(pathToFileURL(file('long.html')).href);
  await drawn();
  await button('Pause').click();
});
await check('Charts of what is in sight have values and the moment, and a click goes to a time', async () => {
  await page.getByRole('slider', { name: 'Moment' }).press('End');
  await then('Charts');
  const values = await chartsShow();
  const plot = charts().locator('[data-chart="deliveries"] .plot');
  const box = await plot.boundingBox();
  const left = await charts().locator('[data-chart="deliveries"] .moment').getAttribute('x1');
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForTimeout(600);
  assert(Math.abs((await moment()) - LONG / 2) < 12, `the middle is ${await moment()}`);
  const right = await charts().locator('[data-chart="deliveries"] .moment').getAttribute('x1');
  assert(Number(right) < Number(left), `the line stays at ${left}`);
  const told = await charts().getByRole('status').textContent();
  assert(/^00:0\d:\d\d: .*robots/.test(told), told);
  await page.mouse.move(box.x + box.width * 0.72, box.y + box.height / 2);
  await page.waitForTimeout(300);
  await page.screenshot({ path: `${SHOTS}replay-charts.png` });
  await page.mouse.move(5, 5);
  await charts().getByLabel('As a table').check();
  const rows = charts().getByRole('region', { name: 'Table of figures over time' }).getByRole('row');
  await rows.nth(LONG / 30 - 1).waitFor({ timeout: PATIENCE });
  await charts().getByLabel('As a table').uncheck();
  return `${values}; ${told}`;
});
await axe('a file with charts, dark');
await check('Encounters of then are a table: a row goes there, its names choose, its place is shown', async () => {
  await then('Encounters');
  const words = await encounterGoes();
  await page.screenshot({ path: `${SHOTS}replay-encounters.png` });
  return words;
});
await axe('a file with encounters, dark');
await check('A map of heat shows where robots met people in what is in sight', async () => {
  await page.getByText('Layers', { exact: true }).click();
  await page.getByLabel('where robots met people').check();
  await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.cells) > 0, null, {
    timeout: PATIENCE,
  });
  const cells = await page.locator('canvas').first().getAttribute('data-cells');
  await page.getByRole('group', { name: 'Meaning of the colours' }).waitFor({ timeout: PATIENCE });
  await axe('a file with a map of heat');
  await page.getByLabel('where robots waited').check();
  await page.getByText('Only a running server knows').waitFor({ timeout: PATIENCE });
  await page.waitForFunction(() => document.querySelector('canvas')?.dataset.cells === '0', null, {
    timeout: PATIENCE,
  });
  await page.getByLabel('none', { exact: true }).check();
  await page.getByText('Layers', { exact: true }).click();
  return `${cells} places`;
});
await page.emulateMedia({ colorScheme: 'light' });
await then('Charts');
await chartsShow();
await page.waitForTimeout(500);
await axe('a file with charts, light');
await page.screenshot({ path: `${SHOTS}replay-charts-light.png` });
await page.close();

await check('Seeking among 800 robots shows the moment at once', async () => {
  const many = JSON.parse(await readFile(here('../../scenarios/kiva-800.json'), 'utf8'));
  await writeFile(file('many.json'), JSON.stringify({ ...many, drain_s: 0, map: here('../../maps/kiva.json') }));
  await giveway('sim', file('many.json'), '--duration', String(MANY), '--no-bound', '--reel', file('many.reel'));
  await giveway('replay', file('many.reel'), '--page', file('many.html'));
  page = await open();
  await page.goto(pathToFileURL(file('many.html')).href);
  await drawn();
  await button('Pause').click();
  // How long a seek takes is told, and depends on the machine; that each of them ends is asserted.
  const [took, stuck] = await page.evaluate(
    async ([seconds, patience]) => {
      const [slider, canvas] = [document.querySelector('input[type="range"]'), document.querySelector('canvas')];
      const turn = () =>
        new Promise((done) => {
          requestAnimationFrame(done);
        });
      const times = [];
      let stuck = 0;
      // Forth and back, never to where it is: a third of the time at least lies between.
      for (let i = 0; i < 20; i++) {
        const shown = canvas.dataset.version;
        slider.value = String((i * 11 + 3) % (seconds - 1));
        const began = performance.now();
        slider.dispatchEvent(new Event('input', { bubbles: true }));
        while (canvas.dataset.version === shown && performance.now() - began < patience) await turn();
        if (canvas.dataset.version === shown) stuck += 1;
        times.push(performance.now() - began);
      }
      return [times.sort((a, b) => a - b), stuck];
    },
    [MANY, PATIENCE],
  );
  const robots = await page.evaluate(() => document.querySelector('canvas').dataset.robots);
  assert(robots === '800' && stuck === 0, `${robots} robots, and ${stuck} of ${took.length} seeks showed nothing else`);
  await page.close();
  return `median ${took[10].toFixed(0)} ms, longest ${took.at(-1).toFixed(0)} ms of 20`;
});

let server = await start('replay', file('run.jsonl.gz'), '--listen', '127.0.0.1:0');
await check('A recording opens as a replay whose scrubber grows to all of it', async () => {
  page = await open();
  await page.goto(server.url);
  await badge().waitFor({ timeout: PATIENCE });
  await drawn();
  await page.waitForFunction(
    (most) => Number(document.querySelector('input[type="range"]')?.max) >= most,
    SECONDS - 1,
    { timeout: PATIENCE },
  );
  await bookmarks()
    .getByRole('button', { name: /Encounter|Off the path/ })
    .last()
    .click();
  await until('the second minute', async () => (await moment()) > 60, PATIENCE / 1_000);
  await page.screenshot({ path: `${SHOTS}replay-recording.png` });
  await then('Charts');
  await chartsShow();
  await then('Encounters');
  await page
    .getByRole('region', { name: 'Encounters', exact: true })
    .getByText(/\d+ shown/)
    .waitFor({ timeout: PATIENCE });
  await then('Jobs');
  await page
    .getByRole('table', { name: 'Jobs that waited then' })
    .locator('tbody tr')
    .first()
    .waitFor({ timeout: PATIENCE });
  await button('Back to playback').click();
  await badge().waitFor({ state: 'detached', timeout: PATIENCE });
  await page.close();
});
await server.kill();

const SERVE = [
  'serve',
  '--scenario',
  here('../../scenarios/lab.json'),
  '--listen',
  '127.0.0.1:0',
  '--database',
  file('db.sqlite'),
];
server = await start(...SERVE);
page = await open();
await page.goto(server.url);
await drawn();
await check('A running server shows its own past, in which nothing can be changed', async () => {
  await page.request.post(`${server.url}/v1/fleet/stop`);
  await page.waitForTimeout(1_500);
  await page.request.post(`${server.url}/v1/fleet/resume`);
  await page.waitForTimeout(4_000);
  await button('Replay').click();
  await badge().waitFor({ timeout: PATIENCE });
  await bookmarks().getByText('all robots were stopped by hand').first().waitFor({ timeout: PATIENCE });
  assert((await page.getByRole('button', { name: 'Submit' }).count()) === 0, 'jobs can be handed in');
  await page.waitForTimeout(1_000);
  await page.screenshot({ path: `${SHOTS}replay-server.png` });
});
await axe('a server');
await check('The live floor can be stopped during a replay, and is resumed only from the present', async () => {
  await button('Stop all robots now (live)').click();
  const stopped = async () => (await (await page.request.get(`${server.url}/v1/fleet`)).json()).stopped;
  await until('a stopped fleet', async () => (await stopped()) !== null, 20);
  await page.getByText('Go back to live to resume them.').waitFor({ timeout: PATIENCE });
  assert((await button('Resume all robots').count()) === 0, 'it can be resumed from the past');
  await page.screenshot({ path: `${SHOTS}replay-stopped.png` });
  await page.request.post(`${server.url}/v1/fleet/resume`);
  await button('Stop all robots now (live)').waitFor({ timeout: PATIENCE });
});
await check('A server has charts and jobs of its past', async () => {
  await then('Jobs');
  await page.getByRole('heading', { name: /the list is as of \d\d:\d\d:\d\d/ }).waitFor({ timeout: PATIENCE });
  await then('Charts');
  await charts().locator('[data-chart="deliveries"] .moment').first().waitFor({ state: 'attached', timeout: PATIENCE });
  await charts().locator('[data-chart="waiting"] polyline').first().waitFor({ state: 'attached', timeout: PATIENCE });
  const said = await charts().locator('[data-chart="plans"] [data-value]').allInnerTexts();
  await page.screenshot({ path: `${SHOTS}replay-server-charts.png` });
  await then('Encounters');
  await page.getByText('No encounters in this time range.').waitFor({ timeout: PATIENCE });
  await then('Encounters');
  await page.getByText('Layers', { exact: true }).click();
  await page.getByLabel('where robots waited').check();
  await page.getByRole('group', { name: 'Meaning of the colours' }).waitFor({ timeout: PATIENCE });
  await page.getByLabel('none', { exact: true }).check();
  await page.getByText('Layers', { exact: true }).click();
  return `searches ${said.join(', ')}`;
});
await check('What is in sight is saved as a file', async () => {
  const saving = page.waitForEvent('download', { timeout: PATIENCE });
  await button('Save as a file').click();
  await (await saving).saveAs(file('saved.reel'));
  return `${(await stat(file('saved.reel'))).size} bytes`;
});
await check('Back to live is live', async () => {
  await button('Back to live').click();
  await badge().waitFor({ state: 'detached', timeout: PATIENCE });
  const before = await version();
  await until('something that moves', async () => (await version()) > before, PATIENCE / 1_000);
  assert(await button('Stop all robots').isEnabled(), 'the stop stays dead');
});
await check('The address opens a span of the past, and stands at its end', async () => {
  await page.evaluate(() => {
    location.hash = '#replay?from=2&to=4';
  });
  await badge().waitFor({ timeout: PATIENCE });
  await button('Play').waitFor({ timeout: PATIENCE });
  const { min, max, value } = await page
    .getByRole('slider', { name: 'Moment' })
    .evaluate((input) => ({ min: input.min, max: input.max, value: input.value }));
  assert(Number(min) === 2 && Number(max) === 4 && Math.abs(Number(value) - 4) < 0.3, `${min} to ${max} at ${value}`);
  await page.evaluate(() => {
    location.hash = '';
  });
  await badge().waitFor({ state: 'detached', timeout: PATIENCE });
});
await check('A saved reel opens in the page; another file is refused in words', async () => {
  const chooser = page.locator('input[type="file"][accept=".reel"]');
  await chooser.setInputFiles(file('saved.reel'));
  await badge().waitFor({ timeout: PATIENCE });
  await writeFile(file('no.reel'), 'hello\n');
  await chooser.setInputFiles(file('no.reel'));
  await page.getByRole('alert').filter({ hasText: 'This is not a recording' }).waitFor({ timeout: PATIENCE });
  await button('Dismiss').click();
  await button('Back to live').click();
});
await check('A reel that is dropped onto the page plays, with the map it was made on', async () => {
  const base64 = (await readFile(file('run.reel'))).toString('base64');
  const dropped = await page.evaluateHandle((text) => {
    const carried = new DataTransfer();
    carried.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], 'run.reel'));
    return carried;
  }, base64);
  await page.dispatchEvent('main', 'drop', { dataTransfer: dropped });
  await badge().waitFor({ timeout: PATIENCE });
  await page.waitForFunction(() => document.querySelector('canvas')?.dataset.robots === '20', null, {
    timeout: PATIENCE,
  });
  await button('Back to live').click();
  await page.waitForFunction(() => document.querySelector('canvas')?.dataset.robots === '2', null, {
    timeout: PATIENCE,
  });
});
await check('What a killed server kept is there when it is back', async () => {
  await server.kill();
  server = await start(...SERVE);
  const { spans } = await (await page.request.get(`${server.url}/v1/past`)).json();
  // A server that is back within a moment goes on with the span of the one before it.
  const [{ from_s, to_s }] = spans;
  assert(from_s < 0, JSON.stringify(spans));
  await page.goto(`${server.url}/#replay?from=${from_s}&to=${Math.min(0, to_s)}`);
  await badge().waitFor({ timeout: PATIENCE });
  await drawn();
  await bookmarks().getByText('all robots were stopped by hand').first().waitFor({ timeout: PATIENCE });
  return `${(to_s - from_s).toFixed(1)} s`;
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await server.kill();
await rm(folder, { recursive: true, force: true });
await finish(browser);

/** Shows what was, below the scrubber. */
async function then(what) {
  await bar().getByRole('button', { name: what, exact: true }).click();
}

/** Charts with a line for deliveries and one for the moment that is shown; what they say. */
async function chartsShow() {
  await charts()
    .locator('[data-chart="deliveries"] polyline')
    .first()
    .waitFor({ state: 'attached', timeout: PATIENCE });
  assert((await charts().locator('figure').count()) === 6, 'charts are missing');
  assert((await charts().locator('.moment').count()) === 6, 'the moment is not marked');
  const values = await charts()
    .locator('[data-chart="deliveries"] [data-value], [data-chart="people"] [data-value]')
    .allInnerTexts();
  assert(
    values.every((value) => /^[\d,.]+$/.test(value)),
    `it says ${values.join(', ')}`,
  );
  return values.join(', ');
}

/** The last encounter of the list is gone to, its robot chosen, its place shown. */
async function encounterGoes() {
  const list = page.getByRole('region', { name: 'Encounters', exact: true });
  const row = list.locator('[data-encounter]').last();
  await row.waitFor({ timeout: PATIENCE });
  const words = (await row.innerText()).replaceAll(/\s+/g, ' ');
  const at = words
    .split(' ')[0]
    .split(':')
    .reduce((sum, n) => sum * 60 + Number(n), 0);
  await page.locator('body').press('End');
  await row.getByRole('button', { name: /^Replay/ }).click();
  assert(Math.abs((await moment()) - Math.max(0, at - 5)) <= 1.5, `${words}, but it is ${await moment()}`);
  await page.locator('body').press('End');
  await row.getByRole('rowheader').getByRole('button').click();
  assert(Math.abs((await moment()) - Math.max(0, at - 5)) <= 1.5, `${words}, but the time goes to ${await moment()}`);
  await row.getByRole('button', { name: /^robot-/ }).click();
  await page.getByRole('region', { name: 'Robot', exact: true }).waitFor({ timeout: PATIENCE });
  await row.getByRole('button', { name: /show on the floor/ }).click();
  await page.waitForTimeout(700);
  return words;
}

/** Starts the program, and reads where it is from its first line. */
async function start(...words) {
  const child = spawn(program, words, {
    env: { ...process.env, RUST_LOG: 'warn' },
    stdio: ['ignore', 'pipe', 'inherit'],
  });
  const ended = new Promise((done) => {
    child.on('exit', done);
  });
  process.on('exit', () => child.kill('SIGKILL'));
  const url = await new Promise((found, failed) => {
    let text = '';
    child.stdout.on('data', (more) => {
      text += more;
      const line = /(http:\/\/[\d.:]+)\//.exec(text);
      if (line) found(line[1]);
    });
    child.on('exit', (code) => failed(new Error(`${words[0]} ended with ${code}: ${text}`)));
  });
  return {
    url,
    kill: async () => {
      child.kill('SIGKILL');
      await ended;
    },
  };
}

async function open() {
  const one = await context.newPage();
  listen(one, complaints, isLostLink);
  return one;
}

async function axe(look) {
  await check(`axe finds nothing wrong (${look})`, () => assertAccessible(page, look));
}
