// The messages of the pages: every language has them all, with the same placeholders; calls give what they need; and
// what is seen on a page in several languages stands in its messages, not in its source. It reads the sources and runs
// none of them.
import { parse as parseMessage, type MessageFormatElement } from '@formatjs/icu-messageformat-parser';
import { parse as parseSvelte } from 'svelte/compiler';
import ts from 'typescript';
import { describe, expect, test } from 'vitest';
import { LANGUAGES, languageFor, metres, sayIn, seconds } from '../src/language';

/** Rooms that speak English alone; every visible text of the others is a message. */
const ENGLISH = ['editor', 'docs'];
/** Messages stand in one room and are said in others, too: the dashboard's in all but those that load nothing of it. */
const isSaidIn = (messages: string, room: string): boolean =>
  messages === room || (messages === 'words' && !['headset', 'station', 'docs', 'editor', 'language'].includes(room));
/** What is the same in every language: names, examples, and signs. */
const NAMES = ['picker-7', 'Giveway', 'VDA 5050', 'CSV', 'JSON'];

const files = import.meta.glob<string>('../src/**/messages/*.json', { eager: true, query: '?raw', import: 'default' });
const sources = import.meta.glob<string>('../src/**/*.{ts,svelte}', { eager: true, query: '?raw', import: 'default' });
const roomOf = (path: string): string => path.split('/')[2] ?? '';

