// Makes docs/floor.png from a running server, at the size that the README shows:
//   giveway serve --scenario scenarios/kiva-100.json --database picture.sqlite
//   node docs/picture.mjs http://127.0.0.1:8080
// Needs `npm --prefix web ci` and a Chromium; CHROMIUM names it where it is no Debian package.
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';

const url = process.argv[2] ?? 'http://127.0.0.1:8080';
const target = process.argv[3] ?? fileURLToPath(new URL('floor.png', import.meta.url));
const require = createRequire(new URL('../web/package.json', import.meta.url));
const { chromium } = require('playwright-core');
const known = ['/usr/bin/chromium-headless-shell', '/usr/bin/chromium'];
const executablePath = process.env.CHROMIUM ?? known.find((path) => existsSync(path));

const args = ['--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const browser = await chromium.launch({ executablePath, args });
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
const page = await context.newPage();
await page.goto(url);
await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset.robots) > 0, null, { timeout: 30_000 });
// Long enough for robots to be on their ways.
await page.waitForTimeout(Number(process.env.SECONDS_BEFORE ?? 60) * 1000);
await page.screenshot({ path: target });
await browser.close();
console.log(`wrote ${target}`);
