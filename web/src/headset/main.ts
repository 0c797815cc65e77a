// The page of a wearer: sign in, choose marks, then the view into the room, a map on a phone, or the twin.
import '../app.css';
import './headset.css';
import { applyTheme, storedTheme } from '../parts';
import type { FloorMap } from '../wire';
import type { Place } from './align';
import type { Aim } from './arrow';
import { make } from './dom';
import { Painter } from './gl';
import { inkOf, roomInk } from './ink';
import { Overlay } from './overlay';
import type { Lens, Self } from './phone';
import { joined } from './guide';
import { board, refusal, Screen, write } from './screen';
import { Server } from './server';
import { lockedForm, placesOf, refusalWords, signInForm, type SignedIn } from './signin';
import { Wearer, PLACED_MS } from './wearer';
import { learnSaid } from '../language';
import { learn, metres, seconds, t } from './words';
import { offers, RoomView } from './xr';

applyTheme(storedTheme());
const host = document.getElementById('headset');
const server = new Server();
/** So far a device goes that finds its way by what is around its start, metres. */
const NARROW_TRACKING_M = 15;
const clock = {
  now: () => performance.now(),
  after: (ms: number, run: () => void) => setTimeout(run, ms),
  cancel: (timer: unknown) => clearTimeout(timer as number),
};
const textOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));
/** The code on a mark's sheet leads here, with the name of the mark. */
let scanned = new URLSearchParams(location.search).get('mark');

/** The first screen: who wears this, and by which marks. `ended` says why a session before is over. */
async function signIn(ended = ''): Promise<void> {
  const [canSee, map, workers] = await Promise.all([offers('immersive-ar'), server.map(), server.workers()]);
  if (!host) return;
  if (map.kind !== 'ok') return locked(map, () => signIn());
  host.dataset['screen'] = 'sign-in';
  host.replaceChildren(
    signInForm({
      map: map.value,
      workers: workers.kind === 'ok' ? workers.value.items : [],
      canSee,
      ended,
      begin: (chosen) => begin(map.value, chosen),
      again: () => void signIn(),
    }),
  );
}

function locked(answer: Parameters<typeof lockedForm>[0], then: () => Promise<void>): void {
  host?.replaceChildren(
    lockedForm(answer, (token) => {
      if (token !== null) server.token = token;
      void then();
    }),
  );
}

/** Opens a view. Answers with what went wrong, if anything. */
async function begin(map: FloorMap, { view, name, marks, start }: SignedIn): Promise<string> {
  // The room needs a click that is fresh: what else is to be asked is asked after it is open.
  const hired = server.hire(name);
  if (view === 'room') return seeRoom(hired, marks, name);
  const worker = await hired;
  if (worker.kind !== 'ok') return refusalWords(worker);
  const known = { id: worker.value.id, name: worker.value.name };
  if (view === 'phone') await phone(map, known.id, known.name);
  else if (start) await enterTwin(map, known, start);
  return '';
}

/** The view into the room. Answers with what went wrong at the start, if anything. */
async function seeRoom(hired: ReturnType<Server['hire']>, marks: readonly Place[], name: string): Promise<string> {
  if (!host) return '';
  const canvas = make('canvas', {});
  let id = '';
  let over = false;
  const wearer: Wearer = new Wearer({
    frame: 'device',
    poses: 'tracked',
    clock,
    random: Math.random,
    marks,
    open: (events) => server.open(id, events),
    task: (assignment) => server.task(id, assignment),
    onChange: () => refresh(),
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
      // Where nothing is to be confirmed, a press says again what is to be done.
      confirm: (at) => {
        if (!wearer.confirm(at)) screen.again();
      },
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
        return {
          shown,
          alignment: wearer.alignment,
          marking,
          narrow: false,
          board: 'eyes',
          cell: wearer.cell,
          title,
          detail,
        };
      },
      wantsHands: () => wearer.pump.wantsHands,
      drew: (target: Aim | null) => {
        wearer.drawn();
        host.dataset['aim'] = target ? target.kind : 'none';
      },
    });
  } catch (error) {
    screen.close();
    return t('failed.room', { why: textOf(error) });
  }
  const beat = setInterval(() => wearer.tick(), 100);
  const leave = make('button', { textContent: t('room.close') });
  leave.addEventListener('click', () => void view.leave());
  host.dataset['screen'] = 'room';
  host.replaceChildren(
    make(
      'main',
      { className: 'room' },
      screen.banner,
      screen.note,
      screen.stop,
      make('p', { className: 'dim', textContent: t('room.seen', { name }) }),
      ...(view.wide
        ? []
        : [
            make('p', {
              className: 'dim',
              textContent: t('room.narrow-tracking', { distance: metres(NARROW_TRACKING_M) }),
            }),
          ]),
      make('div', { className: 'row wrap' }, leave, ...screen.talk),
      canvas,
    ),
  );
  const worker = await hired;
  if (over) return '';
  if (worker.kind !== 'ok') {
    await view.leave();
    await signIn(refusalWords(worker));
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
      host,
      server,
      map: { ...map, kinds: kinds.kind === 'ok' ? kinds.value : [] },
      worker,
      start: start.at,
      clock,
      safety: t('safety'),
      left: () => leave(worker.id, worker.name),
    });
    await twin.open();
  } catch (error) {
    await signIn(t('failed.twin', { why: textOf(error) }));
  }
}

