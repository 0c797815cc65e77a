// Five tasks of a new user, from the words on the screen alone: node tests/tasks.mjs PATH_TO_GIVEWAY
// Everything is found by its visible text or by its accessible name, as a screen reader says it; nothing by the
// structure of the page. Why does this robot wait? Close an aisle. Which jobs were late today? Take a robot out of
// service. Draw a floor with two stations and run it.
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, check, finish, isRefusal, listen, openBrowser, until } from './chromium.mjs';
import { QUICK, serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/tasks.mjs PATH_TO_GIVEWAY');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const scratch = mkdtempSync(join(tmpdir(), 'giveway-tasks-'));
const scenario = {
  ...JSON.parse(readFileSync(HERE('../../scenarios/lab.json'), 'utf8')),
  map: HERE('../../maps/lab.json'),
  jobs: 'none',
  fleet: QUICK,
};
writeFileSync(join(scratch, 'tasks.json'), JSON.stringify(scenario));
const server = await serve(program, join(scratch, 'tasks.json'), scratch);
const ask = async (method, path, body) => {
  const answer = await fetch(new URL(path, server.url), {
    method,
    headers: { 'content-type': 'application/json' },
    ...(body ? { body: JSON.stringify(body) } : {}),
  });
  return answer.status === 204 ? null : answer.json();
};

// What happened before: a delivery came late; then a long pick began, and another robot came to the same station.
const deliver = (rack, more) => ask('POST', '/v1/jobs', { kind: 'deliver', rack, station: 'P', ...more });
const isAt = async (activity) => (await ask('GET', '/v1/robots')).items.some((robot) => robot.activity === activity);
await until('robots', async () => (await ask('GET', '/v1/robots')).items.length === 2, 60);
const order = await deliver('K3', {
  pick_s: 1,
  reference: 'order 4711',
  deadline: new Date(Date.now() + 1_000).toISOString(),
});
await until('the late delivery', async () => (await ask('GET', `/v1/jobs/${order.id}`)).state === 'done', 180);
await deliver('K1', { pick_s: 900 });
await deliver('K9', { pick_s: 900 });
await until('a robot that waits for another one', async () => (await isAt('queueing')) && isAt('picking'), 180);

const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'light' });
const page = await context.newPage();
const complaints = [];
// Whether there are robots of other vendors is asked, and refused where the floor has no link to them.
const isRefusedLists = (message) => isRefusal(message) && message.location().url.includes('/v1/robots?unlisted');
listen(page, complaints, isRefusedLists);
const tab = (name) =>
  page.getByRole('group', { name: 'What is shown below the floor' }).getByRole('button', { name, exact: true });

await check('A robot that waits is found among all robots, and says for what and for how long', async () => {
  await page.goto(server.url);
  await page
    .getByRole('list', { name: 'Robots by state' })
    .getByRole('button', { name: /^Queueing.* 1$/ })
    .click({ timeout: PATIENCE });
  const robots = page.getByRole('region', { name: 'Robots', exact: true });
  await robots.getByRole('button', { name: /^robot-\d$/ }).click();
  const why = page.getByRole('region', { name: 'Why it waits' });
  await why.getByText(/is being picked from/).waitFor({ timeout: PATIENCE });
  await robots.getByRole('button', { name: /^Only: Queueing/ }).click();
  return (await why.innerText()).replaceAll('\n', ' ');
});

await check('An aisle is closed by drawing over it and saying why', async () => {
  const areas = page.getByRole('region', { name: 'Closed areas' });
  await areas.getByRole('button', { name: 'Close a rectangle' }).click();
  await page.getByText('Drag a rectangle over the area to keep out of.').waitFor();
  const { x, y, width, height } = await page.getByRole('application', { name: 'Map of the floor' }).boundingBox();
  await page.mouse.move(x + width * 0.45, y + height * 0.3);
  await page.mouse.down();
  await page.mouse.move(x + width * 0.52, y + height * 0.5, { steps: 4 });
  await page.mouse.up();
  await areas.getByLabel('Why').fill('oil on the floor');
  await areas.getByRole('button', { name: 'Close the area' }).click();
  await areas.getByText('oil on the floor, closed until opened').waitFor({ timeout: PATIENCE });
  await areas.getByRole('button', { name: /^Open c\d+ again$/ }).click();
  await areas.getByText(/is open again/).waitFor({ timeout: PATIENCE });
});

