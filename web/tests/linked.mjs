// Robots of other vendors in a real browser, over a real broker: one is not ready, drives, lies, is looked after and
// leaves when it is switched off; another is probed, listed on the page and needs consent. This test starts the broker,
// the robots and the server itself: node tests/linked.mjs PATH-TO-GIVEWAY
import { execFile, spawn } from 'node:child_process';
import { existsSync, mkdtempSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { connect, createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
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
import { serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/linked.mjs target/debug/giveway');
  process.exit(2);
}
const mosquitto = ['/usr/sbin/mosquitto', '/usr/bin/mosquitto', '/usr/local/sbin/mosquitto'].find((path) =>
  existsSync(path),
);
if (mosquitto === undefined) {
  console.error(
    'LEFT OUT: mosquitto is not installed, so no robot of others was shown in a browser. Type: ' +
      'apt-get install --no-install-recommends mosquitto',
  );
  process.exit(0);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-linked-`);
const MAP = HERE('../../maps/thesis.json');
const write = (name, value) => {
  writeFileSync(`${scratch}/${name}`, JSON.stringify(value));
  return `${scratch}/${name}`;
};

/** A port that nobody listens on now. */
const port = await new Promise((done) => {
  const socket = createServer().listen(0, '127.0.0.1', () => {
    const { port } = socket.address();
    socket.close(() => done(port));
  });
});
/** Starts a process that ends with this one. */
function begin(command, args) {
  const process_ = spawn(command, args, { stdio: ['ignore', 'pipe', 'inherit'] });
  process.once('exit', () => process_.kill('SIGKILL'));
  return process_;
}
writeFileSync(`${scratch}/mosquitto.conf`, `listener ${port} 127.0.0.1\nallow_anonymous true\nlog_type none\n`);
const broker = begin(mosquitto, ['-c', `${scratch}/mosquitto.conf`]);
const answers = () =>
  new Promise((done) => {
    const socket = connect(port, '127.0.0.1', () => done(true) || socket.destroy());
    socket.on('error', () => done(false));
  });
await until('a broker', answers, 20);

const mqtt = `mqtt://127.0.0.1:${port}`;
const listed = write('robots.json', {
  giveway_robots: 1,
  map_id: 'thesis',
  kinds: { tug: { fleet: { speed_mps: 1.5, lift_s: 3, accel_loaded_mps2: 0.8, accel_unloaded_mps2: 0.8 }, link: {} } },
  robots: [{ name: 'liar', manufacturer: 'giveway', serial: 'liar', kind: 'tug', version: '2.1.0' }],
});
const scenario = write('floor.json', { giveway_scenario: 1, name: 'others', map: MAP, robots: 0, jobs: 'none' });
const { url, stop } = await serve(program, scenario, scratch, 0, ['--mqtt', mqtt, '--robots', listed]);
/** Switches the robots on. One does not know where it is until it is told, and ends its orders without their picks; the
 *  other does not pause. */
function switchOn() {
  const places = [
    { serial: 'liar', node: 'G0-3' },
    { serial: 'stubborn', node: 'G3-7' },
  ];
  const faults = [
    { fault: 'not_localized', at_s: 0, for_s: 900, robots: ['liar'] },
    { fault: 'quirk', quirk: 'order_actions', value: 'skipped_in_silence', robots: ['liar'] },
    { fault: 'quirk', quirk: 'pause', value: 'fails_and_drives_on', robots: ['stubborn'] },
  ];
  const files = [
    ['--places', write('places.json', { robots: places })],
    ['--faults', write('faults.json', { giveway_faults: 1, faults })],
  ];
  const robots = begin(program, ['robot', '--mqtt', mqtt, '--map', MAP, ...files.flat()]);
  robots.stdout.resume();
  return robots;
}

const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 1000 }, colorScheme: 'light' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints, isRefusal);
const ask = async (path) => (await context.request.get(new URL(path, url).href)).json();
const card = page.getByRole('region', { name: 'Robot', exact: true });
const tab = page.getByRole('region', { name: 'Robots', exact: true });
const waiting = tab.getByRole('region', { name: 'Not on the floor yet' });
const shot = (name) => page.screenshot({ path: `${SHOTS}${name}.png` });

/** Opens the card of a robot that has joined, which the page may not know yet. */
const choose = (id) =>
  until(
    `the card of ${id}`,
    async () => {
      await page.getByLabel('Find on the floor').fill(id);
      await page.keyboard.press('Enter');
      return (await card.count()) > 0 && (await card.innerText()).startsWith(id);
    },
    60,
  );

await page.goto(`${url}/#tab/robots`);
let robots = null;
await check(
  'A robot that is listed and was never heard of stands in the list of those that have not joined',
  async () => {
    const line = waiting.locator('[data-waiting="liar"]');
    await line.getByText('Not ready: it was never heard of').waitFor({ timeout: PATIENCE });
    robots = switchOn();
  },
);
await check('One that is heard of says why it is not ready, and its card is there before it joins', async () => {
  const line = waiting.locator('[data-waiting="liar"]');
  await line.getByText('Not ready: it does not know where it is').waitFor({ timeout: PATIENCE });
  await line.getByRole('button', { name: 'Details' }).click();
  await line.getByText('Operating mode').waitFor({ timeout: PATIENCE });
  await shot('linked-waiting-light');
  await assertAccessible(page, 'robots that have not joined');
});
await check('It is told where it stands by a drag on the map, and says what became of that', async () => {
  // A place that is chosen by the address is in the middle of the picture.
  await page.goto(`${url}/#place/G0-3&tab/robots`);
  await page.getByRole('region', { name: 'Place', exact: true }).waitFor({ timeout: PATIENCE });
  await waiting.getByRole('button', { name: 'Tell it where it stands' }).click();
  const box = await page.getByRole('application', { name: 'Drawing on the floor' }).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y, { steps: 4 });
  await shot('linked-place-light');
  await page.mouse.up();
  const fate = waiting.locator('[data-action="initPosition"]');
  await fate.waitFor({ timeout: PATIENCE });
  // It knows where it stands from then on, joins, and is no longer in this list.
  const ends = async () => {
    const status = fate.getAttribute('data-status', { timeout: 500 }).catch(() => null);
    return (await status) === 'FINISHED' || (await ask('/v1/robots/liar/link')).joined;
  };
  await until('an end of that', ends, 40);
  // A job that waits for it, so that it need not park first.
  const job = await context.request.post(new URL('/v1/jobs', url).href, {
    headers: { 'Idempotency-Key': 'one' },
    data: { kind: 'deliver', rack: 'K1', station: 'W' },
  });
  assert(job.status() === 201, `${job.status()} ${await job.text()}`);
});
await check('It drives by an order, which its card names', async () => {
  await until('a robot that has joined', async () => (await ask('/v1/robots/liar/link')).joined);
  await choose('liar');
  const its = card.locator('[data-linked="liar"]');
  // On a busy machine its order may be over by now: then it is said how.
  const order = its.getByText('released to visit').or(its.locator('[data-false-claim="true"]'));
  await order.first().waitFor({ timeout: 2 * PATIENCE });
  return (await ask('/v1/robots/liar/link')).order;
});
await check(
  'A robot is probed before anybody lists it: it does not pause, and keeps standing where it is',
  async () => {
    const asked = ['robot', 'probe', '--mqtt', mqtt, '--robot', 'giveway/stubborn', '--json'];
    const { stdout } = await promisify(execFile)(program, asked);
    const found = JSON.parse(stdout);
    assert(found.pause === 'none' && found.version === '2.1.0', stdout);
    return `pause ${found.pause}, repeat ${found.repeat}, factsheet ${found.factsheet}`;
  },
);
await check('A robot that nobody listed is listed on the page, and needs consent since it does not pause', async () => {
  const line = tab.locator('[data-unlisted="stubborn"]');
  await line.getByRole('button', { name: 'Add a robot' }).click();
  await line.getByLabel('Kind').selectOption('tug');
  await line.getByRole('form').getByRole('button', { name: 'Add a robot' }).click();
  await until('a need of consent', async () => (await ask('/v1/robots/stubborn/link')).needs_consent, 40);
  const isThere = (await ask('/v1/robots/stubborn/link')).joined;
  if (isThere) await choose('stubborn');
  else await waiting.locator('[data-waiting="stubborn"]').getByRole('button', { name: 'Details' }).click();
  const its = page.locator('[data-linked="stubborn"]');
  await its.getByText('Not ready: it does not pause when told to').waitFor({ timeout: PATIENCE });
  await its.getByRole('button', { name: 'Agree that it drives without pausing' }).click();
  await page.getByRole('dialog').getByRole('button', { name: 'Agree that it drives without pausing' }).click();
  await until('consent', async () => (await ask('/v1/robots/stubborn/link')).not_ready === null, 40);
  return isThere ? 'it had joined' : 'it had not joined';
});
await check('It ends its order without its pick: it is named, waits for a person, and is an alarm', async () => {
  await choose('liar');
  const its = card.locator('[data-linked="liar"]');
  await its
    .locator('[data-false-claim="true"]')
    .first()
    .waitFor({ timeout: 2 * PATIENCE });
  await its.locator('[data-failed]').waitFor({ timeout: PATIENCE });
  await shot('linked-lies-light');
  await assertAccessible(page, 'a robot that lies');
  const { items } = await ask('/v1/alarms');
  assert(
    items.some((one) => one.kind === 'robot_claims'),
    items.map((one) => one.kind).join(),
  );
  return its.locator('[data-failed]').innerText();
});
await check('What was said stands in its card, newest first, both ways', async () => {
  const its = card.locator('[data-linked="liar"]');
  await its.getByRole('button', { name: 'Messages', exact: true }).click();
  const order = its.locator('li[data-topic="order"][data-way="to"]').first();
  await order.locator('summary').click();
  await order.getByText('"orderId"').waitFor({ timeout: PATIENCE });
  await its.locator('li[data-topic="state"][data-way="from"]').first().waitFor({ timeout: PATIENCE });
  await order.scrollIntoViewIfNeeded();
  await shot('linked-messages-light');
});
await check('It was looked after, and is told to leave the floor', async () => {
  const its = card.locator('[data-linked="liar"]');
  await its.getByRole('button', { name: 'It was looked after' }).click();
  await until('a robot that works again', async () => (await ask('/v1/robots/liar/link')).failed === null, 40);
  await context.request.delete(new URL('/v1/jobs/j1', url).href);
  await card.getByRole('button', { name: 'Remove from the floor' }).click();
  await card.getByRole('button', { name: 'Keep on the floor' }).waitFor({ timeout: PATIENCE });
  const leaves = async () => {
    const { doing, why } = await ask('/v1/robots/liar');
    return doing === 'idle' && why?.code === 'leaves';
  };
  await until('a robot that may be switched off', leaves);
  await card.getByText('switch it off').first().waitFor({ timeout: PATIENCE });
});
await check('Switched off, it has left the floor, and the page has let go of it', async () => {
  robots.kill('SIGINT');
  await until('a robot that has left', async () => (await ask('/v1/robots/liar')).state === 'gone', 90);
  await tab.locator('tbody').getByText('liar').waitFor({ state: 'detached', timeout: PATIENCE });
  await shot('linked-left-light');
});
await check('Nothing went wrong in the console', () => assert(complaints.length === 0, complaints.join(' | ')));
robots?.kill('SIGINT');
await until('robots that are off', () => robots === null || robots.exitCode !== null, 20);
await stop();
broker.kill();
await finish(browser);
