// The map first: its height, the full screen, the wall view, finding, the floor from afar and tablets, in a real
// browser against a real server that this test starts itself: node tests/map.mjs PATH-TO-GIVEWAY
import { PATIENCE, assert, check, isRefusal, listen, until } from './chromium.mjs';
import { openFloor, SHOTS } from './floorpage.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/map.mjs target/debug/giveway');
  process.exit(2);
}
const {
  url,
  browser,
  complaints,
  context,
  page,
  ask,
  robots,
  post,
  host,
  find,
  found,
  separator,
  closures,
  card,
  button,
  tab,
  hash,
  drawn,
  shown,
  open,
  both,
  map,
  end,
} = await openFloor(program, 'map');

await check('The map keeps its size whatever is shown below it', async () => {
  const sizes = [];
  for (const name of ['Jobs', 'Robots', 'Timelines', 'Charts', 'Encounters', 'Audit']) {
    await tab(name).click();
    await page.waitForTimeout(400);
    const { width, height } = await host.boundingBox();
    sizes.push(`${width} × ${height}`);
  }
  assert(new Set(sizes).size === 1, sizes.join(', '));
  await tab('Jobs').click();
  return sizes[0];
});
await check(
  'The splitter shares the height by keys and by pointer, is put back by a double click, and is remembered',
  async () => {
    const share = async () => Number(await separator.getAttribute('aria-valuenow'));
    const height = async () => (await host.boundingBox()).height;
    const [usual, before] = [await share(), await height()];
    await separator.focus();
    await page.keyboard.press('ArrowDown');
    assert((await share()) === usual + 2 && (await height()) > before, 'an arrow does not move it');
    for (const [key, end] of [
      ['Home', 'min'],
      ['End', 'max'],
    ]) {
      await page.keyboard.press(key);
      assert(
        (await share()) === Number(await separator.getAttribute(`aria-value${end}`)),
        `${key} leads to ${await share()}`,
      );
    }
    const box = await separator.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2 - 150, { steps: 5 });
    await page.mouse.up();
    const [dragged, to] = [await share(), await separator.boundingBox()];
    assert(Math.abs(to.y - (box.y - 150)) < 12, `it was dragged by ${box.y - to.y} px instead of 150`);
    await page.reload();
    await drawn();
    assert((await share()) === dragged, `${dragged} became ${await share()} with a reload`);
    await separator.dblclick();
    assert((await share()) === usual, `a double click leads to ${await share()}`);
    return `${before} px at ${usual} %, ${dragged} % after the drag`;
  },
);
await check('The map fills the screen by a button and by a key, and Escape leaves', async () => {
  const full = async () => (await host.boundingBox()).height > 840;
  await button('Full screen').click();
  await until('a map that fills the screen', full, 10);
  assert((await page.getByRole('banner').count()) === 0 && !(await tab('Jobs').isVisible()), 'something else is there');
  await page.waitForTimeout(300);
  await both('map-full');
  await page.keyboard.press('Escape');
  await until('a map of its usual size', async () => !(await full()), 10);
  await host.focus();
  await page.keyboard.press('f');
  await until('a map that fills the screen', full, 10);
  await page.keyboard.press('f');
  await until('a map of its usual size', async () => !(await full()), 10);
});
await check(
  'The view for a wall needs no hand: an address, large figures, alarms in words; Escape leaves',
  async () => {
    await open('#wall');
    const wall = page.getByRole('region', { name: 'Figures for the wall' });
    await wall.getByText('No alarms.').or(wall.locator('li b')).first().waitFor({ timeout: PATIENCE });
    await post('/v1/fleet/stop');
    await wall.getByText(/stopped by hand/).waitFor({ timeout: PATIENCE });
    const jobs = await wall.locator('[data-figure="waiting"]').innerText();
    assert(/^[\d,]+$/.test(jobs) && /^[\d,]+$/.test(await wall.locator('[data-figure="delivered"]').innerText()), jobs);
    const px = await wall
      .locator('[data-figure="delivered"]')
      .evaluate((dd) => parseFloat(getComputedStyle(dd).fontSize));
    assert(px >= 40, `the figures are ${px} px high`);
    assert(!(await tab('Jobs').isVisible()) && (await find.count()) === 0, 'there are tabs or a field');
    await page.waitForTimeout(600);
    await both('map-wall');
    await page.keyboard.press('Escape');
    await tab('Jobs').waitFor({ timeout: PATIENCE });
    assert((await hash()) === '', await hash());
    await post('/v1/fleet/resume');
    await button('Wall view').click();
    await wall.waitFor({ timeout: PATIENCE });
    assert((await hash()) === '#wall', await hash());
    await page.goBack();
    await tab('Jobs').waitFor({ timeout: PATIENCE });
    return `figures of ${px} px`;
  },
);
await check('The legend is folded at first, and neither folded nor open it covers the floor', async () => {
  await button('Show the whole floor').click();
  const legend = page.locator('details.legend');
  assert(!(await legend.evaluate((one) => one.open)), 'it is open at first');
  for (const state of ['folded', 'open']) {
    if (state === 'open') await legend.locator('summary').click();
    await page.waitForTimeout(700);
    const [x, y, scale] = (await shown('view')).split(' ').map(Number);
    const below = (await shown('turned')) === 'true' ? map.bounds[2] - x : y - map.bounds[1];
    const box = await host.boundingBox();
    // With half a station at the edge.
    const foot = box.y + (below + 0.62) * scale + box.height / 2;
    const top = (await legend.boundingBox()).y;
    assert(foot <= top, `${state}: the floor ends at ${foot.toFixed()} px, the legend begins at ${top.toFixed()}`);
  }
  await page.screenshot({ path: `${SHOTS}map-legend.png` });
  await legend.locator('summary').click();
});
await check(
  'Finding goes by parts and without case, shows kinds, by keys alone, and says if there is nothing',
  async () => {
    const id = (await robots())[4].id;
    await find.fill(id.toUpperCase());
    await found.first().waitFor({ timeout: PATIENCE });
    assert((await found.first().innerText()).startsWith(id), await found.first().innerText());
    const number = /\d+$/.exec(id)[0];
    await find.fill(number);
    const kinds = () => found.evaluateAll((all) => [...new Set(all.map((one) => one.dataset.kind))]);
    await until('several kinds', async () => (await kinds()).length > 1, 10);
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    const second = found.nth(1);
    assert(
      (await second.getAttribute('aria-selected')) === 'true' &&
        (await find.getAttribute('aria-activedescendant')) === 'found-1',
      'the second one is not active',
    );
    await both('map-find');
    const name = await second.locator('b').innerText();
    await page.keyboard.press('Enter');
    await page.locator('.card h2').filter({ hasText: name }).waitFor({ timeout: PATIENCE });
    await find.fill('no such thing');
    await page
      .getByRole('status')
      .filter({ hasText: 'Nothing is called “no such thing”.' })
      .waitFor({ timeout: PATIENCE });
    await page.keyboard.press('Escape');
    assert((await find.inputValue()) === '', 'Escape leaves the text');
    return `${number}: ${name}`;
  },
);
await check(
  'Jobs are found by id and by reference, people by name, racks, stations, places and closed areas',
  async () => {
    const { id } = await post('/v1/jobs', {
      kind: 'deliver',
      rack: map.racks[40].id,
      station: map.stations[0].id,
      reference: 'Order 4711',
    });
    for (const text of [id, 'Order 4711']) {
      await find.fill(text);
      await page.keyboard.press('Enter');
      const job = page.getByRole('region', { name: 'Job', exact: true });
      await job.getByRole('heading', { name: `Job ${id}`, exact: true }).waitFor({ timeout: PATIENCE });
      assert((await hash()).includes(`job/${id}`), await hash());
      await job.getByRole('button', { name: 'Close' }).click();
    }
    await context.request.delete(new URL(`/v1/jobs/${id}`, url).href);
    // It covers a place: one that covers nothing is refused.
    const area = await post('/v1/closures', {
      outline: [
        [0, 0],
        [0.3, 0],
        [0.3, 0.3],
      ],
      reason: 'Paint is drying',
    });
    await until('the area', async () => (await closures.getByText('Paint is drying').count()) > 0, 20);
    const charger = map.nodes.find((n) => n.kind === 'charger').id;
    const expected = [
      [map.racks[3].id, 'Rack'],
      [map.stations[1].id, 'Station'],
      [charger, 'Charger'],
      ['drying paint', 'Closed area'],
      [map.nodes.find((n) => n.kind === 'aisle').id, 'Aisle'],
    ];
    const worker = (await ask('/v1/workers')).items[0];
    if (worker) expected.push([worker.name, 'Person']);
    for (const [text, word] of expected) {
      await find.fill(text);
      await found.filter({ hasText: word }).first().waitFor({ timeout: PATIENCE });
    }
    await page.keyboard.press('Escape');
    await context.request.delete(new URL(`/v1/closures/${area.id}`, url).href);
    return expected.map(([text, word]) => `${text}: ${word}`).join(', ');
  },
);
await check('A robot that was found shows its name', async () => {
  await find.fill((await robots())[2].id);
  await page.keyboard.press('Enter');
  await page.waitForTimeout(600);
  const scale = Number((await shown('view')).split(' ')[2]);
  await card.getByRole('button', { name: 'Close' }).click();
  await page.waitForTimeout(600);
  assert(scale >= 28 && Number(await shown('names')) > 0, `at ${scale} px/m there are ${await shown('names')} names`);
  await button('Show the whole floor').click();
  return `${scale} px/m`;
});
await check('From afar there are no routes but that of the chosen robot, with either painter', async () => {
  for (const painter of ['webgl', 'canvas2d']) {
    const small = await (await browser.newContext({ viewport: { width: 390, height: 844 } })).newPage();
    listen(small, complaints, isRefusal);
    await small.goto(`${url}/?painter=${painter}`);
    await drawn(small);
    await until('routes', async () => Number(await shown('routes', small)) > 0, 60);
    await small.getByRole('application', { name: 'Map of the floor' }).focus();
    for (let i = 0; i < 4; i++) await small.keyboard.press('-');
    await until('no routes', async () => Number(await shown('routes', small)) === 0, 10);
    await small.screenshot({ path: `${SHOTS}map-far-${painter}.png` });
    await until(
      'the route of one robot',
      async () => {
        const driving = (await robots()).find((r) => r.activity === 'driving');
        if (!driving) return false;
        await small.evaluate((id) => {
          location.hash = `#robot/${id}`;
        }, driving.id);
        for (let i = 0; i < 8; i++) await small.getByRole('button', { name: 'Zoom out' }).click();
        await small.waitForTimeout(400);
        return Number((await shown('view', small)).split(' ')[2]) < 10 && Number(await shown('routes', small)) > 0;
      },
      30,
    );
    await small.close();
  }
});
for (const [width, height, hand] of [
  [820, 1180, true],
  [1180, 820, true],
  [390, 844, true],
]) {
  await check(
    `At ${width} × ${height} map and list are both usable by finger, and nothing scrolls sideways`,
    async () => {
      const other = await browser.newContext({ viewport: { width, height }, hasTouch: hand });
      const tablet = await other.newPage();
      listen(tablet, complaints, isRefusal);
      await tablet.goto(url);
      await drawn(tablet);
      const told = [];
      for (const name of ['Jobs', 'Robots', 'Timelines', 'Charts', 'Encounters']) {
        await tablet
          .getByRole('group', { name: 'What is shown below the floor' })
          .getByRole('button', { name, exact: true })
          .click();
        await tablet.waitForTimeout(600);
        const over = await tablet.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert(over <= 0, `${name}: it is ${over} px too wide`);
        const small = await tablet.evaluate(() =>
          [...document.querySelectorAll('#app :is(button, input, select, summary)')].flatMap((one) => {
            const target = one.matches('[type="checkbox"], [type="radio"]') ? (one.closest('label') ?? one) : one;
            const { width: w, height: h } = target.getBoundingClientRect();
            // What is out of sight is no target; links in a line of text are as high as that.
            if (
              !one.checkVisibility({ visibilityProperty: true }) ||
              one.closest('.hidden') ||
              w < 2 ||
              one.matches('[type="range"]')
            )
              return [];
            return h < 39.5 || (w < 39.5 && !one.matches('.link'))
              ? [`${one.getAttribute('aria-label') ?? one.innerText} ${Math.round(w)} × ${Math.round(h)}`]
              : [];
          }),
        );
        assert(small.length === 0, `${name}: too small: ${small.slice(0, 6).join('; ')}`);
      }
      const box = await tablet.getByRole('application', { name: 'Map of the floor' }).boundingBox();
      assert(
        box.height >= 280 && box.width >= 0.6 * Math.min(width, 1100) - 20,
        `the map is ${box.width} × ${box.height}`,
      );
      if (width > 640) {
        const list = await tablet.locator('.below').boundingBox();
        assert(list.height >= 180 && list.y + 180 <= height, `the list is ${list.height} high from ${list.y}`);
        told.push(`list ${Math.round(list.height)} px`);
      }
      await tablet.getByRole('button', { name: 'Jobs', exact: true }).click();
      await both(`map-${width}`, tablet);
      await other.close();
      return [`map ${Math.round(box.width)} × ${Math.round(box.height)}`, ...told].join(', ');
    },
  );
}
await end();
