// Jobs: the form, tables of many, the list with its filter, the card of one; and those of a moment of the past.
export { Jobs } from './jobs.svelte';