/** After the view: robots go on keeping away, until somebody says that nobody is there. */
async function left(id: string, name: string, wrong = ''): Promise<void> {
  if (!host || id === '') return signIn();
  const again = make('button', { textContent: t('left.again'), className: 'main' });
  const gone = make('button', { textContent: t('left.gone') });
  const error = make('p', { className: 'error', role: 'alert', textContent: wrong });
  again.addEventListener('click', () => void signIn());
  gone.addEventListener('click', () => {
    void server.clear(id, name).then((answer) => {
      if (answer.kind === 'ok') void signIn(t('left.said', { name }));
      else error.textContent = refusalWords(answer);
    });
  });
  host.dataset['screen'] = 'left';
  host.replaceChildren(
    make(
      'main',
      {},
      make(
        'div',
        { className: 'panel sign' },
        make('h1', { textContent: t('left.heading') }),
        make('p', { textContent: t('left.text', { name }) }),
        error,
        make('div', { className: 'row wrap' }, gone, again),
      ),
    ),
  );
}

/** Says that nobody is there any more. Robots go on keeping away unless the server has heard it. */
function leave(id: string, name: string): void {
  void server
    .clear(id, name)
    .then((answer) => (answer.kind === 'ok' ? signIn(t('left.said', { name })) : left(id, name, refusalWords(answer))));
}

/** The map on a phone, which is fetched only where it is used. */
async function phone(map: FloorMap, id: string, name: string): Promise<void> {
  const { drawMap, onMap } = await import('./phone');
  if (!host) return;
  const canvas = make('canvas', { className: 'map', role: 'img', ariaLabel: t('phone.map') });
  const wearer: Wearer = new Wearer({
    frame: 'map',
    poses: 'placed',
    clock,
    random: Math.random,
    marks: [],
    open: (events) => server.open(id, events),
    task: (assignment) => server.task(id, assignment),
    onChange: () => refresh(),
  });
  const screen = new Screen(host, wearer);
  const where = make('p', { className: 'where' });
  const near = make('ul', { className: 'near', ariaLabel: t('phone.near') });
  const gone = make('button', { textContent: t('left.gone') });
  const done = make('button', { textContent: t('done'), className: 'main', hidden: true });
  const back = make('button', { textContent: t('reconnect'), className: 'main', hidden: true });
  let [self, seen, shot]: [Self | null, Self | null, Lens | null] = [null, null, null];
  let link = wearer.feed.kind;
  /** Another map may have been published while the server was away. */
  const mapAgain = async (): Promise<void> => {
    const answer = await server.map();
    if (answer.kind === 'ok') map = answer.value;
  };
  const refresh = (): void => {
    const shown = wearer.shown();
    if (link === 'lost' && wearer.feed.kind === 'live') void mapAgain();
    link = wearer.feed.kind;
    const ended = wearer.feed.kind === 'ended' ? wearer.feed.text : '';
    screen.say(shown, shown.title, ended || joined(refusal(wearer), shown.detail));
    back.hidden = ended === '';
    done.hidden = wearer.due() === null;
    self = wearer.placed ? { at: wearer.placed.at, heading: null } : seen;
    const for_s = wearer.placed ? Math.ceil((PLACED_MS - (clock.now() - wearer.placed.since)) / 1000) : 0;
    write(where, wearer.placed ? t('phone.placed', { time: seconds(for_s) }) : t(seen ? 'phone.tag' : 'phone.unknown'));
    const lines = shown.near.map((r) =>
      t(r.closest_s === null ? 'phone.robot' : 'phone.robot.closing', { robot: r.id, distance: metres(r.distance) }),
    );
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
    // Without a tag the server knows nothing newer than what was said here; a tag may report but once a second.
    const isSeen = w !== null && ['tracked', 'stale'].includes(w.presence);
    seen = isSeen && w.x !== null && w.y !== null ? { at: [w.x, w.y], heading: w.heading } : null;
    wearer.located(seen && w ? w.accuracy : null);
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
  host.replaceChildren(
    make(
      'main',
      { className: 'phone' },
      screen.banner,
      canvas,
      where,
      near,
      screen.note,
      screen.stop,
      make(
        'div',
        { className: 'row wrap' },
        make('span', { className: 'dim grow', textContent: name }),
        back,
        done,
        ...screen.talk,
        gone,
      ),
      make('p', { className: 'safety', textContent: t('safety') }),
    ),
  );
  wearer.start();
  const mark = placesOf(map).find((p) => p.name === scanned);
  scanned = null;
  if (mark) wearer.place(mark.at);
  refresh();
}

/** The sheets of the marks, to be printed. */
async function sheets(): Promise<void> {
  const [{ markSheets }, map] = await Promise.all([import('./marks'), server.map()]);
  if (!host) return;
  if (map.kind !== 'ok') return locked(map, sheets);
  host.dataset['screen'] = 'marks';
  host.replaceChildren(markSheets(map.value, () => void sheets()));
}

void learn()
  .then(learnSaid)
  .then(() => (location.pathname.endsWith('/marks') ? sheets() : signIn()));
