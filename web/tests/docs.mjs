// The page of the API's descriptions, against a running server: node tests/docs.mjs http://127.0.0.1:8080
import { assert, assertAccessible, check, finish, listen, openBrowser, PATIENCE } from './chromium.mjs';

const url = process.argv[2];
const browser = await openBrowser();
const page = await (await browser.newContext({ viewport: { width: 1280, height: 900 } })).newPage();
const complaints = [];
const foreign = [];
listen(page, complaints);
page.on('request', (request) => {
  if (new URL(request.url()).host !== new URL(url).host) foreign.push(request.url());
});
await page.goto(new URL('/docs', url).href);
await page.locator('#submitJob').waitFor({ timeout: PATIENCE });
const api = await (await page.request.get(new URL('/openapi.json', url).href)).json();
const operations = Object.values(api.paths).flatMap((item) => Object.values(item));

await check('Every operation, every schema and every WebSocket has its place on /docs', async () => {
  const ids = new Set(await page.locator('[id]').evaluateAll((all) => all.map((one) => one.id)));
  const wanted = [
    ...operations.map((o) => o.operationId),
    ...Object.keys(api.components.schemas).map((name) => `schema-${name}`),
  ];
  const missing = [...wanted, 'channel-live', 'channel-workerFeed'].filter((id) => !ids.has(id));
  assert(missing.length === 0, `${missing} are missing`);
  return `${operations.length} operations`;
});
await check('A link leads to what it names', async () => {
  const broken = await page
    .locator('a[href^="#"]')
    .evaluateAll((all) => all.map((a) => a.getAttribute('href').slice(1)).filter((id) => !document.getElementById(id)));
  assert(broken.length === 0, `${[...new Set(broken)]} lead nowhere`);
});
await check('A search leaves what has the words', async () => {
  await page.getByRole('searchbox').fill('patch webhook');
  assert((await page.locator('main .route:visible').count()) === 0, 'something is left');
  await page.getByRole('searchbox').fill('delete /v1/jobs');
  assert(
    (await page.locator('main .route:visible').evaluateAll((all) => all.map((one) => one.id))).join() === 'cancelJob',
    'it is not left alone',
  );
  await page.getByRole('searchbox').fill('');
});
await check('The page loads nothing from elsewhere, breaks no rule of the server and is accessible', async () => {
  assert(foreign.length === 0, `${foreign}`);
  assert(complaints.length === 0, `${complaints}`);
  await assertAccessible(page, 'the page of the API');
});
await finish(browser);
