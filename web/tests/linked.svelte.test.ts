// Robots of other vendors on the page: their card with what can be done, their messages, and those that have not
// joined.
import { flushSync, mount, unmount, type Component } from 'svelte';
import { afterEach, describe, expect, test, vi } from 'vitest';
import type { Drawing } from '../src/floor';
import { Notices } from '../src/parts/notices.svelte';
import { actionOf, laidOut, nameFor, newestFirst } from '../src/robots/linked';
import Life from '../src/robots/Life.svelte';
import LinkedCard from '../src/robots/LinkedCard.svelte';
import NotOnFloor from '../src/robots/NotOnFloor.svelte';
import { learnRights, type Me } from '../src/session';
import {
  ACTS,
  Api,
  type ActionFate,
  type LinkedRobot,
  type NoticedOfRobot,
  type RobotDetail,
  type SaidError,
  type SaidMessage,
  type SaidState,
  type UnlistedRobot,
} from '../src/wire';

const AT = '2027-01-31T06:00:00Z';
const state: SaidState = {
  at: AT,
  mode: 'MANUAL',
  e_stop: 'AUTOACK',
  field_violation: true,
  paused: true,
  last_node: 'G4-7',
  charge: 0.42,
  charging: true,
  loads: ['K1'],
  errors: [{ level: 'FATAL', kind: 'orderError', words: 'node G9-9 is unknown' }],
  wants_base: false,
};
const noticed = (words: string, is_false_claim = false): NoticedOfRobot => ({
  at: AT,
  said: { text: words },
  is_false_claim,
});
const linked = (id: string, more: Partial<LinkedRobot> = {}): LinkedRobot => ({
  id,
  manufacturer: 'acme',
  serial: '0001',
  kind: 'tug',
  version: '2.1.0',
  joined: true,
  not_ready: null,
  needs_consent: false,
  failed: null,
  needs_care: false,
  order: 'no order',
  said: state,
  noticed: [],
  false_claims: 0,
  longest_base_m: 4,
  figures: [],
  contradictions: [],
  ...more,
});
const stranger: UnlistedRobot = {
  manufacturer: 'acme',
  serial: 'tug 7/b',
  version: 'v2',
  heard: AT,
  connection: 'ONLINE',
};
const message = (topic: string, to_robot: boolean, text = '{"a":1}'): SaidMessage => ({
  at: AT,
  to_robot,
  topic,
  text,
});

/** An API whose answers are made by method and path; what none was made for is refused with 404. */
function apiOf(answers: Record<string, (body: unknown) => unknown>) {
  const asked: [string, unknown][] = [];
  vi.stubGlobal('fetch', (path: string, { method, body }: { method: string; body?: string }) => {
    const [what, sent] = [`${method} ${path}`, body === undefined ? null : (JSON.parse(body) as unknown)];
    asked.push([what, sent]);
    const value = answers[what]?.(sent);
    const type = { headers: { 'content-type': 'application/json' } };
    if (value === undefined)
      return Promise.resolve(new Response('{"title":"There is no such link"}', { ...type, status: 404 }));
    if (value === null) return Promise.resolve(new Response(null, { status: 204 }));
    return Promise.resolve(new Response(JSON.stringify(value), { ...type, status: 200 }));
  });
  const sent = (what: string): unknown[] => asked.filter(([one]) => one === what).map(([, body]) => body);
  return { api: new Api(), asked, sent };
}
async function signedInAs(role: Me['role'], may: Me['may'] = ACTS): Promise<void> {
  await learnRights(() => Promise.resolve({ name: 'Eva', role, subject: null, by: 'session', expires: null, may }));
}
const open: (() => void)[] = [];
function shown<Props extends Record<string, unknown>>(component: Component<Props>, props: Props) {
  const target = document.createElement('div');
  document.body.append(target);
  const mounted = mount(component, { target, props });
  open.push(() => {
    void unmount(mounted);
    target.remove();
  });
  flushSync();
  const button = (name: string): HTMLButtonElement | undefined =>
    [...target.querySelectorAll('button')].find((one) => one.textContent?.trim() === name);
  const text = (): string => (target.textContent ?? '').replace(/\s+/g, ' ');
  return { target, button, text };
}
afterEach(async () => {
  open.splice(0).forEach((close) => close());
  vi.unstubAllGlobals();
  await signedInAs('admin');
});

