// Alarms on the page: which of them call for a person, what a click shows, who acknowledges, and when it makes a sound.
import { flushSync, mount, unmount } from 'svelte';
import { describe, expect, test } from 'vitest';
import Alarms from '../src/alarms/Alarms.svelte';
import { fresh, secondsBetween, showsOf, titleOf } from '../src/alarms/shown';
import { Signals, type Means } from '../src/alarms/signals.svelte';
import type { Picked } from '../src/floor';
import { EMPTY, reduce, type Alarm, type AlarmRecord, type Answer, type Mirror } from '../src/wire';
import { snapshot } from './samples';

const alarm = (id: string, more: Partial<Alarm> = {}): Alarm => ({
  id, kind: 'robot_silent', severity: 'warning', subject_kind: 'robot', subject: 'robot-3', text: `${id}: robot-3 sends no reports.`,
  remedy: 'Check its radio.', x: 1, y: 2, waiting: 0, since_s: 6, acknowledged_by: null, ...more,
});

function means(stored: Record<string, string> = {}, allows = true) {
  const log: string[] = [];
  let now = 0;
  const all: Means = {
    beep: (severity) => { log.push(`beep ${severity}`); },
    ask: () => Promise.resolve(allows),
    notify: (title, _, tag) => { log.push(`notify ${tag}: ${title}`); },
    load: (key) => stored[key] ?? null,
    store: (key, value) => { stored[key] = value; },
    now: () => now,
  };
  return { all, log, stored, later: (ms: number) => { now += ms; } };
}

describe('which alarms call for a person', () => {
  test('the title counts those that nobody looks after, and no notices', () => {
    expect(titleOf([])).toBe('Giveway');
    expect(titleOf([alarm('al1'), alarm('al2', { severity: 'notice' }), alarm('al3', { acknowledged_by: 'Ben' })])).toBe('(1) Giveway');
  });
  test('an alarm calls once, and again only if it becomes critical', () => {
    expect(fresh([alarm('al1')], new Map())).toHaveLength(1);
    expect(fresh([alarm('al1')], new Map([['al1', 'warning']]))).toHaveLength(0);
    expect(fresh([alarm('al1', { severity: 'critical' })], new Map([['al1', 'warning']]))).toHaveLength(1);
    expect(fresh([alarm('al1', { severity: 'notice' })], new Map())).toHaveLength(0);
  });
  test('a subject is chosen, a job opened, a place shown, and the server is none of these', () => {
    expect(showsOf(alarm('a'))).toEqual({ kind: 'pick', picked: { kind: 'robot', id: 'robot-3' } });
    expect(showsOf(alarm('a', { subject_kind: 'job', subject: 'j4' }))).toEqual({ kind: 'job', id: 'j4' });
    expect(showsOf(alarm('a', { subject_kind: 'floor', subject: null }))).toEqual({ kind: 'place', at: [1, 2] });
    expect(showsOf(alarm('a', { subject_kind: 'server', subject: null, x: null, y: null }))).toEqual({ kind: 'nothing' });
    // As a recording of an earlier version has it.
    expect(showsOf({ id: 'journal', text: 'The journal is slow.', since_s: 1 })).toEqual({ kind: 'nothing' });
  });
  test('how long a past alarm lasted', () => {
    expect(secondsBetween('2027-01-31T06:00:00Z', '2027-01-31T06:01:30Z')).toBe(90);
  });
});

