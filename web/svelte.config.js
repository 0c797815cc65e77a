// Svelte itself needs no preprocessing: scripts are plain TypeScript that it can strip.
export default { compilerOptions: { runes: true } };
