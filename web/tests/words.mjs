// The page of a wearer and the dashboard in German and in Chinese, what a wearer hears, and the sheets of a map's
// marks, against a real server that this test starts itself: node tests/words.mjs PATH-TO-GIVEWAY
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { fileURLToPath } from 'node:url';
import {
  PATIENCE,
  assert,
  assertAccessible,
  assertOneLine,
  check,
  finish,
  listen,
  openBrowser,
  until,
} from './chromium.mjs';
import { serve } from './serve.mjs';

const program = process.argv[2];
if (!program) {
  console.error('Say where the program is: node tests/words.mjs target/debug/giveway');
  process.exit(2);
}
const HERE = (path) => fileURLToPath(new URL(path, import.meta.url));
const SHOTS = HERE('./shots/');
await mkdir(SHOTS, { recursive: true });
const scratch = mkdtempSync(`${tmpdir()}/giveway-words-`);
const MARKS = [
  { id: 'M1', x: 0, y: 1.5 },
  { id: 'M2', x: 6, y: 2 },
  { id: 'R106', x: 0, y: 0 },
];
const map = JSON.parse(readFileSync(HERE('../../maps/lab.json'), 'utf8'));
const node = map.nodes.find((n) => n.id === 'R106');
Object.assign(MARKS[2], { x: node.x, y: node.y });
writeFileSync(`${scratch}/map.json`, JSON.stringify({ ...map, marks: MARKS }));
const scenario = JSON.parse(readFileSync(HERE('../../tests/it/quiet.json'), 'utf8'));
writeFileSync(`${scratch}/words.json`, JSON.stringify({ ...scenario, map: `${scratch}/map.json` }));
const { url, stop } = await serve(program, `${scratch}/words.json`, scratch);
const browser = await openBrowser();
const complaints = [];
const ask = async (path, body) => {
  const sent = body
    ? { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) }
    : {};
  const answer = await fetch(url + path, sent);
  assert(answer.ok, `${path}: ${answer.status} ${await answer.clone().text()}`);
  return answer.json().catch(() => null);
};

/** A page in a language, whose voice is written down: one voice for each of German and English. */
async function open(locale, more = {}) {
  const context = await browser.newContext({
    locale,
    viewport: { width: 390, height: 780 },
    hasTouch: true,
    colorScheme: 'light',
    ...more,
  });
  const page = await context.newPage();
  listen(page, complaints);
  await page.addInitScript(() => {
    delete Navigator.prototype.xr;
    globalThis.heard = [];
    const voice = (lang) => ({ lang, localService: true, default: false, name: lang, voiceURI: lang });
    const voices = [voice('de-DE'), voice('en-US')];
    globalThis.SpeechSynthesisUtterance = class {
      constructor(text) {
        this.text = text;
      }
    };
    Object.defineProperty(globalThis, 'speechSynthesis', {
      value: {
        pending: false,
        getVoices: () => voices,
        cancel: () => {},
        speak: ({ text, lang }) => text && globalThis.heard.push(`${lang}: ${text}`),
      },
    });
  });
  return page;
}
const LOOKS = [
  ['light', 1400],
  ['dark', 820],
  ['light', 390],
  ['dark', 390],
];
async function shots(page, name) {
  const before = page.viewportSize();
  for (const [colorScheme, width] of LOOKS) {
    await page.emulateMedia({ colorScheme });
    await page.setViewportSize({ width, height: 844 });
    await page.waitForTimeout(500);
    await page.screenshot({ path: `${SHOTS}words-${name}-${colorScheme}-${width}.png`, fullPage: true });
    const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert(over <= 0, `${name} at ${width}: ${over} px too wide`);
  }
  await page.emulateMedia({ colorScheme: 'light' });
  await page.setViewportSize(before);
}
const board = (page) => page.locator('.banner').innerText();
const boardSays = (page, text) => page.locator('.banner', { hasText: text }).waitFor({ timeout: PATIENCE });
const heard = (page) => page.evaluate(() => globalThis.heard);
const hears = (page, text) =>
  until(`"${text}" among ${JSON.stringify([])}`, async () => (await heard(page)).includes(text), 60).catch(async () => {
    throw new Error(`heard ${JSON.stringify(await heard(page))}, not ${text}`);
  });
const worker = async (name) => (await ask('/v1/workers')).items.find((w) => w.name === name);

