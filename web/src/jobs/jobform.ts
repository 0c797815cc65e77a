// The job form without its looks: which fields a kind of job needs, and the request made of them.
import type { JobKind, NewJob, Problem } from '../wire';
import { detailOf, t, trouble, wordsBy } from '../words';

export type Field = 'rack' | 'station' | 'node' | 'robot';
export type FormField = Field | 'priority' | 'deadline';
export type FieldErrors = Partial<Record<FormField, string>>;

export interface FormValues {
  kind: JobKind;
  rack: string;
  station: string;
  node: string;
  robot: string;
  priority: string;
  /** Minutes from now; empty for none. */
  deadline: string;
}
export type Built = { kind: 'ready'; job: NewJob } | { kind: 'wrong'; errors: FieldErrors };

export const FIELDS: Record<JobKind, readonly Field[]> = {
  deliver: ['rack', 'station'],
  return: ['rack'],
  relocate: ['rack', 'node'],
  charge: ['robot'],
  park: ['robot'],
  go: ['robot', 'node'],
};
const MISSING = wordsBy<Field>({
  rack: 'job.name.rack',
  station: 'job.name.station',
  node: 'job.name.node',
  robot: 'job.name.robot',
});

export const BLANK: FormValues = {
  kind: 'deliver',
  rack: '',
  station: '',
  node: '',
  robot: '',
  priority: '0',
  deadline: '',
};

/** The stations in a text such as “S1 > S2”. */
export const stationsOf = (text: string): string[] =>
  text
    .split('>')
    .map((s) => s.trim())
    .filter((s) => s !== '');

/** Checks only what the page can know; whether a rack exists is the server's to say. */
export function build(values: FormValues, now: Date): Built {
  const errors: FieldErrors = {};
  const job: NewJob = { kind: values.kind, priority: 0 };
  for (const field of FIELDS[values.kind]) {
    const text = values[field].trim();
    const stations = field === 'station' ? stationsOf(text) : [];
    if (text === '' || (field === 'station' && stations.length === 0)) errors[field] = MISSING[field];
    else if (stations.length > 1) job.stops = stations.map((station) => ({ station }));
    else job[field] = stations[0] ?? text;
  }
  const priority = Number(values.priority);
  if (values.priority.trim() === '' || !Number.isInteger(priority) || priority < 0 || priority > 9) {
    errors.priority = t('job.priority.wrong');
  } else {
    job.priority = priority;
  }
  if (values.deadline.trim() !== '') {
    const minutes = Number(values.deadline);
    if (!Number.isFinite(minutes) || minutes <= 0 || minutes > 7 * 24 * 60) {
      errors.deadline = t('job.deadline.wrong');
    } else {
      job.deadline = new Date(now.getTime() + minutes * 60_000).toISOString();
    }
  }
  return Object.keys(errors).length > 0 ? { kind: 'wrong', errors } : { kind: 'ready', job };
}

/** Sorts a server's answer into what belongs beside a field and what belongs under the form. */
export function explain(problem: Problem, kind: JobKind): { fields: FieldErrors; form: string | null } {
  const shown: readonly string[] = [...FIELDS[kind], 'priority', 'deadline'];
  const fields: FieldErrors = {};
  const rest: string[] = [];
  for (const error of problem.errors ?? []) {
    const field = error.field.startsWith('stops') ? 'station' : error.field;
    if (shown.includes(field)) fields[field as FormField] = detailOf(error);
    else rest.push(detailOf(error));
  }
  const isNamed = Object.keys(fields).length > 0 || rest.length > 0;
  if (!isNamed) rest.push(trouble({ kind: 'refused', problem }) ?? '');
  return { fields, form: rest.length > 0 ? rest.join(' ') : null };
}
