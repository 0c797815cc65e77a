// Robots of two kinds that join, leave and have faults, in a real browser against a real server that this test starts
// itself: node tests/robots.mjs PATH-TO-GIVEWAY
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import {
  PATIENCE,
  assert,
  assertAccessible,
  check,
  finish,
  isRefusal,
  listen,
  openBrowser,
  until,
} from './chromium.mjs';
import { FAST, serve } from './serve.mjs';

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
const { url, stop } = await serve(program, `${scratch}/robots.json`, scratch, 0, FAST);
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints, isRefusal);
const ask = async (path) => (await context.request.get(new URL(path, url).href)).json();
const robots = async () => (await ask('/v1/robots')).items;
const card = page.getByRole('region', { name: 'Robot', exact: true });
const choose = async (id) => {
  // Right after a reload the field may not know the robots yet.
  await until(
    `the card of ${id}`,
    async () => {
      await page.getByLabel('Find on the floor').fill(id);
      await page.keyboard.press('Enter');
      return (await card.count()) > 0 && (await card.innerText()).startsWith(id);
    },
    20,
  );
};

await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
  timeout: PATIENCE,
});
const map = await ask('/v1/map');

await check('The card of a robot says of which kind it is', async () => {
  for (const kind of ['shuttle', 'mover']) {
    await until(`the card of a ${kind}`, async () => {
      const robot = (await robots()).find((r) => r.kind === kind);
      if (!robot) return false;
      await choose(robot.id);
      return card
        .getByText(kind, { exact: true })
        .waitFor({ timeout: 5_000 })
        .then(
          () => true,
          () => false,
        );
    });
    await card.getByRole('button', { name: 'Close' }).click();
  }
  return (await ask('/v1/kinds')).map((k) => k.name).join(', ');
});
for (const [fault, words] of [
  ['emergency_stop', 'emergency stop is pressed'],
  ['manual', 'driven by hand'],
]) {
  await check(`A robot says in its card that it has the fault ${fault}, and goes on after it`, async () => {
    // The fault may end while the card opens: then the next one is looked at.
    let seen = null;
    await until(`a card with "${words}"`, async () => {
      const robot = (await robots()).find((r) => r.fault === fault);
      if (!robot) return false;
      await choose(robot.id);
      const there = card.getByText(words, { exact: false }).first();
      if (
        !(await there.waitFor({ timeout: 5_000 }).then(
          () => true,
          () => false,
        ))
      )
        return false;
      await page.screenshot({ path: `${SHOTS}fault-${fault.replace('_', '-')}.png` });
      seen = robot.id;
      return true;
    });
    await until('an end of the fault', async () => (await robots()).find((r) => r.id === seen)?.fault === null);
    await card.getByRole('button', { name: 'Close' }).click();
    return seen;
  });
}
await check(
  'A robot is taken off the floor in its card, is gone when it was switched off, and comes back',
  async () => {
    const all = await robots();
    const id = (all.find((r) => r.state === 'idle') ?? all.at(-1)).id;
    await choose(id);
    await card.getByRole('button', { name: 'Remove from the floor' }).click();
    await card.getByRole('button', { name: 'Keep on the floor' }).waitFor({ timeout: PATIENCE });
    await page.screenshot({ path: `${SHOTS}leaving.png` });
    await page.getByText(`${id} is not on the floor.`).waitFor({ timeout: 4 * PATIENCE });
    const left = await robots();
    assert(
      left.length === all.length - 1 && !left.some((r) => r.id === id),
      `${left.length} of ${all.length} robots are there`,
    );
    await page.getByText(`${left.length} robots`, { exact: true }).waitFor({ timeout: PATIENCE });
    // It comes back onto the first place that nobody holds.
    const kind = all.find((r) => r.id === id).kind;
    let back = null;
    for (const node of map.nodes.filter((n) => n.kind === 'parking' || n.kind === 'charger' || n.kind === 'storage')) {
      const answer = await context.request.post(new URL('/v1/robots', url).href, {
        data: { name: id, kind, node: node.id },
      });
      if (answer.status() === 201) {
        back = node.id;
        break;
      }
    }
    assert(back !== null, 'no place was free');
    await card.getByRole('button', { name: 'Remove from the floor' }).waitFor({ timeout: PATIENCE });
    await page.getByText(`${all.length} robots`, { exact: true }).waitFor({ timeout: PATIENCE });
    await card.getByRole('button', { name: 'Close' }).click();
    return `${id} left and came back at ${back}`;
  },
);
const panel = page.getByRole('region', { name: 'Robots', exact: true });
const three = (await robots()).slice(0, 3).map((r) => r.id);
const lines = () => panel.locator('tbody tr[data-robot]');
await check('The tab of robots lists them all, sorted by a click on a heading and searched by a word', async () => {
  await page.getByRole('button', { name: 'Robots', exact: true }).click();
  const all = await robots();
  await until('a line for every robot', async () => (await lines().count()) === all.length, 20);
  await panel.getByRole('button', { name: 'Battery' }).click();
  // The fleet drives on, so a line may be on its way to its new place.
  let charges = [];
  await until(
    'lines in the order of their charge',
    async () => {
      charges = (await lines().evaluateAll((rows) => rows.map((row) => row.innerText))).map((text) =>
        Number(/(\d+) %/.exec(text)[1]),
      );
      return charges.every((c, i) => i === 0 || c >= charges[i - 1] - 1);
    },
    20,
  ).catch((error) => {
    throw new Error(`${error.message} (${charges.join()})`);
  });
  await panel.getByRole('button', { name: 'Robot', exact: true }).click();
  await panel.getByRole('searchbox', { name: 'Search robots' }).fill('shuttle');
  const shuttles = all.filter((r) => r.kind === 'shuttle').length;
  await until('only shuttles', async () => (await lines().count()) === shuttles, 20);
  await panel.getByRole('searchbox', { name: 'Search robots' }).fill('');
  return `${all.length} robots, ${shuttles} shuttles`;
});
await check(
  'Several robots are paused and resumed at once by keys alone, and the count of paused ones filters map and list',
  async () => {
    for (const id of three) {
      await panel.getByRole('checkbox', { name: `Select ${id}`, exact: true }).focus();
      await page.keyboard.press('Space');
    }
    await panel.getByText('3 selected').waitFor({ timeout: PATIENCE });
    await panel.getByRole('button', { name: 'Pause', exact: true }).focus();
    await page.keyboard.press('Enter');
    await panel.getByText('3 robots paused.').waitFor({ timeout: PATIENCE });
    await until('three paused robots', async () => (await ask('/v1/robots?activity=paused')).items.length === 3, 20);
    const count = page.locator('button[data-activity="paused"]');
    await until('a count of them', async () => /Paused.*\b3$/s.test((await count.innerText()).trim()), 20);
    await count.click();
    await until(
      'only paused robots in the list',
      async () => (await lines().count()) === 3 && (await panel.locator('tr[data-activity="paused"]').count()) === 3,
      20,
    );
    for (const theme of ['Light', 'Dark']) {
      await page.getByLabel('Theme').selectOption({ label: theme });
      await page.waitForTimeout(300);
      await page.screenshot({ path: `${SHOTS}robots-${theme.toLowerCase()}.png` });
      await assertAccessible(page, `robots, ${theme}`);
    }
    await count.click();
    await until('all robots in the list', async () => (await lines().count()) > 3, 20);
    await panel.getByRole('button', { name: 'Resume', exact: true }).click();
    await panel.getByText('3 robots resumed.').waitFor({ timeout: PATIENCE });
    await until('no paused robot', async () => (await ask('/v1/robots?activity=paused')).items.length === 0, 20);
    await panel.getByRole('button', { name: 'Dismiss' }).click();
  },
);
await check('Robots go out of service and back, and are sent to charge', async () => {
  await panel.getByRole('button', { name: 'Charge', exact: true }).click();
  await panel.getByText('3 robots sent to charge.').waitFor({ timeout: PATIENCE });
  await panel.getByRole('button', { name: 'Out of service', exact: true }).click();
  await panel.getByText('3 robots going out of service.').waitFor({ timeout: PATIENCE });
  await until('maintenance', async () => (await robots()).filter((r) => r.maintenance).length === 3, 20);
  await panel.getByRole('button', { name: 'Back in service', exact: true }).click();
  await panel.getByText('3 robots back in service.').waitFor({ timeout: PATIENCE });
  await until('no maintenance', async () => (await robots()).every((r) => !r.maintenance), 20);
});
await check('The card of a robot has its life from the server, also in a page that was just opened', async () => {
  await page.reload();
  await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
    timeout: PATIENCE,
  });
  await choose(three[0]);
  const story = card.getByRole('list', { name: 'What happened to the robot' });
  for (const words of ['back in service', 'sent out of service', 'resumed', 'paused by hand']) {
    await story.getByText(words, { exact: true }).first().waitFor({ timeout: PATIENCE });
  }
  await card
    .getByText(/^\d+ m$|^[\d.]+ km$/)
    .first()
    .waitFor({ timeout: PATIENCE });
  for (const theme of ['Light', 'Dark']) {
    await page.getByLabel('Theme').selectOption({ label: theme });
    await page.waitForTimeout(300);
    await page.screenshot({ path: `${SHOTS}robot-card-${theme.toLowerCase()}.png` });
    await assertAccessible(page, `card of a robot, ${theme}`);
  }
  await card.getByRole('button', { name: 'Close' }).click();
});
await check('Every state that the filter of the jobs list offers is one that the server knows', async () => {
  await page.getByRole('button', { name: 'Jobs', exact: true }).click();
  const filter = page.getByLabel('Show jobs in state');
  for (const state of await filter.locator('option').evaluateAll((options) => options.map((o) => o.value))) {
    const answer = page.waitForResponse(
      (r) => r.url().includes('/v1/jobs?') && (state === 'any' || r.url().includes(`state=${state}`)),
      { timeout: PATIENCE },
    );
    await filter.selectOption(state);
    assert((await answer).status() === 200, `${state}: ${(await answer).status()}`);
  }
  assert(
    (await page.getByRole('region', { name: 'Jobs', exact: true }).getByRole('alert').count()) === 0,
    'the list complains',
  );
});
await check(
  'The visible area of the whole hall is refused once where it is too large, and then not asked for again',
  async () => {
    await page.getByRole('button', { name: 'Timelines', exact: true }).click();
    const asked = [];
    page.on('request', (r) => {
      if (r.url().includes('/v1/timelines')) asked.push(r.url());
    });
    // A robot that was found is shown large.
    await page.getByRole('button', { name: 'Show the whole floor' }).click();
    await page.getByRole('button', { name: 'Use the visible area' }).click();
    await page.waitForTimeout(4_000);
    const many = map.nodes.length > 200;
    assert(many ? asked.length === 1 : asked.length > 2, `${asked.length} requests for ${map.nodes.length} places`);
    if (many) await page.getByText(/choose a smaller area/).waitFor({ timeout: PATIENCE });
    return `${map.nodes.length} places, ${asked.length} requests`;
  },
);
await check('Nothing was complained about', async () => {
  assert(complaints.length === 0, complaints.join('; '));
});
await stop();
await finish(browser);
