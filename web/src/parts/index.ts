// Parts that every room may build with: the theme, offered names, asking again and again, and, as `Field.svelte`, a
// text field. They know nothing of warehouses.
export { valueOf, type Loaded } from './loaded';
export { poll } from './poll';
export { suggest } from './suggest';
export { applyTheme, storedTheme, THEMES, type Theme } from './theme';
