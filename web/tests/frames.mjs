// What a frame costs with 800 robots and 20 people, all of them moving: node tests/frames.mjs [DIST] [SHOTS]
// It serves the built page, from dist/ or DIST, with a toy floor. Times are of this page's own scripts, not
// of the graphics card, of which a test machine has none; they are printed, and only what does not depend on
// the machine is asserted. SHOTS is a folder for pictures.
import { mkdir } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { startMock } from '../dev/mock.mjs';
import { PATIENCE, assert, check, finish, openBrowser } from './chromium.mjs';

const ROBOTS = 800;
const PEOPLE = 20;
const SECONDS = 5;
const MOST_CALLS = 12;
const dist = process.argv[2] ?? fileURLToPath(new URL('../dist', import.meta.url));
const shots = process.argv[3] ?? null;
if (shots) await mkdir(shots, { recursive: true });

/** Runs in the page before anything else: clocks every frame and every message, and counts drawing calls. */
function spy() {
  const seen = { frames: [], messages: [], calls: [], uploads: [] };
  let [calls, uploaded] = [0, 0];
  globalThis.seen = seen;
  const frame = globalThis.requestAnimationFrame.bind(globalThis);
  globalThis.requestAnimationFrame = (run) =>
    frame((now) => {
      [calls, uploaded] = [0, 0];
      const began = performance.now();
      run(now);
      seen.frames.push(performance.now() - began);
      seen.calls.push(calls);
      seen.uploads.push(uploaded);
    });
  const message = Object.getOwnPropertyDescriptor(WebSocket.prototype, 'onmessage');
  Object.defineProperty(WebSocket.prototype, 'onmessage', {
    ...message,
    set(run) {
      message.set.call(this, (event) => {
        const began = performance.now();
        run(event);
        seen.messages.push(performance.now() - began);
      });
    },
  });
  for (const name of ['drawArrays', 'drawArraysInstanced', 'drawElements']) {
    const draw = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...given) {
      calls += 1;
      return draw.apply(this, given);
    };
  }
  const upload = WebGL2RenderingContext.prototype.bufferSubData;
  WebGL2RenderingContext.prototype.bufferSubData = function (...given) {
    uploaded += 4 * (given[4] ?? 0);
    return upload.apply(this, given);
  };
}

const at = (list, part) =>
  [...list].sort((a, b) => a - b)[Math.min(list.length - 1, Math.floor(part * list.length))] ?? NaN;
const told = (list) => `median ${at(list, 0.5).toFixed(2)}, p95 ${at(list, 0.95).toFixed(2)}`;

const mock = await startMock({ port: 0, robots: ROBOTS, people: PEOPLE, width: 90, height: 56, dist });
const browser = await openBrowser();
for (const painter of ['webgl', 'canvas2d']) {
  const page = await browser.newPage({
    viewport: { width: 1440, height: 900 },
    colorScheme: painter === 'webgl' ? 'dark' : 'light',
  });
  await page.addInitScript(spy);
  await page.goto(`http://127.0.0.1:${mock.port}/?painter=${painter}`);
  await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
    timeout: PATIENCE,
  });
  await page.waitForTimeout(3_000);
  // In processor time, which other programs on the machine do not stretch.
  const devtools = await page.context().newCDPSession(page);
  await devtools.send('Performance.enable', { timeDomain: 'threadTicks' });
  const scripts = async () =>
    (await devtools.send('Performance.getMetrics')).metrics.find((m) => m.name === 'ScriptDuration').value;
  const watch = async (what) => {
    await page.evaluate(() =>
      Object.values(globalThis.seen).forEach((list) => {
        list.length = 0;
      }),
    );
    const before = await scripts();
    await page.waitForTimeout(SECONDS * 1_000);
    const busy = 1_000 * ((await scripts()) - before);
    const seen = await page.evaluate(() => globalThis.seen);
    await check(`${painter}, ${what}: ${ROBOTS} robots and ${PEOPLE} people are drawn frame by frame`, async () => {
      const shown = await page.locator('canvas[data-robots]').evaluate((canvas) => ({ ...canvas.dataset }));
      assert(shown.painter === painter, `it is painted with ${shown.painter}`);
      assert(
        Number(shown.robots) === ROBOTS && Number(shown.people) === PEOPLE,
        `it shows ${shown.robots} robots and ${shown.people} people`,
      );
      assert(
        seen.frames.length > 2 && seen.messages.length > 2,
        `there were ${seen.frames.length} frames and ${seen.messages.length} messages`,
      );
      const calls = Math.max(...seen.calls);
      assert(calls <= MOST_CALLS, `one frame took ${calls} drawing calls`);
      assert(painter === 'canvas2d' || calls > 1, 'nothing was drawn');
      return (
        `script, ms: per frame ${told(seen.frames)}; per message ${told(seen.messages)}; ` +
        `all scripts took ${(busy / SECONDS).toFixed(0)} ms of processor time a second; ` +
        `at most ${calls} drawing calls; ${Math.round(at(seen.uploads, 0.5) / 1000)} kB to the graphics card; ` +
        `${(seen.frames.length / SECONDS).toFixed(0)} frames/s`
      );
    });
    if (shots) await page.screenshot({ path: `${shots}/${painter}-${what}.png` });
  };
  await watch('whole');
  const map = page.getByRole('application', { name: 'Map of the floor' });
  await map.focus();
  for (let i = 0; i < 8; i++) await page.keyboard.press('+');
  await watch('near');
  await page.close();
}
mock.stop();
await finish(browser);
