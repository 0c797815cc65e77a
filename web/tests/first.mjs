// What a first visit to a hall with 800 robots costs: node tests/first.mjs PROGRAM
// Bytes of files, answers and the snapshot as they travel are counted until all robots are drawn, and asserted; times,
// and how many patches come meanwhile, depend on the machine and are printed.
import { mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, check, finish, openBrowser, until } from './chromium.mjs';
import { serve } from './serve.mjs';

const ROBOTS = 800;
/** Files and answers, in the median of five visits. */
const MOST_BYTES = 135_000;
/** Of the snapshot, for each robot: it grows with what robots are at, and how far the floor has got depends on the
 *  machine. */
const MOST_BYTES_EACH = 110;
const program = process.argv[2];
const scenario = fileURLToPath(new URL('../../scenarios/kiva-800.json', import.meta.url));
const server = await serve(program, scenario, mkdtempSync(`${tmpdir()}/giveway-first-`));
const browser = await openBrowser();
// What all are sent is compressed at its best beside the start, or when the first one asks; until then it goes as it
// is.
for (const path of ['/v1/map', '/openapi.json']) {
  await until(
    `the packed ${path}`,
    async () =>
      (await fetch(server.url + path, { headers: { 'Accept-Encoding': 'br' } })).headers.get('content-encoding') ===
      'br',
  );
}

/** Visits the floor with nothing in the cache, and counts until all robots are drawn. */
async function visit() {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  const page = await context.newPage();
  const cdp = await context.newCDPSession(page);
  const urls = new Map();
  const sizes = new Map();
  let live = 0;
  let snapshots = 0;
  const add = (url, bytes) => sizes.set(url, (sizes.get(url) ?? 0) + bytes);
  await cdp.send('Network.enable');
  cdp.on('Network.requestWillBeSent', ({ requestId, request }) => urls.set(requestId, new URL(request.url).pathname));
  cdp.on('Network.webSocketCreated', ({ requestId, url }) => urls.set(requestId, new URL(url).pathname));
  cdp.on('Network.loadingFinished', ({ requestId, encodedDataLength }) => add(urls.get(requestId), encodedDataLength));
  cdp.on('Network.webSocketFrameReceived', ({ requestId, response: { opcode, payloadData } }) => {
    // The patches that follow the snapshot come as long as the page is open.
    if (opcode === 2) {
      add(urls.get(requestId), Buffer.byteLength(payloadData, 'base64'));
      snapshots += 1;
    } else live += Buffer.byteLength(payloadData);
  });
  const began = performance.now();
  await page.goto(server.url);
  await page.waitForFunction((robots) => Number(document.querySelector('canvas')?.dataset.robots) >= robots, ROBOTS, {
    timeout: PATIENCE,
  });
  const took = performance.now() - began;
  await context.close();
  assert(snapshots === 1, `${snapshots} snapshots came packed`);
  return { took, sizes, live };
}

await check(
  `A first visit takes at most ${MOST_BYTES / 1000} kB, and ${MOST_BYTES_EACH} bytes for each of ${ROBOTS} robots`,
  async () => {
    const visits = [];
    for (let i = 0; i < 5; i++) visits.push(await visit());
    const totals = visits.map(({ sizes }) => [...sizes.values()].reduce((sum, bytes) => sum + bytes, 0));
    const { sizes } = visits[totals.indexOf(Math.max(...totals))];
    const largest = [...sizes].sort((a, b) => b[1] - a[1]).slice(0, 12);
    const told = largest.map(([url, bytes]) => `${url} ${(bytes / 1_000).toFixed(1)} kB`).join(', ');
    const snapshots = visits.map((visit) => visit.sizes.get('/v1/live'));
    // In a slow visit some of what the page fetches a little later is there before the robots are.
    const rest = totals.map((total, i) => total - snapshots[i]).sort((a, b) => a - b);
    assert(rest[2] <= MOST_BYTES, `${rest.join(', ')} bytes beside the snapshot: ${told}`);
    assert(Math.max(...snapshots) <= MOST_BYTES_EACH * ROBOTS, `${snapshots.join(', ')} bytes of snapshots`);
    const ms = visits.map(({ took }) => took).sort((a, b) => a - b);
    const kB = (bytes) => `${(Math.max(...bytes) / 1_000).toFixed(0)} kB`;
    return (
      `${kB(totals)}: ${told}; until all are drawn ${kB(visits.map((v) => v.live))} of patches at most, and ` +
      `${ms[2].toFixed(0)} ms, median of five, ${ms[0].toFixed(0)} to ${ms[4].toFixed(0)}`
    );
  },
);
await check(
  'Every text above a kilobyte is compressed for those who take it, and nothing is for those who do not',
  async () => {
    const encoding = async (path, accepts) =>
      (await fetch(server.url + path, { headers: { 'Accept-Encoding': accepts } })).headers.get('content-encoding');
    for (const path of ['/v1/map', '/v1/robots', '/openapi.json']) {
      const found = [await encoding(path, 'br'), await encoding(path, 'gzip'), await encoding(path, 'identity')];
      assert(String(found) === 'br,gzip,', `${path}: ${found}`);
    }
    const script = /src="(\/assets\/[^"]+\.js)"/.exec(await (await fetch(`${server.url}/`)).text())[1];
    assert((await encoding(script, 'br')) === 'br' && (await encoding(script, 'gzip;q=0, identity')) === null, script);
    assert((await encoding('/v1/health/live', 'br')) === null, 'a few bytes are compressed');
  },
);
await browser.close();
await server.stop();
finish();
