// What stands on the display: the bar, the rack, what is to be taken, the lines, the buttons, and what covers them all.
import { make } from '../parts';
import type { Mistake } from './judge';
import { countdown, isOver, leftOf, linesLeft, litOf, nextOf } from './lines';
import { drawRack } from './rack';
import type { Line, Station } from './state';
import { clockTime, t, time } from './words';

export const write = (element: HTMLElement, text: string): void => {
  if (element.textContent !== text) element.textContent = text;
};
const words = (className: string, text: string): HTMLElement => make('p', { className, textContent: text });

type Next = NonNullable<Station['next']>;

/** When the next rack comes; nobody knows that while its robot waits for something that has no known end. */
const comesIn = ({ rack, in_s }: Next, now: (s: number) => string): string =>
  in_s === null ? t('bar.next.unknown', { rack }) : t('bar.next', { rack, time: now(in_s) });
const comesSoon = ({ rack, robot, in_s }: Next, now: (s: number) => string): string =>
  in_s === null ? t('none.unknown', { rack, robot }) : t('none.soon', { rack, time: now(in_s), robot });

export class Board {
  readonly bar = make('header', { className: 'bar' });
  readonly rack = make('div', { className: 'rack' });
  readonly big = make('section', { className: 'big' });
  readonly counts = make('div', { className: 'counts' });
  readonly lines = make('ol', { className: 'lines', tabIndex: 0, ariaLabel: t('lines') });
  readonly note = make('p', { className: 'note', role: 'status' });
  readonly paused = make('p', { className: 'paused', role: 'status', hidden: true });
  /** For those who hear the page. */
  readonly spoken = make('p', { className: 'hidden', role: 'status' });
  readonly alert = make('p', { className: 'hidden', role: 'alert' });
  readonly old = make('div', { className: 'old', hidden: true });
  #drawn = new Map<HTMLElement, string>();
  #left = { left: words('left', ''), end: words('end', ''), next: words('next', '') };
  #soon = words('soon', '');
  #oldTitle = make('strong', {});

  constructor() {
    this.counts.append(this.#left.left, this.#left.end);
    // The seconds are not said again and again.
    this.old.append(make('div', {}, this.#oldTitle, make('span', { role: 'alert', textContent: t('old.text') })));
  }

  /** Shows a state; `age_ms` is how long ago the server said it. */
  show(station: Station, mistake: Mistake | null, age_ms: number): void {
    const { visit, paused, id, robot, served, totes, reach, hands_seen } = station;
    const rack = visit?.rack ?? null;
    this.#once(this.bar, [id, rack, robot, served], () => [
      make('h1', { textContent: t('bar.station', { id }) }),
      ...(rack === null ? [] : [words('', t('bar.rack', { rack }))]),
      ...(robot === null ? [] : [words('', t('bar.robot', { robot }))]),
      words('grow', t('bar.served', { count: served })),
      this.#left.next,
    ]);
    this.#countDown(station, age_ms);
    // Not by its expected end, which is another one in every message.
    const shown = [visit?.lines, visit?.face, rack, visit === null, totes, reach, mistake];
    this.#once(this.rack, shown, () => [drawRack(station, mistake)]);
    this.#once(this.big, [visit?.lines, visit?.rack, mistake, visit === null, hands_seen], () =>
      this.#bigWords(station, mistake),
    );
    this.#showLines(visit?.lines ?? []);
    this.paused.hidden = paused === null;
    write(this.paused, paused === null ? '' : t('paused', { time: clockTime(paused) }));
    write(this.spoken, sentence(station));
    write(this.alert, mistake ? `${mistakeTitle(mistake)}. ${mistakeHelp(mistake)}.` : '');
  }

