// How the height is shared between the map and what is below it: one share, the same for every tab, remembered.

/** Of the map, in percent. */
export const LEAST = 30;
export const MOST = 80;
export const USUAL = 68;
const KEY = 'giveway.map-share';

export const within = (share: number): number => Math.min(MOST, Math.max(LEAST, Math.round(share)));

export function storedShare(): number {
  try {
    const text = localStorage.getItem(KEY);
    const share = text === null ? NaN : Number(text);
    return Number.isFinite(share) ? within(share) : USUAL;
  } catch {
    return USUAL;
  }
}

export function storeShare(share: number): void {
  try {
    localStorage.setItem(KEY, String(share));
  } catch {
    // Storage may be forbidden; the share then lasts as long as the page.
  }
}

/** What a key makes of it; null for keys that mean nothing here. */
export function afterKey(share: number, key: string): number | null {
  switch (key) {
    case 'ArrowUp':
    case 'ArrowLeft':
      return within(share - 2);
    case 'ArrowDown':
    case 'ArrowRight':
      return within(share + 2);
    case 'PageUp':
      return within(share - 10);
    case 'PageDown':
      return within(share + 10);
    case 'Home':
      return LEAST;
    case 'End':
      return MOST;
    default:
      return null;
  }
}
