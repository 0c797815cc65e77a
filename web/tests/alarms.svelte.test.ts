// Alarms on the page: which of them call for a person, what a click shows, who acknowledges, and when it makes a sound.
import { flushSync, mount, unmount } from 'svelte';
import { describe, expect, test } from 'vitest';
import AlarmPage from '../src/alarms/AlarmPage.svelte';
import Alarms from '../src/alarms/Alarms.svelte';
import { handover } from '../src/alarms/handover';
import { fresh, secondsBetween, showsOf, titleOf } from '../src/alarms/shown';
import { sortedAlarms, wantedAlarms } from '../src/alarms/table';
import { Signals, type Means } from '../src/alarms/signals.svelte';
import type { Picked } from '../src/floor';
import type { Drawing } from '../src/floor';
import { Notices } from '../src/parts/notices.svelte';
import { learnRights } from '../src/session';
import { EMPTY, reduce, type Alarm, type AlarmRecord, type Answer, type Mirror } from '../src/wire';
import { learnNames, learnNumbers } from '../src/words';
import { snapshot } from './samples';

const alarm = (id: string, more: Partial<Alarm> = {}): Alarm => ({
  id,
  kind: 'robot_silent',
  severity: 'warning',
  subject_kind: 'robot',
  subject: 'robot-3',
  text: `${id}: robot-3 sends no reports.`,
  remedy: 'Check its radio.',
  x: 1,
  y: 2,
  waiting: 0,
  since_s: 6,
  acknowledged_by: null,
  ...more,
});

function means(stored: Record<string, string> = {}, allows = true) {
  const log: string[] = [];
  let now = 0;
  const all: Means = {
    beep: (severity) => {
      log.push(`beep ${severity}`);
    },
    ask: () => Promise.resolve(allows),
    notify: (title, _, tag) => {
      log.push(`notify ${tag}: ${title}`);
    },
    load: (key) => stored[key] ?? null,
    store: (key, value) => {
      stored[key] = value;
    },
    now: () => now,
  };
  return {
    all,
    log,
    stored,
    later: (ms: number) => {
      now += ms;
    },
  };
}

