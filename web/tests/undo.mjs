// Addresses of what is shown, refusals where they belong, and undo, in a real browser against a real server that this
// test starts itself: node tests/undo.mjs PATH-TO-GIVEWAY
import { PATIENCE, assert, check, until } from './chromium.mjs';
import { openFloor, SHOTS } from './floorpage.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/undo.mjs target/debug/giveway');
  process.exit(2);
}
const {
  url,
  context,
  page,
  ask,
  robots,
  post,
  host,
  find,
  messages,
  closures,
  card,
  button,
  tab,
  hash,
  drawn,
  open,
  both,
  map,
  end,
} = await openFloor(program, 'undo');

await check(
  'An address chooses a thing and a tab, Back and Forward go through them, and an unknown one says so',
  async () => {
    const [first, second] = (await robots()).map((r) => r.id);
    await open(`#robot/${first}&tab/robots`);
    await card.getByRole('heading', { name: first, exact: true }).waitFor({ timeout: PATIENCE });
    await page.getByRole('region', { name: 'Robots', exact: true }).waitFor({ timeout: PATIENCE });
    await find.fill(second);
    await page.keyboard.press('Enter');
    await card.getByRole('heading', { name: second, exact: true }).waitFor({ timeout: PATIENCE });
    assert((await hash()) === `#robot/${second}&tab/robots`, await hash());
    await tab('Jobs').click();
    assert((await hash()) === `#robot/${second}`, await hash());
    await page.goBack();
    await page.getByRole('region', { name: 'Robots', exact: true }).waitFor({ timeout: PATIENCE });
    await page.goBack();
    await card.getByRole('heading', { name: first, exact: true }).waitFor({ timeout: PATIENCE });
    await page.goForward();
    await card.getByRole('heading', { name: second, exact: true }).waitFor({ timeout: PATIENCE });
    for (const [address, label, title] of [
      ['#station/', 'Station', map.stations[0].id],
      ['#rack/', 'Rack', map.racks[1].id],
      ['#place/', 'Place', map.nodes.find((n) => n.kind === 'charger').id],
    ]) {
      await open(address + encodeURIComponent(title));
      await page
        .getByRole('region', { name: label, exact: true })
        .getByRole('heading', { name: title, exact: true })
        .waitFor({ timeout: PATIENCE });
    }
    await open('#robot/robot-999');
    await messages
      .getByRole('alert')
      .filter({ hasText: 'There is no robot robot-999 on this floor.' })
      .waitFor({ timeout: PATIENCE });
    await page.waitForTimeout(200);
    await both('map-unknown');
    await messages.getByRole('button', { name: 'Dismiss the message' }).click();
    await open('#nonsense');
    await messages.getByRole('alert').filter({ hasText: '“nonsense”' }).waitFor({ timeout: PATIENCE });
    await open('#job/j999999');
    await page.getByRole('region', { name: 'Job', exact: true }).getByRole('alert').waitFor({ timeout: PATIENCE });
    await open('');
  },
);
await check('An address of the past opens the past, and Back leads to the present', async () => {
  const id = (await robots())[0].id;
  await open(`#robot/${id}`);
  await until('some seconds of the past', async () => ((await ask('/v1/past')).spans[0]?.to_s ?? 0) > 8, 40);
  await page.evaluate(() => {
    location.hash = '#replay?from=2&to=6';
  });
  await page.getByRole('status').filter({ hasText: 'Replay: this is the past' }).waitFor({ timeout: PATIENCE });
  await page.goBack();
  await page
    .getByRole('status')
    .filter({ hasText: 'Replay: this is the past' })
    .waitFor({ state: 'detached', timeout: PATIENCE });
  await card.getByRole('heading', { name: id, exact: true }).waitFor({ timeout: PATIENCE });
  assert((await hash()) === `#robot/${id}`, await hash());
  await open('');
});
await check('What was done is undone by a button, by keys, and for a robot, a floor and an area alike', async () => {
  const undo = messages.getByRole('button', { name: 'Undo' });
  const id = (await robots())[1].id;
  const one = async () => (await robots()).find((r) => r.id === id);
  await open(`#robot/${id}`);
  await card.getByRole('button', { name: 'Pause this robot' }).click();
  await messages.getByText(`Paused a robot: ${id}`).waitFor({ timeout: PATIENCE });
  // With the focus the offer stays for as long as the pictures take.
  await undo.focus();
  await both('map-undo');
  await undo.click();
  await until('a robot that goes on', async () => (await one()).activity !== 'paused', 20);
  await card.getByRole('button', { name: 'Out of service' }).click();
  await messages.getByText(`Took a robot out of service: ${id}`).waitFor({ timeout: PATIENCE });
  await host.focus();
  await page.keyboard.press('Control+z');
  await until('a robot in service', async () => !(await one()).maintenance, 20);
  await card.getByRole('button', { name: 'Close' }).click();
  // To undo a stop asks first, as each start of all robots does; to undo a start does not.
  await button('Stop all robots').click();
  await messages.getByText('Stopped all robots').waitFor({ timeout: PATIENCE });
  await undo.click();
  await page.getByRole('dialog').getByRole('button', { name: 'Resume all robots' }).click();
  await messages.getByText('Resumed all robots').waitFor({ timeout: PATIENCE });
  await undo.focus();
  await page.keyboard.press('Enter');
  await until('a stopped floor', async () => (await ask('/v1/fleet')).stopped !== null, 20);
  await post('/v1/fleet/resume');
  await until(
    'a floor without alarm',
    async () => (await page.getByText('All robots are stopped by hand', { exact: true }).count()) === 0,
    20,
  );
  const area = {
    outline: [
      [0, 0],
      [0.3, 0],
      [0.3, 0.3],
    ],
    reason: 'Paint',
  };
  // The list may show the area that was just opened for a moment longer, so each button is named by its area.
  const openAgain = (id) =>
    closures.getByRole('button', { name: `Open ${id} again`, exact: true }).click({ timeout: PATIENCE });
  const closed = async () => (await ask('/v1/closures')).items.filter((c) => c.state === 'closed');
  const first = (await post('/v1/closures', area)).id;
  await openAgain(first);
  await messages.getByText(`Opened an area: ${first}`, { exact: true }).waitFor({ timeout: PATIENCE });
  await undo.click();
  await until('the area again', async () => (await closed()).some((c) => c.reason === 'Paint' && c.id !== first), 20);
  await openAgain((await closed()).find((c) => c.reason === 'Paint').id);
  await until('no area', async () => (await closed()).length === 0, 20);
  await messages.getByRole('button', { name: 'Dismiss the message' }).click();
});
await check('The offer to undo ends after ten seconds, but not while it has the focus', async () => {
  const id = (await robots())[3].id;
  await open(`#robot/${id}`);
  await card.getByRole('button', { name: 'Pause this robot' }).click();
  await messages.getByRole('button', { name: 'Undo' }).focus();
  await page.waitForTimeout(11_000);
  assert(await messages.getByRole('button', { name: 'Undo' }).isVisible(), 'it went although it had the focus');
  await host.focus();
  await messages.getByRole('button', { name: 'Undo' }).waitFor({ state: 'detached', timeout: 15_000 });
  await card.getByRole('button', { name: 'Resume this robot' }).click();
  await card.getByRole('button', { name: 'Pause this robot' }).waitFor({ timeout: PATIENCE });
});
await check('What is refused is said beside what asked for it', async () => {
  await page.reload();
  await drawn();
  const id = (await robots())[0].id;
  // A job that waits for another one can be cancelled for as long as this takes.
  const first = await post('/v1/jobs', {
    kind: 'deliver',
    rack: map.racks[0].id,
    station: map.stations[0].id,
    pick_s: 3600,
  });
  const second = await post('/v1/jobs', {
    kind: 'deliver',
    rack: map.racks[1].id,
    station: map.stations[0].id,
    after: [first.id],
  });
  const area = await post('/v1/closures', {
    outline: [
      [0, 0],
      [0.3, 0],
      [0.3, 0.3],
    ],
    reason: 'Paint',
  });
  // Each refusal has a number, so that an earlier one is not taken for it.
  let asked = 0;
  await page.route('**/v1/**', (route) => {
    if (route.request().method() === 'GET') return route.continue();
    asked += 1;
    const detail = `The test refuses this, number ${asked}.`;
    return route.fulfill({
      status: 409,
      contentType: 'application/problem+json',
      body: JSON.stringify({ title: 'No', status: 409, detail }),
    });
  });
  const refused = async (where, act) => {
    const before = asked;
    await act();
    await until('a request', () => asked > before, 20);
    await where
      .getByRole('alert')
      .filter({ hasText: `number ${asked}.` })
      .waitFor({ timeout: PATIENCE });
  };
  const told = [];
  await find.fill(id);
  await page.keyboard.press('Enter');
  for (const name of [
    /^(Pause|Resume) this robot$/,
    /^(Remove from|Keep on) the floor$/,
    /^(Out of|Back in) service$/,
  ]) {
    await refused(card, () => card.getByRole('button', { name }).click());
  }
  await card.getByRole('button', { name: 'Close' }).click();
  told.push('robot');
  await find.fill(map.stations[0].id);
  await page.keyboard.press('Enter');
  const station = page.getByRole('region', { name: 'Station', exact: true });
  await refused(station, () => station.getByRole('button', { name: 'Pause the station' }).click());
  await station.getByRole('button', { name: 'Close' }).click();
  told.push('station');
  const table = page.getByRole('region', { name: 'Table of jobs' });
  await table.getByRole('button', { name: `Cancel ${second.id}` }).click({ timeout: PATIENCE });
  const dialog = page.getByRole('dialog');
  await refused(dialog, () => dialog.getByRole('button', { name: 'Cancel the job' }).click());
  await page.screenshot({ path: `${SHOTS}map-refused.png` });
  await dialog.getByRole('button', { name: 'Keep it' }).click();
  await table.getByRole('button', { name: second.id, exact: true }).click();
  const job = page.getByRole('region', { name: 'Job', exact: true });
  await refused(job, () => job.getByLabel('Priority, 0 to 9').selectOption('9'));
  await job.getByRole('button', { name: 'Close' }).click();
  told.push('cancelled job', 'priority');
  const form = page.getByRole('form', { name: 'New job' });
  await form.getByLabel('Rack', { exact: true }).fill(map.racks[2].id);
  await form.getByLabel('Station', { exact: true }).fill(map.stations[0].id);
  await refused(form, () => form.getByRole('button', { name: 'Submit job' }).click());
  told.push('new job');
  await button('Many jobs from a table').click();
  await dialog
    .getByLabel('Or paste it here')
    .fill(`kind,rack,station\ndeliver,${map.racks[2].id},${map.stations[0].id}\n`);
  await refused(dialog, () => dialog.getByRole('button', { name: 'Submit 1 job' }).click());
  await dialog.getByRole('button', { name: 'Close' }).click();
  told.push('many jobs');
  await closures.getByRole('button', { name: 'Close a polygon' }).focus();
  await page.keyboard.press('Enter');
  await page.getByRole('application', { name: 'Drawing on the floor' }).waitFor({ timeout: PATIENCE });
  for (const key of ['Enter', 'ArrowRight', 'ArrowRight', 'Enter', 'ArrowUp', 'ArrowUp', 'Enter', 'Enter'])
    await page.keyboard.press(key);
  const closing = closures.getByRole('form', { name: 'Close an area' });
  await closing.getByLabel('Why').fill('cleaning');
  await refused(closing, () => closing.getByRole('button', { name: 'Close the area' }).click());
  await closing.getByRole('button', { name: 'Do not close it' }).click();
  const line = closures.getByRole('listitem').filter({ hasText: 'Paint' });
  await refused(line, () => line.getByRole('button', { name: `Open ${area.id} again` }).click());
  told.push('closed area', 'opened area');
  await tab('Robots').click();
  const panel = page.getByRole('region', { name: 'Robots', exact: true });
  await panel.getByRole('checkbox', { name: `Select ${id}`, exact: true }).check();
  await refused(panel, () =>
    panel
      .getByRole('button', { name: /^(Pause|Resume)$/ })
      .and(page.locator(':enabled'))
      .first()
      .click(),
  );
  told.push('several robots');
  await refused(page.locator('header'), () => button('Stop all robots').click());
  await button('Evacuate').click();
  await refused(page.locator('header'), () => dialog.getByRole('button', { name: 'Evacuate now' }).click());
  told.push('stop', 'evacuation');
  await page.unroute('**/v1/**');
  for (const one of [second, first]) await context.request.delete(new URL(`/v1/jobs/${one.id}`, url).href);
  await context.request.delete(new URL(`/v1/closures/${area.id}`, url).href);
  await page.reload();
  await drawn();
  return told.join(', ');
});
await end();
