// The page of a wearer in a real browser, with a scripted headset (iwer), against the program itself over HTTPS:
// node tests/headset.mjs PROGRAM. It starts the server itself, since it also kills it. Each check prints a sentence.
import { spawn } from 'node:child_process';
import { mkdir, mkdtemp, readFile, rm } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, assertAccessible, check, finish, isLostLink, listen, openBrowser } from './chromium.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/headset.mjs target/debug/giveway');
  process.exit(2);
}
const require = createRequire(import.meta.url);
const SHOTS = fileURLToPath(new URL('./shots/', import.meta.url));
const SCENARIO = fileURLToPath(new URL('../../tests/it/quiet.json', import.meta.url));
const IWER = await readFile(join(require.resolve('iwer'), '../../build/iwer.min.js'), 'utf8');
const TOKEN = 'a-token-for-the-headset-test';
/** People walk so fast: metres per second, and so often they move here. */
const [WALK, STEP_MS] = [1.2, 40];

await mkdir(SHOTS, { recursive: true });
const folder = await mkdtemp(join(tmpdir(), 'giveway-headset-'));
let server = await start(0);
const { url } = server;
const browser = await openBrowser();
const context = await browser.newContext({
  ignoreHTTPSErrors: true,
  viewport: { width: 1280, height: 720 },
  colorScheme: 'dark',
});
const complaints = [];
const page = await context.newPage();
watch(page);
await page.addInitScript(IWER);
await page.addInitScript(() => {
  const { XRDevice, metaQuest3 } = globalThis.IWER;
  const headset = new XRDevice(metaQuest3);
  headset.installRuntime({ forceInstall: true });
  headset.primaryInputMode = 'controller';
  headset.stereoEnabled = false;
  const seen = XRFrame.prototype.getViewerPose;
  XRFrame.prototype.getViewerPose = function (space) {
    const { lost, emulated } = globalThis.headset;
    const pose = lost ? null : seen.call(this, space);
    if (pose && emulated) Object.defineProperty(pose, 'emulatedPosition', { value: true });
    return pose;
  };
  globalThis.headset = { device: headset, lost: false, emulated: false };
});
const root = page.locator('#headset');
const reads = (name) => root.getAttribute(`data-${name}`);
const until = (name, ...values) =>
  page
    .waitForFunction(
      ([key, wanted]) => wanted.includes(document.querySelector('#headset')?.dataset[key]),
      [name, values],
      { timeout: PATIENCE },
    )
    .catch(async () => {
      throw new Error(`${name} is ${await reads(name)}, not ${values.join(' or ')}; the board says: ${await board()}`);
    });
const board = () =>
  page
    .locator('.banner')
    .innerText()
    .catch(() => 'nothing');
const shot = (name) => page.screenshot({ path: `${SHOTS}headset-${name}.png` });

// Where the device's frame lies in the map, in truth: the page has to find that out.
let truth = { theta: 0.6, shift: [2.5, -1] };
let here = [0, 0];
let facing = 0;
/** Puts the headset to a place of the map, facing an angle of it. */
async function stand([x, y], angle = facing) {
  [here, facing] = [[x, y], angle];
  const [c, s] = [Math.cos(truth.theta), Math.sin(truth.theta)];
  const [dx, dy] = [x - truth.shift[0], y - truth.shift[1]];
  // The device looks to -z, which is up in its plan: a quarter turn before the x axis.
  const yaw = angle - truth.theta - Math.PI / 2;
  await page.evaluate(
    ([px, pz, w]) => {
      const { device } = globalThis.headset;
      device.position.set(px, 1.65, pz);
      device.quaternion.set(0, Math.sin(w / 2), 0, Math.cos(w / 2));
    },
    [c * dx + s * dy, -(c * dy - s * dx), yaw],
  );
}
async function walk(to, most = Infinity) {
  const [from, began] = [here, Date.now()];
  const whole = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
  for (;;) {
    const gone = Math.min(whole, most, ((Date.now() - began) / 1000) * WALK);
    await stand(
      [from[0] + (gone / whole) * (to[0] - from[0]), from[1] + (gone / whole) * (to[1] - from[1])],
      whole > 0 ? angle : facing,
    );
    if (gone >= Math.min(whole, most)) return;
    await page.waitForTimeout(STEP_MS);
  }
}
/** Lets the display draw so many frames: inputs and places count from one to the next. */
const frames = (count) =>
  page.evaluate(
    (n) =>
      new Promise((done) => {
        const next = () => {
          n -= 1;
          if (n < 0) done();
          else requestAnimationFrame(next);
        };
        next();
      }),
    count,
  );
