// The whole page from the two descriptions: what is where, every operation, every message, every schema.
import { byTag, nameOf, type Answer, type Description, type Messages, type Route, type Schema } from './description';
import { code, link, make, words } from './html';
import { body, table, told, typeOf } from './schema';

/** The schema of a body, and its media type where that is not JSON. */
function content(parts: Record<string, { schema?: Schema }> | undefined): (Node | string)[] {
  return Object.entries(parts ?? {}).flatMap(([media, one], i) => [
    ...(i > 0 ? [', or '] : []),
    ...typeOf(one.schema),
    ...(media === 'application/json' || media === 'application/problem+json' ? [] : [` as ${media}`]),
  ]);
}

function route({ method, path, operation }: Route): HTMLElement {
  const parts: Node[] = [
    make('h3', {}, make('span', { class: `method ${method}` }, method.toUpperCase()), ' ', code(path)),
    words(operation.summary ?? ''),
  ];
  if (operation.description && operation.description !== operation.summary) parts.push(words(operation.description));
  const parameters = operation.parameters ?? [];
  if (parameters.length > 0) {
    parts.push(make('h4', {}, 'Parameters'));
    const row = (p: (typeof parameters)[number]) => {
      const text = [p.description ?? '', told(p.schema)].filter(Boolean).join(' ');
      return [code(p.name), p.required ? p.in : `${p.in}, optional`, typeOf(p.schema), text];
    };
    parts.push(table(parameters.map(row)));
  }
  if (operation.requestBody)
    parts.push(make('h4', {}, 'Body'), make('p', {}, ...content(operation.requestBody.content)));
  parts.push(make('h4', {}, 'Answers'));
  const answer = ([status, one]: [string, Answer]) => [code(status), one.description, content(one.content)];
  parts.push(table(Object.entries(operation.responses).map(answer)));
  return make(
    'section',
    { class: 'route', id: operation.operationId, 'data-find': find(method, path, operation.summary) },
    ...parts,
  );
}

function find(...texts: (string | undefined)[]): string {
  return texts.join(' ').toLowerCase();
}

function channel(messages: Messages, name: string): HTMLElement {
  const { address, description } = messages.channels[name]!;
  const parts: Node[] = [
    make('h3', {}, make('span', { class: 'method' }, 'WS'), ' ', code(address)),
    words(description ?? ''),
  ];
  for (const operation of Object.values(messages.operations)) {
    if (nameOf(operation.channel.$ref) !== name) continue;
    parts.push(make('h4', {}, operation.action === 'send' ? 'The server sends' : 'The client sends'));
    for (const ref of operation.messages) {
      const message = messages.components.messages[nameOf(ref.$ref)]!;
      const known = message.payload.$ref ? messages.components.schemas[nameOf(message.payload.$ref)]! : message.payload;
      parts.push(
        make('details', {}, make('summary', {}, code(message.name), ' ', message.summary ?? ''), ...body(known)),
      );
    }
  }
  return make(
    'section',
    { class: 'route', id: `channel-${name}`, 'data-find': find('ws', address, description) },
    ...parts,
  );
}

function schemas(api: Description, messages: Messages): HTMLElement[] {
  const all = { ...messages.components.schemas, ...api.components.schemas };
  const one = ([name, schema]: [string, Schema]) =>
    make(
      'section',
      { class: 'schema', id: `schema-${name}`, 'data-find': find(name) },
      make('h3', {}, name),
      ...body(schema),
    );
  return Object.entries(all)
    .sort(([a], [b]) => a.localeCompare(b))
    .map(one);
}

/** Hides what does not have all words that are searched for. */
export function filter(host: ParentNode, text: string): void {
  const wanted = text.toLowerCase().split(/\s+/).filter(Boolean);
  for (const element of host.querySelectorAll<HTMLElement>('[data-find]')) {
    const here = element.dataset['find']!;
    element.hidden = !wanted.every((word) => here.includes(word));
  }
}

/** The page: its navigation, and its text. */
export function page(api: Description, messages: Messages): HTMLElement[] {
  const groups = byTag(api);
  const main = make(
    'main',
    {},
    make('h1', {}, `${api.info.title} ${api.info.version}: API`),
    words(api.info.description ?? ''),
    make(
      'p',
      {},
      link('/openapi.json', '/openapi.json'),
      ' (OpenAPI 3.1) and ',
      link('/asyncapi.json', '/asyncapi.json'),
      ' (AsyncAPI 3.0) are made for programs: generate a client from them.',
    ),
    ...groups.flatMap((g) => [make('h2', { id: `tag-${g.tag}` }, g.tag), words(g.description), ...g.routes.map(route)]),
    make('h2', { id: 'websockets' }, 'WebSockets'),
    words(messages.info.description ?? ''),
    ...Object.keys(messages.channels).map((name) => channel(messages, name)),
    make('h2', { id: 'schemas' }, 'Schemas'),
    ...schemas(api, messages),
  );
  const search = make('input', {
    type: 'search',
    placeholder: 'Search',
    'aria-label': 'Search operations and schemas',
  }) as HTMLInputElement;
  const item = (r: Route) =>
    make(
      'li',
      { 'data-find': find(r.method, r.path, r.operation.summary) },
      link(`#${r.operation.operationId}`, `${r.method.toUpperCase()} ${r.path}`),
    );
  const nav = make(
    'nav',
    { 'aria-label': 'Operations' },
    search,
    ...groups.flatMap((g) => [link(`#tag-${g.tag}`, g.tag), make('ul', {}, ...g.routes.map(item))]),
    link('#websockets', 'WebSockets'),
    make('ul', {}),
    link('#schemas', 'Schemas'),
  );
  search.addEventListener('input', () => {
    filter(nav, search.value);
    filter(main, search.value);
  });
  return [nav, main];
}