type Texts = Record<string, string>;
const rooms = new Map<string, Map<string, Texts>>();
for (const [path, text] of Object.entries(files)) {
  const language = path.replace(/^.*\//, '').replace('.json', '');
  const room = rooms.get(roomOf(path)) ?? new Map<string, Texts>();
  // A room may have more messages than those that its page begins with.
  rooms.set(roomOf(path), room.set(language, { ...room.get(language), ...(JSON.parse(text) as Texts) }));
}

/** The placeholders of a message. */
function placeholders(tree: readonly MessageFormatElement[], found = new Set<string>()): Set<string> {
  for (const part of tree) {
    if (part.type === 0 || part.type === 7) continue;
    found.add(part.value);
    if ('options' in part && part.options)
      for (const { value } of Object.values(part.options)) placeholders(value, found);
  }
  return found;
}
const wanted = (text: string): string[] => [...placeholders(parseMessage(text))].sort();

/** How the messages of a language differ from the English ones, a line each. */
function differences(english: Texts, other: Texts): string[] {
  const wrong: string[] = [];
  for (const key of new Set([...Object.keys(english), ...Object.keys(other)])) {
    const [a, b] = [english[key], other[key]];
    if (b === undefined) wrong.push(`${key} is missing`);
    else if (a === undefined) wrong.push(`${key} is not in English`);
    else if (b.trim() === '') wrong.push(`${key} is empty`);
    else if (wanted(a).join() !== wanted(b).join())
      wrong.push(`${key} has {${wanted(b).join()}} instead of {${wanted(a).join()}}`);
  }
  return wrong;
}

/** The plural forms of a message that its language asks for and the message lacks, such as Spanish `many`. */
function pluralsMissing(language: string, tree: readonly MessageFormatElement[]): string[] {
  return tree.flatMap((part) => {
    if (!('options' in part) || !part.options) return [];
    const inner = Object.values(part.options).flatMap(({ value }) => pluralsMissing(language, value));
    if (part.type !== 6) return inner;
    // `many` of Spanish is for millions, and reads as `other` does.
    const forms = new Intl.PluralRules(language).resolvedOptions().pluralCategories.filter((form) => form !== 'many');
    return [...inner, ...forms.filter((form) => !(form in part.options))];
  });
}

/** Keys of messages, which scripts hand on to where they are said. */
const keys = new Set([...rooms.values()].flatMap((languages) => Object.keys(languages.get('en') ?? {})));
const isWord = (text: string): boolean =>
  /\p{L}{2}/u.test(NAMES.reduce((rest, name) => rest.replaceAll(name, ''), text));
const SEEN = [
  'aria-label',
  'aria-description',
  'aria-roledescription',
  'aria-valuetext',
  'title',
  'placeholder',
  'alt',
  'label',
  'hint',
  'prompt',
];

/** Texts that an expression in a component can come to; what it compares with or hands on to a function is none. */
function textsOf(node: Record<string, unknown> | null | undefined): string[] {
  const all = (...names: string[]): string[] =>
    names.flatMap((name) => textsOf(node?.[name] as Record<string, unknown>));
  switch (node?.['type']) {
    case 'Literal':
      return typeof node['value'] === 'string' ? [node['value']] : [];
    case 'TemplateLiteral':
      return [
        ...(node['quasis'] as { value: { cooked: string } }[]).map((quasi) => quasi.value.cooked),
        ...(node['expressions'] as Record<string, unknown>[]).flatMap(textsOf),
      ];
    case 'ConditionalExpression':
      return all('consequent', 'alternate');
    case 'LogicalExpression':
      return all('left', 'right');
    case 'BinaryExpression':
      return node['operator'] === '+' ? all('left', 'right') : [];
    case 'TSAsExpression':
    case 'TSNonNullExpression':
      return all('expression');
    default:
      return [];
  }
}

/** Texts in a Svelte component that a visitor sees or hears. */
function hardCodedInSvelte(source: string): string[] {
  const found: string[] = [];
  const walk = (node: unknown): void => {
    if (Array.isArray(node)) return node.forEach(walk);
    if (typeof node !== 'object' || node === null) return;
    const { type, name, value, data, expression } = node as Record<string, unknown>;
    if (type === 'Text' && typeof data === 'string' && isWord(data)) found.push(data.trim());
    if (type === 'ExpressionTag')
      found.push(
        ...textsOf(expression as Record<string, unknown>)
          .filter(isWord)
          .map((text) => text.trim()),
      );
    if (type === 'Attribute' || type === 'StyleDirective') {
      if (!SEEN.includes(String(name))) return;
      return walk(value);
    }
    Object.values(node).forEach(walk);
  };
  walk(parseSvelte(source, { modern: true }).fragment);
  const scripts = [...source.matchAll(/<script[^>]*>(.*?)<\/script>/gs)].map(([, script]) => script ?? '');
  return [...found, ...scripts.flatMap(hardCodedInScript)];
}

/** Texts in a script that go to an element that a visitor sees or hears, and whole sentences wherever they go. */
function hardCodedInScript(source: string): string[] {
  const found: string[] = [];
  const seen = ['textContent', 'ariaLabel', 'placeholder', 'title', 'alt', 'innerText', 'label', 'prompt', 'words'];
  const textOf = (node: ts.Node): string => {
    if (ts.isStringLiteralLike(node)) return node.text;
    return ts.isTemplateExpression(node)
      ? [node.head, ...node.templateSpans.map((s) => s.literal)].map((p) => p.text).join(' ')
      : '';
  };
  const isCallOfT = (node: ts.Node): node is ts.CallExpression =>
    ts.isCallExpression(node) && ts.isIdentifier(node.expression) && node.expression.text === 't';
  const targetOf = (node: ts.Node): string | null => {
    if (ts.isPropertyAssignment(node)) return node.name.getText();
    return ts.isBinaryExpression(node) && ts.isPropertyAccessExpression(node.left) ? node.left.name.text : null;
  };
  const walk = (node: ts.Node, isShown: boolean): void => {
    // What a programmer did wrong is told to programmers.
    if (ts.isThrowStatement(node) || ts.isImportDeclaration(node) || ts.isLiteralTypeNode(node)) return;
    if (isCallOfT(node)) return node.arguments.slice(1).forEach((one) => walk(one, false));
    const text = textOf(node);
    if ((isShown && !keys.has(text) && isWord(text)) || /^\p{Lu}\p{Ll}+ \p{Ll}/u.test(text)) found.push(text);
    const target = targetOf(node);
    const goesOn = isShown && !ts.isCallExpression(node) && !ts.isBinaryExpression(node);
    ts.forEachChild(node, (child) => walk(child, target === null ? goesOn : seen.includes(target)));
  };
  walk(ts.createSourceFile('x.ts', source, ts.ScriptTarget.Latest, true), false);
  return found;
}

/** Calls of `t` in a script: the key, and the values that are given; no key where it is made up at run time. */
function callsIn(source: string): { key: string | null; values: string[] | null }[] {
  const found: { key: string | null; values: string[] | null }[] = [];
  const walk = (node: ts.Node): void => {
    if (ts.isCallExpression(node) && ts.isIdentifier(node.expression) && node.expression.text === 't') {
      const [key, values] = node.arguments;
      const given =
        values && ts.isObjectLiteralExpression(values) ? values.properties.map((p) => p.name?.getText() ?? '') : [];
      const keys = key && ts.isConditionalExpression(key) ? [key.whenTrue, key.whenFalse] : [key];
      const isKnown = !values || ts.isObjectLiteralExpression(values);
      for (const one of keys)
        found.push({
          key: one && ts.isStringLiteralLike(one) ? one.text : null,
          values: isKnown ? given.sort() : null,
        });
    }
    ts.forEachChild(node, walk);
  };
  walk(ts.createSourceFile('x.ts', source, ts.ScriptTarget.Latest, true));
  return found;
}
/** The scripts of a component, and what stands in braces, as one script. */
const scriptOf = (path: string, source: string): string =>
  path.endsWith('.ts')
    ? source
    : [...source.matchAll(/\bt\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)/g)].map(([call]) => call).join(';\n');

