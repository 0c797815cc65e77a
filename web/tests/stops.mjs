// A delivery to two stations, and a waiting job that is given to another robot, in a real browser against a real server
// that this test starts itself: node tests/stops.mjs PATH-TO-GIVEWAY
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
  console.error('Say where the program is: node tests/stops.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-stops-`);
// Two robots for shelves and two that carry bins alone, all of them quick. A pick takes an hour: it ends when the test
// says so.
const map = JSON.parse(readFileSync(HERE('../../maps/mixed.json'), 'utf8'));
for (const station of map.stations) station.pick_s = 3600;
writeFileSync(`${scratch}/map.json`, JSON.stringify(map));
const scenario = JSON.parse(readFileSync(HERE('../../scenarios/mixed.json'), 'utf8'));
const quick = { speed_mps: 5, speed_loaded_mps: 5, accel_unloaded_mps2: 5, accel_loaded_mps2: 5, lift_s: 0.1 };
const kinds = scenario.kinds.map((kind) => ({ ...kind, share: 1, fleet: { ...kind.fleet, ...quick } }));
Object.assign(scenario, { map: `${scratch}/map.json`, robots: 4, jobs: 'none', kinds });
delete scenario.customers;
writeFileSync(`${scratch}/stops.json`, JSON.stringify(scenario));
const { url, stop } = await serve(program, `${scratch}/stops.json`, scratch, 0, FAST);
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints, isRefusal);
const ask = async (path) => (await context.request.get(new URL(path, url).href)).json();
const post = async (path, data) => {
  const answer = await context.request.post(new URL(path, url).href, { data });
  assert(answer.ok(), `${path}: ${answer.status()} ${await answer.text()}`);
  return answer.json().catch(() => null);
};
const jobOf = (id) => ask(`/v1/jobs/${id}`);
const [first, second] = map.stations.map((s) => s.id);
const shelves = map.racks.filter((r) => r.load === 'shelf').map((r) => r.id);

const form = page.getByRole('form', { name: 'New job' });
const station = form.getByLabel('Station', { exact: true });
const panel = page.getByRole('region', { name: 'Job', exact: true });
const stops = () => panel.getByRole('list', { name: 'Stations' }).getByRole('listitem').allInnerTexts();
const choice = panel.getByRole('combobox', { name: 'Give the job to another robot' });
const give = panel.getByRole('button', { name: 'Give it' });
const open = async (id) => {
  await page
    .getByRole('region', { name: 'Table of jobs' })
    .getByRole('button', { name: id, exact: true })
    .click({ timeout: PATIENCE });
  await panel.getByRole('heading', { name: `Job ${id}`, exact: true }).waitFor({ timeout: PATIENCE });
};
const looks = async (name) => {
  for (const theme of ['Light', 'Dark']) {
    await page.getByLabel('Theme').selectOption({ label: theme });
    await page.waitForTimeout(300);
    await page.screenshot({ path: `${SHOTS}${name}-${theme.toLowerCase()}.png` });
    await assertAccessible(page, `${name}, ${theme}`);
  }
};

await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, {
  timeout: PATIENCE,
});
const robots = (await ask('/v1/robots')).items;
const kindOf = (id) => robots.find((r) => r.id === id).kind;

await check('A station that is not on the map is refused in words, beside the field', async () => {
  await form.getByLabel('Kind of job').selectOption('deliver');
  await form.getByLabel('Rack', { exact: true }).fill(shelves[0]);
  await station.fill(`${first} > no-such-station`);
  await form.getByRole('button', { name: 'Submit job' }).click();
  const error = form.locator('#job-station-error');
  await error.waitFor({ timeout: PATIENCE });
  const words = await error.innerText();
  assert(words.includes('no-such-station') && !/[{}[\]]/.test(words), `these are no words: ${words}`);
  assert((await station.getAttribute('aria-invalid')) === 'true', 'the field is not marked as wrong');
  assert((await ask('/v1/jobs')).items.length === 0, 'there is a job');
  await page.screenshot({ path: `${SHOTS}stops-wrong.png` });
  return words;
});
let toBoth;
await check('A delivery to two stations is submitted as one text, and its panel lists both', async () => {
  await station.fill(`${first} > ${second}`);
  await form.getByRole('button', { name: 'Submit job' }).click();
  toBoth = await form.getByRole('link').textContent({ timeout: PATIENCE });
  assert(
    (await jobOf(toBoth)).stops.map((s) => s.station).join() === `${first},${second}`,
    JSON.stringify(await jobOf(toBoth)),
  );
  await open(toBoth);
  const shown = await stops();
  assert(shown.join() === `${first}, to come,${second}, to come`, shown.join());
  return `${toBoth}: ${shown.join('; ')}`;
});
await check('The panel says which station was served, and when', async () => {
  await until(`${toBoth} at ${first}`, async () => {
    const j = await jobOf(toBoth);
    return j.state === 'picking' && j.station === first;
  });
  await post(`/v1/stations/${first}/done`);
  await until(`${first} served`, async () => (await stops())[0].startsWith(`${first}, served`), 20);
  const shown = await stops();
  assert(
    new RegExp(`^${first}, served at .*\\d\\d:\\d\\d`).test(shown[0]) && shown[1] === `${second}, to come`,
    shown.join(),
  );
  await until(`${toBoth} at ${second}`, async () => {
    const j = await jobOf(toBoth);
    return j.state === 'picking' && j.station === second;
  });
  await panel.getByText(`${second}, being served`, { exact: true }).waitFor({ timeout: PATIENCE });
  return (await stops()).join('; ');
});
await check('axe finds nothing wrong with the stations of a job, in both themes', () => looks('stops'));