  /** Says that what is shown may not be trusted, or no longer. */
  showOld(isOld: boolean, age_ms: number, isFirst: boolean): void {
    this.old.hidden = !isOld;
    write(this.#oldTitle, isFirst ? t('old.first') : t('old.heading', { time: time(age_ms / 1000) }));
  }

  #countDown({ visit, next }: Station, age_ms: number): void {
    const { left, end, next: coming } = this.#left;
    const now = (s: number): string => time(countdown(s, age_ms));
    const lines = visit ? linesLeft(visit) : 0;
    write(left, visit && lines > 0 ? t('left', { lines, pieces: visit.pieces_left }) : '');
    const ends = visit?.expected_end ?? null;
    write(end, ends ? t('end', { time: now(ends.p50), most: now(ends.p90) }) : '');
    write(coming, next ? comesIn(next, now) : t('bar.next.none'));
    write(this.#soon, next ? comesSoon(next, now) : t('none.later'));
  }

  #bigWords({ visit, hands_seen }: Station, mistake: Mistake | null): Node[] {
    if (mistake) return [nameOf(mistake), words('title', mistakeTitle(mistake)), words('wide', mistakeHelp(mistake))];
    if (!visit) return [words('title', t('none.heading')), this.#soon];
    const [lit, next] = [litOf(visit), nextOf(visit)];
    if (!lit) {
      const kind = visit.lines.length === 0 ? 'free' : 'over';
      return [words('title', t(`${kind}.heading`)), words('wide', t(`${kind}.text`))];
    }
    const then = next ? t('big.then', { count: leftOf(next), slot: next.slot, tote: next.tote }) : t('big.last');
    const arrow = make('span', { ariaHidden: 'true', textContent: '→' });
    const take = make(
      'p',
      { className: 'take' },
      make('span', { className: 'count', textContent: t('big.count', { count: leftOf(lit) }) }),
      ' ',
      make('span', { className: 'slot', textContent: lit.slot }),
      ' ',
      make('span', { className: 'tote' }, arrow, ' ', t('big.tote', { tote: lit.tote })),
    );
    return [
      take,
      ...(lit.item === null ? [] : [words('item', lit.item)]),
      ...(lit.done === 0 ? [] : [words('of', t('big.of', { done: lit.done, count: lit.quantity }))]),
      ...(lit.by === 'arm' ? [words('arm', t('big.arm'))] : []),
      words('then', then),
      words('hands', t(hands_seen ? 'big.hands' : 'big.hands.none')),
    ];
  }

  #showLines(lines: readonly Line[]): void {
    this.lines.hidden = lines.length === 0;
    // Where the list has another height, such as after a tablet was turned, another part of it is to be seen.
    const isNew = this.#once(this.lines, [lines, this.lines.clientHeight], () => lines.map(lineOf));
    const lit = this.lines.querySelector<HTMLElement>('[data-state="lit"]');
    // A long list shows the lit line with the one before it. Only the list itself moves, never the page.
    if (isNew && lit) this.lines.scrollTop = lit.offsetTop - this.lines.offsetTop - lit.offsetHeight;
  }

  /** Fills an element if what it shows has changed; whether it had. */
  #once(element: HTMLElement, shows: readonly unknown[], children: () => Node[]): boolean {
    const key = JSON.stringify(shows);
    if (this.#drawn.get(element) === key) return false;
    this.#drawn.set(element, key);
    element.replaceChildren(...children());
    return true;
  }
}

function lineOf(line: Line): HTMLElement {
  const { quantity: count, slot, tote, item, done, state } = line;
  const how = state === 'short' ? t('line.short', { done, count }) : t(`line.${state}`);
  const element = make(
    'li',
    {},
    make('span', { className: 'what', textContent: t('line', { count, slot, tote }) }),
    make('span', { className: 'item', textContent: item ?? '' }),
    make('span', { className: 'how', textContent: how }),
  );
  element.dataset['state'] = state;
  if (isOver(line)) element.dataset['over'] = '';
  return element;
}

/** What is to be done, as a sentence. */
function sentence({ visit }: Station): string {
  const lit = litOf(visit);
  if (!lit) return visit === null ? t('none.heading') : t(visit.lines.length === 0 ? 'free.heading' : 'over.heading');
  const { slot, tote, item } = lit;
  const count = leftOf(lit);
  return item === null ? t('take', { count, slot, tote }) : t('take.item', { count, slot, tote, item });
}

/** A cross and what is wrong, to be read from afar; a long name stands in the sentence below alone. */
function nameOf({ is }: Mistake): HTMLElement {
  const isShort = is !== null && is.length <= 4;
  const name = make('p', { className: 'named', ariaHidden: 'true' });
  if (isShort) name.append(make('span', { textContent: is }));
  return name;
}

const mistakeTitle = ({ kind, is }: Mistake): string =>
  kind === 'wrong_slot' ? t('mistake.slot', { is: is ?? '' }) : t('mistake.tote', { is: is ?? '' });
const mistakeHelp = ({ kind, right }: Mistake): string => {
  if (right === null) return t('mistake.stop');
  return kind === 'wrong_slot' ? t('mistake.slot.right', { right }) : t('mistake.tote.right', { right });
};