describe.each([...rooms])('the messages of %s', (room, languages) => {
  const english = languages.get('en') ?? {};
  const own = Object.entries(sources).filter(([path]) => isSaidIn(room, roomOf(path)));
  test('there is one file for each language', () => {
    expect([...languages.keys()].sort()).toEqual(Object.keys(LANGUAGES).sort());
  });
  test.each([...languages])('%s has every message with its placeholders and plurals', (language, texts) => {
    expect(differences(english, texts)).toEqual([]);
    const plurals = Object.entries(texts).flatMap(([key, text]) =>
      pluralsMissing(language, parseMessage(text)).map((form) => `${key} lacks ${form}`),
    );
    expect(plurals).toEqual([]);
  });
  test('each call gives what its message needs', () => {
    const wrong = own.flatMap(([path, source]) =>
      callsIn(scriptOf(path, source)).flatMap(({ key, values }) => {
        const text = key === null ? undefined : english[key];
        if (text === undefined || values === null) return [];
        return wanted(text).join() === values.join()
          ? []
          : [`${path}: ${key} needs {${wanted(text).join()}}, not {${values.join()}}`];
      }),
    );
    expect(wrong).toEqual([]);
  });
  test('each message is used', () => {
    const all = own.map(([, source]) => source).join('\n');
    const made = [...all.matchAll(/`([^`$]*)\$\{[^}]*\}([^`$]*)`/g)]
      .map(([, before, after]) => [before ?? '', after ?? ''] as const)
      .filter(([before, after]) => /\w\.$/.test(before) || /^\.\w/.test(after));
    const isMade = (key: string): boolean =>
      made.some(([before, after]) => key.startsWith(before) && key.endsWith(after));
    expect(Object.keys(english).filter((key) => !all.includes(`'${key}'`) && !isMade(key))).toEqual([]);
  });
});

/** The sources that a page loads at first: what its script imports, and what that imports; but no types, and nothing
 *  that is fetched when it is needed. */
function loadedWith(path: string, found = new Set<string>()): ReadonlySet<string> {
  const source = sources[path];
  if (source === undefined || found.has(path)) return found;
  found.add(path);
  for (const [, names, from] of source.matchAll(/^\s*(?:import|export) (?!type\b)([^;]*?)from '(\.[^']*)';/gm)) {
    if (
      /^\{[^}]*\} $/.test(names!) &&
      names!
        .replace(/[{}]/g, '')
        .split(',')
        .every((name) => /^\s*type\b|^\s*$/.test(name))
    )
      continue;
    const at = new URL(from!, `http://h/${path.replace('../', '')}`).pathname.replace(/^\//, '../');
    for (const one of [at, `${at}.ts`, `${at}/index.ts`]) loadedWith(one, found);
  }
  return found;
}
test('messages that are fetched later are said by nothing that the dashboard loads at first', () => {
  const ofPanels = Object.keys(JSON.parse(files['../src/words/panels/messages/en.json'] ?? '{}') as Texts);
  const early = loadedWith('../src/main.ts');
  expect(early.has('../src/jobs/JobsTable.svelte') && early.has('../src/floor/Floor.svelte')).toBe(true);
  expect(early.has('../src/page/PickedCard.svelte')).toBe(false);
  expect(ofPanels.length).toBeGreaterThan(0);
  expect(
    ofPanels.flatMap((key) =>
      [...early].filter((path) => sources[path]!.includes(`'${key}'`)).map((path) => `${key}: ${path}`),
    ),
  ).toEqual([]);
});

