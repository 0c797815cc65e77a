// The rooms of `src`: which one may know which, entered by which door; and how long files and lines may be. It reads the
// sources and runs none of them.
import { describe, expect, test } from 'vitest';

/** In reading order: a room names only rooms above it. */
const ROOMS = [
  'wire',
  'language',
  'words',
  'parts',
  'session',
  'replay',
  'floor',
  'cards',
  'why',
  'robots',
  'people',
  'places',
  'jobs',
  'encounters',
  'timelines',
  'charts',
  'report',
  'alarms',
  'audit',
  'page',
  'headset',
  'station',
  'docs',
  'editor',
];
/** The pages of a wearer, of a station and of the API, and the map editor load nothing of the dashboard. */
const HEADSET_KNOWS = ['wire', 'language', 'parts'];
const STATION_KNOWS = ['wire', 'language', 'parts'];
const DOCS_KNOWS = ['parts'];
const EDITOR_KNOWS = ['parts', 'session'];

type Sources = ReadonlyMap<string, string>;
const files = import.meta.glob<string>('../src/**/*.{ts,svelte}', { eager: true, query: '?raw', import: 'default' });

const IMPORT = /(?:from|import)\s*\(?\s*'(\.[^']+)'/g;
const roomOf = (path: string): string => (path.includes('/') ? path.split('/')[0]! : '');
const folderOf = (path: string): string => path.replace(/(^|\/)[^/]*$/, '');

/** What a file imports, as paths below `src`. */
function importsOf(sources: Sources, path: string): string[] {
  const found: string[] = [];
  for (const [, spec] of sources.get(path)!.matchAll(IMPORT)) {
    const plain = new URL(spec!, `file:///${path}`).pathname.slice(1);
    const file = [plain, `${plain}.ts`, `${plain}/index.ts`].find((one) => sources.has(one));
    if (file) found.push(file);
    else if (!/\.(css|json)$/.test(plain)) found.push(`${plain} (which is not there)`);
  }
  return found;
}

/** What is wrong with the rooms, a line each. */
function wrongs(sources: Sources): string[] {
  const wrong: string[] = [];
  for (const path of sources.keys()) {
    const room = roomOf(path);
    if (room !== '' && !ROOMS.includes(room))
      wrong.push(`${path}: ${room} is no room; say in tests/walls.test.ts where it stands`);
    for (const other of importsOf(sources, path)) {
      const to = roomOf(other);
      if (room === to) {
        if (other === `${room}/index.ts`) wrong.push(`${path} imports its own door; name the file behind it`);
        continue;
      }
      const [here, there] = [ROOMS.indexOf(room), ROOMS.indexOf(to)];
      if (room !== '' && there > here) wrong.push(`${path} imports ${other}: ${to} comes after ${room}`);
      if (room !== '' && there < 0) wrong.push(`${path} imports ${other}, which is in no room`);
      if (room === 'headset' && !HEADSET_KNOWS.includes(to))
        wrong.push(`${path} imports ${other}: the page of a wearer loads nothing of ${to}`);
      if (room === 'station' && !STATION_KNOWS.includes(to))
        wrong.push(`${path} imports ${other}: the page of a station loads nothing of ${to}`);
      if (room === 'docs' && !DOCS_KNOWS.includes(to))
        wrong.push(`${path} imports ${other}: the page of the API loads nothing of ${to}`);
      if (room === 'editor' && !EDITOR_KNOWS.includes(to))
        wrong.push(`${path} imports ${other}: the map editor loads nothing of ${to}`);
      const isDoor = other === `${to}/index.ts` || (other.endsWith('.svelte') && other.split('/').length === 2);
      if (!isDoor)
        wrong.push(`${path} imports ${other}, which is inside ${to}; its doors are index.ts and its components`);
    }
  }
  return [...wrong, ...circles(sources)];
}

/** Circles of imports between folders, those inside of a room among them. */
function circles(sources: Sources): string[] {
  const edges = new Map<string, Set<string>>();
  for (const path of sources.keys()) {
    const from = folderOf(path);
    for (const other of importsOf(sources, path)) {
      if (folderOf(other) !== from) edges.set(from, (edges.get(from) ?? new Set()).add(folderOf(other)));
    }
  }
  const reaches = (from: string, to: string, seen = new Set<string>()): boolean =>
    [...(edges.get(from) ?? [])].some((next) => next === to || (!seen.has(next) && reaches(next, to, seen.add(next))));
  return [...edges.keys()]
    .filter((folder) => reaches(folder, folder))
    .map((folder) => `${folder} imports itself in a circle`);
}