const press = async () => {
  for (const value of [1, 0]) {
    await page.evaluate((v) => globalThis.headset.device.controllers.right.updateButtonValue('trigger', v), value);
    await frames(3);
  }
  // The page takes presses that follow each other faster for one.
  await page.waitForTimeout(400);
};
const ask = async (path, body) => {
  const headers = { authorization: `Bearer ${TOKEN}` };
  const answer = await (body
    ? context.request.post(`${url}${path}`, { data: body, headers })
    : context.request.get(`${url}${path}`, { headers }));
  return answer.json();
};
const MARKS = { R106: [0, 0], R102: [6, 4] };
async function showMarks() {
  for (const name of ['R106', 'R102']) {
    await page.locator('.banner', { hasText: name }).waitFor({ timeout: PATIENCE, state: 'attached' });
    await stand(MARKS[name]);
    await frames(3);
    await press();
  }
  await until('marking', 'done');
}

await check('The page loads without the dashboard, over HTTPS with the certificate that the server made', async () => {
  const asked = [];
  page.on('request', (request) => {
    if (/\.(js|css)$/.test(request.url())) asked.push(request);
  });
  await page.goto(`${url}/headset`);
  await page.getByLabel('Token').waitFor({ timeout: PATIENCE });
  // As they travel: a radio in a hall carries no more than that. The dashboard's would be four times as many.
  const loaded = await Promise.all(
    asked.map(async (request) => [request.url(), (await request.sizes()).responseBodySize]),
  );
  const bytes = loaded.reduce((sum, [, size]) => sum + size, 0);
  assert(bytes > 0 && bytes < 35_000, `${loaded.map(([at, size]) => `${at} ${size}`).join(', ')}: ${bytes} bytes`);
  assert(await page.evaluate(() => isSecureContext), 'no secure context');
  return `${loaded.length} files, ${bytes} bytes`;
});
await check('A token is asked for, then name and marks', async () => {
  await page.getByLabel('Token').fill(TOKEN);
  await page.getByRole('button', { name: 'Continue' }).click();
  await page.getByLabel('Name of the wearer').fill('picker-7');
  await page.getByLabel('First mark').selectOption('R106');
  await page.getByLabel('Second mark').selectOption('R102');
  await page.getByLabel('Third mark').selectOption('');
  await page.getByText('This is not a safety device').waitFor();
  await shot('sign-in');
});
await accessible('sign-in');
await check('The view into the room opens and asks for marks', async () => {
  await stand([0, 0], 0);
  await page.getByRole('button', { name: 'Enter the room view' }).click();
  await until('link', 'live');
  await until('marking', 'taking');
  await page.waitForTimeout(500);
  await shot('marks');
});
await check('Marks that do not fit are refused, with the reason', async () => {
  await press();
  await stand([6, 1]);
  await frames(3);
  await press();
  await until('marking', 'refused');
  const said = await board();
  assert(/you walked/.test(said), said);
  await page.waitForTimeout(300);
  await shot('refused');
  await press();
  await until('marking', 'taking');
  return said.split('\n').at(-1);
});
await check('Two marks align the headset, and the server knows where it is', async () => {
  await showMarks();
  await walk([6, 3.2]);
  await seenAt(here, 0.15);
  return `epoch ${await reads('epoch')}`;
});
const worker = (await ask('/v1/workers')).items[0].id;
await check('An assignment is shown as a path that can be walked', async () => {
  await ask(`/v1/workers/${worker}/assignments`, { place: 'R106', stay_s: 5 });
  await until('shown', 'following');
  // The page is told at once; the list of workers is a picture that is some tenths of a second old.
  let { path } = await ask(`/v1/workers/${worker}`);
  for (let tries = 0; path.length < 2 && tries < 50; tries += 1) {
    await page.waitForTimeout(100);
    ({ path } = await ask(`/v1/workers/${worker}`));
  }
  assert(path.length > 1, 'there is no path');
  await walk(path[1], 1.2);
  await page.waitForTimeout(400);
  await shot('following');
  assert((await reads('shown')) === 'following', `${await reads('shown')} while on the path`);
  const { acknowledged, feed } = await ask(`/v1/workers/${worker}`);
  assert(acknowledged !== null, 'what was shown was not acknowledged');
  assert(feed.jumps === 0 && feed.absurd === 0, JSON.stringify(feed));
  return `${feed.taken} poses taken`;
});
await check('An arrow shows the way when the next point is behind', async () => {
  await stand(here, facing + Math.PI * 0.8);
  await until('aim', 'off view');
  await page.waitForTimeout(400);
  await shot('arrow');
  await stand(here, facing - Math.PI * 0.8);
});
await check('Poses leave at 20 to 60 a second', async () => {
  // Frames and poses of the same span, by the clock of the page: a busy machine gives fewer of both.
  const [rate, drawn] = await page.evaluate(
    () =>
      new Promise((done) => {
        const sent = () => Number(document.querySelector('#headset').dataset.sent);
        const [before, began] = [sent(), performance.now()];
        let count = 0;
        const next = () => {
          count += 1;
          const seconds = (performance.now() - began) / 1000;
          if (seconds > 3) done([(sent() - before) / seconds, count / seconds]);
          else requestAnimationFrame(next);
        };
        requestAnimationFrame(next);
      }),
  );
  // This browser has no graphics card: it may draw fewer than 20 itself.
  assert(rate <= 61 && rate >= Math.min(20, drawn * 0.6), `${rate.toFixed(0)} a second of ${drawn.toFixed(0)} frames`);
  return `${rate.toFixed(0)} a second of ${drawn.toFixed(0)} frames`;
});
await check('Who leaves the path is told so, and redirected', async () => {
  const { path } = await ask(`/v1/workers/${worker}`);
  const seen = [];
  const told = watchShown(seen);
  const [dx, dy] = [path.at(-1)[0] - here[0], path.at(-1)[1] - here[1]];
  // Round the other side of the racks: along the aisle that the path does not take.
  const other = path.some(([x, y]) => x > 5.5 && y < 3)
    ? [
        [6, 4],
        [3, 4],
        [0, 4],
      ]
    : [
        [6, 2],
        [6, 0],
        [3, 0],
      ];
  for (const corner of other) {
    if (seen.includes('redirected')) break;
    const near = () => walk(corner, 0.6);
    for (
      let i = 0;
      i < 12 && !seen.includes('redirected') && Math.hypot(corner[0] - here[0], corner[1] - here[1]) > 0.05;
      i += 1
    )
      await near();
  }
  await page.waitForTimeout(300);
  await shot('redirected');
  told();
  assert(
    seen.includes('deviating') || seen.includes('redirected'),
    `it showed ${seen.join(', ')} (the way was ${dx.toFixed(1)}, ${dy.toFixed(1)})`,
  );
  return seen.join(', ');
});
await check('Who is at the place says to be done with a press', async () => {
  await ask(`/v1/workers/${worker}/assignments`, { place: 'R106', stay_s: 600 });
  for (let tries = 0; !(await board()).includes('Done here?') && tries < 60; tries += 1) {
    const { path } = await ask(`/v1/workers/${worker}`);
    for (const corner of path) if (Math.hypot(corner[0] - here[0], corner[1] - here[1]) > 0.05) await walk(corner);
    await page.waitForTimeout(250);
  }
  await shot('done');
  const { assignment } = await ask(`/v1/workers/${worker}`);
  await press();
  let state = '';
  for (const began = Date.now(); state !== 'done' && Date.now() - began < PATIENCE;) {
    ({ state } = await ask(`/v1/assignments/${assignment}`));
    await page.waitForTimeout(100);
  }
  assert(state === 'done', `${assignment} is ${state}; ${await board()}`);
  return assignment;
});
await check('A guessed position is said to be one', async () => {
  await page.evaluate(() => {
    globalThis.headset.emulated = true;
  });
  await page.locator('.banner', { hasText: 'guess' }).waitFor({ timeout: PATIENCE, state: 'attached' });
  await page.evaluate(() => {
    globalThis.headset.emulated = false;
  });
});
await check('A headset that lost its place shows that, then STOP, and goes on when it has it again', async () => {
  const seen = [];
  const told = watchShown(seen);
  await page.evaluate(() => {
    globalThis.headset.lost = true;
  });
  await until('shown', 'stop');
  await page.waitForTimeout(400);
  await page.evaluate(() => {
    document.querySelector('.stop').style.visibility = 'hidden';
  });
  await shot('stop');
  await page.evaluate(() => {
    globalThis.headset.lost = false;
  });
  await until('shown', 'following', 'redirected', 'deviating', 'idle');
  told();
  return seen.join(', ');
});
await check('After the origin jumped, a new epoch begins and the marks are asked for again', async () => {
  const epoch = Number(await reads('epoch'));
  await page.evaluate(() => globalThis.headset.device.recenter());
  await until('marking', 'taking');
  truth = { theta: -1.1, shift: [4, 2] };
  await until('shown', 'marks', 'stop');
  await shot('recentred');
  const at = here;
  await showMarks();
  assert(Number(await reads('epoch')) > epoch + 1, `epoch ${await reads('epoch')} after ${epoch}`);
  await stand(at);
  await seenAt(at, 0.15);
  return `epoch ${epoch} to ${await reads('epoch')}`;
});
await check(
  'A server that is gone is said plainly; when it is back, everything goes on without the wearer',
  async () => {
    await server.kill();
    await until('shown', 'offline', 'stop');
    assert(
      /onnection/.test(
        await page
          .locator('.banner, .stop')
          .allInnerTexts()
          .then((t) => t.join(' ')),
      ),
      await board(),
    );
    await page.waitForTimeout(300);
    await shot('offline');
    server = await start(Number(new URL(url).port));
    await until('link', 'live');
    await until('marking', 'done');
    await until('shown', 'following', 'redirected', 'deviating', 'idle');
    await seenAt(here, 0.15);
    return `epoch ${await reads('epoch')}, ${await reads('shown')}`;
  },
);
await check('Who ends the view is asked whether the floor is left', async () => {
  await page.evaluate(() => globalThis.headset.device.activeSession.end());
  await page.getByRole('heading', { name: 'The view is closed' }).waitFor({ timeout: PATIENCE });
  await page.getByRole('button', { name: 'I have left the floor' }).click();
  await page.getByText('picker-7 has left the floor.').waitFor({ timeout: PATIENCE });
  let presence = '';
  for (const began = Date.now(); presence !== 'absent' && Date.now() - began < PATIENCE;) {
    ({ presence } = await ask(`/v1/workers/${worker}`));
    await page.waitForTimeout(200);
  }
  assert(presence === 'absent', presence);
});

