// Robots keep out of an area that a person closes on the dashboard: seen on the page, against a real server that this
// test starts itself: node tests/closure.mjs PATH-TO-GIVEWAY
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, check, finish, listen, openBrowser } from './chromium.mjs';
import { FAST, serve } from './serve.mjs';
import { tap } from './tap.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/closure.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-closure-`);
// The shipped scenario, in which a person on the dashboard closes an aisle.
const scenario = JSON.parse(readFileSync(HERE('../../scenarios/closure.json'), 'utf8'));
// Its robots are twice as fast here, so that less is waited for.
Object.assign(scenario, {
  map: HERE('../../maps/thesis.json'),
  closures: [],
  fleet: { speed_mps: 2, accel_unloaded_mps2: 2, accel_loaded_mps2: 2, lift_s: 1 },
});
writeFileSync(`${scratch}/closure.json`, JSON.stringify(scenario));
const { url, stop } = await serve(program, `${scratch}/closure.json`, scratch, 0, FAST);
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
await tap(context);
const page = await context.newPage();
const complaints = [];
listen(page, complaints);

/** The middle of the lower right aisle, through which most robots come to a station, metres: x0, y0, x1, y1. */
const AREA = [11.7, 1.7, 12.3, 5.3];
/** Robots are seen to cross it for so long at most, and to keep out of it for so long. */
const [BEFORE_S, AFTER_S] = [90, 25];
/** What was granted before the closure is driven: so many seconds at most. */
const OUT_S = 25;
const host = page.getByRole('application', { name: 'Map of the floor' });
const closures = page.getByRole('region', { name: 'Closed areas' });
const data = (name) => page.locator('canvas[data-robots]').getAttribute(`data-${name}`);

/** Watches the robots that the page draws for so many seconds, or until `enough` have been inside of the area. */
const watch = (seconds, enough) =>
  page.evaluate(
    ([area, most, few]) =>
      new Promise((done) => {
        const [x0, y0, x1, y1] = area;
        const { floor } = globalThis;
        const [crossed, versions, began, deliveries] = [
          new Map(),
          new Set(),
          floor.time_s,
          floor.counters.robot_deliveries,
        ];
        const look = () => {
          versions.add(floor.version);
          for (const { id, x, y } of floor.robots) {
            if (x > x0 && x < x1 && y > y0 && y < y1) crossed.set(id, `${id} at ${x.toFixed(2)}, ${y.toFixed(2)}`);
          }
          if (floor.time_s - began < most && crossed.size < few) return void requestAnimationFrame(look);
          done({
            crossed: [...crossed.values()],
            pictures: versions.size,
            lasted: floor.time_s - began,
            deliveries: floor.counters.robot_deliveries - deliveries,
          });
        };
        look();
      }),
    [AREA, seconds, enough],
  );

const map = await (await context.request.get(new URL('/v1/map', url).href)).json();
/** Where a place of the map is on the screen, as the page shows it. */
async function onScreen(x, y) {
  const { x: left, y: top, width, height } = await host.boundingBox();
  const [midX, midY, scale] = (await data('view')).split(' ').map(Number);
  // A floor that stands upright may be turned: up is to the right then.
  const [right, up] = (await data('turned')) === 'true' ? [y - midY, midX - x] : [x - midX, y - midY];
  return [left + width / 2 + right * scale, top + height / 2 - up * scale];
}

await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
  timeout: PATIENCE,
});

await check('Before the closure, robots cross the area', async () => {
  const { crossed, lasted } = await watch(BEFORE_S, 3);
  assert(crossed.length >= 3, `in ${lasted.toFixed(0)} s only these did: ${crossed}`);
  return `${crossed.join('; ')} within ${lasted.toFixed(0)} s`;
});
await check('The robots of this test are those that the page draws', async () => {
  await page.getByRole('button', { name: 'Stop all robots' }).click();
  await page.waitForTimeout(3_000);
  const robot = await page.evaluate(() => globalThis.floor.robots[0]);
  assert((await data('robots')) === String(scenario.robots), `it draws ${await data('robots')} robots`);
  await page.mouse.click(...(await onScreen(robot.x, robot.y)));
  await page.locator('.card').getByRole('heading', { name: robot.id, exact: true }).waitFor({ timeout: PATIENCE });
  await page.getByRole('button', { name: 'Close', exact: true }).click();
  await page.getByRole('button', { name: 'Resume all robots' }).first().click();
  await page.getByRole('dialog').getByRole('button', { name: 'Resume all robots' }).click();
  await page.getByRole('button', { name: 'Stop all robots' }).waitFor({ timeout: PATIENCE });
  return `${robot.id} at ${robot.x.toFixed(1)}, ${robot.y.toFixed(1)}`;
});
await check('The area is drawn on the dashboard and closed', async () => {
  await closures.getByRole('button', { name: 'Close a rectangle' }).click();
  await page.getByRole('application', { name: 'Drawing on the floor' }).waitFor({ timeout: PATIENCE });
  const [from, to] = [await onScreen(AREA[0], AREA[1]), await onScreen(AREA[2], AREA[3])];
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps: 5 });
  await page.mouse.up();
  await closures.getByLabel('Why').fill('a rack has fallen over');
  await closures.getByRole('button', { name: 'Close the area' }).click();
  await closures.getByText(/c\d+ is closed/).waitFor({ timeout: PATIENCE });
  await page.waitForFunction(() => globalThis.floor.closures.some((c) => c.state === 'closed'), null, {
    timeout: PATIENCE,
  });
  const { outline } = await page.evaluate(() => globalThis.floor.closures[0]);
  const off = Math.max(
    ...[0, 1].map((i) => Math.abs(Math.min(...outline.map((p) => p[i])) - AREA[i])),
    ...[0, 1].map((i) => Math.abs(Math.max(...outline.map((p) => p[i])) - AREA[i + 2])),
  );
  assert(off < 0.1, `it is ${JSON.stringify(outline)}`);
});
await check('Robots that were inside, or on their way in with a grant, drive out', async () => {
  const inside = map.nodes
    .map(({ x, y }, i) => (x > AREA[0] && x < AREA[2] && y > AREA[1] && y < AREA[3] ? i : -1))
    .filter((i) => i >= 0);
  const began = await page.evaluate(() => globalThis.floor.time_s);
  await page.waitForFunction(
    ([[x0, y0, x1, y1], nodes]) =>
      !globalThis.floor.robots.some(
        ({ x, y, granted }) => (x > x0 && x < x1 && y > y0 && y < y1) || granted.some((node) => nodes.includes(node)),
      ),
    [AREA, inside],
    { timeout: PATIENCE },
  );
  const took = (await page.evaluate(() => globalThis.floor.time_s)) - began;
  assert(took < OUT_S, `it takes ${took.toFixed(1)} s`);
  return `after ${took.toFixed(1)} s`;
});
await check('From then on no robot enters it, and deliveries go on', async () => {
  const half = page.waitForTimeout(AFTER_S * 500).then(() => page.screenshot({ path: `${SHOTS}closure-kept.png` }));
  const { crossed, pictures, lasted, deliveries } = await watch(AFTER_S, 1);
  await half;
  assert(crossed.length === 0, `${crossed} after ${lasted.toFixed(0)} s`);
  assert(
    pictures > AFTER_S && deliveries > 0,
    `${pictures} pictures and ${deliveries} deliveries in ${lasted.toFixed(0)} s`,
  );
  return `${pictures} pictures and ${deliveries} deliveries in ${lasted.toFixed(0)} s`;
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await stop();
await finish(browser);