function card(robot: LinkedRobot, answers: Record<string, (body: unknown) => unknown> = {}) {
  const made = apiOf({ [`GET /v1/robots/${robot.id}/link`]: () => robot, ...answers });
  const drawings: Drawing[] = [];
  const notices = new Notices();
  const onDraw = (drawing: Drawing): void => {
    drawings.push(drawing);
  };
  return { ...made, drawings, notices, ...shown(LinkedCard, { id: robot.id, api: made.api.linked, notices, onDraw }) };
}

describe('the card of a robot of another vendor', () => {
  test('says why the robot is not ready, before all else, and every figure of its last state', async () => {
    const { target, text } = card(
      linked('tug-1', {
        not_ready: { text: 'its operating mode is Manual, not automatic' },
        false_claims: 2,
        longest_base_m: 1.5,
        noticed: [noticed('refuses an order: full'), noticed('says that pick is finished, and carries nothing', true)],
        contradictions: ['speed 1.0 m/s in the factsheet, 1.2 m/s in its kind'],
      }),
    );
    await expect.poll(text).toContain('Not ready: its operating mode is Manual, not automatic');
    expect(target.querySelector('[data-linked] > h3 + *')?.hasAttribute('data-not-ready')).toBe(true);
    const facts = [...target.querySelectorAll('dl > div')].map((one) => one.textContent?.replace(/\s+/g, ' ').trim());
    expect(facts).toEqual([
      'Manufacturer acme',
      'Serial number 0001',
      'Version 2.1.0',
      'Order no order',
      'Operating mode manual, paused',
      'Emergency stop active, ends by itself',
      'Protective field something is in it',
      'Charge 42 %, charging',
      'Loads K1',
      'Last node G4-7',
      'False claims 2',
      'Released at most 1.5 m',
    ]);
    expect(target.querySelector('[data-level="FATAL"]')?.textContent).toMatch(
      /fatal\s*orderError: node G9-9 is unknown/,
    );
    const seen = [...target.querySelectorAll('[data-false-claim]')];
    expect(seen.map((one) => one.getAttribute('data-false-claim'))).toEqual(['true', 'false']);
    expect(seen[0]?.textContent).toMatch(/false claim\s*says that pick is finished/);
    expect(text()).toContain('speed 1.0 m/s in the factsheet');
  });
  test('of a robot that has said nothing, names what is not known', async () => {
    const { text } = card(linked('tug-1', { said: null, not_ready: { text: 'it was never heard of' }, joined: false }));
    await expect.poll(text).toContain('It has said nothing yet.');
    expect(text()).not.toContain('Operating mode');
  });
  test('agrees that a robot drives without pausing only after a question, and only where that is needed', async () => {
    const put = 'PUT /v1/robots/tug-1/consent';
    const without = card(linked('tug-1'));
    await expect.poll(without.text).toContain('Released at most');
    expect(without.button('Agree that it drives without pausing')).toBeUndefined();
    const { button, target, sent, notices } = card(linked('tug-1', { needs_consent: true }), { [put]: () => null });
    await expect.poll(() => button('Agree that it drives without pausing')).toBeDefined();
    button('Agree that it drives without pausing')!.click();
    flushSync();
    const dialog = target.querySelector('dialog')!;
    expect(dialog.open).toBe(true);
    expect(dialog.textContent).toContain('to no lane that a person can reach before it stands');
    expect(sent(put)).toEqual([]);
    dialog.querySelector<HTMLButtonElement>('button.main')!.click();
    await expect.poll(() => sent(put)).toHaveLength(1);
    await expect.poll(() => notices.notice?.words ?? '').toContain('tug-1');
    expect(notices.notice?.undo).toBeNull();
  });
  test("says where each figure of the robot's kind comes from", async () => {
    const figures = [
      { figure: 'speed', value: '1.2 m/s', origin: 'file' },
      { figure: 'outline', value: '0.9 × 0.5 m', origin: 'factsheet' },
      { figure: 'payload', value: '-', origin: 'default' },
    ] as const;
    const { text } = card(linked('tug-1', { figures: [...figures] }));
    await expect.poll(text).toContain('Speed 1.2 m/s from its file');
    expect(text()).toContain('Outline 0.9 × 0.5 m from its factsheet');
    expect(text()).toContain('Payload - assumed');
  });
  test('says that a robot was looked after where an action failed, and tells what the server refuses', async () => {
    const { button, text, sent } = card(linked('tug-1', { failed: 'pick: no load found', needs_care: true }));
    await expect.poll(text).toContain('It waits for a person: pick: no load found');
    button('It was looked after')!.click();
    await expect.poll(() => sent('POST /v1/robots/tug-1/settled')).toHaveLength(1);
    await expect.poll(text).toContain('There is no such link');
  });
  test('sends an action with its parameters, and shows its fate until it is over', async () => {
    const fate = 'GET /v1/robots/tug-1/actions/gw-1';
    const fates: ActionFate[] = ['RUNNING', 'FINISHED'].map((status) => ({
      id: 'gw-1',
      kind: 'logReport',
      sent: AT,
      status,
      result: status === 'FINISHED' ? 'log 7' : null,
    }));
    const { button, target, sent } = card(linked('tug-1'), {
      'POST /v1/robots/tug-1/actions': () => ({ action: 'gw-1' }),
      [fate]: () => fates.shift(),
    });
    await expect.poll(() => button('Send an action')).toBeDefined();
    button('Send an action')!.click();
    flushSync();
    const [type, parameters] = [...target.querySelectorAll('input')];
    const write = (field: HTMLInputElement | undefined, text: string): void => {
      field!.value = text;
      field!.dispatchEvent(new Event('input', { bubbles: true }));
    };
    write(type, 'logReport');
    write(parameters, '{"reason": "shift"');
    button('Send')!.click();
    flushSync();
    expect(target.querySelector('form [role="alert"]')?.textContent).toContain('as a JSON object');
    expect(sent('POST /v1/robots/tug-1/actions')).toEqual([]);
    write(parameters, '{"reason": "shift"}');
    button('Send')!.click();
    await expect
      .poll(() => sent('POST /v1/robots/tug-1/actions'))
      .toEqual([{ type: 'logReport', parameters: { reason: 'shift' } }]);
    const status = (): string | null | undefined =>
      target.querySelector('[data-action="logReport"]')?.getAttribute('data-status');
    await expect.poll(status).toBe('RUNNING');
    await expect.poll(status, { timeout: 10_000 }).toBe('FINISHED');
    expect(target.querySelector('[data-action]')?.textContent).toContain('logReport: finished (log 7)');
    expect(sent(fate)).toHaveLength(2);
  });
  test('tells a robot where it stands, by a place and a direction that are drawn on the map', async () => {
    const { button, drawings, sent } = card(linked('tug-1'), {
      'POST /v1/robots/tug-1/actions': () => ({ action: 'gw-2' }),
    });
    await expect.poll(() => button('Tell it where it stands')).toBeDefined();
    button('Tell it where it stands')!.click();
    expect(drawings[0]).toMatchObject({ kind: 'pose' });
    expect(drawings[0]!.prompt).toContain('tug-1');
    drawings[0]!.onDone([
      [4, 2],
      [4, 1],
    ]);
    await expect
      .poll(() => sent('POST /v1/robots/tug-1/actions'))
      .toEqual([{ type: 'initPosition', place: { x: 4, y: 2, theta: -Math.PI / 2 } }]);
  });
  test('offers what somebody may do, and messages to administrators alone', async () => {
    await signedInAs('viewer', []);
    const viewer = card(linked('tug-1', { failed: 'pick', needs_care: true, needs_consent: true }));
    await expect.poll(viewer.text).toContain('Released at most');
    const names = [...viewer.target.querySelectorAll('[data-linked] > div button, [data-linked] > button')];
    expect(names.map((one) => one.textContent)).toEqual([]);
    await signedInAs('operator', ['send_robot_action', 'settle_robot']);
    const operator = card(linked('tug-1', { failed: 'pick', needs_care: true, needs_consent: true }));
    await expect.poll(() => operator.button('It was looked after')).toBeDefined();
    expect(operator.button('Send an action')).toBeDefined();
    expect(operator.button('Agree that it drives without pausing')).toBeUndefined();
    expect(operator.button('Messages')).toBeUndefined();
  });
  test('shows messages with the newest first, each with its way, and its text when it is opened', async () => {
    const { button, target } = card(linked('tug-1'), {
      'GET /v1/robots/tug-1/messages': () => ({ messages: [message('state', false), message('order', true)] }),
    });
    await expect.poll(() => button('Messages')).toBeDefined();
    button('Messages')!.click();
    const lines = (): (string | null)[] =>
      [...target.querySelectorAll('li[data-topic]')].map(
        (one) => `${one.getAttribute('data-topic')} ${one.getAttribute('data-way') ?? ''}`,
      );
    await expect.poll(lines).toEqual(['order to', 'state from']);
    expect(target.querySelector('pre')).toBeNull();
    const details = target.querySelector('details')!;
    details.open = true;
    details.dispatchEvent(new Event('toggle'));
    flushSync();
    expect(target.querySelector('pre')?.textContent).toBe('{\n  "a": 1\n}');
  });
  test('is there for a robot behind that link, and for no simulated one', async () => {
    for (const [name, isThere] of [
      ['mqtt', true],
      ['sim', false],
    ] as const) {
      const detail: RobotDetail = {
        id: 'tug-1',
        link: { name, connected: true, capacity: null, refuses: null },
        heard: AT,
        silent_s: 0,
        driven_m: 1,
        started: AT,
        jobs_done: 0,
        jobs_failed: 0,
        alarms: [],
      };
      const { api, sent } = apiOf({
        'GET /v1/robots/tug-1': () => detail,
        'GET /v1/robots/tug-1/history?limit=20': () => ({ items: [], next: null }),
        'GET /v1/robots/tug-1/link': () => linked('tug-1'),
      });
      const props = { id: 'tug-1', api, notices: new Notices(), onJob: () => {}, onDraw: () => {} };
      const { target, text } = shown(Life, props);
      await expect.poll(text).toContain('Nothing is recorded of it.');
      expect(target.querySelector('[data-linked]') !== null).toBe(isThere);
      expect(sent('GET /v1/robots/tug-1/link').length > 0).toBe(isThere);
      open.pop()!();
    }
  });
});