const hand = await browser.newContext({
  ignoreHTTPSErrors: true,
  viewport: { width: 390, height: 780 },
  hasTouch: true,
  colorScheme: 'light',
});
const phone = await hand.newPage();
watch(phone);
await phone.addInitScript((token) => {
  sessionStorage.setItem('giveway.token', token);
  delete Navigator.prototype.xr;
  globalThis.buzzed = [];
  navigator.vibrate = (pattern) => globalThis.buzzed.push(pattern);
}, TOKEN);
await check('A phone shows the same guidance on a map, with a place that the wearer points at', async () => {
  await phone.goto(`${url}/headset`);
  await phone.getByLabel('Name of the wearer').fill('picker-8');
  await phone.screenshot({ path: `${SHOTS}headset-phone-sign-in.png` });
  await phone.getByRole('button', { name: 'Use as a phone' }).click();
  await phone.locator('#headset[data-link="live"]').waitFor({ timeout: PATIENCE });
  const box = await phone.locator('canvas.map').boundingBox();
  await phone.touchscreen.tap(box.x + box.width * 0.5, box.y + box.height * 0.5);
  await phone.getByText('You said that you stand here').waitFor({ timeout: PATIENCE });
  const { items } = await ask('/v1/workers');
  const second = items.find((w) => w.name === 'picker-8').id;
  await ask(`/v1/workers/${second}/assignments`, { place: 'R111', stay_s: 30 });
  await phone
    .locator('#headset[data-shown="following"], #headset[data-shown="deviating"], #headset[data-shown="redirected"]')
    .waitFor({ timeout: PATIENCE });
  await phone.waitForTimeout(1_500);
  await phone.screenshot({ path: `${SHOTS}headset-phone-light.png` });
  await phone.emulateMedia({ colorScheme: 'dark' });
  await phone.waitForTimeout(600);
  await phone.screenshot({ path: `${SHOTS}headset-phone-dark.png` });
  const over = await phone.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert(over <= 0, `it is ${over} px too wide`);
  const { x, y, presence } = await ask(`/v1/workers/${second}`);
  // Said once a second: between two words it may be called stale.
  assert(['tracked', 'stale'].includes(presence), presence);
  return `at ${x}, ${y}; ${(await phone.locator('.banner').innerText()).replaceAll('\n', ': ')}`;
});
await check('A phone has a button for being done, and the fleet takes the word for it', async () => {
  const { items } = await ask('/v1/workers');
  const second = items.find((w) => w.name === 'picker-8').id;
  const open = async () =>
    (await ask(`/v1/workers/${second}/assignments`)).items.filter((a) => a.state !== 'done').length;
  assert((await open()) === 1, `${await open()} are open`);
  await phone.getByRole('button', { name: 'Done' }).click();
  for (const began = Date.now(); (await open()) > 0 && Date.now() - began < PATIENCE;) await phone.waitForTimeout(100);
  assert((await open()) === 0, 'it is open still');
  await phone.getByRole('button', { name: 'Done' }).waitFor({ state: 'hidden', timeout: PATIENCE });
});
await accessible('phone', phone);
await check('A second device takes the place of the first, which does not fight for it', async () => {
  const other = await hand.newPage();
  await other.addInitScript((token) => {
    sessionStorage.setItem('giveway.token', token);
    delete Navigator.prototype.xr;
  }, TOKEN);
  await other.goto(`${url}/headset`);
  await other.getByLabel('Name of the wearer').fill('picker-8');
  await other.getByRole('button', { name: 'Use as a phone' }).click();
  await other.locator('#headset[data-link="live"]').waitFor({ timeout: PATIENCE });
  await phone.getByRole('button', { name: 'Connect again' }).waitFor({ timeout: PATIENCE });
  await phone.waitForTimeout(2_000);
  assert((await other.locator('#headset').getAttribute('data-link')) === 'live', 'the first one took it back');
  await other.close();
});
await check('A phone says that its wearer has left only when the server has heard it', async () => {
  const { items } = await ask('/v1/workers');
  const second = items.find((w) => w.name === 'picker-8').id;
  await phone.route('**/clear', (route) => route.abort());
  await phone.getByRole('button', { name: 'I have left the floor' }).click();
  await phone.getByRole('alert').filter({ hasText: 'The server cannot be reached.' }).waitFor({ timeout: PATIENCE });
  await phone.unroute('**/clear');
  await phone.getByRole('button', { name: 'I have left the floor' }).click();
  await phone.getByText('picker-8 has left the floor.').waitFor({ timeout: PATIENCE });
  let presence = '';
  for (const began = Date.now(); presence !== 'absent' && Date.now() - began < PATIENCE;) {
    ({ presence } = await ask(`/v1/workers/${second}`));
    await phone.waitForTimeout(100);
  }
  assert(presence === 'absent', presence);
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await server.kill();
await rm(folder, { recursive: true, force: true });
await finish(browser);

/** Starts the program on a port, 0 for any. */
async function start(port) {
  const child = spawn(
    program,
    [
      'serve',
      '--tls',
      '--scenario',
      SCENARIO,
      '--listen',
      `127.0.0.1:${port}`,
      '--database',
      join(folder, 'db.sqlite'),
    ],
    {
      env: { ...process.env, GIVEWAY_TOKEN: TOKEN, RUST_LOG: 'warn' },
      stdio: ['ignore', 'pipe', 'inherit'],
    },
  );
  const ended = new Promise((done) => child.on('exit', done));
  process.on('exit', () => child.kill('SIGKILL'));
  const address = await new Promise((found, failed) => {
    let text = '';
    child.stdout.on('data', (more) => {
      text += more;
      const line = /^Giveway is at (https:\/\/[^/]+)\/$/m.exec(text);
      if (line) found(line[1]);
    });
    child.on('exit', (code) => failed(new Error(`the server ended with ${code}: ${text}`)));
  });
  return {
    url: address,
    kill: async () => {
      child.kill('SIGKILL');
      await ended;
    },
  };
}

/** Waits until the server has the worker there. */
async function seenAt([x, y], within) {
  let last = null;
  for (const began = Date.now(); Date.now() - began < PATIENCE;) {
    last = (await ask('/v1/workers')).items[0];
    if (last && last.x !== null && last.presence === 'tracked' && Math.hypot(last.x - x, last.y - y) < within) return;
    await page.waitForTimeout(200);
  }
  throw new Error(
    `the server has the worker at ${last?.x}, ${last?.y} (${last?.presence}), not at ${x.toFixed(2)}, ${y.toFixed(2)}`,
  );
}

/** Notes what is shown, one after the other, until it is called off. */
function watchShown(seen) {
  const timer = setInterval(async () => {
    const now = await reads('shown').catch(() => null);
    if (now && seen.at(-1) !== now) seen.push(now);
  }, 40);
  return () => clearInterval(timer);
}

function watch(one) {
  // The missing token and the pages that are cut off are meant.
  const meant = (message) => /ERR_FAILED|status of 401/.test(message.text());
  listen(one, complaints, (message) => meant(message) || isLostLink(message));
}

async function accessible(look, one = page) {
  await check(`axe finds nothing wrong (${look})`, () => assertAccessible(one, look));
}
