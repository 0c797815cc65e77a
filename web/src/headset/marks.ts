// The sheets of a map's marks, to be printed and laid on the floor: a cross for the place, the name, and a code that
// leads a phone to this page.
import { encode } from 'uqr';
import { make } from './dom';
import { languageField, marksOf } from './signin';
import { coordinate, t } from './words';
import type { Place } from './align';
import type { FloorMap } from '../wire';

const SVG = 'http://www.w3.org/2000/svg';
/** White around a code, in its own squares, so that cameras find it. */
const QUIET = 4;

export function markSheets(map: FloorMap, again: () => void): HTMLElement {
  const marks = marksOf(map);
  const print = make('button', {
    type: 'button',
    className: 'main',
    textContent: t('sheet.print'),
    disabled: marks.length === 0,
  });
  print.addEventListener('click', () => globalThis.print());
  const isListed = (map.marks ?? []).length > 0;
  const about = marks.length === 0 ? t('sheet.none') : isListed ? '' : t('sheet.all');
  const bar = make(
    'div',
    { className: 'panel sign bar' },
    make('h1', { textContent: t('sheet.heading', { map: map.name }) }),
    languageField(again),
    make('p', { textContent: t('sheet.count', { count: marks.length }) }),
    ...(about === '' ? [] : [make('p', { className: 'dim', textContent: about })]),
    make('div', { className: 'row wrap' }, print, make('a', { href: '/headset', textContent: t('sheet.back') })),
  );
  return make('main', { className: 'sheets' }, bar, ...marks.map(sheet));
}

function sheet(mark: Place): HTMLElement {
  const [x, y] = mark.at;
  const address = `${location.origin}/headset?mark=${encodeURIComponent(mark.name)}`;
  const title = t('sheet.mark', { name: mark.name });
  return make(
    'section',
    { className: 'sheet', ariaLabel: title },
    make('p', { className: 'up', textContent: `↑ ${t('sheet.up')}` }),
    cross(),
    make('h2', { textContent: title }),
    make('p', { textContent: t('sheet.place', { x: coordinate(x), y: coordinate(y) }) }),
    make('div', { className: 'scan' }, code(address), make('p', { textContent: t('sheet.scan') })),
    make('p', { textContent: t('sheet.floor') }),
  );
}

function drawing(size: number, name: string): SVGSVGElement {
  const svg = document.createElementNS(SVG, 'svg');
  svg.setAttribute('viewBox', `0 0 ${size} ${size}`);
  svg.setAttribute('class', name);
  svg.setAttribute('aria-hidden', 'true');
  return svg;
}
function path(svg: SVGSVGElement, d: string): SVGPathElement {
  const drawn = document.createElementNS(SVG, 'path');
  drawn.setAttribute('d', d);
  svg.append(drawn);
  return drawn;
}

/** The exact place: where two lines cross. */
function cross(): SVGSVGElement {
  const svg = drawing(100, 'cross');
  path(svg, 'M50 2V98M2 50H98M50 20A30 30 0 1 0 50.1 20');
  return svg;
}

/** A QR code of an address, as one path. */
export function code(address: string): SVGSVGElement {
  const { data, size } = encode(address, { ecc: 'M', border: 0 });
  const svg = drawing(size + 2 * QUIET, 'code');
  path(
    svg,
    data
      .flatMap((row, y) => row.flatMap((isDark, x) => (isDark ? [`M${x + QUIET} ${y + QUIET}h1v1h-1z`] : [])))
      .join(''),
  );
  return svg;
}
