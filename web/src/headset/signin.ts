// The first screen: who wears this, in which language, and by which marks; or the token that the server wants.
import { beside, suggest, type Place } from './align';
import { field, make } from './dom';
import { canStand } from './polygon';
import type { Answer } from './server';
import { voice } from './voice';
import { learn, spoken, t } from './words';
import { chooseLanguage, LANGUAGES, type Language } from '../language';
import type { FloorMap, Worker } from '../wire';

/** What a wearer chose. */
export interface SignedIn {
  view: 'room' | 'phone' | 'twin';
  name: string;
  marks: readonly Place[];
  /** Where the twin begins. */
  start: Place | null;
}
export interface SignInOptions {
  map: FloorMap;
  workers: readonly Worker[];
  /** Whether the browser shows the room. */
  canSee: boolean;
  /** Why a session before is over; empty for none. */
  ended: string;
  /** Answers with what went wrong, if anything. */
  begin(chosen: SignedIn): Promise<string>;
  /** Draws the screen again, in another language. */
  again(): void;
}

interface Kept {
  name: string;
  marks: string[];
  /** Where the twin begins. */
  start: string;
}
const KEPT = 'giveway.headset';
const kept = (): Kept => {
  try {
    const read = JSON.parse(localStorage.getItem(KEPT) ?? '{}') as Partial<Kept>;
    return { name: read.name ?? '', marks: read.marks ?? [], start: read.start ?? '' };
  } catch {
    return { name: '', marks: [], start: '' };
  }
};
const keep = (now: Kept): void => {
  try {
    localStorage.setItem(KEPT, JSON.stringify(now));
  } catch {
    // Storage may be forbidden; then it is typed again.
  }
};

/** The marks of a map: those that it lists, else what stands fast on its floor. */
export function marksOf(map: FloorMap): Place[] {
  if (map.marks && map.marks.length > 0) return map.marks.map((m): Place => ({ name: m.name, at: [m.x, m.y] }));
  const fast = map.nodes.filter((n) => !['aisle', 'storage', 'queue'].includes(n.kind));
  return fast.map((n): Place => ({ name: n.id, at: [n.x, n.y] }));
}
/** Every place that the server takes for a mark, those of `marksOf` first. */
export function placesOf(map: FloorMap): Place[] {
  const first = map.marks && map.marks.length > 0 ? marksOf(map) : [];
  const named = new Set(first.map((p) => p.name));
  return [...first, ...map.nodes.filter((n) => !named.has(n.id)).map((n): Place => ({ name: n.id, at: [n.x, n.y] }))];
}

/** The address asks for the twin at once: somebody wants to walk in without more ado. Once, since who leaves it has
 *  seen it. */
let walksIn = new URLSearchParams(location.search).has('twin');

const option = (name: string): HTMLOptionElement => make('option', { value: name, textContent: name });

/** The languages, each by its own name. */
export function languageField(again: () => void): HTMLElement {
  const choices = (Object.entries(LANGUAGES) as [Language, string][]).map(([code, name]) => {
    const choice = make('option', { value: code, textContent: name });
    choice.lang = code;
    return choice;
  });
  const select = make('select', { id: 'language', name: 'language' }, ...choices);
  select.value = spoken();
  select.addEventListener('change', () => {
    chooseLanguage(select.value as Language);
    void learn(select.value as Language).then(again);
  });
  return field(t('language'), select);
}

