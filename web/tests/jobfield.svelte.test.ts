// The form that submits a job: what is wrong with a field stands beside it until one types in it.
import { flushSync, mount, unmount } from 'svelte';
import { expect, test } from 'vitest';
import JobForm from '../src/jobs/JobForm.svelte';

test('what is wrong with a field goes when it is typed in, and that of the others stays', () => {
  const target = document.createElement('div');
  document.body.append(target);
  const api = { submit: () => Promise.reject(new Error('nothing is sent')) };
  const mounted = mount(JobForm, { target, props: { map: null, robots: [], api, onSubmitted: () => {} } });
  flushSync();
  target.querySelector('form')!.dispatchEvent(new Event('submit', { bubbles: true, cancelable: true }));
  flushSync();
  const wrong = (): string[] => [...target.querySelectorAll('[aria-invalid="true"]')].map((field) => field.id);
  expect(wrong()).toEqual(['job-rack', 'job-station']);
  const rack = target.querySelector<HTMLInputElement>('#job-rack')!;
  rack.value = 'K';
  rack.dispatchEvent(new Event('input', { bubbles: true }));
  flushSync();
  expect(wrong()).toEqual(['job-station']);
  expect(target.querySelectorAll('[role="alert"]').length).toBe(1);
  void unmount(mounted);
  target.remove();
});
