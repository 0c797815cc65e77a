// Jobs from a table: reads CSV, says line by line what is wrong, and makes the requests.
import { readTable, type TableFault, type TableRow } from './table';
import { build, BLANK, FIELDS, stationsOf, type FormValues } from './jobform';
import { JOB_KINDS, type JobKind, type NewJob } from '../wire';
import { t } from '../words';

export interface CsvLine {
  /** In the file, from 1 on. */
  readonly line: number;
  readonly cells: Readonly<Record<string, string>>;
  readonly job: NewJob | null;
  /** The key that the table gives: the same key never makes a second job. */
  readonly key: string | null;
  readonly errors: readonly string[];
}
export type CsvRead = { kind: 'table'; lines: CsvLine[] } | { kind: 'unreadable'; why: string };

export const COLUMNS = [
  'kind',
  'rack',
  'station',
  'node',
  'robot',
  'priority',
  'deadline_min',
  'pick_s',
  'reference',
  'key',
] as const;
export const EXAMPLE = 'kind,rack,station,priority\ndeliver,K1,W1,5\nreturn,K2,,0\n';
export const MOST_LINES = 1_000;
const LONGEST_PICK_S = 3_600;
const LONGEST_REFERENCE = 200;
/** In UTF-8, as the server counts. */
const LONGEST_KEY_BYTES = 255;

export interface Known {
  readonly rack: ReadonlySet<string>;
  readonly station: ReadonlySet<string>;
  readonly node: ReadonlySet<string>;
  readonly robot: ReadonlySet<string>;
}

export function readJobs(text: string, known: Known, now: Date): CsvRead {
  const table = readTable(text);
  if ('kind' in table) return { kind: 'unreadable', why: whyNot(table) };
  const names = table.columns.map((c) => c.toLowerCase());
  const used = (i: number): boolean => names[i] !== '' || table.rows.some((r) => r.cells[i] !== '');
  const strange = names.filter((n, i) => used(i) && !(COLUMNS as readonly string[]).includes(n));
  if (!names.includes('kind') || strange.length > 0) {
    const which =
      strange.length > 0 ? t('csv.column.unknown', { columns: strange.map((s) => `“${s}”`).join(', ') }) : '';
    return {
      kind: 'unreadable',
      why: [t('csv.columns.wrong', { columns: COLUMNS.join(', ') }), which].filter(Boolean).join(' '),
    };
  }
  if (table.rows.length > MOST_LINES)
    return { kind: 'unreadable', why: t('csv.many', { count: table.rows.length, most: MOST_LINES }) };
  const keys = new Map<string, number>();
  return { kind: 'table', lines: table.rows.map((r) => readLine(r, names, known, now, keys)) };
}

function whyNot(fault: TableFault): string {
  switch (fault.kind) {
    case 'empty':
      return t('csv.empty');
    case 'no rows':
      return t('csv.none');
    case 'twice':
      return t('csv.twice', { name: fault.name });
    case 'unclosed':
      return t('csv.unclosed', { line: fault.line });
    case 'not text':
      return t('csv.encoding');
  }
}

function readLine(
  row: TableRow,
  names: readonly string[],
  known: Known,
  now: Date,
  keys: Map<string, number>,
): CsvLine {
  const found: Record<string, string> = {};
  names.forEach((name, i) => {
    found[name] = row.cells[i] ?? '';
  });
  const errors: string[] = [];
  if (row.surplus > 0) errors.push(t('csv.cells', { cells: row.surplus, columns: names.length }));
  const key = found['key'] || null;
  if (key !== null) {
    const before = keys.get(key);
    if (before !== undefined) errors.push(t('csv.key.twice', { key, line: before }));
    else keys.set(key, row.line);
    if (new TextEncoder().encode(key).length > LONGEST_KEY_BYTES)
      errors.push(t('csv.key', { most: LONGEST_KEY_BYTES }));
  }
  const kind = (found['kind'] ?? '').toLowerCase() as JobKind;
  const at = { line: row.line, cells: found, key };
  if (!JOB_KINDS.includes(kind))
    return { ...at, job: null, errors: [t('csv.kind', { kind: found['kind'] ?? '', kinds: JOB_KINDS.join(', ') })] };
  const values: FormValues = {
    ...BLANK,
    kind,
    rack: found['rack'] ?? '',
    station: found['station'] ?? '',
    node: found['node'] ?? '',
    robot: found['robot'] ?? '',
    priority: found['priority'] || '0',
    deadline: found['deadline_min'] ?? '',
  };
  const built = build(values, now);
  if (built.kind === 'wrong') errors.push(...Object.values(built.errors));
  for (const field of ['rack', 'station', 'node', 'robot'] as const) {
    const text = values[field].trim();
    if (text === '') continue;
    if (!FIELDS[kind].includes(field)) errors.push(t('csv.field', { kind, field }));
    else {
      for (const name of field === 'station' ? stationsOf(text) : [text]) {
        if (!known[field].has(name)) errors.push(t('csv.unknown', { field, name }));
      }
    }
  }
  const job = built.kind === 'ready' ? built.job : null;
  const pick = found['pick_s'] ?? '';
  if (pick !== '') {
    const seconds = Number(pick);
    if (kind !== 'deliver') errors.push(t('csv.field', { kind, field: 'pick_s' }));
    else if (!(seconds >= 0 && seconds <= LONGEST_PICK_S)) errors.push(t('csv.pick', { most: LONGEST_PICK_S }));
    else if (job?.stops) for (const stop of job.stops) stop.pick_s = seconds;
    else if (job) job.pick_s = seconds;
  }
  const reference = found['reference'] ?? '';
  if (reference.length > LONGEST_REFERENCE) errors.push(t('csv.reference', { most: LONGEST_REFERENCE }));
  else if (reference !== '' && job) job.reference = reference;
  return { ...at, job: errors.length === 0 ? job : null, errors };
}
