// The page of a wearer: sign in, choose marks, then the view into the room, a map on a phone, or the twin.
import '../app.css';
import './headset.css';
import { applyTheme, storedTheme } from '../parts';
import type { FloorMap } from '../wire';
import { suggest, type Place } from './align';
import type { Aim } from './arrow';
import { field, make } from './dom';
import { Painter } from './gl';
import { inkOf, roomInk } from './ink';
import { Overlay } from './overlay';
import { drawMap, onMap, type Lens, type Self } from './phone';
import { canStand } from './polygon';
import { board, refusal, Screen, write } from './screen';
import { Server } from './server';
import { Wearer, PLACED_MS } from './wearer';
import { offers, RoomView } from './xr';

applyTheme(storedTheme());
const host = document.getElementById('headset');
const server = new Server();
const KEPT = 'giveway.headset';
const SAFETY = 'This is not a safety device. Robots must see people and stop by themselves, whatever this page shows. Look out for yourself.';
const clock = { now: () => performance.now(), after: (ms: number, run: () => void) => setTimeout(run, ms), cancel: (timer: unknown) => clearTimeout(timer as number) };

interface Kept {
  name: string;
  marks: string[];
  /** Where the twin begins. */
  start: string;
}
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

/** The first screen: who wears this, and by which marks. `ended` says why a session before is over. */
async function signIn(ended = ''): Promise<void> {
  const [canSee, map, workers] = await Promise.all([offers('immersive-ar'), server.map(), server.workers()]);
  if (!host) return;
  if (map.kind !== 'ok') return void host.replaceChildren(locked(map.kind === 'locked', map.kind === 'refused' ? map.text : ''));
  const old = kept();
  const places = map.value.nodes.map((n): Place => ({ name: n.id, at: [n.x, n.y] }));
  const known = new Map(places.map((p) => [p.name, p]));
  const fixed = map.value.nodes.filter((n) => !['aisle', 'storage', 'queue'].includes(n.kind)).map((n): Place => ({ name: n.id, at: [n.x, n.y] }));
  const proposed = suggest(fixed) ?? suggest(places.slice(0, 200));
  const first = old.marks.every((m) => known.has(m)) && old.marks.length >= 2 ? old.marks : (proposed ?? []).map((p) => p.name);

  const name = make('input', { id: 'name', name: 'name', required: true, maxLength: 64, autocomplete: 'off', value: old.name, placeholder: 'picker-7' });
  name.setAttribute('list', 'names');
  const names = make('datalist', { id: 'names' }, ...(workers.kind === 'ok' ? workers.value.items : []).map((w) => make('option', { value: w.name })));
  const marks = [0, 1, 2].map((i) => {
    const select = make('select', { id: `mark-${i}`, name: `mark-${i}` }, ...(i === 2 ? [make('option', { value: '', textContent: 'none' })] : []),
      ...places.map((p) => make('option', { value: p.name, textContent: p.name })));
    select.value = first[i] ?? (i === 2 ? '' : (places[i]?.name ?? ''));
    return select;
  });
  const standing = places.filter((p) => canStand(map.value, p.at));
  const start = make('select', { id: 'start', name: 'start' }, ...standing.map((p) => make('option', { value: p.name, textContent: p.name })));
  start.value = standing.some((p) => p.name === old.start) ? old.start : (standing[0]?.name ?? '');
  const error = make('p', { className: 'error', role: 'alert', textContent: ended });
  const twin = make('button', { type: 'button', textContent: 'Enter the twin', disabled: standing.length === 0 });
  const room = make('button', { type: 'submit', className: 'main', textContent: 'Enter the room view', disabled: !canSee });
  const flat = make('button', { type: 'button', textContent: 'Use as a phone: map and text', className: canSee ? '' : 'main' });
  const why = isSecureContext ? 'This browser has no room view (WebXR). ' : 'The room view needs HTTPS: open this page with https://. ';
  const form = make('form', { className: 'panel sign' },
    make('h1', { textContent: 'Guidance for a person' }),
    make('p', { className: 'safety', textContent: SAFETY }),
    field('Name of the wearer', name, 'The same name means the same worker. Use a pseudonym rather than a real name.'), names,
    ...(canSee
      ? [make('fieldset', {}, make('legend', { textContent: 'Marks on the floor that you will show' }),
        make('p', { className: 'dim', textContent: 'Choose two or three places on the map, ideally ten metres apart. In the room view, stand on each and confirm.' }),
        ...marks.map((m, i) => field(i === 2 ? 'Third mark (more reliable)' : i === 0 ? 'First mark' : 'Second mark', m)))]
      : [make('p', { className: 'dim', textContent: `${why}A phone shows the same guidance on a map.` })]),
    error, make('div', { className: 'row wrap' }, flat, ...(canSee ? [room] : [])),
    make('fieldset', {}, make('legend', { textContent: 'The twin: the floor in three dimensions' }),
      make('p', { className: 'dim', textContent: 'Walk through the floor in this window or with a VR headset, to try things out or to train. Robots give way to you as to anybody on the floor.' }),
      field('Begin at', start), make('div', { className: 'row' }, twin)),
    make('p', { className: 'dim small', textContent: 'This page uses and sends no camera images. The server receives positions and keeps those of encounters with robots.' }),
    make('p', { className: 'small' }, make('a', { href: '/', textContent: 'To the dashboard' })));
  const begin = async (view: 'room' | 'phone' | 'twin'): Promise<void> => {
    const chosen = marks.map((m) => m.value).filter((m) => m !== '');
    if (!form.reportValidity()) return;
    if (view === 'room' && new Set(chosen).size < chosen.length) return void (error.textContent = 'Choose different marks.');
    error.textContent = '';
    // The room needs a click that is fresh: what else is to be asked is asked after it is open.
    const hired = server.hire(name.value.trim());
    keep({ name: name.value.trim(), marks: chosen, start: start.value });
    if (view !== 'room') {
      const worker = await hired;
      if (worker.kind !== 'ok') return void (error.textContent = words(worker));
      const { id, name: known } = worker.value;
      return view === 'phone' ? phone(map.value, id, known) : enterTwin(map.value, { id, name: known }, standing.find((p) => p.name === start.value) ?? standing[0]!);
    }
    const failed = await seeRoom(hired, chosen.map((m) => known.get(m)!), name.value.trim());
    if (failed) error.textContent = failed;
  };
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    void begin(canSee ? 'room' : 'phone');
  });
  flat.addEventListener('click', () => void begin('phone'));
  twin.addEventListener('click', () => void begin('twin'));
  host.dataset['screen'] = 'sign-in';
  host.replaceChildren(make('main', {}, form));
}

