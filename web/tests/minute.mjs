// One minute from end to end, against a real server that this test starts itself: a scripted headset (iwer) in the twin
// walks off its path; the dashboard shows the deviation, where the worker is going now, and the robots that give way;
// then the replay shows the same minute. node tests/minute.mjs PATH-TO-GIVEWAY
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, check, finish, listen, openBrowser } from './chromium.mjs';
import { serve } from './serve.mjs';
import { tap } from './tap.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/minute.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const IWER = readFileSync(join(createRequire(import.meta.url).resolve('iwer'), '../../build/iwer.min.js'), 'utf8');
const scratch = mkdtempSync(`${tmpdir()}/giveway-minute-`);
// Twenty robots of the shipped scenario; the only person is the one of this test.
const scenario = JSON.parse(readFileSync(HERE('../../scenarios/people-1.json'), 'utf8'));
Object.assign(scenario, { map: HERE('../../maps/thesis.json') });
delete scenario.workers;
writeFileSync(`${scratch}/minute.json`, JSON.stringify(scenario));
const { url, stop } = await serve(program, `${scratch}/minute.json`, scratch);
const browser = await openBrowser();
const complaints = [];

/** The task is at one end of the middle aisle; the walker turns round half-way and goes to the door in a corner. */
const [START, TASK, DOOR] = ['G3-7', 'G12-7', 'G0-14'];
const AHEAD = [[5, 7]];
const ASTRAY = [[0, 7], [0, 13.6]];
const NAME = 'picker-7';
const WALK_MPS = 1.2;
const MINUTE_S = 60;

// --- The headset ---
const worn = await browser.newContext({ viewport: { width: 480, height: 320 } });
const headset = await worn.newPage();
listen(headset, complaints);
await headset.addInitScript(IWER);
await headset.addInitScript(() => {
  const { XRDevice, metaQuest3 } = globalThis.IWER;
  const device = new XRDevice(metaQuest3);
  device.installRuntime({ forceInstall: true });
  device.stereoEnabled = false;
  /** Walks the device through places of the map, from where the twin has it; stands while it is told to stop. */
  globalThis.walk = async (places, speed) => {
    const { dataset } = document.querySelector('#headset');
    globalThis.frame ??= { at: dataset.at.split(',').map(Number), theta: Number(dataset.heading) - Math.PI / 2 };
    const { at: origin, theta } = globalThis.frame;
    let [x, y] = dataset.at.split(',').map(Number);
    let before = performance.now();
    for (const [tx, ty] of places) {
      while (Math.hypot(tx - x, ty - y) > 0.01) {
        await new Promise((done) => { requestAnimationFrame(done); });
        const now = performance.now();
        const most = dataset.shown === 'stop' ? 0 : (speed * Math.min(200, now - before)) / 1000;
        before = now;
        const left = Math.hypot(tx - x, ty - y);
        const heading = Math.atan2(ty - y, tx - x);
        const step = Math.min(left, most);
        [x, y] = [x + step * Math.cos(heading), y + step * Math.sin(heading)];
        const [c, s] = [Math.cos(theta), Math.sin(theta)];
        const [dx, dy] = [x - origin[0], y - origin[1]];
        device.position.set(c * dx + s * dy, 1.65, s * dx - c * dy);
        const yaw = heading - theta - Math.PI / 2;
        device.quaternion.set(0, Math.sin(yaw / 2), 0, Math.cos(yaw / 2));
      }
    }
  };
});
const sees = (name) => headset.locator('#headset').getAttribute(`data-${name}`);
const ask = async (path, body) => {
  const address = new URL(path, url).href;
  return (await (body ? worn.request.post(address, { data: body }) : worn.request.get(address))).json();
};

// --- The dashboard ---
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
await tap(context);
const page = await context.newPage();
listen(page, complaints);
const card = page.getByRole('region', { name: 'Person', exact: true });
const find = async (id) => {
  await page.getByLabel('Find on the floor').fill(id);
  await page.keyboard.press('Enter');
};
const likely = async () => {
  const rows = await card.locator('.chances > div').evaluateAll((all) => all.map((row) => {
    const [name, , share] = [...row.children].map((cell) => cell.textContent.trim());
    return { name, share: Number.parseInt(share, 10) };
  }));
  return rows.sort((a, b) => b.share - a.share)[0];
};

await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, { timeout: PATIENCE });
/** What was seen of this minute, in seconds of the floor. */
const seen = { worker: '', deviated: null, goal: null, yielding: null };

await check('A headset comes to the floor, gets a task, and follows its path', async () => {
  await headset.goto(new URL('/headset', url).href);
  await headset.getByLabel('Name of the wearer').fill(NAME);
  await headset.getByLabel('Begin at').selectOption(START);
  await headset.getByRole('button', { name: 'Enter the twin' }).click();
  await headset.locator('#headset[data-twin="window"][data-link="live"]').waitFor({ timeout: PATIENCE });
  await headset.getByRole('button', { name: 'Enter VR' }).click();
  await headset.locator('#headset[data-twin="vr"]').waitFor({ timeout: PATIENCE });
  seen.worker = (await ask('/v1/workers')).items[0].id;
  await ask(`/v1/workers/${seen.worker}/assignments`, { place: TASK, stay_s: 600 });
  await headset.locator('#headset[data-shown="following"]').waitFor({ timeout: PATIENCE });
  await find(NAME).then(() => card.getByRole('heading', { name: NAME }).waitFor({ timeout: 5_000 })).catch(() => find(seen.worker));
  await card.getByText('On the path').waitFor({ timeout: PATIENCE });
  // From here it is a minute.
  globalThis.began = await page.evaluate(() => globalThis.floor.time_s);
  await page.evaluate((id) => {
    // What the page was told, second by second.
    globalThis.story = [];
    const look = () => {
      const { floor } = globalThis;
      const worker = floor.workers.find((w) => w.id === id);
      const yields = floor.robots.filter((r) => r.why === `giving way to worker ${id}`).map((r) => r.id);
      globalThis.story.push({ t: floor.time_s, state: worker.state, goal: worker.goals[0] ?? null, yields, at: [worker.x, worker.y] });
      requestAnimationFrame(look);
    };
    look();
  }, seen.worker);
  await headset.evaluate(([places, speed]) => globalThis.walk(places, speed), [AHEAD, WALK_MPS]);
  return `${seen.worker} at ${await sees('at')}`;
});
const story = () => page.evaluate(() => globalThis.story.filter((one, i, all) => i === 0 || JSON.stringify([one.state, one.goal, one.yields]) !== JSON.stringify([all[i - 1].state, all[i - 1].goal, all[i - 1].yields])));
await headset.evaluate(([places, speed]) => globalThis.walk(places, speed), [ASTRAY, WALK_MPS]);
console.log((await story()).map((s) => JSON.stringify(s)).join('\n'));
console.log(await likely(), await card.innerText());
await page.screenshot({ path: `${SHOTS}minute-live.png` });
await stop();
await finish(browser);