describe('the rooms of the page', () => {
  const sources = new Map(Object.entries(files).map(([path, text]) => [path.replace('../src/', ''), text]));
  const planted = (path: string, text: string): string[] =>
    wrongs(new Map(sources).set(path, text + (sources.get(path) ?? '')));

  test('imports go one way, and through doors', () => {
    expect(wrongs(sources)).toEqual([]);
  });
  test('every room is a folder with a door that says in two lines what it is', () => {
    for (const room of ROOMS)
      expect(sources.get(`${room}/index.ts`), room).toMatch(
        /^\/\/ [A-Z][^\n]*\n(\/\/ [^\n]*\n)?(export|import)|^(\/\/ [^\n]*\n){2}/,
      );
  });
  test('no file lies flat in src but the entry', () => {
    expect([...sources.keys()].filter((path) => !path.includes('/'))).toEqual(['main.ts']);
  });
  test('an import of a later room is found', () => {
    expect(planted('words/planted.ts', "import { Jobs } from '../jobs';\n")).toContain(
      'words/planted.ts imports jobs/index.ts: jobs comes after words',
    );
  });
  test('a circle between folders is found, inside of a room as well', () => {
    const found = planted('floor/scene/view.ts', "import type { Sheet } from '../paint/sheet';\n");
    expect(found).toEqual(['floor/paint imports itself in a circle', 'floor/scene imports itself in a circle']);
    expect(planted('wire/planted.ts', "import { count } from '../words';\n")).toContain(
      'wire imports itself in a circle',
    );
  });
  test('an import of what is inside another room is found', () => {
    expect(planted('jobs/planted.ts', "import { Stage } from '../floor/scene/scene';\n")).toEqual([
      'jobs/planted.ts imports floor/scene/scene.ts, which is inside floor; its doors are index.ts and its components',
    ]);
  });
  test('a panel that reaches for the bar is found', () => {
    expect(planted('jobs/JobsTable.svelte', "import TopBar from '../page/TopBar.svelte';\n")).toContain(
      'jobs/JobsTable.svelte imports page/TopBar.svelte: page comes after jobs',
    );
  });
  test('a part of the dashboard in the page of a wearer is found', () => {
    expect(planted('headset/planted.ts', "import { count } from '../words';\n")).toEqual([
      'headset/planted.ts imports words/index.ts: the page of a wearer loads nothing of words',
    ]);
  });
  test('a part of another page in the page of a station is found', () => {
    expect(planted('station/planted.ts', "import { signInAt } from '../session';\n")).toEqual([
      'station/planted.ts imports session/index.ts: the page of a station loads nothing of session',
    ]);
  });
});

/** What is written by hand: lines have at most so many characters, and files so many lines. Prettier breaks what it can. */
const [MOST_CHARACTERS, MOST_LINES] = [120, 600];
const written = import.meta.glob<string>(
  ['../*.{ts,js,html}', '../{src,tests,dev}/**/*.{ts,mts,svelte,css,mjs,html}'],
  {
    eager: true,
    query: '?raw',
    import: 'default',
  },
);

/** What is too long, each with its file and line. */
function tooLong(sources: Sources): string[] {
  return [...sources].flatMap(([path, text]) => {
    const lines = text.split('\n');
    const wide = lines.flatMap((line, i) =>
      [...line].length > MOST_CHARACTERS ? [`${path}:${i + 1} is too wide`] : [],
    );
    return lines.length > MOST_LINES + 1 ? [...wide, `${path} has more than ${MOST_LINES} lines`] : wide;
  });
}

/** The files that ask this device for the date: the server's times are compared with the floor's, of `wire/now.ts`. */
const datesOf = (sources: Sources): string[] =>
  [...sources].flatMap(([path, text]) => (/Date\.now\(\)|new Date\(\)/.test(text) ? [path] : []));

describe('the date', () => {
  test('is asked of this device in one file', () => {
    expect(datesOf(new Map(Object.entries(files)))).toEqual(['../src/wire/now.ts']);
  });
  test('is found where another file asks for it', () => {
    expect(datesOf(new Map([['src/a.ts', 'const late = due < Date.now();']]))).toEqual(['src/a.ts']);
  });
});

describe('what is written by hand', () => {
  test('no line is wider than it may be, and no file longer', () => {
    const sources = new Map(Object.entries(written));
    expect(sources.size).toBeGreaterThan(300);
    for (const path of ['../src/app.css', '../src/page/App.svelte', './map.mjs', '../dev/mock.mjs', '../index.html'])
      expect(sources.get(path)?.length, path).toBeGreaterThan(0);
    expect(tooLong(sources)).toEqual([]);
  });
  test('a wide line and a long file are found, wherever they are', () => {
    const wide = `${'x'.repeat(MOST_CHARACTERS)}\n${'x'.repeat(MOST_CHARACTERS + 1)}\n`;
    expect(tooLong(new Map([['tests/wide.mjs', wide]]))).toEqual(['tests/wide.mjs:2 is too wide']);
    expect(tooLong(new Map([['src/long.css', 'x\n'.repeat(MOST_LINES)]]))).toEqual([]);
    expect(tooLong(new Map([['src/long.css', 'x\n'.repeat(MOST_LINES + 1)]]))).toEqual([
      'src/long.css has more than 600 lines',
    ]);
  });
});
