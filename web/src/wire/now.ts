// The time on the floor: by the server's clock, as its live feed tells it. This device's clock may be set wrong, and a
// simulated floor may run faster than time does. It opens no socket.
import type { Mirror } from './mirror';

/** The floor's time when it was last heard, milliseconds of the epoch, by this device's count of milliseconds. */
let heard: { floor: number; at: number; speed: number } | null = null;

/** Sets the floor's clock by a picture that has just come. */
export function hearTime(mirror: Pick<Mirror, 'started' | 'time_s' | 'speed'>, at = performance.now()): void {
  if (mirror.started === null) return;
  heard = { floor: mirror.started + mirror.time_s * 1_000, at, speed: mirror.speed };
}

/** The time on the floor, milliseconds of the epoch; this device's time as long as the floor's is not known. */
export function floorNow(at = performance.now()): number {
  return heard === null ? Date.now() : heard.floor + Math.max(0, at - heard.at) * heard.speed;
}

/** The same as a date. */
export const floorDate = (): Date => new Date(floorNow());
