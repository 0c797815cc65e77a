// The map editor: floors are drawn, checked while they are drawn, and tried out before anything is built.
// It loads nothing of the dashboard but its colours; `edit.ts` has the tools, `Sheet.svelte` the drawing.
export { default as Editor } from './Editor.svelte';
