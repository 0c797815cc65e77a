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
const [START, TASK] = ['G3-7', 'G12-7'];
/** That way leads to the door, and up to the last turn to the station's queue as well: either is right. */
const BEHIND = ['G0-14', 'G0-0'];
const AHEAD = [[5, 7]];
const ASTRAY = [
  [0, 7],
  [0, 13.6],
];
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
        await new Promise((done) => {
          requestAnimationFrame(done);
        });
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
/** The destinations that the card of the person shows, most likely first, with their shares in per cent. */
const likely = async () => {
  const rows = await card.locator('.chances > div').evaluateAll((all) =>
    all.map((row) => {
      const [name, , share] = [...row.children].map((cell) => cell.textContent.trim());
      return { name, share: Number.parseInt(share, 10) };
    }),
  );
  return rows.sort((a, b) => b.share - a.share);
};

await page.goto(url);
const map = await ask('/v1/map');
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
  timeout: PATIENCE,
});
/** What the page was told in this minute, picture by picture: `t` in seconds of the floor. */
const story = () => page.evaluate(() => globalThis.story);
const when = async (what, so) => {
  for (const began = Date.now(); Date.now() - began < PATIENCE;) {
    const found = await so();
    if (found) return found;
    await page.waitForTimeout(100);
  }
  const told = JSON.stringify((await story()).at(-1));
  const said = await card.innerText().catch(() => 'nothing');
  throw new Error(`${what} is not shown; the page was told ${told}, the card says ${said}`);
};
let worker = '';
let began = 0;

await check('A headset comes to the floor, gets a task, and the dashboard shows it on its path', async () => {
  await headset.goto(new URL('/headset', url).href);
  await headset.getByLabel('Name of the wearer').fill(NAME);
  await headset.getByLabel('Begin at').selectOption(START);
  await headset.getByRole('button', { name: 'Enter the twin' }).click();
  await headset.locator('#headset[data-twin="window"][data-link="live"]').waitFor({ timeout: PATIENCE });
  await headset.getByRole('button', { name: 'Enter VR' }).click();
  await headset.locator('#headset[data-twin="vr"]').waitFor({ timeout: PATIENCE });
  worker = (await ask('/v1/workers')).items[0].id;
  await ask(`/v1/workers/${worker}/assignments`, { place: TASK, stay_s: 600 });
  await headset.locator('#headset[data-shown="following"]').waitFor({ timeout: PATIENCE });
  await page.waitForFunction(
    (id) => globalThis.floor.workers.some((w) => w.id === id && w.state === 'following'),
    worker,
    { timeout: PATIENCE },
  );
  await find(worker);
  await card.getByText(/^On the path for/).waitFor({ timeout: PATIENCE });
  await page.evaluate((id) => {
    globalThis.story = [];
    let version = null;
    const look = () => {
      const { floor } = globalThis;
      const { state, goals, x, y } = floor.workers.find((w) => w.id === id);
      const yields = floor.robots
        .filter((r) => r.why?.code === 'gives_way' && r.why.args.worker === id)
        .map((r) => r.id);
      if (floor.version !== version)
        globalThis.story.push({
          t: floor.time_s,
          state,
          goal: goals[0] ?? null,
          yields,
          at: [x, y],
          deviations: floor.counters.deviations,
        });
      version = floor.version;
      requestAnimationFrame(look);
    };
    look();
  }, worker);
  began = await page.evaluate(() => globalThis.floor.time_s);
  await headset.evaluate(([places, speed]) => globalThis.walk(places, speed), [AHEAD, WALK_MPS]);
  await card.getByText(/^On the path for/).waitFor({ timeout: PATIENCE });
  return `${worker} at ${await sees('at')}`;
});
const astray = headset.evaluate(([places, speed]) => globalThis.walk(places, speed), [ASTRAY, WALK_MPS]);
await check('When the headset walks off the path, the dashboard shows the deviation', async () => {
  await card.getByText(/^(Off the path|On a new path) for/).waitFor({ timeout: PATIENCE });
  await card.getByText('you left the path', { exact: true }).first().waitFor({ timeout: PATIENCE });
  await page.getByRole('region', { name: 'Counters' }).getByText('Deviations').waitFor({ timeout: PATIENCE });
  await when('a deviation', async () => (await story()).at(-1).deviations >= 1);
  return (await card.locator('p').first().innerText()).trim();
});
await check('It shows where the worker is going now', async () => {
  const top = await when(`the way to ${BEHIND}`, async () => {
    const all = await likely();
    const task = all.find((one) => one.name === TASK)?.share ?? 0;
    return BEHIND.includes(all[0]?.name) && all[0].share >= 2 * task ? all[0] : null;
  });
  await page.screenshot({ path: `${SHOTS}minute-live.png` });
  return `${top.name}: ${top.share} %`;
});
await check('It shows a robot that gives way, with the reason', async () => {
  const robot = page.getByRole('region', { name: 'Robot', exact: true });
  const words = await when('a robot that gives way', async () => {
    const id = (await story()).at(-1).yields[0];
    if (id === undefined) return null;
    await find(id);
    const text = robot.getByText(new RegExp(`(giving|gives) way to .*(${worker}|${NAME})`)).first();
    return text.waitFor({ timeout: 1_500 }).then(
      async () => `${id}: ${(await text.innerText()).trim()}`,
      () => null,
    );
  });
  await page.screenshot({ path: `${SHOTS}minute-yields.png` });
  await find(worker);
  return words;
});
await astray;
await page.waitForFunction((end) => globalThis.floor.time_s >= end, began + MINUTE_S, {
  timeout: 2 * MINUTE_S * 1_000,
});

