// What the form sends, what it refuses itself, and where it puts what the server refuses.
import { describe, expect, test } from 'vitest';
import { BLANK, build, explain, FIELDS, type FormValues } from '../src/jobs/jobform';
import { suggest } from '../src/parts';
import { JOB_KINDS, Keys, newKey } from '../src/wire';

const NOW = new Date('2026-03-01T12:00:00Z');
const form = (more: Partial<FormValues>): FormValues => ({ ...BLANK, ...more });

describe('the job form', () => {
  test('a delivery carries rack, station and priority, and nothing else', () => {
    const built = build(form({ rack: ' K1 ', station: 'P1', node: 'A12', robot: 'robot-1' }), NOW);
    expect(built).toEqual({ kind: 'ready', job: { kind: 'deliver', rack: 'K1', station: 'P1', priority: 0 } });
  });

  test('each kind sends exactly the fields it needs', () => {
    const full = { rack: 'K1', station: 'P1', node: 'A12', robot: 'robot-1' };
    for (const kind of JOB_KINDS) {
      const built = build(form({ ...full, kind }), NOW);
      if (built.kind !== 'ready') throw new Error(`${kind} was refused`);
      expect(Object.keys(built.job).sort()).toEqual(['kind', 'priority', ...FIELDS[kind]].sort());
    }
  });

  test('an empty field is named beside itself', () => {
    expect(build(form({ rack: 'K1', station: '  ' }), NOW)).toEqual({
      kind: 'wrong',
      errors: { station: 'Name a station.' },
    });
  });

  test('minutes become a deadline on the clock', () => {
    const built = build(form({ kind: 'return', rack: 'K1', deadline: '15' }), NOW);
    expect(built).toMatchObject({ job: { deadline: '2026-03-01T12:15:00.000Z' } });
  });

  test.each(['-1', '10', '1.5', 'high', ''])('a priority of "%s" is refused', (priority) => {
    expect(build(form({ rack: 'K1', station: 'P1', priority }), NOW)).toMatchObject({
      kind: 'wrong',
      errors: { priority: expect.any(String) },
    });
  });

  test.each(['0', '-5', 'soon', '99999'])('a deadline in "%s" minutes is refused', (deadline) => {
    expect(build(form({ rack: 'K1', station: 'P1', deadline }), NOW)).toMatchObject({
      kind: 'wrong',
      errors: { deadline: expect.any(String) },
    });
  });
});

describe('a refusal by the server', () => {
  test('goes beside the field it names', () => {
    const problem = {
      title: 'Bad',
      status: 422,
      detail: 'One field.',
      errors: [{ field: 'rack', detail: 'There is no rack K9.' }],
    };
    expect(explain(problem, 'deliver')).toEqual({ fields: { rack: 'There is no rack K9.' }, form: null });
  });

  test('of a field that is not shown goes under the form', () => {
    const problem = { title: 'Bad', status: 422, errors: [{ field: 'after', detail: 'There is no job j1.' }] };
    expect(explain(problem, 'deliver')).toEqual({ fields: {}, form: 'There is no job j1.' });
  });

  test('without fields is told as a whole', () => {
    expect(explain({ title: 'Busy', status: 503 }, 'go').form).toBe('Busy');
    expect(explain({ title: 'Busy', status: 503, detail: 'Try in a minute.' }, 'go').form).toBe('Try in a minute.');
  });
});

describe('the idempotency key', () => {
  test('stays the same for the same job until the server has answered', () => {
    const keys = new Keys();
    let n = 0;
    const fresh = () => `key-${++n}`;
    expect([keys.keyFor('a', fresh), keys.keyFor('a', fresh)]).toEqual(['key-1', 'key-1']);
    expect(keys.keyFor('b', fresh)).toBe('key-2');
    keys.answered();
    expect(keys.keyFor('b', fresh)).toBe('key-3');
  });

  test('is a version 4 UUID where randomUUID is missing', () => {
    const plain = { getRandomValues: (bytes: Uint8Array) => bytes.fill(0xff) } as unknown as Crypto;
    expect(newKey(plain)).toBe('ffffffff-ffff-4fff-bfff-ffffffffffff');
  });
});

describe('suggestions', () => {
  test('names that begin with the text come first, and never too many', () => {
    const names = ['A10', 'B1', 'K1', 'K10', 'K2'];
    expect(suggest(names, 'k1')).toEqual(['K1', 'K10']);
    expect(suggest(names, '1')).toEqual(['A10', 'B1', 'K1', 'K10']);
    expect(
      suggest(
        Array.from({ length: 5_000 }, (_, i) => `N${i}`),
        'n',
      ),
    ).toHaveLength(40);
  });
});