const german = await open('de-AT');
await check('A German browser gets the page in German', async () => {
  await german.goto(`${url}/headset`);
  await german.getByRole('heading', { name: 'Wegführung für eine Person' }).waitFor({ timeout: PATIENCE });
  assert((await german.locator('html').getAttribute('lang')) === 'de', 'lang');
  const loaded = await german.evaluate(() =>
    performance
      .getEntriesByType('resource')
      .map((e) => e.name)
      .filter((n) => /\/(en|de|es|zh)-[^/]*\.js/.test(n)),
  );
  // Its messages, and the server's sentences.
  assert(loaded.length === 2 && loaded.every((file) => /\/de-/.test(file)), `it loaded ${loaded}`);
  await shots(german, 'sign-in-de');
});
await check('axe finds nothing wrong (sign in, German)', () => assertAccessible(german, 'sign in'));
await check('The wearer reads and hears task and place, in German', async () => {
  await german.getByLabel('Name der Trägerin').fill('packer-1');
  await german.getByRole('button', { name: 'Als Telefon benutzen' }).click();
  await german.locator('#headset[data-link="live"]').waitFor({ timeout: PATIENCE });
  const box = await german.locator('canvas.map').boundingBox();
  await german.touchscreen.tap(box.x + box.width * 0.5, box.y + box.height * 0.5);
  await german.getByText('Sie haben angegeben, dass Sie hier stehen.').waitFor({ timeout: PATIENCE });
  const { id } = await worker('packer-1');
  await ask(`/v1/workers/${id}/assignments`, { place: 'R111', stay_s: 600, what: 'K1 zählen' });
  await boardSays(german, 'K1 zählen bei R111');
  await hears(german, 'de-DE: K1 zählen bei R111.');
  await shots(german, 'phone-de');
  return (await board(german)).replaceAll('\n', ': ');
});
await check('axe finds nothing wrong (phone, German)', () => assertAccessible(german, 'phone'));
await check('A tag that knows the place better ends what the tap said', async () => {
  const { id } = await worker('packer-1');
  const before = await ask(`/v1/workers/${id}`);
  const there = { x: before.x, y: before.y, accuracy_m: 0.2 };
  // It says where it is all the while, as a tag does, however long the page takes for each step.
  const tag = setInterval(() => void ask(`/v1/workers/${id}/position`, there).catch(() => null), 300);
  try {
    await german.getByText('Ein Tag oder ein anderes Gerät zeigt, wo Sie sind.').waitFor({ timeout: PATIENCE });
    const sent = Number(await german.locator('#headset').getAttribute('data-sent'));
    const box = await german.locator('canvas.map').boundingBox();
    await german.touchscreen.tap(box.x + box.width * 0.2, box.y + box.height * 0.2);
    await german.waitForTimeout(2_400);
    assert(Number(await german.locator('#headset').getAttribute('data-sent')) === sent, 'the tap is still sent');
  } finally {
    clearInterval(tag);
  }
});
await check('At the place it says so; done leads to the next, and each is heard once', async () => {
  const { id } = await worker('packer-1');
  const goal = map.nodes.find((n) => n.id === 'R111');
  const stand = async () => {
    const { path } = await ask(`/v1/workers/${id}`);
    const [x, y] = path.at(-1) ?? [goal.x, goal.y];
    const from = await worker('packer-1');
    const [dx, dy] = [x - from.x, y - from.y];
    const step = Math.min(1, 0.5 / Math.max(0.01, Math.hypot(dx, dy)));
    await ask(`/v1/workers/${id}/position`, { x: from.x + dx * step, y: from.y + dy * step, accuracy_m: 0.1 });
  };
  await until(
    'the place',
    async () => {
      await stand();
      return (await board(german)).includes('Sie sind da');
    },
    90,
  );
  await hears(german, 'de-DE: Sie sind da.');
  await german.screenshot({ path: `${SHOTS}words-there-de.png` });
  await ask(`/v1/workers/${id}/assignments`, { place: 'R106', stay_s: 600, what: 'Kartons holen' });
  await german.getByRole('button', { name: 'Fertig', exact: true }).click();
  await until(
    'the next',
    async () => {
      await stand();
      return (await board(german)).includes('Kartons holen bei R106');
    },
    60,
  );
  await until(
    'the word for it',
    async () => (await heard(german)).some((text) => text.endsWith('Als Nächstes: Kartons holen bei R106.')),
    30,
  );
  const all = (await heard(german)).join(' ');
  for (const once of ['Sie sind da', 'Fertig.', 'Als Nächstes'])
    assert(all.split(once).length === 2, `${once} was not heard once: ${all}`);
  return all;
});
await check('A tap says it again; switched off, the voice is silent', async () => {
  const before = (await heard(german)).length;
  await german.getByRole('button', { name: 'Noch einmal sagen' }).click();
  assert((await heard(german)).length === before + 1, 'nothing was heard');
  assert((await heard(german)).at(-1).includes('Kartons holen bei R106'), (await heard(german)).at(-1));
  await german.getByRole('button', { name: 'Stimme: an' }).click();
  await german.getByRole('button', { name: 'Noch einmal sagen' }).click();
  assert((await heard(german)).length === before + 1, 'it spoke');
  await german.getByRole('button', { name: 'Stimme: aus' }).click();
});
await check('A task that is cancelled is heard to be cancelled', async () => {
  const { id } = await worker('packer-1');
  const { items } = await ask(`/v1/workers/${id}/assignments`);
  const open = items.find(({ what, state }) => what === 'Kartons holen' && state !== 'done');
  const answer = await fetch(`${url}/v1/assignments/${open.id}`, { method: 'DELETE' });
  assert(answer.ok, `${answer.status} ${await answer.text()}`);
  await until(
    'the word for it',
    async () => (await heard(german)).some((text) => text.includes('Diese Aufgabe ist abgesagt.')),
    30,
  );
});
await check('Another language is chosen, and remembered', async () => {
  await german.getByRole('button', { name: 'Ich habe die Halle verlassen' }).click();
  await german.getByText('packer-1 hat die Halle verlassen.').waitFor({ timeout: PATIENCE });
  await german.getByLabel('Sprache').selectOption('es');
  await german.getByRole('heading', { name: 'Guía para una persona' }).waitFor({ timeout: PATIENCE });
  await german.reload();
  await german.getByRole('heading', { name: 'Guía para una persona' }).waitFor({ timeout: PATIENCE });
  await shots(german, 'sign-in-es');
});

