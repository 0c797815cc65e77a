// How the page is built, tested and served while it is being written. Without GIVEWAY_URL the dev
// server starts the toy floor of dev/mock.mjs and talks to that; with it, to the server named there.
import { parse } from '@formatjs/icu-messageformat-parser';
import { svelte } from '@sveltejs/vite-plugin-svelte';
import { readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';
import { readFile } from 'node:fs/promises';
import { defineConfig, type Plugin } from 'vitest/config';

const MOCK_PORT = 8791;
const server = process.env['GIVEWAY_URL'] ?? `http://127.0.0.1:${MOCK_PORT}`;

function mockServer(): Plugin {
  return {
    name: 'giveway-mock',
    apply: 'serve',
    async configureServer() {
      if (process.env['GIVEWAY_URL'] || process.env['VITEST']) return;
      const { startMock } = await import('./dev/mock.mjs');
      await startMock({ port: MOCK_PORT });
    },
  };
}

/** All stations have the same page, as the server has it. */
function stationPage(): Plugin {
  return {
    name: 'giveway-station',
    apply: 'serve',
    configureServer({ middlewares }) {
      middlewares.use((request, _, next) => {
        if (request.url?.startsWith('/station/')) request.url = '/station.html';
        next();
      });
    },
  };
}

/** Below this many bytes a file is sent as it is. */
const SMALL = 1024;

/** Writes `.br` and `.gz` beside each text of the build, from which the server takes what a browser accepts. */
function compressed(): Plugin {
  return {
    name: 'giveway-compressed',
    apply: 'build',
    writeBundle({ dir }) {
      for (const name of readdirSync(dir!, { recursive: true, encoding: 'utf8' })) {
        const path = join(dir!, name);
        if (!/\.(html|js|css|json|svg|txt)$/.test(name) || statSync(path).size < SMALL) continue;
        const text = readFileSync(path);
        writeFileSync(`${path}.gz`, gzipSync(text, { level: 9 }));
        const size = { [constants.BROTLI_PARAM_SIZE_HINT]: text.length };
        writeFileSync(`${path}.br`, brotliCompressSync(text, { params: size }));
      }
    },
  };
}

/** Compiles messages, so that no page loads the parser: without placeholders one is a string, else a tree. */
function messages(): Plugin {
  const compiled = (text: string) => {
    const tree = parse(text, { captureLocation: false });
    return tree.every((part) => part.type === 0) ? tree.map((part) => part.value).join('') : tree;
  };
  return {
    name: 'giveway-messages',
    enforce: 'pre',
    async load(id) {
      if (!/\/messages\/[a-z]+\.json$/.test(id)) return null;
      const texts = Object.entries(JSON.parse(await readFile(id, 'utf8')) as Record<string, string>);
      return JSON.stringify(Object.fromEntries(texts.map(([key, text]) => [key, compiled(text)])));
    },
  };
}

/** `--mode single`: script and style in one piece each, for pages that are a file with a reel in it. */
const single = {
  copyPublicDir: false,
  cssCodeSplit: false,
  rolldownOptions: {
    input: 'src/main.ts',
    output: { codeSplitting: false, entryFileNames: 'page.js', assetFileNames: 'page[extname]' },
  },
};

/** What the same pages load is one file: half a kilobyte of each answer are its headers. */
const TOGETHER = [
  { name: 'base', test: /src\/parts\/(theme|dom)\.ts|vite\/preload-helper|rolldown\/runtime/ },
  { name: 'words', test: /src\/(words\/[a-z]+|wire\/api)\.ts/ },
  { name: 'early', test: /src\/(replay\/spans|alarms\/shown|floor\/(paint\/sheet|scene\/view))\.ts/ },
  { name: 'session', test: /node_modules\/(svelte|esm-env|clsx)\/|src\/session\/(session|english)\.ts/ },
];

export default defineConfig(({ mode }) => ({
  plugins: [messages(), svelte(), mockServer(), stationPage(), ...(mode === 'single' ? [] : [compressed()])],
  // Tests run components as a browser would, not as a server-side render, and parse messages. Pages get them compiled:
  // the formatter's own parser would be 30 kB for nothing.
  resolve: process.env['VITEST']
    ? { conditions: ['browser'] }
    : {
        alias: [
          {
            find: /^@formatjs\/icu-messageformat-parser$/,
            replacement: '@formatjs/icu-messageformat-parser/no-parser.js',
          },
        ],
      },
  build: {
    target: ['chrome123', 'firefox121', 'safari17.5'],
    // An inlined data: URL would need a hole in the Content-Security-Policy.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 700,
    // Pages that share no script: neither a headset, nor a station's display, nor the page of the API need load the
    // dashboard.
    rolldownOptions: {
      input: ['index.html', 'headset.html', 'station.html', 'docs.html', 'editor.html', 'signin.html'],
      output: { codeSplitting: { includeDependenciesRecursively: false, groups: TOGETHER } },
    },
    ...(mode === 'single' ? single : {}),
  },
  // Tests compare the page's types with the server's sources.
  server: {
    ...(process.env['VITEST'] ? { fs: { allow: ['..'] } } : {}),
    proxy: { '/v1': { target: server, ws: true }, '/openapi.json': server, '/asyncapi.json': server },
  },
  // A minute for a test that takes a tenth of a second: a machine may be busy with other work.
  test: {
    environment: 'happy-dom',
    // Styles are read as they are written, and not left out.
    css: { include: /\?raw$/ },
    include: ['tests/**/*.test.ts'],
    setupFiles: ['tests/english.ts'],
    testTimeout: 60_000,
    hookTimeout: 60_000,
  },
}));