describe('which alarms call for a person', () => {
  test('the title counts those that nobody looks after, and no notices', () => {
    expect(titleOf([])).toBe('Giveway');
    expect(
      titleOf([alarm('al1'), alarm('al2', { severity: 'notice' }), alarm('al3', { acknowledged_by: 'Ben' })]),
    ).toBe('(1) Giveway');
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
    expect(showsOf(alarm('a', { subject_kind: 'server', subject: null, x: null, y: null }))).toEqual({
      kind: 'nothing',
    });
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
    const [asked, picked, drawn]: [string[], Picked[], Drawing[]] = [[], [], []];
    const done =
      (what: string) =>
      (id: string): Promise<Answer<null>> => {
        asked.push(`${what} ${id}`);
        return Promise.resolve({ kind: 'ok', value: null });
      };
    const api = {
      acknowledge: (id: string, by: string): Promise<Answer<AlarmRecord>> => {
        asked.push(`${id} by ${by}`);
        return Promise.resolve({ kind: 'unreachable' });
      },
      clear: (id: string, by: string) => done(`clear by ${by}`)(id),
      narrow: (id: string) => done('narrow')(id),
      pause: done('pause'),
      resume: done('resume'),
      maintain: done('maintain'),
      workAgain: done('back'),
      retire: done('retire'),
    };
    const props = {
      mirror,
      source: { tense: 'now', api } as const,
      signals: new Signals(means(stored).all),
      notices: new Notices(),
      onDraw: (drawing: Drawing) => {
        drawn.push(drawing);
      },
      onAll: () => {},
      onPick: (one: Picked) => {
        picked.push(one);
      },
      onJob: () => {},
      onPlace: () => {},
    };
    const target = document.createElement('div');
    const mounted = mount(Alarms, { target, props });
    flushSync();
    const button = (words: string) =>
      [...target.querySelectorAll('button')].find((one) => one.textContent?.startsWith(words));
    return { target, asked, picked, drawn, button, close: () => unmount(mounted) };
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
    const refusals = () => {
      flushSync();
      return [...shown.target.querySelectorAll('li')].map((li) => li.querySelector('[role=alert]')?.textContent);
    };
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
  test('what helps is a button of the alarm itself, for those who may', async () => {
    const lost = alarm('al1', {
      kind: 'worker_lost',
      subject_kind: 'worker',
      subject: 'w1',
      text: 'worker-7e31 (w1) is lost: 3 robots wait.',
      acts: ['clear_worker', 'narrow_worker'],
    });
    learnNumbers([{ id: 'w1', name: 'worker-7e31' }]);
    learnNames(new Map([['worker-7e31', 'picker-7']]));
    const shown = list([lost], { 'giveway.name': 'Ana' });
    const text = shown.target.textContent!;
    expect(text).toContain('picker-7 is lost: 3 robots wait.');
    expect([text.includes('w1'), text.includes('7e31')], 'one name and no other').toEqual([false, false]);
    shown.button('Nobody is there')!.click();
    expect(shown.asked).toEqual(['clear by Ana w1']);
    shown.button('Say about where')!.click();
    shown.drawn[0]!.onDone([[1, 2]]);
    expect(shown.asked[1]).toBe('narrow w1');
    await shown.close();
    await learnRights(() =>
      Promise.resolve({ name: 'Eva', role: 'viewer', subject: null, by: 'session', expires: null, may: [] }),
    );
    const viewer = list([lost]);
    expect([...viewer.target.querySelectorAll('li button')].map((b) => b.textContent)).toEqual(['picker-7']);
    await viewer.close();
    await learnRights(() =>
      Promise.resolve({ name: 'Eva', role: 'admin', subject: null, by: 'nothing', expires: null }),
    );
    learnNumbers([]);
    learnNames(new Map());
  });
  test('a group calls once, and its members do not call when it is over', () => {
    const one = means();
    const signals = new Signals(one.all);
    signals.setSound(true);
    one.log.length = 0;
    const group = alarm('al9', {
      severity: 'critical',
      subject: null,
      subject_kind: 'floor',
      members: [{ id: 'al1', subject: 'robot-1', acknowledged_by: null }],
    });
    signals.note([group]);
    signals.note([alarm('al1')]);
    expect(one.log).toEqual(['beep critical']);
    expect(titleOf([alarm('al1', { shelved_until: '2027-01-31T06:00:00Z' })]), 'what is put aside calls nobody').toBe(
      'Giveway',
    );
  });
});

describe('the alarm page', () => {
  const record = (id: string, more: Partial<AlarmRecord> = {}): AlarmRecord => ({
    id,
    kind: 'robot_silent',
    severity: 'warning',
    state: 'active',
    subject: { kind: 'robot', id: 'robot-3' },
    text: 'robot-3 sends no reports.',
    code: 'robot_silent',
    args: {},
    remedy: { code: null, args: {}, text: '' },
    x: null,
    y: null,
    waiting: 0,
    since: '2027-01-31T06:00:00Z',
    acknowledged: null,
    shelved: null,
    notes: [],
    acts: [],
    group: null,
    members: [],
    cleared: null,
    ...more,
  });
  const aside = { by: 'Ben', at: '2027-01-31T06:00:00Z', until: '2027-01-31T09:00:00Z', reason: 'radio' };
  const ids = (alarms: readonly AlarmRecord[]) => alarms.map((one) => one.id);

  test('finds alarms by what is written in them, by notes and by members', () => {
    const member = {
      id: 'al5',
      subject: { kind: 'robot' as const, id: 'robot-77' },
      text: '',
      x: null,
      y: null,
      since: '',
      acknowledged_by: null,
    };
    const all = [
      record('al1'),
      record('al2', { notes: [{ by: 'Ben', at: '', text: 'loose wheel' }] }),
      record('al3', { members: [member] }),
      record('al4', { shelved: aside }),
    ];
    expect(ids(wantedAlarms(all, 'all', 'WHEEL'))).toEqual(['al2']);
    expect(ids(wantedAlarms(all, 'all', 'robot-77'))).toEqual(['al3']);
    expect(ids(wantedAlarms(all, 'calls', ''))).toEqual(['al1', 'al2', 'al3']);
    expect(ids(wantedAlarms(all, 'shelved', ''))).toEqual(['al4']);
  });
  test('the worst come first, and what is put aside comes last, however it is sorted', () => {
    const all = [
      record('al1', { severity: 'critical', shelved: aside }),
      record('al2'),
      record('al3', { severity: 'critical' }),
      record('al10', { since: '2027-01-31T05:00:00Z' }),
    ];
    expect(ids(sortedAlarms(all, { by: 'severity', way: 'down' }))).toEqual(['al3', 'al10', 'al2', 'al1']);
    expect(ids(sortedAlarms(all, { by: 'since', way: 'up' }))).toEqual(['al10', 'al3', 'al2', 'al1']);
  });
  test('the hand-over says of each alarm who looks after it, and what was found out', () => {
    const noted = record('al1', {
      acknowledged: { by: 'Ana', at: '2027-01-31T06:01:00Z' },
      notes: [{ by: 'Ana', at: '2027-01-31T06:05:00Z', text: 'no power' }],
    });
    const over = record('al2', { cleared: '2027-01-31T07:00:00Z' });
    const text = handover(
      [noted, record('al3', { severity: 'critical', shelved: aside })],
      [over],
      new Date('2027-01-31T08:00:00Z'),
    );
    const lines = text.split('\n');
    expect(lines[2]).toMatch(/^Warning: robot-3 sends no reports\./);
    expect(text).toMatch(/acknowledged by Ana\n.*Ana: no power/);
    expect(text).toMatch(/Critical: .*\n {2}nobody looks after it yet\n {2}Put aside until .* by Ben: radio/);
    expect(text).toContain('1 alarm ended in the last 8 hours.');
  });
  test('shows groups that open, and sends what somebody does with the name that is known', async () => {
    const member = {
      id: 'al5',
      subject: { kind: 'robot' as const, id: 'robot-77' },
      text: 'robot-77 sends no reports.',
      x: 1,
      y: 2,
      since: '2027-01-31T06:00:00Z',
      acknowledged_by: 'Ben',
    };
    const items = [
      record('al9', {
        severity: 'critical',
        subject: { kind: 'floor', id: 'floor' },
        text: '7 of 9 robots send no reports: robot-77.',
        members: [member],
      }),
    ];
    const asked: unknown[] = [];
    const answer =
      (what: string) =>
      (...more: unknown[]) => {
        asked.push([what, ...more]);
        return Promise.resolve({ kind: 'ok' as const, value: items[0]! });
      };
    const api = {
      alarms: () => Promise.resolve({ kind: 'ok' as const, value: { items, next: null } }),
      acknowledge: answer('acknowledge'),
      shelve: answer('shelve'),
      unshelve: answer('unshelve'),
      noteAlarm: answer('note'),
    } as never;
    const target = document.createElement('div');
    const page = mount(AlarmPage, {
      target,
      props: {
        api,
        signals: new Signals(means({ 'giveway.name': 'Ana' }).all),
        notices: new Notices(),
        onPick: () => {},
        onJob: () => {},
        onPlace: () => {},
        onDraw: () => {},
      },
    });
    const button = (words: string) =>
      [...target.querySelectorAll('button')].find((one) => one.textContent?.startsWith(words));
    await expect
      .poll(() => {
        flushSync();
        return button('1 robot') !== undefined;
      })
      .toBe(true);
    expect(target.textContent).not.toContain('robot-77 sends no reports.');
    button('1 robot')!.click();
    flushSync();
    expect(target.querySelector('.inside')!.textContent!.replaceAll(/\s+/g, ' ')).toContain(
      'robot-77 robot-77 sends no reports.',
    );
    button('Acknowledge al9')!.click();
    const [note, reason] = [...target.querySelectorAll<HTMLInputElement>('.forms input')];
    for (const [input, text] of [
      [note!, 'no power'],
      [reason!, 'being mended'],
    ] as const) {
      input.value = text;
      input.dispatchEvent(new Event('input', { bubbles: true }));
      flushSync();
      input.closest('form')!.dispatchEvent(new Event('submit', { bubbles: true, cancelable: true }));
      flushSync();
    }
    expect(asked).toEqual([
      ['acknowledge', 'al9', 'Ana'],
      ['note', 'al9', 'Ana', 'no power'],
      ['shelve', 'al9', { by: 'Ana', for_s: 3600, reason: 'being mended' }],
    ]);
    await unmount(page);
  });
});
