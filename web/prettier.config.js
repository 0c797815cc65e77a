// How the sources are formatted: `npm run format` does it, and `npm run check` fails on a file that it would change.
export default {
  printWidth: 120,
  singleQuote: true,
  bracketSameLine: true,
  plugins: ['prettier-plugin-svelte'],
  overrides: [{ files: '*.svelte', options: { parser: 'svelte' } }],
};