const words = (answer: { kind: 'locked' } | { kind: 'refused'; text: string } | { kind: 'unreachable' }): string =>
  answer.kind === 'refused' ? answer.text : answer.kind === 'locked' ? 'The server requires a different token: reload this page.' : 'The server cannot be reached.';

/** Asks for the token, or to try again. */
function locked(wantsToken: boolean, text: string): HTMLElement {
  const token = make('input', { id: 'token', type: 'password', required: true, autocomplete: 'off' });
  const form = make('form', { className: 'panel sign' }, make('h1', { textContent: wantsToken ? 'This server requires an access token' : 'No answer' }),
    make('p', { className: wantsToken ? 'dim' : 'error', textContent: wantsToken ? 'Whoever runs this server can give you one.' : text || 'The server cannot be reached.' }),
    ...(wantsToken ? [field('Token', token)] : []),
    make('div', { className: 'row' }, make('button', { type: 'submit', className: 'main', textContent: wantsToken ? 'Continue' : 'Try again' })));
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    if (wantsToken) server.token = token.value.trim();
    void signIn();
  });
  return make('main', {}, form);
}

/** The view into the room. Answers with what went wrong at the start, if anything. */
async function seeRoom(hired: ReturnType<Server['hire']>, marks: readonly Place[], name: string): Promise<string> {
  if (!host) return '';
  const canvas = make('canvas', {});
  let id = '';
  let over = false;
  const wearer: Wearer = new Wearer({
    frame: 'device', poses: 'tracked', clock, random: Math.random, marks, open: (events) => server.open(id, events), onChange: () => refresh(),
  });
  const screen = new Screen(host, wearer);
  const refresh = (): void => {
    const shown = wearer.shown();
    const [title, detail] = board(shown, wearer);
    screen.say(shown, title, detail);
  };
  let view: RoomView;
  try {
    view = await RoomView.enter('immersive-ar', new Overlay(new Painter(canvas), roomInk(), inkOf, null), {
      sample: (sample) => wearer.frame(sample),
      confirm: (at) => wearer.confirm(at),
      held: () => wearer.remark(),
      reset: () => wearer.reset(),
      woke: () => wearer.woke(),
      ended: () => {
        over = true;
        clearInterval(beat);
        screen.close();
        void left(id, name);
      },
      scene: () => {
        const shown = wearer.shown();
        const [title, detail] = board(shown, wearer);
        const marking = wearer.marking.kind === 'taking' || wearer.marking.kind === 'refused';
        return { shown, alignment: wearer.alignment, marking, narrow: false, board: 'eyes', title, detail };
      },
      drew: (target: Aim | null) => {
        wearer.drawn();
        host.dataset['aim'] = target ? target.kind : 'none';
      },
    });
  } catch (error) {
    screen.close();
    return `The view did not open: ${error instanceof Error ? error.message : String(error)}`;
  }
  const beat = setInterval(() => wearer.tick(), 100);
  const leave = make('button', { textContent: 'Close the view' });
  leave.addEventListener('click', () => void view.leave());
  host.dataset['screen'] = 'room';
  host.replaceChildren(make('main', { className: 'room' }, screen.banner, screen.note, screen.stop,
    make('p', { className: 'dim', textContent: `${name} sees guidance in the room.${view.wide ? '' : ' This device is reliable only within about 15 m of where it started.'}` }),
    make('div', { className: 'row' }, leave), canvas));
  const worker = await hired;
  if (over) return '';
  if (worker.kind !== 'ok') {
    await view.leave();
    await signIn(words(worker));
    return '';
  }
  id = worker.value.id;
  wearer.start();
  refresh();
  return '';
}

