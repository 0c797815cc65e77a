// Turns pointer, wheel and keys into what a person wants of the map: pan, zoom, point, choose.
type Pixel = [px: number, py: number];

export interface Wishes {
  pan(dx: number, dy: number): void;
  zoom(factor: number, px?: number, py?: number): void;
  fit(): void;
  /** The map alone on the whole screen, or no longer. */
  full(): void;
  /** null: nothing is pointed at any more. */
  hover(at: Pixel | null): void;
  choose(at: Pixel | null): void;
  /** To the next thing in sight, or to the one before. */
  step(by: 1 | -1): void;
}

const PAN_STEP_PX = 60;
/** A press that moves less than this is a click, not a drag. */
const CLICK_PX = 4;

export function listen(host: HTMLElement, wishes: Wishes, signal: AbortSignal): void {
  const pointers = new Map<number, Pixel>();
  let dragged = 0;
  const at = (e: MouseEvent): Pixel => {
    const box = host.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  };

  host.addEventListener(
    'pointerdown',
    (e) => {
      if (e.button !== 0) return;
      if (pointers.size === 0) dragged = 0;
      pointers.set(e.pointerId, at(e));
      host.setPointerCapture(e.pointerId);
    },
    { signal },
  );

  host.addEventListener(
    'pointermove',
    (e) => {
      const before = pointers.get(e.pointerId);
      const now = at(e);
      if (!before) {
        wishes.hover(now);
        return;
      }
      const other = [...pointers].find(([id]) => id !== e.pointerId)?.[1];
      dragged += apart(before, now);
      if (other) {
        const middle: Pixel = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
        wishes.zoom(apart(now, other) / Math.max(1, apart(before, other)), ...middle);
      } else if (dragged > CLICK_PX) {
        wishes.pan(now[0] - before[0], now[1] - before[1]);
      }
      pointers.set(e.pointerId, now);
    },
    { signal },
  );

  const release = (e: PointerEvent): void => {
    if (!pointers.delete(e.pointerId)) return;
    if (e.type === 'pointerup' && dragged <= CLICK_PX) wishes.choose(at(e));
  };
  host.addEventListener('pointerup', release, { signal });
  host.addEventListener('pointercancel', release, { signal });
  host.addEventListener('pointerleave', () => wishes.hover(null), { signal });

  host.addEventListener(
    'wheel',
    (e) => {
      e.preventDefault();
      // Some browsers count wheel steps in lines rather than pixels.
      const pixels = e.deltaMode === WheelEvent.DOM_DELTA_LINE ? e.deltaY * 33 : e.deltaY;
      wishes.zoom(Math.exp(-pixels * 0.0015), ...at(e));
    },
    { signal, passive: false },
  );

  host.addEventListener(
    'keydown',
    (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey || !press(e.key, wishes)) return;
      e.preventDefault();
    },
    { signal },
  );
}

function press(key: string, wishes: Wishes): boolean {
  switch (key) {
    case 'ArrowLeft':
      wishes.pan(PAN_STEP_PX, 0);
      return true;
    case 'ArrowRight':
      wishes.pan(-PAN_STEP_PX, 0);
      return true;
    case 'ArrowUp':
      wishes.pan(0, PAN_STEP_PX);
      return true;
    case 'ArrowDown':
      wishes.pan(0, -PAN_STEP_PX);
      return true;
    case '+':
    case '=':
      wishes.zoom(1.25);
      return true;
    case '-':
    case '_':
      wishes.zoom(0.8);
      return true;
    case '0':
      wishes.fit();
      return true;
    case 'f':
      wishes.full();
      return true;
    case 'n':
      wishes.step(1);
      return true;
    case 'p':
      wishes.step(-1);
      return true;
    case 'Escape':
      wishes.choose(null);
      return true;
    default:
      return false;
  }
}

const apart = (a: Pixel, b: Pixel): number => Math.hypot(a[0] - b[0], a[1] - b[1]);