const chinese = await open('zh-CN');
await check('A Chinese browser gets the page in Chinese, with no English left', async () => {
  await chinese.goto(`${url}/headset?mark=M2`);
  await chinese.getByRole('heading', { name: '人员引导' }).waitFor({ timeout: PATIENCE });
  assert((await chinese.locator('html').getAttribute('lang')) === 'zh-Hans', 'lang');
  const visible = await chinese.locator('main').innerText();
  const left = visible
    .replaceAll(/English|Deutsch|Español|WebXR|HTTPS|https:|VR|[A-Z]\d+(-\d+)?/g, '')
    .match(/[A-Za-z]{3,}/g);
  assert(left === null, `${left}`);
  await shots(chinese, 'sign-in-zh');
});
await check('axe finds nothing wrong (sign in, Chinese)', () => assertAccessible(chinese, 'sign in'));
await check(
  'Whoever scanned the code of a mark stands there, and the task is shown in Chinese without a voice for it',
  async () => {
    await chinese.getByLabel('佩戴者姓名').fill('packer-2');
    await chinese.getByRole('button', { name: '作为手机使用' }).click();
    await chinese.getByText('您指明自己站在这里').waitFor({ timeout: PATIENCE });
    await until(
      'the place',
      async () => {
        const w = await worker('packer-2');
        return w?.x === 6 && w?.y === 2;
      },
      30,
    );
    const { id } = await worker('packer-2');
    await ask(`/v1/workers/${id}/assignments`, { place: 'R106', stay_s: 600, what: '清点 K1' });
    await boardSays(chinese, 'R106：清点 K1');
    await chinese.getByText('此设备没有中文语音').waitFor({ timeout: PATIENCE });
    assert((await heard(chinese)).length === 0, `a voice of another language read it: ${await heard(chinese)}`);
    await shots(chinese, 'phone-zh');
    return (await board(chinese)).replaceAll('\n', '；');
  },
);
await check('axe finds nothing wrong (phone, Chinese)', () => assertAccessible(chinese, 'phone'));

const sheets = await open('de-DE', { viewport: { width: 1400, height: 900 } });
await check('Each mark of the map has a sheet with a code, on a page of its own', async () => {
  await sheets.goto(`${url}/headset/marks`);
  await sheets.getByRole('heading', { name: 'Marke M1' }).waitFor({ timeout: PATIENCE });
  assert((await sheets.locator('.sheet .code path').count()) === MARKS.length, 'codes');
  await sheets.getByText(`${MARKS.length} Marken, jede auf einem eigenen Blatt.`).waitFor();
  const pdf = (await sheets.pdf({ format: 'A4', printBackground: true })).toString('latin1');
  const pages = pdf.match(/\/Type \/Page\b/g)?.length;
  assert(pages === MARKS.length, `${pages} pages are printed`);
  await shots(sheets, 'sheets-de');
});
await check('axe finds nothing wrong (sheets)', () => assertAccessible(sheets, 'sheets'));
const DESK = { viewport: { width: 1440, height: 900 }, hasTouch: false };
const TABS = 9;
/** What a visitor of the dashboard sees and hears, but for the names in the audit, whose titles are requests, and
 *  examples of CSV. */
