// One format, two readers: the cases are those of the program's reader (src/floor/text/table.rs).
import { expect, test } from 'vitest';
import cases from '../fixtures/tables.json';
import { readTable } from '../src/jobs/table';

function read(text: string): unknown {
  const table = readTable(text);
  if ('kind' in table) {
    const { kind, ...rest } = table;
    return { fault: kind, ...rest };
  }
  return {
    columns: table.columns,
    rows: table.rows.map(({ surplus, ...row }) => (surplus === 0 ? row : { ...row, surplus })),
  };
}

test.each(cases)('the page reads $about as the program does', ({ text, read: wanted }) => {
  expect(read(text)).toEqual(wanted);
});
