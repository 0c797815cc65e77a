// The rack as the picker sees it, to scale, and the totes: what is lit, what comes next, what is over, what was wrong.
import { draw, reachWidth, type Box } from './face';
import type { Mistake } from './judge';
import { leftOf, litOf, nextOf, slotMarks, type Mark } from './lines';
import type { Station } from './state';
import { t } from './words';

const SPACE = 'http://www.w3.org/2000/svg';
type Attributes = Readonly<Record<string, string | number>>;

function shape(tag: string, attributes: Attributes, ...children: (Node | string)[]): SVGElement {
  const element = document.createElementNS(SPACE, tag);
  Object.entries(attributes).forEach(([name, value]) => element.setAttribute(name, String(value)));
  element.append(...children);
  return element;
}

const box = ({ x, y, width, height }: Box, inset: number, more: Attributes): SVGElement => {
  const [wide, high] = [width - 2 * inset, height - 2 * inset];
  return shape('rect', { x: x + inset, y: y + inset, width: wide, height: high, rx: 0.02, ...more });
};
const words = (text: string, x: number, y: number, size: number, className: string): SVGElement =>
  shape('text', { x, y, 'font-size': size, class: className }, text);

/** What stands in a slot or tote besides its name. */
interface Said {
  mark: Mark | 'plain';
  /** Pieces to pick, where they are to be read from afar. */
  count: number | null;
  isWrong: boolean;
}

/** A name that is read from afar, and a cross that leaves it alone: below it, or beside it where there is more room. */
function wrongWords({ name, x, y, width, height }: Box): SVGElement[] {
  const isWide = width > height;
  const [left, down] = isWide ? [0.33, 0.5] : [0.5, 0.29];
  const [cx, cy, r] = isWide ? [0.73, 0.5, height * 0.2] : [0.5, 0.7, width * 0.22];
  const size = Math.min((width * (isWide ? 0.75 : 1)) / Math.max(2, name.length), height * (isWide ? 0.65 : 0.35));
  const across = `l${2 * r} ${2 * r} m0 ${-2 * r} l${-2 * r} ${2 * r}`;
  return [
    words(name, x + width * left, y + height * down + size * 0.36, size, 'name'),
    shape('path', { d: `M${x + width * cx - r} ${y + height * cy - r} ${across}`, class: 'cross' }),
  ];
}

/** A tick for what is done; for what is missing, a circle with a stroke through it. */
function sign({ x, y, width, height }: Box, mark: Mark | 'plain'): SVGElement[] {
  const [cx, cy, r] = [x + width / 2, y + height * 0.66, Math.min(width, height) * 0.2];
  const k = r * 0.7;
  const tick = `M${cx - r} ${cy} l${k} ${k} l${r * 1.3} ${-r * 1.4}`;
  const circle = `M${cx - r} ${cy} a${r} ${r} 0 1 0 ${2 * r} 0 a${r} ${r} 0 1 0 ${-2 * r} 0`;
  if (mark === 'done') return [shape('path', { d: tick, class: 'sign done' })];
  if (mark !== 'short') return [];
  return [shape('path', { d: `${circle} M${cx - k} ${cy + k} L${cx + k} ${cy - k}`, class: 'sign short' })];
}

function cell(place: Box, kind: 'slot' | 'tote', { mark, count, isWrong }: Said): SVGElement {
  const { name, x, y, width, height } = place;
  const small = Math.min(width * (name.length > 2 ? 0.34 : 0.46), height * 0.3);
  const large = Math.min(width * (count !== null && count > 99 ? 0.42 : 0.6), height * 0.5);
  const parts = [box(place, 0.008, { class: 'ground' })];
  if (isWrong) {
    parts.push(...wrongWords(place));
  } else if (count !== null) {
    parts.push(words(name, x + width / 2, y + height * 0.33, small, 'name'));
    parts.push(words(String(count), x + width / 2, y + height * 0.84, large, 'count'));
  } else if (kind === 'tote' || mark === 'plain' || mark === 'open' || mark === 'next') {
    const size = kind === 'tote' ? height * 0.62 : small;
    parts.push(words(name, x + width / 2, y + height / 2 + size * 0.36, size, 'name'));
  } else {
    parts.push(words(name, x + width / 2, y + height * 0.36, small, 'name'), ...sign(place, mark));
  }
  const wrong = isWrong ? { 'data-wrong': '' } : {};
  return shape('g', { class: `${kind} ${mark}`, 'data-name': name, 'data-mark': mark, ...wrong }, ...parts);
}

/** Draws the rack anew. Outlines say where the hand is thought to go: the likelier, the wider. */
export function drawRack(station: Station, mistake: Mistake | null): SVGElement {
  const { visit, totes, reach } = station;
  const [lit, next, marks] = [litOf(visit), nextOf(visit), slotMarks(visit)];
  const drawing = draw(visit?.face ?? null, totes);
  const slots = drawing.slots.map((slot) =>
    cell(slot, 'slot', {
      mark: marks.get(slot.name) ?? 'plain',
      count: lit?.slot === slot.name ? leftOf(lit) : null,
      isWrong: mistake?.kind === 'wrong_slot' && mistake.is === slot.name,
    }),
  );
  const below = drawing.totes.map((tote) =>
    cell(tote, 'tote', {
      mark: lit?.tote === tote.name ? 'lit' : next?.tote === tote.name ? 'next' : 'plain',
      count: null,
      isWrong: mistake?.kind === 'wrong_tote' && mistake.is === tote.name,
    }),
  );
  const hands = (places: readonly Box[], kind: 'slot' | 'tote'): SVGElement[] =>
    places.flatMap((place) => {
      const probability = Math.max(0, ...reach.filter((one) => one[kind] === place.name).map((one) => one.probability));
      const width = reachWidth(probability);
      const more = { class: 'reach', 'stroke-width': width, 'data-reach': place.name };
      // The frame of a wrong place says more.
      const isWrong = mistake?.kind === `wrong_${kind}` && mistake.is === place.name;
      return width === 0 || isWrong ? [] : [box(place, 0.008 + width / 2, more)];
    });
  const { body } = drawing;
  // Where no slots are known, the rack has its name; where no rack is, a dashed line says where it will be.
  const outline = box(body, 0, { class: visit ? 'body' : 'body empty' });
  const isBare = drawing.slots.length === 0 && visit?.rack;
  const title = isBare ? [words(visit.rack ?? '', 0, body.y + body.height / 2, 0.2, 'name')] : [];
  const label = lit ? t('face.take', { slot: lit.slot, tote: lit.tote }) : t('face');
  // Those that are lit are drawn over the edges of their neighbours, and what is wrong over all.
  const rank = ({ classList, dataset }: SVGElement): number =>
    'wrong' in dataset ? 2 : Number(classList.contains('lit'));
  const inOrder = [...slots, ...below].sort((a, b) => rank(a) - rank(b));
  const seen = { viewBox: drawing.view.join(' '), role: 'img', 'aria-label': label, class: 'face' };
  const reaches = [...hands(drawing.slots, 'slot'), ...hands(drawing.totes, 'tote')];
  return shape('svg', seen, outline, ...title, ...inOrder, ...reaches);
}