await check(
  'The late jobs of today are in the report, each with its reference, whatever day the browser has',
  async () => {
    // Days are the server's: this machine's clock may be wrong.
    const tomorrow = await context.newPage();
    listen(tomorrow, complaints, isRefusedLists);
    await tomorrow.clock.setFixedTime(new Date(Date.now() + 24 * 3_600_000));
    await tomorrow.goto(server.url);
    await tomorrow
      .getByRole('group', { name: 'What is shown below the floor' })
      .getByRole('button', { name: 'Report', exact: true })
      .click();
    const report = tomorrow.getByRole('region', { name: 'Report', exact: true });
    await report.getByLabel('Of which time').selectOption('Today');
    const late = report.getByRole('table', { name: 'Late jobs' });
    await late.getByRole('cell', { name: 'order 4711' }).waitFor({ timeout: PATIENCE });
    await late.getByRole('button', { name: order.id }).click();
    await tomorrow
      .getByRole('region', { name: 'Job', exact: true })
      .getByRole('heading', { name: new RegExp(order.id) })
      .waitFor({ timeout: PATIENCE });
    await tomorrow.close();
  },
);

await check('A robot is taken out of service in the list of robots', async () => {
  await tab('Robots').click();
  const robots = page.getByRole('region', { name: 'Robots', exact: true });
  await robots.getByLabel('Select robot-2').check();
  await robots.getByRole('button', { name: 'Out of service' }).click();
  await robots.getByText('1 robot going out of service.').waitFor({ timeout: PATIENCE });
});

await check('A floor with two stations is drawn, and half an hour on it is run', async () => {
  await page.getByRole('link', { name: 'Map editor' }).click();
  const plan = page.getByRole('application', { name: /^Floor plan/ });
  await page.getByRole('heading', { name: 'Map editor' }).waitFor({ timeout: PATIENCE });
  await page.getByRole('button', { name: 'New' }).click();
  await plan.focus();
  const tool = (name) =>
    page.getByRole('navigation', { name: 'Tools' }).getByRole('button', { name, exact: false }).click();
  const here = () => page.getByRole('main').getByText(/^-?\d+\.\d\d, -?\d+\.\d\d m: /);
  /** Draws with the keyboard: what the page says is where the cursor is, in metres. */
  const goTo = async ([x, y]) => {
    await plan.focus();
    if ((await here().count()) === 0) await page.keyboard.press('ArrowUp');
    for (let i = 0; i < 60; i++) {
      const [, left, up] = /(-?\d+\.\d\d), (-?\d+\.\d\d) m/.exec(await here().innerText());
      if (Number(left) === x && Number(up) === y) return;
      await page.keyboard.press(
        Number(left) < x ? 'ArrowRight' : Number(left) > x ? 'ArrowLeft' : Number(up) < y ? 'ArrowUp' : 'ArrowDown',
      );
    }
    throw new Error(`the cursor does not get to ${x}, ${y}`);
  };
  const draw = async (name, from, to = null) => {
    await tool(name);
    await goTo(from);
    await page.keyboard.press('Enter');
    if (to === null) return;
    await goTo(to);
    await page.keyboard.press('Enter');
  };
  for (const [a, b] of [
    [
      [0, 0],
      [6, 0],
    ],
    [
      [6, 0],
      [6, 3],
    ],
    [
      [6, 3],
      [0, 3],
    ],
    [
      [0, 3],
      [0, 0],
    ],
  ])
    await draw('Aisle', a, b);
  await draw('Racks', [1, 1], [5, 2]);
  await draw('Station', [2, -1], [2, -1]);
  await draw('Station', [3, 4], [4, 4]);
  await draw('Charger', [-1, 0]);
  await draw('Charger', [7, 0]);
  await draw('Parking place', [7, 3]);
  await page.getByText(/^The map can be used/).waitFor({ timeout: PATIENCE });
  await page.getByText(/2 stations\./).waitFor();
  await page.getByLabel('Robots', { exact: true }).fill('2');
  await page.getByRole('button', { name: 'Try it' }).click();
  await page.getByText('Deliveries an hour').waitFor({ timeout: PATIENCE });
  const perHour = /Deliveries an hour\s+(\d+)/.exec(
    await page.getByRole('complementary', { name: 'About this map' }).innerText(),
  )?.[1];
  assert(Number(perHour) > 10, `${perHour} deliveries an hour`);
  return `${perHour} deliveries an hour`;
});
await check('The pages log no error', async () => {
  assert(complaints.length === 0, complaints.join(' | '));
});
await server.stop();
await finish(browser);
