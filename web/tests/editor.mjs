// The map editor in a real browser: a floor with two stations is drawn, checked, tried out, kept and read again.
// node tests/editor.mjs http://127.0.0.1:8080
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import { PATIENCE, assert, assertAccessible, check, finish, listen, openBrowser, until } from './chromium.mjs';

const url = process.argv[2];
if (!url) {
  console.error('Say where the server is: node tests/editor.mjs http://127.0.0.1:8080');
  process.exit(2);
}
const SHOTS = fileURLToPath(new URL('./shots/', import.meta.url));
await mkdir(SHOTS, { recursive: true });
const browser = await openBrowser();
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'light' });
const page = await context.newPage();
const complaints = [];
listen(page, complaints);

const sheet = page.getByRole('application');
const status = page.locator('section', { has: page.getByRole('heading', { name: 'Check' }) }).getByRole('status');
const tool = (name) => page.getByRole('navigation', { name: 'Tools' }).getByRole('button', { name });

/** Where a place of the floor is on the screen. */
async function pixel([x, y]) {
  const box = await sheet.boundingBox();
  const [left, top, wide] = (await sheet.getAttribute('viewBox')).split(' ').map(Number);
  const scale = box.width / wide;
  return [box.x + (x - left) * scale, box.y + (-y - top) * scale];
}

/** Waits until the server has said of the map that is drawn now, and of no earlier one, that it can be used. */
async function usable() {
  const now = status.and(page.locator('[aria-busy=false]'));
  await now.filter({ hasText: 'can be used' }).waitFor({ timeout: PATIENCE });
}

/** The name of the map that is drawn. */
const mapName = () => page.locator('aside').getByLabel('Name', { exact: true }).first().inputValue();

/** Draws with a tool from one place to another, metres; presses where there is one place only. */
async function draw(name, from, to = from) {
  await tool(name).click();
  await page.mouse.move(...(await pixel(from)));
  await page.mouse.down();
  await page.mouse.move(...(await pixel(to)), { steps: 3 });
  await page.mouse.up();
}

async function downloaded() {
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: 'Download' }).click(),
  ]);
  return { name: download.suggestedFilename(), map: JSON.parse(await readFile(await download.path(), 'utf8')) };
}

await check('The editor opens empty, and says what is missing', async () => {
  await page.goto(new URL('/editor', url).href);
  await status.filter({ hasText: 'error' }).waitFor({ timeout: PATIENCE });
  await page.getByRole('button', { name: /nodes: there are none/ }).waitFor();
});

await check('A floor with two stations is drawn with the mouse and has no errors', async () => {
  const aisles = [
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
  ];
  for (const [a, b] of aisles) await draw('Aisle', a, b);
  await draw('Racks', [1, 1], [5, 2]);
  await draw('Station', [2, -1]);
  await page.getByText(/, 1 station\.$/).waitFor({ timeout: PATIENCE });
  await draw('Station', [3, 4], [4, 4]);
  await page.getByText(/, 2 stations\.$/).waitFor({ timeout: PATIENCE });
  await draw('Charger', [-1, 0]);
  await draw('Charger', [7, 0]);
  await draw('Parking place', [7, 3]);
  await draw('Parking place', [-1, 3]);
  await page.getByLabel('Name', { exact: true }).fill('drawn floor');
  await page.keyboard.press('Enter');
  await usable();
  const { name, map } = await downloaded();
  assert(name === 'drawn-floor.json', name);
  assert(map.stations.length === 2 && map.racks.length === 10 && map.chargers.length === 2, JSON.stringify(map));
  return `${map.nodes.length} places, ${map.lanes.length} lanes`;
});

await check('A place that nothing joins is found and marked in place, and undoing takes it away', async () => {
  await draw('Charger', [9, 5]);
  const finding = page.getByRole('button', { name: /no lane touches them/ });
  await finding.waitFor({ timeout: PATIENCE });
  assert((await page.locator('path.mark.error').getAttribute('d')) !== '', 'no mark');
  await finding.click();
  assert((await page.locator('circle.mark.shown').count()) === 1, 'it is not shown');
  await page.screenshot({ path: `${SHOTS}editor-finding.png` });
  await page.getByRole('button', { name: 'Undo' }).click();
  await usable();
  await page.getByRole('button', { name: 'Fit' }).click();
});

await check('Trying it runs half an hour in seconds, with deliveries, and shows where robots waited', async () => {
  await page.getByLabel('Robots', { exact: true }).fill('4');
  await page.getByRole('button', { name: 'Try it' }).click();
  const deliveries = page.locator('[data-figure="deliveries"]');
  await deliveries.waitFor({ timeout: PATIENCE });
  assert(Number(await deliveries.textContent()) > 10, `${await deliveries.textContent()} deliveries`);
  const heat = await page.locator('circle.heat').count();
  assert(heat > 0, 'four robots never waited');
  await page.mouse.move(5, 5);
  await page.screenshot({ path: `${SHOTS}editor.png` });
  return `${await deliveries.textContent()} deliveries, ${heat} places`;
});

