// The twin of the page of a wearer, in a window and with a scripted VR headset (iwer), against a real server that this
// test starts itself: node tests/twin.mjs PATH-TO-GIVEWAY
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, assertAccessible, check, finish, listen, openBrowser } from './chromium.mjs';
import { serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/twin.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const IWER = readFileSync(join(createRequire(import.meta.url).resolve('iwer'), '../../build/iwer.min.js'), 'utf8');
const scratch = mkdtempSync(`${tmpdir()}/giveway-twin-`);
// The shipped scenario with one simulated person, beside whom the one of this test walks.
const scenario = JSON.parse(readFileSync(HERE('../../scenarios/people-1.json'), 'utf8'));
Object.assign(scenario, { map: HERE('../../maps/thesis.json') });
Object.assign(scenario.workers, { enter_s: 1, deviations: { at_s: [], causes: 'none' } });
writeFileSync(`${scratch}/twin.json`, JSON.stringify(scenario));
const { url, stop } = await serve(program, `${scratch}/twin.json`, scratch);
const browser = await openBrowser();
const complaints = [];
/** The narrow view of docs/headset.md, degrees. */
const NARROW = [30, 17.5];
const START = 'G3-0';

const context = await browser.newContext({ viewport: { width: 1120, height: 760 }, colorScheme: 'light' });
const page = await open(context);
const root = page.locator('#headset');
const reads = (name) => root.getAttribute(`data-${name}`);
const at = async () => (await reads('at')).split(',').map(Number);
const ask = async (path, body) => {
  const address = new URL(path, url).href;
  return (await (body ? context.request.post(address, { data: body }) : context.request.get(address))).json();
};
const shot = (name) => page.screenshot({ path: `${SHOTS}twin-${name}.png` });
const soon = async (what, so) => {
  for (const began = Date.now(); Date.now() - began < PATIENCE;) {
    if (await so()) return;
    await new Promise((done) => {
      setTimeout(done, 100);
    });
  }
  throw new Error(`${what} never comes`);
};
const map = await ask('/v1/map');
const me = async () => (await ask('/v1/workers')).items.find((w) => w.name === 'visitor');
const apart = ([x, y], [u, v]) => Math.hypot(x - u, y - v);

await check('The twin is entered from the page without a headset, at a place that is chosen', async () => {
  await page.goto(new URL('/headset', url).href);
  await page.getByLabel('Name of the wearer').fill('visitor');
  await page.getByLabel('Begin at').selectOption(START);
  await page.screenshot({ path: `${SHOTS}twin-sign-in.png`, fullPage: true });
  await page.getByRole('button', { name: 'Enter the twin' }).click();
  await page.locator('#headset[data-twin="window"][data-link="live"]').waitFor({ timeout: PATIENCE });
  assert(!(await page.getByRole('button', { name: 'Enter VR' }).isVisible()), 'there is no VR here');
  const node = map.nodes.find((n) => n.id === START);
  assert(apart(await at(), [node.x, node.y]) < 0.01, `it begins at ${await at()}`);
});
await check('It draws the robots and the other people whom the server has', async () => {
  await soon('the simulated person', async () => (await reads('people')) === '1');
  const { items } = await ask('/v1/robots');
  assert(Number(await reads('robots')) === items.length, `it draws ${await reads('robots')} robots of ${items.length}`);
  return `${items.length} robots`;
});
await check('Whoever walks in it is a worker for the server, there and with that heading', async () => {
  await soon('the worker', async () => {
    const worker = await me();
    return worker?.presence === 'tracked' && apart([worker.x, worker.y], await at()) < 0.1;
  });
  const { heading } = await me();
  const facing = Number(await reads('heading'));
  assert(
    Math.abs(Math.atan2(Math.sin(heading - facing), Math.cos(heading - facing))) < 0.05,
    `the server has ${heading}, it looks to ${facing}`,
  );
});
await check('Keys walk as fast as people do, and not through racks', async () => {
  const canvas = page.locator('canvas');
  await canvas.focus();
  const before = await at();
  // By the clock of the page, which goes on while a busy machine is late with the key.
  const now = () => page.evaluate(() => performance.now() / 1_000);
  const began = await now();
  await page.keyboard.down('w');
  await page.waitForTimeout(2_000);
  await page.keyboard.up('w');
  const [gone, seconds] = [apart(before, await at()), (await now()) - began];
  assert(gone > 0.3 && gone < 1.75 * seconds, `in ${seconds.toFixed(1)} s it went ${gone.toFixed(2)} m`);
  const inside = ([x, y], [[x0, y0], , [x1, y1]]) => x > x0 && x < x1 && y > y0 && y < y1;
  // From here the racks are ahead: into them for as long as it takes.
  await page.keyboard.down('w');
  for (let i = 0; i < 20; i++) {
    await page.waitForTimeout(100);
    const now = await at();
    assert(!map.obstacles.some((o) => inside(now, o)), `it is in the racks, at ${now}`);
  }
  await page.keyboard.up('w');
  // On a busy machine a pose may be late for a moment.
  await soon('the worker', async () => (await me())?.presence === 'tracked');
  const worker = await me();
  const { feed } = await ask(`/v1/workers/${worker.id}`);
  assert(feed.jumps === 0 && feed.absurd === 0 && feed.taken > 20, JSON.stringify(feed));
  return `${gone.toFixed(2)} m; ${feed.taken} poses taken`;
});
await accessible('the twin');
await check('A task is shown as the path on the floor, and drags look along it', async () => {
  const { id } = await me();
  await ask(`/v1/workers/${id}/assignments`, { place: 'G6-7', stay_s: 600 });
  await soon('the path', async () => Number(await reads('path')) > 1);
  const box = await page.locator('canvas').boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  /** The heading, once a drag has reached the picture: a busy page is frames behind. */
  const settled = async (before) => {
    for (let [last, tries] = [NaN, 0]; ; tries += 1) {
      await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
      const now = Number(await reads('heading'));
      if (now === last && (now !== before || tries > 30)) return now;
      last = now;
      await page.waitForTimeout(100);
    }
  };
  /** Drags the picture; a drag to the right turns to the left. Answers by how much. */
  const drag = async (dx, dy = 0) => {
    const before = Number(await reads('heading'));
    await page.mouse.move(middle[0] - dx / 2, middle[1] - dy / 2);
    await page.mouse.down();
    await page.mouse.move(middle[0] + dx / 2, middle[1] + dy / 2, { steps: 3 });
    await page.mouse.up();
    return (await settled(before)) - before;
  };
  const turn = await drag(200);
  assert(turn > 0.15 && turn < 0.4, `a drag of 200 pixels turns by ${turn.toFixed(2)}`);
  /** How far to the left the path leads, a few steps ahead. */
  const off = async () => {
    const { path } = await ask(`/v1/workers/${id}`);
    const from = await at();
    const to = path.find((p) => apart(p, from) > 1.5) ?? path.at(-1) ?? from;
    const more = Math.atan2(to[1] - from[1], to[0] - from[0]) - Number(await reads('heading'));
    return Math.atan2(Math.sin(more), Math.cos(more));
  };
  let left = await off();
  for (let i = 0; i < 20 && Math.abs(left) > 0.15; i++) {
    await drag(Math.max(-350, Math.min(350, (left * 200) / turn)));
    left = await off();
  }
  assert(Math.abs(left) < 0.3, `it looks ${left.toFixed(2)} past the path`);
  // And down a little, to the floor.
  await drag(0, -90);
  await page.waitForTimeout(400);
  await shot('window');
  return `200 pixels turn by ${turn.toFixed(2)}; ${await reads('path')} points`;
});
await check('The narrow view shows 30° by 17.5°, and nothing outside of it', async () => {
  await page.locator('.pad').evaluate((pad) => {
    pad.style.visibility = 'hidden';
  });
  await page.getByRole('button', { name: /Narrow view/ }).click();
  await page.waitForTimeout(300);
  await shot('narrow');
  const { width, height, left, right, top, bottom } = await lit(page);
  // The longer side of the window shows 80°.
  const ahead = Math.max(width, height) / 2 / Math.tan((40 * Math.PI) / 180);
  const seen = [(right - left + 1) / 2, (bottom - top + 1) / 2].map(
    (half) => (Math.atan(half / ahead) * 360) / Math.PI,
  );
  assert(
    seen.every((angle, i) => Math.abs(angle - NARROW[i]) < 0.4),
    `it shows ${seen.map((a) => a.toFixed(1)).join('° by ')}°`,
  );
  await page.locator('canvas').focus();
  await page.keyboard.press('n');
  await page.waitForTimeout(300);
  assert((await reads('narrow')) === 'false' && (await lit(page)).share > 0.99, 'it stays narrow');
  await page.locator('.pad').evaluate((pad) => {
    pad.style.visibility = '';
  });
  return `${seen.map((a) => a.toFixed(1)).join('° by ')}°`;
});
await check('A finger walks with the pad, on a phone whose page is no wider than it is', async () => {
  await page.setViewportSize({ width: 390, height: 780 });
  await page.waitForTimeout(300);
  const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert(over <= 0, `it is ${over} px too wide`);
  const before = await at();
  const pad = await page.locator('.pad').boundingBox();
  await page.mouse.move(pad.x + pad.width / 2, pad.y + pad.height / 2);
  await page.mouse.down();
  // Back, since ahead there may be racks.
  await page.mouse.move(pad.x + pad.width / 2, pad.y + pad.height - 4, { steps: 3 });
  await page.waitForTimeout(800);
  await shot('phone');
  await page.mouse.up();
  const gone = apart(before, await at());
  assert(gone > 0.2, `it went ${gone.toFixed(2)} m`);
  await page.waitForTimeout(200);
  const rest = await at();
  await page.waitForTimeout(300);
  assert(apart(rest, await at()) < 0.01, 'it goes on after the finger has left');
  await page.setViewportSize({ width: 1120, height: 760 });
  return `${gone.toFixed(2)} m`;
});
await check('Whoever leaves is no longer on the floor for the server', async () => {
  await page.getByRole('button', { name: 'I have left the floor' }).click();
  await page.getByText('visitor has left the floor.').waitFor({ timeout: PATIENCE });
  await soon('absence', async () => (await me()).presence === 'absent');
});
await page.close();

const worn = await browser.newContext({ viewport: { width: 720, height: 405 }, colorScheme: 'dark' });
const vr = await open(worn);
await vr.addInitScript(IWER);
await vr.addInitScript(() => {
  const { XRDevice, metaQuest3 } = globalThis.IWER;
  const headset = new XRDevice(metaQuest3);
  headset.installRuntime({ forceInstall: true });
  headset.primaryInputMode = 'controller';
  headset.stereoEnabled = true;
  globalThis.headset = headset;
});
const sees = (name) => vr.locator('#headset').getAttribute(`data-${name}`);
const stands = async () => (await sees('at')).split(',').map(Number);
const seen = async () => (await ask('/v1/workers')).items.find((w) => w.name === 'trainee');
const frames = (count) =>
  vr.evaluate(
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
await check('A VR headset is in the twin where the window was, and the server has it there', async () => {
  await vr.goto(new URL('/headset', url).href);
  await vr.getByLabel('Name of the wearer').fill('trainee');
  await vr.getByLabel('Begin at').selectOption(START);
  await vr.getByRole('button', { name: 'Enter the twin' }).click();
  await vr.locator('#headset[data-twin="window"][data-link="live"]').waitFor({ timeout: PATIENCE });
  const before = await stands();
  await vr.getByRole('button', { name: 'Enter VR' }).click();
  await vr.locator('#headset[data-twin="vr"]').waitFor({ timeout: PATIENCE });
  assert(await vr.evaluate(() => globalThis.headset.activeSession.enabledFeatures !== null), 'there is no session');
  assert(apart(before, await stands()) < 0.01, `from ${before} it came to ${await stands()}`);
  await soon(
    'the trainee',
    async () => (await seen())?.presence === 'tracked' && apart([(await seen()).x, (await seen()).y], before) < 0.1,
  );
  await frames(5);
  await vr.screenshot({ path: `${SHOTS}twin-vr.png` });
  return `at ${before}, ${await sees('robots')} robots`;
});
await check('A step of the wearer is a step on the map, and the left stick walks on', async () => {
  const before = await stands();
  await vr.evaluate(async () => {
    for (let i = 0; i < 20; i++) {
      globalThis.headset.position.z -= 0.02;
      await new Promise((done) => {
        requestAnimationFrame(done);
      });
    }
  });
  await frames(3);
  const stepped = apart(before, await stands());
  assert(Math.abs(stepped - 0.4) < 0.02, `a step of 0.4 m is one of ${stepped.toFixed(2)} m`);
  await vr.evaluate(() => globalThis.headset.controllers.left.updateAxes('thumbstick', 0, 1));
  const from = await stands();
  await soon('a walk', async () => apart(from, await stands()) > 0.2);
  await vr.evaluate(() => globalThis.headset.controllers.left.updateAxes('thumbstick', 0, 0));
  await frames(3);
  const there = await stands();
  await frames(3);
  assert(apart(there, await stands()) < 0.01, 'it goes on after the stick was let go');
  await soon('the trainee', async () => apart([(await seen()).x, (await seen()).y], there) < 0.1);
});
await check('The right stick turns by 30° on the spot, once for each push', async () => {
  const [before, facing] = [await stands(), Number(await sees('heading'))];
  await vr.evaluate(() => globalThis.headset.controllers.right.updateAxes('thumbstick', 1, 0));
  await frames(12);
  await vr.evaluate(() => globalThis.headset.controllers.right.updateAxes('thumbstick', 0, 0));
  await frames(4);
  const turn = Number(await sees('heading')) - facing;
  assert(Math.abs(Math.atan2(Math.sin(turn), Math.cos(turn)) + Math.PI / 6) < 0.02, `it turned by ${turn.toFixed(2)}`);
  assert(apart(before, await stands()) < 0.02, 'it went elsewhere');
});
await check('A button narrows the view of both eyes', async () => {
  const before = await lit(vr, 'screen');
  await vr.evaluate(() => globalThis.headset.controllers.right.updateButtonValue('a-button', 1));
  await frames(4);
  await vr.evaluate(() => globalThis.headset.controllers.right.updateButtonValue('a-button', 0));
  await frames(4);
  assert((await sees('narrow')) === 'true', 'it is not narrow');
  await vr.screenshot({ path: `${SHOTS}twin-vr-narrow.png` });
  const after = await lit(vr, 'screen');
  assert(
    after.share < before.share * 0.25 && after.halves.every((share) => share > 0),
    `of ${before.share} of the picture, ${after.share} is left: ${after.halves}`,
  );
  return `${(after.share * 100).toFixed(1)} % of the picture`;
});
await check('When the device is recentred, the wearer stays where they were on the map', async () => {
  const before = await stands();
  await vr.evaluate(() => globalThis.headset.recenter());
  await frames(6);
  assert(apart(before, await stands()) < 0.05, `from ${before} it came to ${await stands()}`);
  const { feed } = await ask(`/v1/workers/${(await seen()).id}`);
  assert(feed.jumps === 0, `${feed.jumps} jumps`);
});
await check('After VR, the window goes on from there', async () => {
  const before = await stands();
  await vr.evaluate(() => globalThis.headset.activeSession.end());
  await vr.locator('#headset[data-twin="window"]').waitFor({ timeout: PATIENCE });
  assert(apart(before, await stands()) < 0.05, `from ${before} it came to ${await stands()}`);
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await stop();
await finish(browser);

async function open(one) {
  const made = await one.newPage();
  listen(made, complaints);
  return made;
}

async function accessible(look) {
  await check(`axe finds nothing wrong (${look})`, () => assertAccessible(page, look));
}

/** The part of a picture that is not masked: its borders, its share, and its shares of the left and the right half. */
async function lit(one, what = 'canvas') {
  const png = await (what === 'screen' ? one.screenshot() : one.locator('canvas').screenshot());
  return one.evaluate(async (base64) => {
    const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))]));
    const { width, height } = picture;
    const ink = new OffscreenCanvas(width, height).getContext('2d');
    ink.drawImage(picture, 0, 0);
    const { data } = ink.getImageData(0, 0, width, height);
    let [left, right, top, bottom, count, leftHalf] = [width, -1, height, -1, 0, 0];
    // The rounded corners and the frame of the focus are no part of what is drawn.
    const rim = 14;
    for (let y = rim; y < height - rim; y++) {
      for (let x = rim; x < width - rim; x++) {
        const i = 4 * (y * width + x);
        if (data[i] + data[i + 1] + data[i + 2] === 0) continue;
        [left, right, top, bottom, count] = [
          Math.min(left, x),
          Math.max(right, x),
          Math.min(top, y),
          Math.max(bottom, y),
          count + 1,
        ];
        if (x < width / 2) leftHalf += 1;
      }
    }
    const all = (width - 2 * rim) * (height - 2 * rim);
    return {
      width,
      height,
      left,
      right,
      top,
      bottom,
      share: count / all,
      halves: [(2 * leftHalf) / all, (2 * (count - leftHalf)) / all],
    };
  }, png.toString('base64'));
}
