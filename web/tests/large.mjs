// The map editor with a large hall: what a stroke, a drag of a place and a move of the plan cost the page.
// node web/tests/large.mjs PROGRAM
// What is asserted is the page's processor time, which other programs on the machine do not stretch; frames a second
// are printed.
import { mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, check, finish, listen, openBrowser } from './chromium.mjs';
import { serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say which program to start: node web/tests/large.mjs target/debug/giveway');
  process.exit(2);
}
/** What a frame may cost while something is dragged, milliseconds: above it, drawing feels slow. */
const FRAME_MS = 50;
/** What the page may work when a stroke ends, milliseconds. */
const END_MS = 400;

const root = fileURLToPath(new URL('../../', import.meta.url));
const server = await serve(program, 'scenarios/lab.json', mkdtempSync(join(tmpdir(), 'giveway-large-')));
const browser = await openBrowser();
const page = await (await browser.newContext({ viewport: { width: 1440, height: 900 } })).newPage();
const complaints = [];
listen(page, complaints);
const sheet = page.getByRole('application');
const status = page.locator('section', { has: page.getByRole('heading', { name: 'Check' }) }).getByRole('status');

// In processor time of the page's main thread.
const devtools = await page.context().newCDPSession(page);
await devtools.send('Performance.enable', { timeDomain: 'threadTicks' });
const worked = async () =>
  1000 * (await devtools.send('Performance.getMetrics')).metrics.find((m) => m.name === 'TaskDuration').value;

/** What the page works while `run` runs, in all and per frame, milliseconds; and how many frames a second it shows. */
async function cost(run) {
  await page.evaluate(() => {
    globalThis.times = [];
    const note = (at) => {
      globalThis.times.push(at);
      globalThis.noting = requestAnimationFrame(note);
    };
    globalThis.noting = requestAnimationFrame(note);
  });
  const before = await worked();
  await run();
  const ms = (await worked()) - before;
  const times = await page.evaluate(() => {
    cancelAnimationFrame(globalThis.noting);
    return globalThis.times;
  });
  assert(times.length > 1, 'the page showed no frames');
  return { ms, perFrame: ms / times.length, rate: (1000 * (times.length - 1)) / (times.at(-1) - times[0]) };
}

/** Drags over the sheet for about two seconds, as a hand does: sixty moves a second at most. */
async function drag([x0, y0], [x1, y1], steps = 90) {
  const box = await sheet.boundingBox();
  const at = (t) => [box.x + box.width * (x0 + (x1 - x0) * t), box.y + box.height * (y0 + (y1 - y0) * t)];
  await page.mouse.move(...at(0));
  await page.mouse.down();
  const moving = await cost(async () => {
    for (let i = 1; i <= steps; i++) {
      await page.mouse.move(...at(i / steps));
      await page.waitForTimeout(8);
    }
  });
  const ending = await cost(async () => {
    await page.mouse.up();
    await page.waitForTimeout(900);
  });
  return { moving, ending };
}

const tool = (name) => page.getByRole('navigation', { name: 'Tools' }).getByRole('button', { name }).click();
function fast({ moving, ending }) {
  const said =
    `${moving.perFrame.toFixed(1)} ms of processor time a frame, ${ending.ms.toFixed(0)} ms at the end; ` +
    `${moving.rate.toFixed(0)} frames a second`;
  assert(moving.perFrame <= FRAME_MS && ending.ms <= END_MS, said);
  return said;
}

await check('A hall with five thousand places is opened', async () => {
  await page.goto(new URL('/editor', server.url).href);
  await page.getByLabel('Open a file').setInputFiles(join(root, 'maps/kiva.json'));
  await status.filter({ hasText: 'can be used' }).waitFor({ timeout: PATIENCE });
});
await check('Moving the plan is smooth', async () => {
  await page.keyboard.down('Shift');
  const found = await drag([0.7, 0.6], [0.3, 0.4]);
  await page.keyboard.up('Shift');
  return fast(found);
});
await check('A stroke with the aisle tool is smooth, and so is its end', async () => {
  await page.getByRole('button', { name: 'Fit' }).click();
  await tool('Aisle');
  return fast(await drag([0.2, 0.03], [0.8, 0.03]));
});
await check('Dragging a block of racks is smooth, and so is its end', async () => {
  await tool('Racks');
  return fast(await drag([0.4, 0.4], [0.6, 0.5]));
});
await check('Dragging a place is smooth, and so is its end', async () => {
  await page.getByRole('button', { name: 'Zoom in' }).click();
  await page.getByRole('button', { name: 'Zoom in' }).click();
  await tool('Select and move');
  return fast(await drag([0.5, 0.5], [0.6, 0.7]));
});
await check('Undoing it is smooth', async () => {
  const { ms, rate } = await cost(async () => {
    for (let i = 0; i < 3; i++) await page.getByRole('button', { name: 'Undo' }).click();
    await page.waitForTimeout(600);
  });
  const said = `${ms.toFixed(0)} ms of processor time; ${rate.toFixed(0)} frames a second`;
  assert(ms <= 3 * END_MS, said);
  return said;
});
await check('The page logs no error', async () => {
  assert(complaints.length === 0, complaints.join(' | '));
});
await server.stop();
await finish(browser);