/** The twin, which is fetched only when somebody enters it. */
async function enterTwin(map: FloorMap, worker: { id: string; name: string }, start: Place): Promise<void> {
  if (!host) return;
  const [{ Twin }, kinds] = await Promise.all([import('./twin'), server.kinds()]);
  try {
    const twin = new Twin({
      host, server, map: { ...map, kinds: kinds.kind === 'ok' ? kinds.value : [] }, worker, start: start.at, clock, safety: SAFETY,
      left: () => leave(worker.id, worker.name),
    });
    await twin.open();
  } catch (error) {
    await signIn(`The twin did not open: ${error instanceof Error ? error.message : String(error)}`);
  }
}

/** After the view: robots go on keeping away, until somebody says that nobody is there. */
async function left(id: string, name: string, wrong = ''): Promise<void> {
  if (!host || id === '') return signIn();
  const again = make('button', { textContent: 'Reopen the view', className: 'main' });
  const gone = make('button', { textContent: 'I have left the floor' });
  const error = make('p', { className: 'error', role: 'alert', textContent: wrong });
  again.addEventListener('click', () => void signIn());
  gone.addEventListener('click', () => {
    void server.clear(id, name).then((answer) => {
      if (answer.kind === 'ok') void signIn(`${name} has left the floor.`);
      else error.textContent = words(answer);
    });
  });
  host.dataset['screen'] = 'left';
  host.replaceChildren(make('main', {}, make('div', { className: 'panel sign' }, make('h1', { textContent: 'The view is closed' }),
    make('p', { textContent: `Robots still keep away from every place that ${name} could have reached. Reopen the view, or leave the floor and confirm it below.` }),
    error, make('div', { className: 'row wrap' }, gone, again))));
}

