// Alarms: what is wrong now, who looks after it, what was wrong, and how the page calls a person. It finds nothing out
// by itself: the server does.
export { Signals as AlarmSignals } from './signals.svelte';
export { SEVERITY_WORDS, severityOf, titleOf } from './shown';
