// Colours, read from the style sheet, where each is written once.
import type { Colour, Ink } from './shapes';

const known = new Map<string, string>();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => known.clear());

/** A colour by its name in app.css, as it holds now. */
export function inkOf(name: string): string {
  const had = known.get(name);
  if (had !== undefined) return had;
  // light-dark() is resolved in a real property only.
  const probe = document.createElement('span');
  document.body.append(probe);
  probe.style.color = `var(--${name})`;
  const colour = getComputedStyle(probe).color;
  probe.remove();
  known.set(name, colour);
  return colour;
}

/** Colours for WebGL. */
export function roomInk(): Ink {
  const of = (name: string): Colour => {
    const numbers = inkOf(`xr-${name}`).match(/[\d.]+/g)?.map(Number) ?? [];
    const [r = 255, g = 255, b = 255, a = 1] = numbers;
    return [r / 255, g / 255, b / 255, a];
  };
  return { path: of('path'), chevron: of('chevron'), next: of('next'), robot: of('robot'), close: of('close'), mark: of('mark'), stop: of('stop') };
}