describe('robots that are not on the floor', () => {
  const LISTS = 'GET /v1/robots?unlisted=true&limit=1';
  function lists(answers: Record<string, (body: unknown) => unknown>) {
    const made = apiOf(answers);
    const notices = new Notices();
    return { ...made, notices, ...shown(NotOnFloor, { api: made.api, notices, onDraw: () => {} }) };
  }
  test('are no matter on a floor without a link to robots, which is asked once', async () => {
    const { sent, target } = lists({});
    await expect.poll(() => sent(LISTS)).toHaveLength(1);
    expect(target.textContent?.trim()).toBe('');
  });
  test('have their reason, and their card is there before they join', async () => {
    const waits = linked('tug-2', { joined: false, not_ready: { text: 'it does not know where it is' } });
    const { target, text } = lists({
      [LISTS]: () => ({ items: [], next: null, waiting: [waits], unlisted: [] }),
      'GET /v1/robots/tug-2/link': () => waits,
    });
    await expect.poll(text).toContain('Not ready: it does not know where it is');
    expect(text()).not.toContain('listed by nobody');
    target.querySelector<HTMLButtonElement>('[data-waiting="tug-2"] button')!.click();
    await expect.poll(text).toContain('Tell it where it stands');
  });
  test('are taken off the list, and put back by undo', async () => {
    const waits = linked('tug-2', { joined: false, not_ready: { text: 'it is switched off' } });
    const { target, sent, notices } = lists({
      [LISTS]: () => ({ waiting: [waits], unlisted: [] }),
      'DELETE /v1/robots/tug-2': () => null,
      'POST /v1/robots': () => ({ id: 'tug-2' }),
    });
    const remove = (): HTMLButtonElement | undefined =>
      [...target.querySelectorAll('button')].find((one) => one.textContent?.startsWith('Remove from the list'));
    await expect.poll(remove).toBeDefined();
    remove()!.click();
    await expect.poll(() => notices.notice?.words).toBe('Removed tug-2 from the list.');
    await notices.undo();
    expect(sent('POST /v1/robots')).toEqual([{ name: 'tug-2', kind: 'tug', manufacturer: 'acme', serial: '0001' }]);
  });
  test('that nobody listed are listed with a name and a kind', async () => {
    const { target, text, sent, notices } = lists({
      [LISTS]: () => ({ waiting: [], unlisted: [stranger] }),
      'GET /v1/kinds': () => ['robot', 'tug'].map((name) => ({ name, footprint: null, footprint_loaded: null })),
      'POST /v1/robots': () => ({ id: 'tug-7-b' }),
    });
    await expect.poll(text).toContain('Heard of, listed by nobody');
    expect(text()).toContain('Every listed robot has joined.');
    expect(text()).toContain('connection ONLINE');
    target.querySelector<HTMLButtonElement>('[data-unlisted] button')!.click();
    await expect.poll(() => target.querySelectorAll('option')).toHaveLength(2);
    const kind = target.querySelector('select')!;
    kind.value = 'tug';
    kind.dispatchEvent(new Event('change', { bubbles: true }));
    flushSync();
    target.querySelector<HTMLButtonElement>('form button')!.click();
    await expect
      .poll(() => sent('POST /v1/robots'))
      .toEqual([{ name: 'tug-7-b', kind: 'tug', manufacturer: 'acme', serial: 'tug 7/b' }]);
    await expect.poll(() => notices.notice?.words ?? '').toContain('tug-7-b');
  });
  test('are listed by administrators alone', async () => {
    await signedInAs('operator', ['settle_robot']);
    const waits = linked('tug-2', { joined: false });
    const { target, text } = lists({ [LISTS]: () => ({ waiting: [waits], unlisted: [stranger] }) });
    await expect.poll(text).toContain('It is ready, and joins in a moment.');
    expect(target.querySelectorAll('button')).toHaveLength(1);
  });
});