// The robot of the first job is at one station, the other one that carries shelves at the other: the third job waits.
let waits;
const chosen = (await jobOf(toBoth)).robot;
const other = await post('/v1/jobs', { kind: 'deliver', rack: shelves[1], station: first });
await check(
  'A waiting job cannot be given to a robot that cannot carry its rack, which is said beside the choice',
  async () => {
    await until(`${other.id} at ${first}`, async () => (await jobOf(other.id)).state === 'picking');
    waits = (await post('/v1/jobs', { kind: 'deliver', rack: shelves[2], station: first })).id;
    await open(waits);
    assert((await jobOf(waits)).state === 'waiting', 'it does not wait');
    const wrong = robots.find((r) => r.kind === 'shuttle').id;
    await choice.selectOption(wrong);
    await give.click();
    const error = panel.getByRole('alert');
    await error.waitFor({ timeout: PATIENCE });
    const words = await error.innerText();
    assert(words.split(/\s+/).length >= 3 && !/[{}[\]:]/.test(words), `these are no words: ${words}`);
    assert((await choice.getAttribute('aria-invalid')) === 'true', 'the choice is not marked as wrong');
    assert(
      (await choice.getAttribute('aria-describedby')) === (await error.getAttribute('id')),
      'the choice does not name what is wrong with it',
    );
    assert((await jobOf(waits)).only === null, 'it was given all the same');
    return words;
  },
);
await check('axe finds nothing wrong with a choice that was refused, in both themes', () => looks('reassign-refused'));
await check('A waiting job is given to another robot, which panel and server name', async () => {
  assert((await choice.locator('option').first().innerText()) === 'any robot', 'it says that a robot has it');
  await choice.selectOption(chosen);
  assert((await panel.getByRole('alert').count()) === 0, 'the old refusal stays beside a new choice');
  await give.click();
  await panel.getByText(`chosen: ${chosen}`).waitFor({ timeout: PATIENCE });
  const job = await jobOf(waits);
  assert(job.only === chosen && job.robot === null && job.state === 'waiting', JSON.stringify(job));
  await panel
    .getByText(new RegExp(`waits for ${chosen}|${chosen} .*${toBoth}`))
    .first()
    .waitFor({ timeout: PATIENCE });
  return `${waits}: ${(await panel.getByRole('region', { name: 'Why it waits' }).innerText()).replaceAll(/\s+/g, ' ')}`;
});
await check('axe finds nothing wrong with a choice that was made, in both themes', () => looks('reassign'));
await check('It waits for that robot although another one is free before, and then that robot has it', async () => {
  const free = (await jobOf(other.id)).robot;
  assert(kindOf(free) === kindOf(chosen) && free !== chosen, `${free} and ${chosen}`);
  await post(`/v1/stations/${first}/done`);
  await until(`${other.id} done`, async () => (await jobOf(other.id)).state === 'done');
  await until(`${free} without a job`, async () => (await ask(`/v1/robots/${free}`)).job === null, 60);
  assert(
    (await jobOf(waits)).only === chosen && (await jobOf(waits)).robot === null,
    JSON.stringify(await jobOf(waits)),
  );
  await post(`/v1/stations/${second}/done`);
  await until(`${toBoth} done`, async () => (await jobOf(toBoth)).state === 'done');
  await until(`${waits} with a robot`, async () => (await jobOf(waits)).robot !== null);
  assert((await jobOf(waits)).robot === chosen, JSON.stringify(await jobOf(waits)));
  await panel.getByRole('definition').getByRole('button', { name: chosen, exact: true }).waitFor({ timeout: PATIENCE });
  assert(
    (await choice.locator('option').allInnerTexts()).every((name) => name !== chosen),
    'it can be given to the robot that has it',
  );
  assert((await choice.inputValue()) === '', `the choice is still ${await choice.inputValue()}`);
  await page.screenshot({ path: `${SHOTS}reassign-taken.png` });
  return `${chosen}, not ${free}`;
});
await check('The stations of a job that is done were all served', async () => {
  await panel.getByRole('button', { name: 'Close', exact: true }).click();
  await open(toBoth);
  await panel.getByText('done', { exact: true }).waitFor({ timeout: PATIENCE });
  const shown = await stops();
  assert(shown.length === 2 && shown.every((line) => /, served at .*\d\d:\d\d/.test(line)), shown.join());
  assert((await choice.count()) === 0, 'a job that is over can be given away');
  return shown.join('; ');
});
await check('Nothing was complained about', async () => {
  assert(complaints.length === 0, complaints.join('; '));
});
await stop();
await finish(browser);
