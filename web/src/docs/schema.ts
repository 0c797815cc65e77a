// A schema in HTML: its type in a line, with links to named schemas, and its fields in a table.
import { nameOf, type Schema } from './description';
import { code, link, make, words, prose } from './html';

/** Bounds and examples of a value, in words. */
function bounds(schema: Schema): string {
  const parts: string[] = [];
  if (schema.minimum !== undefined && schema.maximum !== undefined)
    parts.push(`${schema.minimum} to ${schema.maximum}`);
  else if (schema.minimum !== undefined) parts.push(`${schema.minimum} or more`);
  else if (schema.maximum !== undefined) parts.push(`up to ${schema.maximum}`);
  if (schema.maxLength !== undefined)
    parts.push(`up to ${schema.maxLength} ${schema.maxLength === 1 ? 'character' : 'characters'}`);
  if (schema.maxItems !== undefined && schema.maxItems !== schema.minItems)
    parts.push(`up to ${schema.maxItems} ${schema.maxItems === 1 ? 'item' : 'items'}`);
  if (schema.example !== undefined) parts.push(`such as ${JSON.stringify(schema.example)}`);
  return parts.join('; ');
}

/** The type of a schema, in a line. */
export function typeOf(schema: Schema | boolean | undefined): (Node | string)[] {
  if (schema === undefined || typeof schema === 'boolean') return ['anything'];
  if (schema.$ref) return [link(`#schema-${nameOf(schema.$ref)}`, nameOf(schema.$ref))];
  const list = schema.oneOf ?? schema.anyOf;
  if (list) return list.flatMap((one, i) => [...(i > 0 ? [' or '] : []), ...typeOf(one)]);
  if (schema.allOf) return schema.allOf.flatMap((one, i) => [...(i > 0 ? [' and '] : []), ...typeOf(one)]);
  if (schema.enum) return schema.enum.flatMap((one, i) => [...(i > 0 ? [', '] : []), code(String(one))]);
  const types = [schema.type ?? 'anything'].flat();
  return types.flatMap((type, i): (Node | string)[] => {
    const before = i > 0 ? [' or '] : [];
    if (type !== 'array') return [...before, type];
    const length =
      schema.minItems !== undefined && schema.minItems === schema.maxItems ? `${schema.minItems} × ` : 'list of ';
    return [...before, length, ...typeOf(schema.items)];
  });
}

/** The fields of an object, those of all parts of an `allOf` among them. */
function fieldsOf(schema: Schema): { name: string; schema: Schema; required: boolean }[] {
  const own = Object.entries(schema.properties ?? {}).map(([name, field]) => ({
    name,
    schema: field,
    required: schema.required?.includes(name) ?? false,
  }));
  return [...own, ...(schema.allOf ?? []).flatMap(fieldsOf)];
}

/** What is known of a schema: its words, its type where it is no object, and its fields. */
export function body(schema: Schema): Node[] {
  const parts: Node[] = [];
  if (schema.description) parts.push(words(schema.description));
  const fields = fieldsOf(schema);
  if (fields.length === 0) parts.push(make('p', { class: 'type' }, ...typeOf(schema)));
  else {
    const based = (schema.allOf ?? []).filter((one) => one.$ref);
    if (based.length > 0)
      parts.push(make('p', {}, 'All of ', ...based.flatMap((one) => [...typeOf(one), ', ']), 'and:'));
    parts.push(table(fields.map((f) => [code(f.name), mark(f.required), typeOf(f.schema), told(f.schema)])));
  }
  return parts;
}

function mark(required: boolean): string {
  return required ? '' : 'optional';
}

/** Words and bounds of a field. */
export function told(schema: Schema | undefined): string {
  if (!schema) return '';
  const text = schema.description ?? '';
  const limits = bounds(schema);
  return limits ? `${text} (${limits})`.trim() : text;
}

type Cell = Node | string | (Node | string)[];

/** A table without a head: what the columns are can be seen. */
export function table(rows: Cell[][]): HTMLElement {
  const cells = (row: Cell[]): HTMLElement[] =>
    row.map((cell) =>
      make('td', {}, ...[cell].flat().flatMap((part) => (typeof part === 'string' ? prose(part) : [part]))),
    );
  return make('table', {}, make('tbody', {}, ...rows.map((row) => make('tr', {}, ...cells(row)))));
}
