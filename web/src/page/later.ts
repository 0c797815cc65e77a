// Parts of the page that its first sight does not need: they are fetched, with their messages, when they are needed, or
// else a little after the page is there, so that they open at once, also while the server cannot be reached.
import { learnMore } from '../words';

/** A part and its messages. */
export const fetched = async <T>(part: Promise<{ default: T }>): Promise<T> =>
  (await Promise.all([part, learnMore()]))[0].default;

/** A part whose messages are there from the beginning. */
const part = <T>(one: Promise<{ default: T }>): Promise<T> => one.then((found) => found.default);

export const later = {
  tryOut: () => part(import('./TryOut.svelte')),
  order: () => part(import('../jobs/JobForm.svelte')),
  closing: () => part(import('../places/ClosureForm.svelte')),
  card: () => fetched(import('./PickedCard.svelte')),
  job: () => fetched(import('../jobs/JobPanel.svelte')),
  csv: () => fetched(import('../jobs/CsvJobs.svelte')),
  alarms: () => fetched(import('../alarms/AlarmPage.svelte')),
  robots: () => fetched(import('../robots/RobotsTable.svelte')),
  bar: () => fetched(import('../replay/ReplayBar.svelte')),
  bookmarks: () => fetched(import('../replay/Bookmarks.svelte')),
  wall: () => fetched(import('./Wall.svelte')),
} as const;

/** Fetches them all. What cannot be fetched now is asked for again when it is needed. */
export function fetchLater(): void {
  for (const fetchIt of Object.values(later)) fetchIt().catch(() => {});
}
