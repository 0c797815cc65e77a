// Colours, read from the style sheet, where each is written once.
import type { HallInk } from './hall';
import type { Colour, Ink } from './shapes';
import { ACTIVITIES } from '../wire';

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

/** A colour for WebGL, by its name in app.css. */
function colourOf(name: string): Colour {
  const numbers =
    inkOf(name)
      .match(/[\d.]+/g)
      ?.map(Number) ?? [];
  const [r = 255, g = 255, b = 255, a = 1] = numbers;
  return [r / 255, g / 255, b / 255, a];
}

/** The colours of guidance. */
export function roomInk(): Ink {
  const of = (name: string): Colour => colourOf(`xr-${name}`);
  return {
    path: of('path'),
    chevron: of('chevron'),
    next: of('next'),
    robot: of('robot'),
    close: of('close'),
    mark: of('mark'),
    stop: of('stop'),
    outside: of('outside'),
  };
}

/** The colours of the twin: those of the map where it has them. */
export function hallInk(): HallInk {
  const of = colourOf;
  return {
    sky: of('twin-sky'),
    floor: of('map-floor'),
    edge: of('map-edge'),
    lane: of('map-lane'),
    blocked: of('twin-blocked'),
    closed: of('map-closed'),
    places: {
      station: of('map-station'),
      queue: of('map-queue'),
      charger: of('map-charger'),
      parking: of('map-parking'),
      exit: of('map-exit'),
    },
    frame: of('twin-frame'),
    goods: ['twin-goods-1', 'twin-goods-2', 'twin-goods-3'].map(of),
    states: Object.fromEntries([
      ...ACTIVITIES.map((one) => [one, of(`state-${one}`)]),
      ['gone', of('state-idle')],
    ]) as HallInk['states'],
    nose: of('twin-nose'),
    person: of('map-person'),
    region: of('map-region'),
  };
}
