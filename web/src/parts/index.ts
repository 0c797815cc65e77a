// Parts that every room may build with: the theme, offered names, asking again and again, what was just done with a way
// to undo it, and, as `Field.svelte`, a text field. They know nothing of warehouses.
export { valueOf, type Loaded } from './loaded';
export { Notices, OFFERED_MS, type Notice } from './notices.svelte';
export { poll } from './poll';
export { suggest } from './suggest';
export { applyTheme, storedTheme, THEMES, type Theme } from './theme';
