// The map editor with a large hall: a stroke, a drag of a place and a move of the plan, in frames a second.
// node web/tests/large.mjs PROGRAM
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
/** Frames a second below which drawing feels slow. */
const LEAST = 20;
/** How long the page may stand still when a stroke ends, milliseconds. */
const LONGEST_MS = 400;

const root = fileURLToPath(new URL('../../', import.meta.url));
const server = await serve(program, 'scenarios/lab.json', mkdtempSync(join(tmpdir(), 'giveway-large-')));
const browser = await openBrowser();
const page = await (await browser.newContext({ viewport: { width: 1440, height: 900 } })).newPage();
const complaints = [];
listen(page, complaints);
const sheet = page.getByRole('application');
const status = page.locator('section', { has: page.getByRole('heading', { name: 'Check' }) }).getByRole('status');

/** Frames a second, and the longest pause between two frames, while `run` runs. */
async function frames(run) {
  await page.evaluate(() => {
    globalThis.times = [];
    const note = (at) => {
      globalThis.times.push(at);
      globalThis.noting = requestAnimationFrame(note);
    };
    globalThis.noting = requestAnimationFrame(note);
  });
  await run();
  const times = await page.evaluate(() => {
    cancelAnimationFrame(globalThis.noting);
    return globalThis.times;
  });
  const gaps = times.slice(1).map((at, i) => at - times[i]);
  return { rate: (1000 * gaps.length) / (times.at(-1) - times[0]), longest: Math.max(...gaps) };
}

/** Drags over the sheet for about two seconds, as a hand does: sixty moves a second at most. */
async function drag([x0, y0], [x1, y1], steps = 90) {
  const box = await sheet.boundingBox();
  const at = (t) => [box.x + box.width * (x0 + (x1 - x0) * t), box.y + box.height * (y0 + (y1 - y0) * t)];
  await page.mouse.move(...at(0));
  await page.mouse.down();
  const moving = await frames(async () => {
    for (let i = 1; i <= steps; i++) {
      await page.mouse.move(...at(i / steps));
      await page.waitForTimeout(8);
    }
  });
  const ending = await frames(async () => {
    await page.mouse.up();
    await page.waitForTimeout(900);
  });
  return { moving, ending };
}

const tool = (name) => page.getByRole('navigation', { name: 'Tools' }).getByRole('button', { name }).click();
function fast({ moving, ending }) {
  const said = `${moving.rate.toFixed(0)} frames a second, ${ending.longest.toFixed(0)} ms at the end`;
  assert(moving.rate >= LEAST && ending.longest <= LONGEST_MS, said);
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
  const { rate, longest } = await frames(async () => {
    for (let i = 0; i < 3; i++) await page.getByRole('button', { name: 'Undo' }).click();
    await page.waitForTimeout(600);
  });
  assert(longest <= LONGEST_MS, `${longest.toFixed(0)} ms`);
  return `${rate.toFixed(0)} frames a second, ${longest.toFixed(0)} ms at most`;
});
await check('The page logs no error', async () => {
  assert(complaints.length === 0, complaints.join(' | '));
});
await server.stop();
await finish(browser);
