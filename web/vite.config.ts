// How the page is built, tested and served while it is being written. Without GIVEWAY_URL the dev
// server starts the toy floor of dev/mock.mjs and talks to that; with it, to the server named there.
import { svelte } from '@sveltejs/vite-plugin-svelte';
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

/** `--mode single`: script and style in one piece each, for pages that are a file with a reel in it. */
const single = {
  copyPublicDir: false,
  cssCodeSplit: false,
  rolldownOptions: {
    input: 'src/main.ts',
    output: { codeSplitting: false, entryFileNames: 'page.js', assetFileNames: 'page[extname]' },
  },
};

export default defineConfig(({ mode }) => ({
  plugins: [svelte(), mockServer()],
  // Tests run components as a browser would, not as a server-side render.
  ...(process.env['VITEST'] ? { resolve: { conditions: ['browser'] } } : {}),
  build: {
    target: ['chrome123', 'firefox121', 'safari17.5'],
    // An inlined data: URL would need a hole in the Content-Security-Policy.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 700,
    // Pages that share no script: neither a headset nor the page of the API need load the dashboard.
    rolldownOptions: { input: ['index.html', 'headset.html', 'docs.html', 'editor.html', 'signin.html'] },
    ...(mode === 'single' ? single : {}),
  },
  server: { proxy: { '/v1': { target: server, ws: true }, '/openapi.json': server, '/asyncapi.json': server } },
  // A minute for a test that takes a tenth of a second: a machine may be busy with other work.
  test: { environment: 'happy-dom', include: ['tests/**/*.test.ts'], testTimeout: 60_000, hookTimeout: 60_000 },
}));
