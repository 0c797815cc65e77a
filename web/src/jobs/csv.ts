// Jobs from a table: reads CSV, says line by line what is wrong, and makes the requests.
import { build, BLANK, FIELDS, stationsOf, type FormValues } from './jobform';
import { JOB_KINDS, type JobKind, type NewJob } from '../wire';
import { t } from '../words';

export interface CsvLine {
  /** In the file, from 1 on. */
  readonly line: number;
  readonly cells: Readonly<Record<string, string>>;
  readonly job: NewJob | null;
  readonly errors: readonly string[];
}
export type CsvRead = { kind: 'table'; lines: CsvLine[] } | { kind: 'unreadable'; why: string };

export const COLUMNS = ['kind', 'rack', 'station', 'node', 'robot', 'priority', 'deadline_min', 'pick_s', 'reference'] as const;
export const EXAMPLE = 'kind,rack,station,priority\ndeliver,K1,W1,5\nreturn,K2,,0\n';
export const MOST_LINES = 1_000;
const LONGEST_PICK_S = 3_600;
const LONGEST_REFERENCE = 200;

/** Cells of every line that has any; quotes as in RFC 4180. */
export function cells(text: string): { line: number; cells: string[] }[] {
  const separator = separatorOf(text);
  const out: { line: number; cells: string[] }[] = [];
  let row: string[] = [];
  let cell = '';
  let quoted = false;
  let line = 1;
  let began = 1;
  const endCell = (): void => { row.push(cell.trim()); cell = ''; };
  const endRow = (): void => {
    endCell();
    if (row.some((c) => c !== '')) out.push({ line: began, cells: row });
    row = [];
    began = line;
  };
  const plain = text.replace(/^\uFEFF/, '');
  for (let i = 0; i < plain.length; i++) {
    const c = plain[i]!;
    if (c === '\n') line += 1;
    if (quoted) {
      if (c !== '"') cell += c;
      else if (plain[i + 1] === '"') { cell += '"'; i += 1; } else quoted = false;
    } else if (c === '"' && cell.trim() === '') { quoted = true; cell = ''; } else if (c === separator) endCell();
    else if (c === '\n') endRow();
    else if (c !== '\r') cell += c;
  }
  endRow();
  return out;
}

/** Some spreadsheets write semicolons, some tabs. */
function separatorOf(text: string): string {
  const head = text.split('\n', 1)[0] ?? '';
  return [';', '\t'].find((s) => head.includes(s) && !head.includes(',')) ?? ',';
}

export interface Known {
  readonly rack: ReadonlySet<string>;
  readonly station: ReadonlySet<string>;
  readonly node: ReadonlySet<string>;
  readonly robot: ReadonlySet<string>;
}

export function readJobs(text: string, known: Known, now: Date): CsvRead {
  const [head, ...rest] = cells(text);
  if (!head) return { kind: 'unreadable', why: t('csv.empty') };
  const names = head.cells.map((c) => c.toLowerCase());
  const strange = names.filter((n) => !(COLUMNS as readonly string[]).includes(n));
  if (!names.includes('kind') || strange.length > 0) {
    const which = strange.length > 0 ? t('csv.column.unknown', { columns: strange.map((s) => `“${s}”`).join(', ') }) : '';
    return { kind: 'unreadable', why: [t('csv.columns.wrong', { columns: COLUMNS.join(', ') }), which].filter(Boolean).join(' ') };
  }
  if (rest.length === 0) return { kind: 'unreadable', why: t('csv.none') };
  if (rest.length > MOST_LINES) return { kind: 'unreadable', why: t('csv.many', { count: rest.length, most: MOST_LINES }) };
  return { kind: 'table', lines: rest.map((r) => readLine(r, names, known, now)) };
}

function readLine(row: { line: number; cells: string[] }, names: readonly string[], known: Known, now: Date): CsvLine {
  const found: Record<string, string> = {};
  names.forEach((name, i) => { found[name] = row.cells[i] ?? ''; });
  const errors: string[] = [];
  if (row.cells.length > names.length) errors.push(t('csv.cells', { cells: row.cells.length, columns: names.length }));
  const kind = (found['kind'] ?? '').toLowerCase() as JobKind;
  const at = { line: row.line, cells: found };
  if (!JOB_KINDS.includes(kind)) return { ...at, job: null, errors: [t('csv.kind', { kind: found['kind'] ?? '', kinds: JOB_KINDS.join(', ') })] };
  const values: FormValues = {
    ...BLANK, kind, rack: found['rack'] ?? '', station: found['station'] ?? '', node: found['node'] ?? '',
    robot: found['robot'] ?? '', priority: found['priority'] || '0', deadline: found['deadline_min'] ?? '',
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