/** Says that nobody is there any more. Robots go on keeping away unless the server has heard it. */
function leave(id: string, name: string): void {
  void server.clear(id, name).then((answer) => (answer.kind === 'ok' ? signIn(`${name} has left the floor.`) : left(id, name, words(answer))));
}

/** The map on a phone. */
function phone(map: FloorMap, id: string, name: string): void {
  if (!host) return;
  const canvas = make('canvas', { className: 'map', role: 'img', ariaLabel: 'Map with your path' });
  const wearer: Wearer = new Wearer({ frame: 'map', poses: 'placed', clock, random: Math.random, marks: [], open: (events) => server.open(id, events), onChange: () => refresh() });
  const screen = new Screen(host, wearer);
  const where = make('p', { className: 'where' });
  const near = make('ul', { className: 'near', ariaLabel: 'Robots nearby' });
  const gone = make('button', { textContent: 'I have left the floor' });
  const done = make('button', { textContent: 'Done', className: 'main', hidden: true });
  const back = make('button', { textContent: 'Connect again', className: 'main', hidden: true });
  let [self, seen, shot]: [Self | null, Self | null, Lens | null] = [null, null, null];
  const refresh = (): void => {
    const shown = wearer.shown();
    const ended = wearer.feed.kind === 'ended' ? wearer.feed.text : '';
    screen.say(shown, shown.title, ended || `${refusal(wearer)}${shown.detail}`);
    back.hidden = ended === '';
    done.hidden = wearer.due() === null;
    self = wearer.placed ? { at: wearer.placed.at, heading: null } : seen;
    const for_s = wearer.placed ? Math.ceil((PLACED_MS - (clock.now() - wearer.placed.since)) / 1000) : 0;
    write(where, wearer.placed ? `You said that you stand here. This is valid for ${for_s} s: tap again after you move.`
      : seen ? 'Your position comes from a tag or another device.' : 'The server does not know where you are. Tap the map where you stand.');
    const lines = shown.near.map((r) => `${r.id}: ${r.distance.toFixed(1)} m${r.closest_s === null ? '' : ', coming closer'}`);
    if (near.dataset['lines'] !== lines.join()) {
      near.dataset['lines'] = lines.join();
      near.replaceChildren(...lines.map((textContent) => make('li', { textContent })));
    }
    if (canvas.isConnected) shot = drawMap(canvas, map, self, shown, inkOf);
    wearer.drawn();
  };
  const look = async (): Promise<void> => {
    const answer = await server.worker(id);
    const w = answer.kind === 'ok' ? answer.value : null;
    // Without a tag the server knows nothing newer than what was said here.
    seen = w && w.x !== null && w.y !== null && w.presence === 'tracked' ? { at: [w.x, w.y], heading: w.heading } : null;
  };
  const beats = [setInterval(() => wearer.tick(), 250), setInterval(() => void look(), 1_000)];
  canvas.addEventListener('click', (event) => {
    const box = canvas.getBoundingClientRect();
    if (shot) wearer.place(onMap(shot, [event.clientX - box.left, event.clientY - box.top], box.width, box.height));
  });
  back.addEventListener('click', () => wearer.retryNow());
  done.addEventListener('click', () => wearer.done());
  gone.addEventListener('click', () => {
    beats.forEach(clearInterval);
    screen.close();
    leave(id, name);
  });
  host.dataset['screen'] = 'phone';
  host.replaceChildren(make('main', { className: 'phone' }, screen.banner, canvas, where, near, screen.note, screen.stop,
    make('div', { className: 'row wrap' }, make('span', { className: 'dim grow', textContent: name }), back, done, gone),
    make('p', { className: 'safety', textContent: SAFETY })));
  wearer.start();
  refresh();
}

void signIn();
