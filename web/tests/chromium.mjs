// The browser that the tests use: Debian's, without a window and without a graphics card.
import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

const ARGS = [
  '--headless', '--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  '--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run',
];

export async function openBrowser() {
  const executablePath = process.env.CHROMIUM ?? ['/usr/bin/chromium-headless-shell', '/usr/bin/chromium'].find((path) => existsSync(path));
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
    console.log(`FAIL: ${sentence}: ${String(error.message ?? error).split('\n').slice(0, 4).join(' | ')}`);
  }
}

export function assert(truth, why) {
  if (!truth) throw new Error(why);
}

/** Asks twice a second until it is so. */
export async function until(what, so, seconds = 240) {
  for (let i = 0; i < 2 * seconds; i++) {
    if (await so()) return;
    await new Promise((done) => { setTimeout(done, 500); });
  }
  throw new Error(`${what} never comes`);
}

/** Says how many checks passed, and ends. */
export async function finish(browser) {
  await browser.close();
  console.log(`${passed} passed, ${failed} failed`);
  process.exit(failed === 0 ? 0 : 1);
}
