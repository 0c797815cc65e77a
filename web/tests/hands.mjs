// Hands of a scripted client at a picking station, in a real browser against a real server that this test starts itself:
// node tests/hands.mjs PATH_TO_GIVEWAY. They confirm lines without a click, a wrong slot is shown before the hand has a
// piece, and the page asks about a piece that nobody has seen in its tote. Each check prints a sentence.
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, assertAccessible, check, finish, listen, openBrowser, until } from './chromium.mjs';
import { serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/hands.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
const MAP = HERE('../../maps/stations.json');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-hands-`);
const scenario = { giveway_scenario: 1, name: 'hands', robots: 4, period_ms: 50, jobs: 'none', map: MAP };
writeFileSync(`${scratch}/hands.json`, JSON.stringify(scenario));
const { url, stop } = await serve(program, `${scratch}/hands.json`, scratch);
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: 'dark' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints);
const ask = async (path) => (await context.request.get(url + path)).json();
const post = async (path, data) => {
  const answer = await context.request.post(url + path, { data });
  assert(answer.ok(), `${path}: ${answer.status()} ${await answer.text()}`);
  return answer.json();
};

// The rack's face as the picker sees it: metres to the right of its middle, towards the picker, and above the floor.
const map = JSON.parse(readFileSync(MAP, 'utf8'));
const S1 = map.stations.find(({ id }) => id === 'S1');
const stands = map.nodes.find(({ id }) => id === S1.node);
const rack = map.racks.find(({ type }) => type);
const shelf = map.rack_types.find(({ id }) => id === rack.type);
const middle = [0, 1].map((i) => S1.cell.opening.outline.reduce((sum, p) => sum + p[i], 0) / S1.cell.opening.outline.length);
const length = Math.hypot(middle[0] - stands.x, middle[1] - stands.y);
const out = [(middle[0] - stands.x) / length, (middle[1] - stands.y) / length];
const right = [-out[1], out[0]];
const onMap = ([r, o, z]) => [stands.x + right[0] * r + out[0] * o, stands.y + right[1] * r + out[1] * o, z];
const slotAt = (name, deep) => {
  const [column, row] = [name.charCodeAt(0) - 65, Number(name.slice(1)) - 1];
  return [(column + 0.5) * shelf.width_m / shelf.columns - shelf.width_m / 2, shelf.face_m - deep, shelf.heights_m[row]];
};
const toteAt = (name) => {
  const [x, y, z] = S1.cell.totes.find(({ id }) => id === name).at;
  return [(x - stands.x) * right[0] + (y - stands.y) * right[1], (x - stands.x) * out[0] + (y - stands.y) * out[1], z];
};
const joint = ([r, o, z], back) => { const [x, y, h] = onMap([r, o + back, z]); return [x, h, -y, 0.01]; };
const poseOf = (at) => ({
  at: onMap([0, 1.1, 0]).slice(0, 2), heading: 0,
  hands: { l: null, r: Array.from({ length: 25 }, (_, i) => joint(at, i === 0 ? 0.17 : i === 4 || i === 9 ? 0 : 0.09)) },
});

// The client: a page of its own with the socket of a headset.
const worker = await post('/v1/workers', { name: 'picker' });
const headset = await context.newPage();
await headset.goto(`${url}/openapi.json`);
await headset.evaluate(({ id }) => new Promise((ready) => {
  const socket = new WebSocket(`${location.origin.replace('http', 'ws')}/v1/workers/${id}/feed`);
  globalThis.pose = { socket, seq: 0, cells: [] };
  socket.onopen = () => socket.send(JSON.stringify({ type: 'hello', versions: [1], frame: 'map' }));
  socket.onmessage = ({ data }) => {
    const message = JSON.parse(data);
    const t = performance.now();
    if (message.type === 'ping') socket.send(JSON.stringify({ type: 'pong', id: message.id, t1: t, t2: t }));
    if (message.type === 'cell') globalThis.pose.cells.push(message);
    if (message.type === 'clock') ready();
  };
}), { id: worker.id });
let hand = [0.2, 0.95, 0.95];
/** Moves the hand in so many seconds. All poses of one movement are sent from within the page, each at its time. */
const moves = async (to, seconds) => {
  const n = Math.round(seconds / 0.025);
  const smooth = (t) => t * t * (3 - 2 * t);
  const way = Array.from({ length: n }, (_, i) => hand.map((from, k) => from + (to[k] - from) * smooth((i + 1) / n)));
  hand = to;
  await headset.evaluate(async (poses) => {
    const { pose } = globalThis;
    for (const one of poses) {
      pose.seq += 1;
      pose.socket.send(JSON.stringify({ type: 'pose', epoch: 1, seq: pose.seq, t: performance.now(), ...one }));
      await new Promise((done) => { setTimeout(done, 25); });
    }
  }, way.map(poseOf));
};
const grasps = async (slot) => {
  await moves(slotAt(slot, -0.35), 0.6);
  await moves(slotAt(slot, 0.12), 0.5);
  await moves(slotAt(slot, 0.12), 0.5);
  await moves(slotAt(slot, -0.35), 0.5);
};
const puts = async (tote) => {
  await moves(toteAt(tote), 0.8);
  await moves(toteAt(tote), 0.3);
};
const station = page.locator('#station');
const shows = (attribute, value) => page.locator(`#station[data-${attribute}="${value}"]`).waitFor({ timeout: PATIENCE });

const [first, second] = S1.cell.totes.map(({ id }) => id);
const job = await post('/v1/jobs', {
  kind: 'deliver', rack: rack.id, station: 'S1', pick_s: 900,
  lines: [{ slot: 'C3', quantity: 1, tote: second }, { slot: 'A2', quantity: 1, tote: first }],
});
await page.goto(`${url}/station/S1`);
await shows('lit', 'C3');

await check('The server asks for hands where somebody stands in a workplace, and says what is lit', async () => {
  await moves([0.21, 0.95, 0.95], 0.6);
  await until('a message about the station', () => headset.evaluate(() => globalThis.pose.cells.at(-1)?.hands === true), 5);
  const cell = await headset.evaluate(() => globalThis.pose.cells.at(-1));
  assert(cell.station === 'S1' && cell.slot.id === 'C3' && cell.tote.id === second && cell.pieces === 1, JSON.stringify(cell));
});
await check('The page shows where the hand most likely goes, before it is there', async () => {
  const seen = page.locator('[data-reach="C3"]').first().waitFor({ state: 'attached', timeout: PATIENCE });
  await moves(slotAt('C3', -0.35), 0.6);
  await moves(slotAt('C3', -0.1), 0.4);
  await seen;
  await moves([0.2, 0.95, 0.95], 0.6);
});
await check('A hand that takes from the lit slot and puts into its tote confirms the line without a click', async () => {
  await grasps('C3');
  assert((await station.getAttribute('data-lit')) === 'C3', 'a grasp confirms nothing');
  await puts(second);
  await shows('lit', 'A2');
});
await check('A hand in a wrong slot turns the page to wrong before it has a piece', async () => {
  await moves(slotAt('B2', -0.35), 0.6);
  await moves(slotAt('B2', 0.07), 0.5);
  await shows('mistake', 'wrong_slot');
  const told = await headset.evaluate(() => globalThis.pose.cells.map(({ warning }) => warning?.slot));
  assert(told.includes('B2'), `the headset was told ${JSON.stringify(told)}`);
  await page.screenshot({ path: `${SHOTS}station-hand-wrong.png` });
  const { visit } = await ask('/v1/stations/S1');
  assert(visit.lines[1].done === 0, 'a wrong slot confirms nothing');
  await moves(slotAt('B2', -0.35), 0.4);
});
await check('The rack leaves at the last grasp, and the page asks about a piece that nobody sees in its tote', async () => {
  await grasps('A2');
  await page.getByText(`Is the last piece of A2 in tote ${first}?`).waitFor({ timeout: PATIENCE });
  assert((await ask(`/v1/jobs/${job.id}`)).state === 'done', 'the rack is not wanted any more');
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme });
    await page.waitForTimeout(300);
    await page.screenshot({ path: `${SHOTS}station-asks-${colorScheme}.png` });
    await assertAccessible(page, `asks, ${colorScheme}`);
  }
  await page.getByRole('button', { name: 'In the tote' }).click();
  await until('an answer', async () => (await ask('/v1/stations/S1')).unconfirmed === null, 20);
  const { lines } = await ask(`/v1/jobs/${job.id}`);
  assert(lines.every(({ state }) => state === 'done'), JSON.stringify(lines));
});
await check('Nothing was complained about', () => assert(complaints.length === 0, complaints.join(' | ')));
await stop();
await finish(browser);