describe('what is written and read', () => {
  test('an action needs a type, and parameters that are an object', () => {
    expect(actionOf(' stateRequest ', '')).toEqual({ action: { type: 'stateRequest' } });
    for (const wrong of ['{', '[1]', '"x"', 'null'])
      expect(actionOf('x', wrong)).toMatchObject({
        errors: { parameters: expect.stringContaining('JSON') as unknown },
      });
    expect(actionOf('', '[')).toMatchObject({ errors: { type: expect.any(String), parameters: expect.any(String) } });
  });
  test('a message keeps its key while others come, and two alike have two', () => {
    const before = newestFirst([message('state', false), message('state', false)]);
    const after = newestFirst([message('state', false), message('state', false), message('order', true)]);
    expect(new Set(before.map((one) => one.key)).size).toBe(2);
    expect(after.slice(1)).toEqual(before);
  });
  test('a text that is cut off, or no JSON, is shown as it is', () => {
    expect([laidOut('{"a":'), laidOut('[1]')]).toEqual(['{"a":', '[\n  1\n]']);
  });
  test('a name is proposed that the server takes', () => {
    expect(nameFor({ serial: '/ä tug 7/b ' })).toBe('tug-7-b');
    expect(nameFor({ serial: 'x'.repeat(99) })).toHaveLength(64);
  });
});

