import { expect, test } from 'vitest';
import { floorDate, floorNow, hearTime } from '../src/wire';

test('as long as no picture has come, the time on the floor is that of this device', () => {
  expect(Math.abs(floorDate().getTime() - Date.now())).toBeLessThan(1_000);
});

test('the time on the floor is that of the server, however this device is set', () => {
  hearTime({ started: 1_000_000, time_s: 60, speed: 1 }, 5_000);
  expect(floorNow(5_000)).toBe(1_060_000);
  expect(floorNow(7_500)).toBe(1_062_500);
});

test('on a simulated floor that runs four times as fast, a second is four', () => {
  hearTime({ started: 0, time_s: 60, speed: 4 }, 5_000);
  expect(floorNow(6_000)).toBe(64_000);
});

test('a recording that does not say when it was made sets no clock', () => {
  hearTime({ started: 0, time_s: 60, speed: 1 }, 5_000);
  hearTime({ started: null, time_s: 90, speed: 1 }, 9_000);
  expect(floorNow(6_000)).toBe(61_000);
});