const said = (page) =>
  page.evaluate(() => {
    const named = [...document.querySelectorAll('[aria-label], [title], [placeholder]:not(textarea)')].filter(
      (e) => !e.closest('[data-outcome]'),
    );
    const actors = new Set(
      [...document.querySelectorAll('[data-outcome] td:nth-of-type(1)')].map((cell) => cell.innerText),
    );
    const text = [...actors].reduce((all, actor) => all.replaceAll(actor, ''), document.body.innerText);
    return [text, ...named.flatMap((e) => [e.ariaLabel, e.title, e.placeholder])].filter(Boolean).join('\n');
  });
const dashboard = await open('de-DE', DESK);
await check('The dashboard is in German, with numbers as Germans write them', async () => {
  await dashboard.goto(url);
  await dashboard.locator('canvas[data-robots]').waitFor({ state: 'attached', timeout: PATIENCE });
  await dashboard.getByRole('button', { name: 'Alle Roboter anhalten' }).waitFor({ timeout: PATIENCE });
  await dashboard.getByLabel('In der Halle finden').fill('R106');
  await dashboard.keyboard.press('Enter');
  await dashboard
    .getByRole('region', { name: 'Ort', exact: true })
    .getByText(/^-?\d+,\d m \/ -?\d+,\d m$/)
    .waitFor({ timeout: PATIENCE });
  await dashboard.getByRole('button', { name: 'Bericht', exact: true }).click();
  await dashboard.getByText('Worauf wartende Roboter warteten').waitFor({ timeout: PATIENCE });
  await shots(dashboard, 'dashboard-de');
});
await check('axe finds nothing wrong (dashboard, German)', () => assertAccessible(dashboard, 'dashboard'));
const desk = await open('zh-CN', DESK);
await check('The dashboard has no English left in Chinese, whichever panel is shown', async () => {
  await desk.goto(url);
  await desk.locator('canvas[data-robots]').waitFor({ state: 'attached', timeout: PATIENCE });
  const tabs = desk.getByRole('group', { name: '地图下方显示的内容' }).getByRole('button');
  assert((await tabs.count()) >= TABS, `${await tabs.count()} tabs`);
  const words = `Giveway|giveway|English|Deutsch|Español|CSV|JSON|Ctrl|Esc|Shift|reel|${map.name}`;
  const own = new RegExp(`${words}|(robot|packer|worker)-\\w+|[A-Z]+\\d+(-\\d+)?`, 'g');
  const columns = /kind|rack|station|priority|deadline_min|node|robot|pick_s|reference|then/g;
  const left = new Set();
  for (let tab = 0; tab < TABS; tab += 1) {
    await tabs.nth(tab).click();
    await desk.waitForTimeout(1_500);
    for (const word of (await said(desk))
      .replaceAll(own, '')
      .replaceAll(columns, '')
      .match(/.*[A-Za-z]{3,}.*/g) ?? [])
      left.add(word);
  }
  assert(left.size === 0, [...left].join(' | '));
  await shots(desk, 'dashboard-zh');
});
await check('The bar on top is one line in every language, now and in a replay', async () => {
  for (const locale of ['en-GB', 'de-DE', 'es-ES', 'zh-CN']) {
    for (const [when, hash, is] of [
      ['now', '', '[data-link="live"]'],
      ['then', '#replay', '.past'],
    ]) {
      const one = await open(locale, DESK);
      await one.goto(`${url}/${hash}`);
      await one.locator(`header ${is}`).waitFor({ timeout: PATIENCE });
      await assertOneLine(one, `${locale}, ${when}`);
      await one.screenshot({
        path: `${SHOTS}words-bar-${locale.slice(0, 2)}-${when}.png`,
        clip: { x: 0, y: 0, width: 1440, height: 60 },
      });
      await one.context().close();
    }
  }
});
await check('Nothing was complained about in the console', () =>
  assert(complaints.length === 0, complaints.join(' | ')),
);

await stop();
await finish(browser);
