// Parts that every room may build with: the theme, offered names, asking again and again, plain elements, and, as
// components, a text field and what was just done with a way to undo it. They know nothing of warehouses, and this door
// nothing of Svelte.
export { make } from './dom';
export { valueOf, type Loaded } from './loaded';
export type { Notice, Notices } from './notices.svelte';
export { poll } from './poll';
export { suggest } from './suggest';
export { applyTheme, storedTheme, THEMES, type Theme } from './theme';