describe('the wire', () => {
  const source = Object.values(
    import.meta.glob<string>('../../src/api/dto/linked.rs', { eager: true, query: '?raw', import: 'default' }),
  ).join('');
  const fieldsOf = (name: string): string[] => {
    const body = new RegExp(`pub struct ${name} \\{(.*?)\\n\\}`, 's').exec(source)?.[1] ?? '';
    return [...body.matchAll(/^ {4}pub (\w+):/gm)].map(([, field]) => field!);
  };
  const error: SaidError = { level: '', kind: '', words: '' };
  const fate: ActionFate = { id: '', kind: '', sent: '', status: '', result: null };
  test.each([
    ['LinkedRobotDto', linked('tug-1')],
    ['SaidStateDto', state],
    ['SaidErrorDto', error],
    ['NoticedDto', noticed('')],
    ['UnlistedRobotDto', stranger],
    ['SaidMessageDto', message('state', false)],
    ['ActionFateDto', fate],
  ])('%s has the keys that the server writes', (name, sample) => {
    expect(fieldsOf(name).length).toBeGreaterThan(0);
    expect(Object.keys(sample).sort()).toEqual(fieldsOf(name).sort());
  });
  test('names are escaped in paths', async () => {
    const { api, asked } = apiOf({});
    await api.linked.fate('a/b', 'c?d');
    expect(asked[0]![0]).toBe('GET /v1/robots/a%2Fb/actions/c%3Fd');
  });
});
