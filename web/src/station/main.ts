// The page of a picking station: the display of the station that the address names, or the stations to choose from.
import '../app.css';
import './station.css';
import { learnSaid } from '../language';
import { applyTheme, make, storedTheme } from '../parts';
import { refusalWords, StationPage } from './page';
import { signInAt, station, stations } from './server';
import { learn, t } from './words';

applyTheme(storedTheme());
const host = document.getElementById('station');
/** The station that the address names; empty where it names none. */
const id = decodeURIComponent(location.pathname.replace(/^\/station\/?/, ''));
let page: StationPage | null = null;

/** Looks whether the server knows the station and who is here, and shows the display, once. */
async function look(): Promise<void> {
  if (!host) return;
  if (id === '') return choose(host);
  const answer = await station(id);
  switch (answer.kind) {
    case 'locked':
      return location.assign(signInAt(location));
    case 'unknown':
      return choose(host);
    case 'refused':
      if (!page) refuse(host, refusalWords(answer));
      return;
    // The display connects by itself, and says so.
    case 'unreachable':
    case 'ok':
      if (page) return;
      document.title = t('page.title', { id });
      page = new StationPage({ host, id, onTrouble: () => void look() });
      page.open();
  }
}

/** Says that there is no such station, and which ones there are. */
async function choose(root: HTMLElement): Promise<void> {
  page?.close();
  page = null;
  const answer = await stations();
  if (answer.kind === 'locked') return location.assign(signInAt(location));
  if (answer.kind !== 'ok') return refuse(root, refusalWords(answer));
  document.title = t('page.title.all');
  const links = answer.value.items.map((one) =>
    make('li', {}, make('a', { href: `/station/${encodeURIComponent(one.id)}`, textContent: one.id })),
  );
  const none = make('p', { textContent: t('unknown.none') });
  const list = links.length === 0 ? none : make('ul', { ariaLabel: t('unknown.list') }, ...links);
  const heading = id === '' ? t('unknown.choose') : t('unknown.heading', { id });
  const help = id === '' ? [] : [make('p', { className: 'dim', textContent: t('unknown.choose') })];
  root.dataset['link'] = 'none';
  root.replaceChildren(make('main', { className: 'choose' }, make('h1', { textContent: heading }), ...help, list));
}

function refuse(root: HTMLElement, why: string): void {
  const again = make('button', { className: 'main', textContent: t('refused.again') });
  again.addEventListener('click', () => void look());
  root.replaceChildren(
    make(
      'main',
      { className: 'choose' },
      make('h1', { textContent: t('refused.heading') }),
      make('p', { role: 'alert', textContent: why }),
      again,
    ),
  );
}

void learn().then(learnSaid).then(look);