// Where the first check failed, nothing was told, and those below say what they miss.
const told = (await story()) ?? [];
const deviated = told.find((s) => s.state === 'deviating' || s.state === 'redirected');
/** How much the probability of the likeliest changed within half a second of a moment; nothing if another was
 *  likelier. */
const change = (s) => {
  const near = told.filter((other) => Math.abs(other.t - s.t) <= 0.5);
  const isSame = near.every(({ goal }) => goal && goal.x === s.goal.x && goal.y === s.goal.y);
  const isBetween = near[0] !== s && near.at(-1) !== s;
  return isSame && isBetween ? Math.max(...near.map(({ goal }) => Math.abs(goal.p - s.goal.p))) : Infinity;
};
/** The moment at which one of the places behind was the likeliest and its probability changed least. */
const steady = told
  .filter((s) => behind(s) && s.t > deviated?.t)
  .map((s) => ({ ...s, change: change(s) }))
  .sort((a, b) => a.change - b.change)[0];
const yielding = told.find(
  (s, i) =>
    s.t > (deviated?.t ?? Infinity) &&
    s.yields[0] &&
    [i - 3, i + 3].every((k) => told[k]?.yields.includes(s.yields[0])),
);

const slider = page.getByRole('slider', { name: 'Moment' });
const seek = async (t) => {
  await slider.evaluate((input, value) => {
    input.value = String(value);
    input.dispatchEvent(new Event('input', { bubbles: true }));
  }, t);
  await page.waitForTimeout(700);
};
await check('The replay has a bookmark of the same deviation, at the same second', async () => {
  await page.getByRole('button', { name: 'Replay', exact: true }).click();
  const mark = page
    .getByRole('region', { name: 'Bookmarks' })
    .getByRole('button', { name: /Off the path/ })
    .first();
  await mark.waitFor({ timeout: PATIENCE });
  const words = (await mark.innerText()).replaceAll(/\s+/g, ' ');
  const { bookmarks } = await ask('/v1/past');
  const first = bookmarks.find((one) => one.kind === 'deviation' && one.who.includes(worker));
  assert(
    deviated && Math.abs(first.at_s - deviated.t) < 1,
    `the bookmark is of ${first.at_s} s, the page was told at ${deviated?.t} s`,
  );
  await mark.click();
  await page
    .getByRole('button', { name: 'Pause', exact: true })
    .click({ timeout: 3_000 })
    .catch(() => {});
  await seek(first.at_s + 0.5);
  await card.getByText(/^(Off the path|On a new path) for/).waitFor({ timeout: PATIENCE });
  await card.getByText('you left the path', { exact: true }).first().waitFor({ timeout: PATIENCE });
  await page.screenshot({ path: `${SHOTS}minute-replay.png` });
  return `${words}; ${first.at_s} s and ${deviated.t} s`;
});
await check('Before it, the worker was on the path', async () => {
  await seek(deviated.t - 1);
  await card.getByText(/^On the path for/).waitFor({ timeout: PATIENCE });
});
await check('It shows the same goal with the same probability at the same moment', async () => {
  const seen = () =>
    JSON.stringify(told.filter((s) => s.t > deviated?.t).map((s) => [s.t, s.goal?.x, s.goal?.y, s.goal?.p]));
  assert(steady?.change < 0.2, `none of ${BEHIND} was the likeliest for a second: ${seen()}`);
  const off = 6 + 100 * steady.change;
  await seek(steady.t);
  const name = behind(steady);
  const shown = await when(`${name} at ${Math.round(100 * steady.goal.p)} %`, async () =>
    (await likely()).slice(0, 2).find((one) => one.name === name && Math.abs(one.share - 100 * steady.goal.p) <= off),
  );
  return `${shown.name}: ${shown.share} % at ${steady.t} s, ${Math.round(100 * steady.goal.p)} % live`;
});
await check('It shows the same robot giving way at the same moment', async () => {
  assert(yielding, 'no robot gave way for long');
  await seek(yielding.t);
  await find(yielding.yields[0]);
  const text = page
    .getByRole('region', { name: 'Robot', exact: true })
    .getByText(new RegExp(`(giving|gives) way to .*(${worker}|${NAME})`))
    .first();
  await text.waitFor({ timeout: PATIENCE });
  return `${yielding.yields[0]}: ${(await text.innerText()).trim()}`;
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await stop();
await finish(browser);

/** Which of the places behind the worker was the likeliest, if one was. */
function behind({ goal }) {
  return BEHIND.find((name) => {
    const { x, y } = map.nodes.find((n) => n.id === name);
    return goal && Math.hypot(goal.x - x, goal.y - y) < 0.5;
  });
}