describe('sound and notifications', () => {
  test('are off until somebody asks for them, and stay as they were chosen', async () => {
    const one = means();
    const signals = new Signals(one.all);
    signals.note([alarm('al1')]);
    expect(one.log).toEqual([]);
    signals.setSound(true);
    await signals.setNotifications(true);
    expect(one.stored).toMatchObject({ 'giveway.alarm-sound': 'on', 'giveway.alarm-notifications': 'on' });
    const again = new Signals(one.all);
    expect([again.sound, again.notifications]).toEqual([true, true]);
  });
  test('a new alarm sounds once; a critical one again and again until it is acknowledged', () => {
    const { all, log, later } = means({ 'giveway.alarm-sound': 'on' });
    const signals = new Signals(all);
    signals.note([alarm('al1')]);
    signals.note([alarm('al1')]);
    expect(log).toEqual(['beep warning']);
    later(60_000);
    const critical = alarm('al1', { severity: 'critical' });
    signals.note([critical]);
    signals.note([critical]);
    later(11_000);
    signals.note([critical]);
    later(11_000);
    signals.note([{ ...critical, acknowledged_by: 'Ben' }]);
    expect(log).toEqual(['beep warning', 'beep critical', 'beep critical']);
  });
  test('a notification names the alarm; where the browser refuses, the page says so', async () => {
    const { all, log } = means({ 'giveway.alarm-notifications': 'on' });
    new Signals(all).note([alarm('al7')]);
    expect(log).toEqual(['notify al7: al7: robot-3 sends no reports.']);
    const refusing = new Signals(means({}, false).all);
    await refusing.setNotifications(true);
    expect([refusing.notifications, refusing.refused]).toEqual([false, true]);
  });
});

describe('the list of alarms', () => {
  function list(alarms: Alarm[], stored: Record<string, string> = {}) {
    const reduced = reduce(EMPTY, snapshot({ time_s: 10, alarms }));
    const mirror: Mirror = reduced.kind === 'gap' ? EMPTY : reduced.mirror;
    const [asked, picked]: [string[], Picked[]] = [[], []];
    const api = {
      acknowledge: (id: string, by: string): Promise<Answer<AlarmRecord>> => { asked.push(`${id} by ${by}`); return Promise.resolve({ kind: 'unreachable' }); },
      alarms: (): Promise<Answer<never>> => Promise.resolve({ kind: 'unreachable' }),
    };
    const props = {
      mirror, source: { tense: 'now', api } as const, signals: new Signals(means(stored).all),
      onPick: (one: Picked) => { picked.push(one); }, onJob: () => {}, onPlace: () => {},
    };
    const target = document.createElement('div');
    const mounted = mount(Alarms, { target, props });
    flushSync();
    const button = (words: string) => [...target.querySelectorAll('button')].find((one) => one.textContent?.startsWith(words));
    return { target, asked, picked, button, close: () => unmount(mounted) };
  }

  test('says how bad it is, for how long, what to do, and who looks after it', async () => {
    const shown = list([alarm('al1'), alarm('al2', { severity: 'critical', acknowledged_by: 'Ben' })]);
    const rows = [...shown.target.querySelectorAll('li')].map((li) => li.textContent!.replaceAll(/\s+/g, ' '));
    expect(rows[0]).toContain('Warning');
    expect(rows[0]).toContain('for 4 s');
    expect(rows[0]).toContain('Check its radio.');
    expect(rows[1]).toContain('acknowledged by Ben');
    shown.button('robot-3')!.click();
    expect(shown.picked).toEqual([{ kind: 'robot', id: 'robot-3' }]);
    await shown.close();
  });
  test('an acknowledgement carries the name that is known here', async () => {
    const shown = list([alarm('al1'), alarm('al2')], { 'giveway.name': 'Ana' });
    shown.button('Acknowledge')!.click();
    expect(shown.asked).toEqual(['al1 by Ana']);
    // A refusal is said with the alarm that was acknowledged.
    const refusals = () => { flushSync(); return [...shown.target.querySelectorAll('li')].map((li) => li.querySelector('[role=alert]')?.textContent); };
    await expect.poll(refusals).toEqual(['The server cannot be reached.', undefined]);
    await shown.close();
  });
  test('a notice asks for no acknowledgement, and without alarms it keeps quiet', async () => {
    const notice = list([alarm('al1', { severity: 'notice' })]);
    expect([...notice.target.querySelectorAll('li button')].map((b) => b.textContent)).toEqual(['robot-3']);
    await notice.close();
    const none = list([]);
    expect(none.target.textContent).toContain('No alarms.');
    await none.close();
  });
});
