// Robots of two kinds that join, leave and have faults, in a real browser against a real server that this test starts
// itself: node tests/robots.mjs PATH-TO-GIVEWAY
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, check, finish, isRefusal, listen, openBrowser, until } from './chromium.mjs';
import { serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/robots.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-robots-`);
// The shipped scenario with few robots, to which something happens all the time.
const scenario = JSON.parse(readFileSync(HERE('../../scenarios/mixed.json'), 'utf8'));
Object.assign(scenario, { map: HERE('../../maps/mixed.json'), robots: 9, jobs: { backlog: 6 }, customers: {} });
scenario.faults = { emergency_stops_per_hour: 60, manual_drives_per_hour: 60, repair_s: 12 };
writeFileSync(`${scratch}/robots.json`, JSON.stringify(scenario));
const { url, stop } = await serve(program, `${scratch}/robots.json`, scratch);
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints, isRefusal);
const ask = async (path) => (await context.request.get(new URL(path, url).href)).json();
const robots = async () => (await ask('/v1/robots')).items;
const card = page.getByRole('region', { name: 'Robot', exact: true });
const choose = async (id) => {
  await page.getByLabel('Find on the floor').fill(id);
  await page.keyboard.press('Enter');
};

await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, { timeout: PATIENCE });
const map = await ask('/v1/map');

await check('The card of a robot says of which kind it is', async () => {
  for (const kind of ['shuttle', 'mover']) {
    await until(`the card of a ${kind}`, async () => {
      const robot = (await robots()).find((r) => r.kind === kind);
      if (!robot) return false;
      await choose(robot.id);
      return card.getByText(kind, { exact: true }).waitFor({ timeout: 5_000 }).then(() => true, () => false);
    });
    await card.getByRole('button', { name: 'Close' }).click();
  }
  return (await ask('/v1/kinds')).map((k) => k.name).join(', ');
});
for (const [fault, words] of [['emergency_stop', 'emergency stop is pressed'], ['manual', 'driven by hand']]) {
  await check(`A robot says in its card that it has the fault ${fault}, and goes on after it`, async () => {
    // The fault may end while the card opens: then the next one is looked at.
    let seen = null;
    await until(`a card with "${words}"`, async () => {
      const robot = (await robots()).find((r) => r.fault === fault);
      if (!robot) return false;
      await choose(robot.id);
      const there = card.getByText(words, { exact: false }).first();
      if (!(await there.waitFor({ timeout: 5_000 }).then(() => true, () => false))) return false;
      await page.screenshot({ path: `${SHOTS}fault-${fault.replace('_', '-')}.png` });
      seen = robot.id;
      return true;
    });
    await until('an end of the fault', async () => (await robots()).find((r) => r.id === seen)?.fault === null);
    await card.getByRole('button', { name: 'Close' }).click();
    return seen;
  });
}
await check('A robot is taken off the floor in its card, is gone when it was switched off, and comes back', async () => {
  const all = await robots();
  const id = (all.find((r) => r.state === 'idle') ?? all.at(-1)).id;
  await choose(id);
  await card.getByRole('button', { name: 'Remove from the floor' }).click();
  await card.getByRole('button', { name: 'Keep on the floor' }).waitFor({ timeout: PATIENCE });
  await page.screenshot({ path: `${SHOTS}leaving.png` });
  await page.getByText(`${id} is not on the floor.`).waitFor({ timeout: 4 * PATIENCE });
  const left = await robots();
  assert(left.length === all.length - 1 && !left.some((r) => r.id === id), `${left.length} of ${all.length} robots are there`);
  await page.getByText(`${left.length} robots`, { exact: true }).waitFor({ timeout: PATIENCE });
  // It comes back onto the first place that nobody holds.
  const kind = all.find((r) => r.id === id).kind;
  let back = null;
  for (const node of map.nodes.filter((n) => n.kind === 'parking' || n.kind === 'charger' || n.kind === 'storage')) {
    const answer = await context.request.post(new URL('/v1/robots', url).href, { data: { name: id, kind, node: node.id } });
    if (answer.status() === 201) { back = node.id; break; }
  }
  assert(back !== null, 'no place was free');
  await card.getByRole('button', { name: 'Remove from the floor' }).waitFor({ timeout: PATIENCE });
  await page.getByText(`${all.length} robots`, { exact: true }).waitFor({ timeout: PATIENCE });
  await card.getByRole('button', { name: 'Close' }).click();
  return `${id} left and came back at ${back}`;
});
await check('Nothing was complained about', async () => {
  assert(complaints.length === 0, complaints.join('; '));
});
await stop();
await finish(browser);