await check('A reload finds the floor as it was', async () => {
  const before = (await downloaded()).map;
  await page.reload();
  await usable();
  assert(JSON.stringify((await downloaded()).map) === JSON.stringify(before), 'another floor');
});

await check('A place is selected, renamed and moved; keys undo it', async () => {
  await draw('Select and move', [7, 3], [8, 3]);
  const name = page.locator('aside').getByLabel('Name', { exact: true }).nth(1);
  await name.fill('corner');
  await name.press('Enter');
  let { map } = await downloaded();
  assert(
    map.nodes.some((n) => n.id === 'corner' && n.x === 8),
    JSON.stringify(map.nodes.slice(-4)),
  );
  await sheet.focus();
  await page.keyboard.press('Control+z');
  await page.keyboard.press('Control+z');
  ({ map } = await downloaded());
  assert(!map.nodes.some((n) => n.id === 'corner') && map.nodes.some((n) => n.x === 7 && n.y === 3), 'not undone');
});

await check('The keyboard alone draws an aisle', async () => {
  const before = (await downloaded()).map.nodes.length;
  await sheet.focus();
  await page.keyboard.press('l');
  assert((await tool('Aisle').getAttribute('aria-pressed')) === 'true', 'the tool is another one');
  for (let i = 0; i < 2; i++) await page.keyboard.press('Shift+ArrowUp');
  await page.keyboard.press('Enter');
  for (let i = 0; i < 3; i++) await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Enter');
  const after = (await downloaded()).map.nodes.length;
  assert(after > before, `${before} places, then ${after}`);
  await page.getByRole('button', { name: 'Undo' }).click();
});

await check('A picture and a DXF drawing are drawn over', async () => {
  const input = page.getByLabel('Picture or DXF drawing');
  await input.setInputFiles({
    name: 'hall.svg',
    mimeType: 'image/svg+xml',
    buffer: Buffer.from(
      '<svg xmlns="http://www.w3.org/2000/svg" width="200" height="100">' +
        '<rect width="200" height="100" fill="#8cf"/></svg>',
    ),
  });
  await page.locator('image').waitFor({ timeout: PATIENCE });
  await page.getByLabel('Width, m').fill('12');
  await page.getByLabel('Width, m').press('Enter');
  assert((await page.locator('image').getAttribute('height')) === '6', 'its shape is another one');
  await input.setInputFiles({
    name: 'hall.dxf',
    mimeType: 'application/dxf',
    buffer: Buffer.from(
      [
        '0',
        'SECTION',
        '2',
        'ENTITIES',
        '0',
        'LINE',
        '10',
        '0',
        '20',
        '0',
        '11',
        '6000',
        '21',
        '0',
        '0',
        'ENDSEC',
        '0',
        'EOF',
      ].join('\n'),
    ),
  });
  await page.getByLabel('Metres a unit').fill('0.001');
  await page.getByLabel('Metres a unit').press('Enter');
  assert((await page.locator('.dxf polyline').count()) === 1, 'no line');
  await input.setInputFiles({ name: 'x.png', mimeType: 'image/png', buffer: Buffer.from('nothing') });
  await page.getByRole('alert').filter({ hasText: 'cannot show this file' }).waitFor();
  await page.getByRole('button', { name: 'Remove the picture' }).click();
  await page.getByRole('button', { name: 'Remove the drawing' }).click();
});

await check('What is different from the map of the server is listed', async () => {
  await page.getByRole('button', { name: 'Compare with the server’s map' }).click();
  await page.getByText(/^nodes: \d+ added, \d+ removed/).waitFor({ timeout: PATIENCE });
});

await check('The map of the server is opened, and a file; what is no map is refused', async () => {
  await page.getByRole('button', { name: 'Open the server’s map' }).click();
  await until('the map of the server', async () => (await mapName()) !== 'drawn floor');
  await usable();
  const { map } = await downloaded();
  assert(map.nodes.length > 10, map.name);
  const file = `${tmpdir()}/giveway-editor-${process.pid}.json`;
  await writeFile(file, JSON.stringify({ ...map, name: 'from a file' }));
  await page.getByLabel('Open a file').setInputFiles(file);
  await until('the map of the file', async () => (await mapName()) === 'from a file');
  assert((await downloaded()).map.nodes.length === map.nodes.length, 'another map');
  await page
    .getByLabel('Open a file')
    .setInputFiles({ name: 'x.json', mimeType: 'application/json', buffer: Buffer.from('{}') });
  await page.getByRole('alert').filter({ hasText: 'This is no map file' }).waitFor();
  await page.getByRole('button', { name: 'Close' }).click();
});

for (const colorScheme of ['light', 'dark']) {
  await check(`The editor is accessible (${colorScheme})`, async () => {
    await page.emulateMedia({ colorScheme });
    await page.getByRole('button', { name: 'Fit' }).click();
    await assertAccessible(page, `the editor, ${colorScheme}`);
    await page.screenshot({ path: `${SHOTS}editor-${colorScheme}.png` });
  });
}
await check('The page breaks no rule of the server and logs no error', async () => {
  assert(complaints.length === 0, complaints.join(' | '));
});
await finish(browser);
