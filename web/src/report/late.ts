// Which deliveries were late in the time of a report: those that the server counts there.
import type { Api, Job } from '../wire';

/** So many pages of jobs are looked through. */
const MOST_PAGES = 10;

export interface Late {
  readonly jobs: readonly Job[];
  readonly complete: boolean;
}

/** Deliveries that were done after their deadline, from one time to another, the latest first; null where the server
 *  does not say. */
export async function lateJobs(api: Pick<Api, 'jobsDone'>, from: string, to: string): Promise<Late | null> {
  const found: Job[] = [];
  let cursor: string | null = null;
  for (let i = 0; i < MOST_PAGES; i++) {
    const answer: Awaited<ReturnType<Api['jobsDone']>> = await api.jobsDone(from, cursor);
    if (answer.kind !== 'ok') return null;
    found.push(...answer.value.items.filter((job) => isLate(job, from, to)));
    cursor = answer.value.next;
    if (cursor === null) break;
  }
  found.sort((a, b) => lateBy_s(b) - lateBy_s(a));
  return { jobs: found, complete: cursor === null };
}

function isLate(job: Job, from: string, to: string): boolean {
  const done = Date.parse(job.updated);
  return (
    job.kind === 'deliver' &&
    job.deadline !== null &&
    done > Date.parse(job.deadline) &&
    done >= Date.parse(from) &&
    done < Date.parse(to)
  );
}

export const lateBy_s = (job: Job): number =>
  job.deadline === null ? 0 : (Date.parse(job.updated) - Date.parse(job.deadline)) / 1_000;
