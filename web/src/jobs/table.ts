// Delimited text (CSV) as spreadsheets and other programs write it. The program reads its files by the same rules
// (src/floor/text/table.rs); fixtures/tables.json has the cases on which both agree.

export interface TableRow {
  /** Where it begins in the text, from 1 on. */
  readonly line: number;
  /** A cell for each column. */
  readonly cells: readonly string[];
  /** How many cells it has where that is more than there are columns; else 0. Empty cells at the end do not count. */
  readonly surplus: number;
}
export interface Table {
  /** Names of the columns; one without a name is empty. */
  readonly columns: readonly string[];
  /** The lines below, without those in which every cell is empty. */
  readonly rows: readonly TableRow[];
}
export type TableFault =
  | { kind: 'empty' }
  | { kind: 'no rows' }
  | { kind: 'twice'; name: string }
  | { kind: 'unclosed'; line: number }
  | { kind: 'not text' };

/** Of two that are equally frequent in the header, the first. */
const SEPARATORS = [',', ';', '\t'] as const;
/** No cell has anything. */
const NOTHING = /^[,;\t \u00A0\uFEFF\n]*$/;
const PADDING = /^[ \t\u00A0\uFEFF]+|[ \t\u00A0\uFEFF]+$/g;

const trimmed = (cell: string): string => cell.replace(PADDING, '');

/**
 * Lines end with LF, CR LF or CR; a byte order mark is passed over; the separator is the most frequent one in the
 * header. A cell in quotes may have separators, line ends and, doubled, quotes (RFC 4180). White space around a cell
 * does not count.
 */
export function readTable(given: string): Table | TableFault {
  if (/[\0\uFFFD]/.test(given)) return { kind: 'not text' };
  const text = given.replace(/^\uFEFF+/, '').replace(/\r\n?/g, '\n');
  if (NOTHING.test(text)) return { kind: 'empty' };
  const lines = split(text, separatorOf(text));
  if (!Array.isArray(lines)) return lines;
  const [head, ...rest] = lines;
  if (!head) return { kind: 'empty' };
  const columns = withoutEmptyEnd(head.cells, 0);
  const lower = columns.map((name) => asciiLower(name));
  const twice = columns.find((name, i) => name !== '' && lower.indexOf(lower[i]!) < i);
  if (twice !== undefined) return { kind: 'twice', name: twice };
  if (rest.length === 0) return { kind: 'no rows' };
  const row = ({ line, cells }: { line: number; cells: string[] }): TableRow => {
    const kept = withoutEmptyEnd(cells, columns.length);
    return {
      line,
      cells: columns.map((_, i) => kept[i] ?? ''),
      surplus: kept.length > columns.length ? kept.length : 0,
    };
  };
  return { columns, rows: rest.map(row) };
}

/** Column names of no language: upper and lower case are the same in them. */
const asciiLower = (name: string): string => name.replace(/[A-Z]/g, (c) => c.toLowerCase());

function withoutEmptyEnd(cells: readonly string[], least: number): string[] {
  let end = cells.length;
  while (end > least && cells[end - 1] === '') end -= 1;
  return cells.slice(0, end);
}

function separatorOf(text: string): string {
  let counts = SEPARATORS.map(() => 0);
  let [quoted, hasText] = [false, false];
  for (const c of text) {
    const i = SEPARATORS.indexOf(c as (typeof SEPARATORS)[number]);
    if (!quoted && c === '\n') {
      if (hasText) break;
      counts = SEPARATORS.map(() => 0);
    } else if (!quoted && i >= 0) counts[i]! += 1;
    else {
      if (c === '"') quoted = !quoted;
      if (trimmed(c) !== '') hasText = true;
    }
  }
  return SEPARATORS[counts.indexOf(Math.max(...counts))]!;
}

/** The lines that have a cell with text. */
function split(text: string, separator: string): { line: number; cells: string[] }[] | TableFault {
  const lines: { line: number; cells: string[] }[] = [];
  let row: string[] = [];
  let cell = '';
  let [line, began] = [1, 1];
  let quoted: number | null = null;
  const endCell = (): void => {
    row.push(trimmed(cell));
    cell = '';
  };
  for (let i = 0; i <= text.length; i++) {
    const c = text[i] ?? '\n';
    if (quoted !== null) {
      if (c === '\n') line += 1;
      if (c !== '"') cell += c;
      else if (text[i + 1] === '"') {
        cell += '"';
        i += 1;
      } else quoted = null;
    } else if (c === '"' && trimmed(cell) === '') {
      quoted = line;
      cell = '';
    } else if (c === separator) endCell();
    else if (c === '\n') {
      endCell();
      if (row.some((one) => one !== '')) lines.push({ line: began, cells: row });
      row = [];
      line += 1;
      began = line;
    } else cell += c;
  }
  return quoted === null ? lines : { kind: 'unclosed', line: quoted };
}
