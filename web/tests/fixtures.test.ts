// The contract from both sides: tests/it/page_fixtures.rs compares the keys of fixtures/*.json with those that the
// server writes, and here the page reads them. A key that the server renames fails before anybody opens a browser.
import { describe, expect, test } from 'vitest';
import { Stage } from '../src/floor/scene/scene';
import { explain } from '../src/jobs/jobform';
import { EMPTY, reduce } from '../src/wire/mirror';
import {
  JOB_KINDS,
  JOB_STATES,
  ACTIVITIES,
  parseMessage,
  type FloorMap,
  type JobPage,
  type Problem,
} from '../src/wire';
import { robot, snapshot, worker } from './samples';

const files = import.meta.glob<string>('../fixtures/*.json', { eager: true, query: '?raw', import: 'default' });
function read(name: string): string {
  const text = files[`../fixtures/${name}.json`];
  if (text === undefined) throw new Error(`there is no fixtures/${name}.json`);
  return text;
}
const json = <T>(name: string): T => JSON.parse(read(name)) as T;

describe('what the server writes', () => {
  test('the map is understood', () => {
    const map = json<FloorMap>('map');
    expect(Object.keys(map)).toEqual(
      expect.arrayContaining([
        'name',
        'bounds',
        'footprint_m',
        'nodes',
        'lanes',
        'stations',
        'racks',
        'obstacles',
        'walkable',
      ]),
    );
    for (const lane of map.lanes) expect(map.nodes[lane.from] && map.nodes[lane.to]).toBeDefined();
    for (const one of [...map.stations, ...map.racks]) expect(map.nodes[one.node]).toBeDefined();
    expect(() => new Stage(map)).not.toThrow();
  });

  test('a snapshot has every key that the page shows', () => {
    const message = parseMessage(read('snapshot'));
    if (message?.type !== 'snapshot') throw new Error('the fixture is no snapshot');
    expect(Object.keys(message)).toEqual(expect.arrayContaining(Object.keys(snapshot())));
    for (const key of ['jobs', 'counters'] as const) {
      expect(Object.keys(message[key])).toEqual(expect.arrayContaining(Object.keys(snapshot()[key])));
    }
    for (const r of message.robots) {
      expect(Object.keys(r)).toEqual(expect.arrayContaining(Object.keys(robot(''))));
      expect(ACTIVITIES).toContain(r.activity);
      expect(Date.parse(r.since!)).toBeGreaterThan(0);
    }
    expect(message.workers.length).toBeGreaterThan(0);
    for (const w of message.workers) expect(Object.keys(w)).toEqual(expect.arrayContaining(Object.keys(worker(''))));
  });

  test('a patch fits on the snapshot before it', () => {
    const first = parseMessage(read('snapshot'));
    const second = parseMessage(read('patch'));
    if (!first || second?.type !== 'patch') throw new Error('the fixtures are no snapshot and patch');
    const begun = reduce(EMPTY, first);
    if (begun.kind === 'gap') throw new Error('the first fixture is no snapshot');
    expect(reduce(begun.mirror, second).kind).toBe('patched');
  });

  test('jobs have kinds and states that the page has words for', () => {
    for (const job of json<JobPage>('jobs').items) {
      expect(JOB_KINDS).toContain(job.kind);
      expect(JOB_STATES).toContain(job.state);
    }
  });

  test('a problem ends up in words beside a field', () => {
    const told = explain(json<Problem>('problem'), 'deliver');
    expect(told.fields.rack ?? told.form).toMatch(/\w+ \w+/);
  });
});
