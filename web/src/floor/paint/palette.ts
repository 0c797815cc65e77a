// Colours of the floor. They are defined once, as custom properties in app.css, and read from there.
import { LOOKS } from '../scene/scene';

const NAMES = [
  'void',
  'floor',
  'edge',
  'wall',
  'lane',
  'walkway',
  'slot',
  'queue',
  'station',
  'charger',
  'parking',
  'exit',
  'rack',
  'rack-edge',
  'carried',
  'granted',
  'held',
  'tick',
  'label',
  'halo',
  'chosen',
  'low',
  'person',
  'region',
  'ahead',
  'closed',
  'gauge',
  'off',
  'stop',
  'heat',
  'heat-1',
  'heat-2',
  'heat-3',
  'heat-4',
  'heat-5',
] as const;
type Name = (typeof NAMES)[number];

export interface Palette {
  of: Record<Name, string>;
  /** In the order of LOOKS. */
  looks: string[];
}

export function readPalette(host: HTMLElement): Palette {
  // light-dark() is resolved only in a real property, so a probe element computes each colour.
  const probe = document.createElement('span');
  host.append(probe);
  const read = (name: string): string => {
    probe.style.color = `var(--${name})`;
    return getComputedStyle(probe).color;
  };
  const of = Object.fromEntries(NAMES.map((n) => [n, read(`map-${n}`)])) as Record<Name, string>;
  const looks = LOOKS.map((look) => read(`state-${look}`));
  probe.remove();
  return { of, looks };
}