/** What a wearer fills in. */
export function signInForm(options: SignInOptions): HTMLElement {
  const { map, workers, canSee, begin } = options;
  const old = kept();
  const places = placesOf(map);
  const known = new Map(places.map((p) => [p.name, p]));
  const two = suggest(marksOf(map)) ?? suggest(places.slice(0, 200));
  const third = two && (beside(marksOf(map), two) ?? beside(places.slice(0, 200), two));
  const proposed = two && third ? [...two, third] : two;
  const isOld = old.marks.every((m) => known.has(m)) && old.marks.length >= 2;
  const first = isOld ? old.marks : (proposed ?? []).map((p) => p.name);

  const name = make('input', {
    id: 'name',
    name: 'name',
    required: true,
    maxLength: 64,
    autocomplete: 'off',
    value: old.name,
    placeholder: 'picker-7',
  });
  name.setAttribute('list', 'names');
  const names = make('datalist', { id: 'names' }, ...workers.map((w) => make('option', { value: w.name })));
  const none = make('option', { value: '', textContent: t('sign.mark.none') });
  const marks = [0, 1, 2].map((i) => {
    const select = make(
      'select',
      { id: `mark-${i}`, name: `mark-${i}` },
      ...(i === 2 ? [none] : []),
      ...places.map((p) => option(p.name)),
    );
    select.value = first[i] ?? (i === 2 ? '' : (places[i]?.name ?? ''));
    return select;
  });
  const standing = places.filter((p) => canStand(map, p.at));
  const start = make('select', { id: 'start', name: 'start' }, ...standing.map((p) => option(p.name)));
  start.value = standing.some((p) => p.name === old.start) ? old.start : (standing[0]?.name ?? '');
  const error = make('p', { className: 'error', role: 'alert', textContent: options.ended });
  const twin = make('button', { type: 'button', textContent: t('sign.twin.enter'), disabled: standing.length === 0 });
  const room = make('button', { type: 'submit', className: 'main', textContent: t('sign.room'), disabled: !canSee });
  const flat = make('button', { type: 'button', textContent: t('sign.phone'), className: canSee ? '' : 'main' });
  const form = make(
    'form',
    { className: 'panel sign' },
    make('h1', { textContent: t('sign.heading') }),
    languageField(options.again),
    make('p', { className: 'safety', textContent: t('safety') }),
    field(t('sign.name'), name, t('sign.name.help')),
    names,
    canSee
      ? markFields(marks)
      : make('p', { className: 'dim', textContent: `${whyNoRoom()} ${t('sign.phone.instead')}` }),
    error,
    make('div', { className: 'row wrap' }, flat, ...(canSee ? [room] : [])),
    make(
      'fieldset',
      {},
      make('legend', { textContent: t('sign.twin') }),
      make('p', { className: 'dim', textContent: t('sign.twin.help') }),
      field(t('sign.twin.start'), start),
      make('div', { className: 'row' }, twin),
    ),
    make('p', { className: 'dim small', textContent: t('sign.privacy') }),
    make(
      'p',
      { className: 'small links' },
      make('a', { href: '/headset/marks', textContent: t('sign.marks.sheets') }),
      make('a', { href: '/', textContent: t('sign.dashboard') }),
    ),
  );

  const go = async (view: SignedIn['view']): Promise<void> => {
    const chosen = marks.map((m) => m.value).filter((m) => m !== '');
    if (!form.reportValidity()) return;
    if (view === 'room' && new Set(chosen).size < chosen.length) return void (error.textContent = t('sign.marks.same'));
    error.textContent = '';
    voice.wake();
    keep({ name: name.value.trim(), marks: chosen, start: start.value });
    error.textContent = await begin({
      view,
      name: name.value.trim(),
      marks: chosen.map((m) => known.get(m)!),
      start: standing.find((p) => p.name === start.value) ?? standing[0] ?? null,
    });
  };
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    void go(canSee ? 'room' : 'phone');
  });
  flat.addEventListener('click', () => void go('phone'));
  twin.addEventListener('click', () => void go('twin'));
  if (walksIn && standing.length > 0) {
    walksIn = false;
    name.value = old.name || `${t('sign.visitor')}-${Math.floor(Math.random() * 1_000)}`;
    requestAnimationFrame(() => void go('twin'));
  }
  return make('main', {}, form);
}

const whyNoRoom = (): string => t(isSecureContext ? 'sign.room.no-xr' : 'sign.room.insecure');

function markFields(marks: readonly HTMLSelectElement[]): HTMLElement {
  const labels = [t('sign.mark.first'), t('sign.mark.second'), t('sign.mark.third')];
  return make(
    'fieldset',
    {},
    make('legend', { textContent: t('sign.marks') }),
    make('p', { className: 'dim', textContent: t('sign.marks.help') }),
    ...marks.map((mark, i) => field(labels[i] ?? '', mark)),
  );
}

/** What the server answered instead of what was wanted. */
export const refusalWords = (answer: Exclude<Answer<unknown>, { kind: 'ok' }>): string =>
  answer.kind === 'refused' ? answer.text : t(answer.kind === 'locked' ? 'refused.locked' : 'refused.unreachable');

/** Asks for the token, or to try again. */
export function lockedForm(
  answer: Exclude<Answer<unknown>, { kind: 'ok' }>,
  again: (token: string | null) => void,
): HTMLElement {
  const wantsToken = answer.kind === 'locked';
  const token = make('input', { id: 'token', type: 'password', required: true, autocomplete: 'off' });
  const form = make(
    'form',
    { className: 'panel sign' },
    make('h1', { textContent: t(wantsToken ? 'locked.heading' : 'silent.heading') }),
    languageField(() => again(null)),
    make('p', {
      className: wantsToken ? 'dim' : 'error',
      textContent: wantsToken ? t('locked.help') : refusalWords(answer),
    }),
    ...(wantsToken ? [field(t('locked.token'), token)] : []),
    make(
      'div',
      { className: 'row' },
      make('button', {
        type: 'submit',
        className: 'main',
        textContent: t(wantsToken ? 'locked.continue' : 'silent.retry'),
      }),
    ),
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    again(wantsToken ? token.value.trim() : null);
  });
  return make('main', {}, form);
}
