// The browser that the tests use: Debian's, without a window and without a graphics card.
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { chromium } from 'playwright-core';

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

const ARGS = [
  '--headless',
  '--no-sandbox',
  '--disable-gpu',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--no-first-run',
];

export async function openBrowser() {
  const executablePath =
    process.env.CHROMIUM ?? ['/usr/bin/chromium-headless-shell', '/usr/bin/chromium'].find((path) => existsSync(path));
  if (!executablePath) {
    console.error('No Chromium: install the Debian package chromium-headless-shell, or set CHROMIUM to one.');
    process.exit(2);
  }
  return chromium.launch({ executablePath, args: ARGS });
}

/** How long something may take before it counts as never, milliseconds: machines are slow when they do much at once. */
export const PATIENCE = 45_000;

let passed = 0;
let failed = 0;

export async function check(sentence, run) {
  try {
    const more = await run();
    passed += 1;
    console.log(`pass: ${sentence}${more ? ` (${more})` : ''}`);
  } catch (error) {
    failed += 1;
    console.log(
      `FAIL: ${sentence}: ${String(error.message ?? error)
        .split('\n')
        .slice(0, 4)
        .join(' | ')}`,
    );
  }
}

export function assert(truth, why) {
  if (!truth) throw new Error(why);
}

/** Notes what a page writes to its console as an error, or throws. The browser itself logs some things that a test
 *  means. */
export function listen(page, complaints, meant = () => false) {
  page.on('console', (message) => {
    if (message.type() === 'error' && !meant(message)) complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(error.message));
}

/** A request that the server refused: the browser logs it, and the page tells the user. */
export const isRefusal = (message) => /status of 4(00|04|09|22)\b/.test(message.text());

/** The server was killed while the page was open, and loads its journal when it is back. */
export const isLostLink = (message) =>
  /ERR_CONNECTION_REFUSED|ERR_CONNECTION_RESET|WebSocket connection to|status of 503/.test(message.text());

/** That the accessibility checker axe finds nothing wrong with a page. */
export async function assertAccessible(page, look) {
  // Evaluated from outside the page, as its Content-Security-Policy lets no script be added.
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => globalThis.axe.run());
  const where = (nodes) =>
    nodes
      .slice(0, 3)
      .map((n) => `${n.target.join(' ')} ${n.failureSummary ?? ''}`)
      .join('; ');
  assert(violations.length === 0, `${look}: ${violations.map((v) => `${v.id}: ${where(v.nodes)}`).join(' | ')}`);
}

/** That the bar on top is one line, and that nothing in it is cut off but the name of who is signed in. */
export async function assertOneLine(page, look) {
  const bar = await page
    .locator('header')
    .first()
    .evaluate((header) => {
      const parts = [...header.children].filter(
        (e) => getComputedStyle(e).position !== 'absolute' && e.getClientRects().length > 0 && e.tagName !== 'DIALOG',
      );
      const middles = parts
        .map((e) => e.getBoundingClientRect())
        .filter(({ height }) => height > 0)
        .map(({ top, bottom }) => (top + bottom) / 2);
      const cut = parts.filter(
        (e) =>
          e.scrollWidth > e.clientWidth + 1 && !e.classList.contains('who') && getComputedStyle(e).display !== 'inline',
      );
      return {
        spread: Math.max(...middles) - Math.min(...middles),
        over: header.scrollWidth - header.clientWidth,
        cut: cut.map((e) => e.innerText),
      };
    });
  assert(bar.spread < 12 && bar.over <= 0 && bar.cut.length === 0, `${look}: the bar on top is ${JSON.stringify(bar)}`);
}

/** Asks twice a second until it is so. */
export async function until(what, so, seconds = 240) {
  for (let i = 0; i < 2 * seconds; i++) {
    if (await so()) return;
    await new Promise((done) => {
      setTimeout(done, 500);
    });
  }
  throw new Error(`${what} never comes`);
}

/** Says how many checks passed, and ends. */
export async function finish(browser) {
  await browser?.close();
  console.log(`${passed} passed, ${failed} failed`);
  process.exit(failed === 0 ? 0 : 1);
}
