// The dashboard: which of present and past is shown, and which room's panel stands where. It alone knows every room,
// and hands each panel what that needs.
export { default as App } from './App.svelte';