describe('visible texts', () => {
  const translated = [...new Set(Object.keys(sources).map(roomOf))].filter((room) => !ENGLISH.includes(room));
  test.each(translated)('all of %s are messages', (room) => {
    const own = Object.entries(sources).filter(([path]) => roomOf(path) === room);
    const found = own.flatMap(([path, source]) =>
      (path.endsWith('.svelte') ? hardCodedInSvelte(source) : hardCodedInScript(source)).map(
        (text) => `${path}: ${text}`,
      ),
    );
    expect(own.length).toBeGreaterThan(0);
    expect(found).toEqual([]);
  });
  test('a number of things is no number before a plural', () => {
    const counts = Object.entries(sources).flatMap(([path, source]) =>
      [...source.matchAll(/\{[^{}]*\.length\}\s+[a-z]+s\b/g)].map(([text]) => `${path}: ${text}`),
    );
    expect(counts).toEqual([]);
  });
  test('a text in a component is found, wherever a visitor meets it', () => {
    expect(hardCodedInSvelte('<p class="dim text">Robots <b>wait</b></p>')).toEqual(['Robots', 'wait']);
    expect(hardCodedInSvelte('<button title="Stop all" aria-label={t("x")}>{t("stop")} · Giveway</button>')).toEqual([
      'Stop all',
    ]);
    expect(hardCodedInSvelte('{#if a}<input placeholder="picker-7" type="text" />{:else}<i>none</i>{/if}')).toEqual([
      'none',
    ]);
  });
  test('a text that an expression of a component comes to is found', () => {
    expect(hardCodedInSvelte("<p>{busy ? 'Closing' : t('closure.close')}</p>")).toEqual(['Closing']);
    expect(hardCodedInSvelte("<b title={`${n} robots`}>{kind === 'robot' ? '–' : n}</b>")).toEqual(['robots']);
    expect(
      hardCodedInSvelte("<i data-kind={a ? 'worker' : 'robot'}>{quantity(n, 'min')}{t(a ? 'robot' : 'job')}</i>"),
    ).toEqual([]);
    expect(hardCodedInSvelte('<script lang="ts">\n  wrong = \'Say who you are.\';\n</script>\n<p>{wrong}</p>')).toEqual(
      ['Say who you are.'],
    );
  });
  test('a text in a script is found', () => {
    expect(hardCodedInScript("make('p', { className: 'dim small', textContent: 'Robots' })")).toEqual(['Robots']);
    expect(hardCodedInScript("x.textContent = a ? t('b') : `Mark ${n}`")).toEqual(['Mark  ']);
    expect(hardCodedInScript("const title = 'The path is over there';")).toEqual(['The path is over there']);
    expect(
      hardCodedInScript(
        "make('p', { textContent: t('sheet.mark', { name: 'A' }) }); throw new Error('This is not seen');",
      ),
    ).toEqual([]);
  });
  test('a missing message, another placeholder and a missing plural are found', () => {
    expect(differences({ a: 'x {n}', b: 'y' }, { a: 'x {m}', c: 'z' })).toEqual([
      'a has {m} instead of {n}',
      'b is missing',
      'c is not in English',
    ]);
    expect(pluralsMissing('de', parseMessage('{n, plural, other {#}}'))).toEqual(['one']);
    expect(callsIn("t(a ? 'x' : 'y', { n: 1 })")).toEqual([
      { key: 'x', values: ['n'] },
      { key: 'y', values: ['n'] },
    ]);
  });
});

describe('a count of one', () => {
  const one = (language: keyof typeof LANGUAGES, key: string, values: Record<string, number>): string =>
    sayIn<string>(language, { m: parseMessage(rooms.get('words')?.get(language)?.[key] ?? '') })('m', values);
  test('has its own verb, and its own noun', () => {
    const jobs = { waiting: 1, done: 1, cancelled: 1, failed: 1 };
    expect(one('en', 'jobs.then.counts', jobs)).toBe('1 waited for a robot, 1 was done, 1 cancelled, 1 failed');
    expect(one('de', 'jobs.then.counts', jobs)).toBe(
      '1 wartete auf einen Roboter, 1 war erledigt, 1 abgebrochen, 1 gescheitert',
    );
    expect(one('es', 'jobs.then.counts', jobs)).toBe('1 esperaba un robot, 1 estaba hecho, 1 cancelado, 1 fallido');
    expect(one('en', 'csv.cells', { cells: 2, columns: 1 })).toBe('2 cells, but 1 column.');
    expect(one('de', 'robots.more', { count: 1 })).toBe('1 weiteren zeigen');
  });
});

describe('languages', () => {
  test('the first one that is wanted and there is', () => {
    expect(languageFor(['fr-CH', 'de-AT', 'en'])).toBe('de');
    expect(languageFor(['zh-Hant-TW'])).toBe('zh');
    expect(languageFor(['eo', ''])).toBe('en');
  });
  test('plurals and units are those of the language', () => {
    const say = (language: keyof typeof LANGUAGES, count: number): string =>
      sayIn<string>(language, { m: parseMessage(rooms.get('headset')?.get(language)?.['sheet.count'] ?? '') })('m', {
        count,
      });
    expect([say('en', 1), say('en', 2)]).toEqual(['1 mark, on one sheet.', '2 marks, each on its own sheet.']);
    expect([say('de', 1), say('de', 1200)]).toEqual([
      '1 Marke auf einem Blatt.',
      '1.200 Marken, jede auf einem eigenen Blatt.',
    ]);
    expect(say('zh', 3)).toBe('3 个标记，每个一张纸。');
    expect((['en', 'de', 'es', 'zh'] as const).map((one) => metres(one, 4.25))).toEqual([
      '4.3 m',
      '4,3 m',
      '4,3 m',
      '4.3米',
    ]);
    expect(metres('de', 0.5)).toBe('50 cm');
    expect((['en', 'de', 'es', 'zh'] as const).map((one) => seconds(one, 12))).toEqual([
      '12 sec',
      '12 Sek.',
      '12 s',
      '12秒',
    ]);
  });
});
