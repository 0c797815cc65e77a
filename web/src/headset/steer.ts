// Hands on the window of the twin: keys and a pad walk, a drag looks around. It knows nothing of the floor.
import { make } from './dom';
import type { Drive } from './walk';

export interface Steer {
  /** What is asked for now. */
  drive(): Drive;
  /** To be laid over the window: where a finger walks. */
  pad: HTMLElement;
}
export interface SteerEvents {
  /** A drag, in pixels of the window. */
  drag(dx: number, dy: number): void;
  done(): void;
  narrow(): void;
}

const KEYS: Record<string, Partial<Drive>> = {
  w: { ahead: 1 },
  arrowup: { ahead: 1 },
  s: { ahead: -1 },
  arrowdown: { ahead: -1 },
  a: { left: 1 },
  d: { left: -1 },
  arrowleft: { turn: 1 },
  arrowright: { turn: -1 },
  q: { turn: 1 },
  e: { turn: -1 },
};
/** Within so much of the pad's half nothing happens: a finger is not exact. */
const DEAD = 0.15;

const within = (v: number): number => Math.max(-1, Math.min(1, v));

/** What the keys that are down ask for together. */
export function driveOf(down: Iterable<string>): Drive {
  const sum = { ahead: 0, left: 0, turn: 0 };
  for (const key of down) for (const part of ['ahead', 'left', 'turn'] as const) sum[part] += KEYS[key]?.[part] ?? 0;
  return { ahead: within(sum.ahead), left: within(sum.left), turn: within(sum.turn) };
}

/** What a finger on the pad asks for, from its middle in shares of its half, y down: ahead, and turns. */
export function driveOfPad([x, y]: readonly [number, number]): Drive {
  const part = (v: number): number => (Math.abs(v) < DEAD ? 0 : within(v));
  return { ahead: part(-y), left: 0, turn: part(-x) };
}

/** Listens to a window that can have the focus. */
export function steer(host: HTMLElement, events: SteerEvents): Steer {
  const down = new Set<string>();
  let thumb: Drive = { ahead: 0, left: 0, turn: 0 };
  const pad = make('div', { className: 'pad', ariaHidden: 'true' }, make('i', {}));

  host.addEventListener('keydown', (event) => {
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (key === 'n' && !event.repeat) events.narrow();
    else if (key === 'enter' && !event.repeat) events.done();
    else if (key in KEYS) down.add(key);
    else return;
    event.preventDefault();
  });
  host.addEventListener('keyup', (event) => down.delete(event.key.toLowerCase()));
  host.addEventListener('blur', () => down.clear());

  follow(host, (event, before) => {
    if (before) events.drag(event.clientX - before.x, event.clientY - before.y);
  });
  const knob = pad.firstElementChild as HTMLElement;
  follow(
    pad,
    (event) => {
      const box = pad.getBoundingClientRect();
      const at = [
        (event.clientX - box.left) / (box.width / 2) - 1,
        (event.clientY - box.top) / (box.height / 2) - 1,
      ] as const;
      thumb = driveOfPad(at);
      knob.style.translate = `${within(at[0]) * 70}% ${within(at[1]) * 70}%`;
    },
    () => {
      thumb = { ahead: 0, left: 0, turn: 0 };
      knob.style.translate = '0 0';
    },
  );

  const drive = (): Drive => {
    const keys = driveOf(down);
    return { ahead: within(keys.ahead + thumb.ahead), left: keys.left, turn: within(keys.turn + thumb.turn) };
  };
  return { drive, pad };
}

/** Follows one pointer from its press to its release. */
function follow(
  on: HTMLElement,
  moved: (event: PointerEvent, before: { x: number; y: number } | null) => void,
  released: () => void = () => {},
): void {
  let last: { id: number; x: number; y: number } | null = null;
  on.addEventListener('pointerdown', (event) => {
    if (last !== null || event.button !== 0) return;
    last = { id: event.pointerId, x: event.clientX, y: event.clientY };
    on.setPointerCapture(event.pointerId);
    moved(event, null);
  });
  on.addEventListener('pointermove', (event) => {
    if (last?.id !== event.pointerId) return;
    moved(event, last);
    last = { id: event.pointerId, x: event.clientX, y: event.clientY };
  });
  const end = (event: PointerEvent): void => {
    if (last?.id !== event.pointerId) return;
    last = null;
    released();
  };
  on.addEventListener('pointerup', end);
  on.addEventListener('pointercancel', end);
}
