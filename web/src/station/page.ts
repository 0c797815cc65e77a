// A station's display at work: the link, keys and scans, what they do at the server, and what is shown of it.
import { make } from '../parts';
import { Asks } from './asks';
import { Board, write } from './board';
import { actOf, askRelease, Buttons, possible, type Act } from './buttons';
import { judge, warned, type Mistake } from './judge';
import { Keys, Once, SAME_PIECE_MS, SAME_PRESS_MS, GAP_MS, type Pressed } from './keys';
import { Changes, leftOf, linesLeft, litOf } from './lines';
import { StationLink } from './link';
import { changeLast, changeLine, openLive, say, type Answer, type Changed } from './server';
import { Sound } from './sound';
import { readStation, type Line, type Station } from './state';
import { said } from '../language';
import { t } from './words';

export interface PageOptions {
  host: HTMLElement;
  id: string;
  /** The link is lost, or the server wants somebody to sign in: what is the matter is to be looked up. */
  onTrouble(): void;
}

/** How long a wrong scan is shown. */
const MISTAKE_MS = 2_000;
/** How long a note stays. */
const NOTE_MS = 4_000;
const BEAT_MS = 250;

export class StationPage {
  #options: PageOptions;
  #station: Station | null = null;
  #heardAt = 0;
  #board = new Board();
  #buttons = new Buttons((act) => this.#act(act));
  /** About the last piece of the rack before. */
  #asks = new Asks((change) => void this.#ask(() => changeLast(this.#options.id, change)));
  #soundOff = make('p', { className: 'sound' }, make('span', { textContent: t('sound.why') }));
  #changes = new Changes();
  #keys = new Keys();
  #once = new Once();
  /** Pieces do not wait for the answer to the piece before. */
  #pieces = new Once();
  #litSince = -Infinity;
  #beat: ReturnType<typeof setInterval> | undefined;
  #sound = new Sound();
  #link: StationLink;
  /** A wrong scan, and until when it is shown. */
  #slip: { mistake: Mistake; until: number } | null = null;
  /** Where the piece that was scanned last belongs. */
  #tote: string | null = null;
  #noteUntil = 0;
  #warning = '';

  constructor(options: PageOptions) {
    this.#options = options;
    this.#link = new StationLink({
      open: (events) => openLive(options.id, events),
      clock: {
        now: () => performance.now(),
        after: (ms, run) => setTimeout(run, ms),
        cancel: (timer) => clearTimeout(timer as number),
      },
      random: Math.random,
      hear: (text) => this.#hear(text),
      onLost: () => {
        this.#show();
        options.onTrouble();
      },
    });
  }

  open(): void {
    const { host } = this.#options;
    const on = make('button', { type: 'button', textContent: t('sound.on') });
    on.addEventListener('click', () => on.blur());
    this.#soundOff.append(on);
    this.#sound.onReady = () => {
      this.#soundOff.hidden = true;
    };
    const { bar, rack, big, counts, lines, note, paused, spoken, alert, old } = this.#board;
    const help = make('footer', { className: 'help' }, make('span', { textContent: t('help') }), this.#soundOff);
    const side = make('div', { className: 'side' }, paused, this.#asks.box, big, note, counts, lines);
    host.replaceChildren(make('main', {}, bar, rack, side, this.#buttons.row, help, spoken, alert, old));
    addEventListener('keydown', this.#keyDown);
    addEventListener('keyup', this.#keyUp);
    addEventListener('pointerdown', this.#touched);
    this.#beat = setInterval(() => this.#show(), BEAT_MS);
    // A display may be set up so that it sounds without having been touched.
    this.#sound.wake();
    this.#link.start();
    this.#show();
  }

  close(): void {
    removeEventListener('keydown', this.#keyDown);
    removeEventListener('keyup', this.#keyUp);
    removeEventListener('pointerdown', this.#touched);
    clearInterval(this.#beat);
    this.#link.stop();
  }

  #hear(text: string): string | null {
    const station = readStation(text);
    if (!station) return null;
    if (station.visit?.job !== this.#station?.visit?.job) this.#tote = null;
    if (litOf(station.visit)?.n !== litOf(this.#station?.visit ?? null)?.n) this.#litSince = performance.now();
    [this.#station, this.#heardAt] = [station, performance.now()];
    this.#changes.hear(station.visit);
    // The link takes note of the message before it is shown.
    queueMicrotask(() => this.#show());
    return station.now;
  }

  get #undo(): Line | null {
    return this.#changes.target(this.#station?.visit ?? null);
  }

  #show(): void {
    const [now, station, link] = [performance.now(), this.#station, this.#link];
    if (this.#slip && now >= this.#slip.until) this.#slip = null;
    if (now >= this.#noteUntil) write(this.#board.note, '');
    const warning = station && !link.isOld ? warned(station) : null;
    const mistake = warning ?? this.#slip?.mistake ?? null;
    this.#warn(warning, now);
    this.#board.showOld(link.isOld, link.age_ms, link.freshAt === null);
    this.#buttons.show(station, this.#undo, link.isOld);
    const { dataset } = this.#options.host;
    dataset['link'] = link.isOld ? 'old' : 'live';
    dataset['visit'] = !station?.visit ? 'none' : station.visit.lines.length > 0 ? 'lines' : 'free';
    dataset['mistake'] = mistake?.kind ?? '';
    dataset['lit'] = litOf(station?.visit ?? null)?.slot ?? '';
    if (!station) return;
    this.#asks.show(station, now);
    this.#board.show(station, mistake, now - this.#heardAt);
  }

  #warn(warning: Mistake | null, now: number): void {
    const key = JSON.stringify(warning);
    if (warning && key !== this.#warning) this.#sound.mistake(now);
    else if (warning) this.#sound.lasting(now);
    this.#warning = key;
  }

  #note(text: string): void {
    write(this.#board.note, text);
    this.#noteUntil = performance.now() + NOTE_MS;
  }

  #touched = (): void => this.#sound.wake();

  get #isAsking(): boolean {
    return this.#options.host.querySelector('dialog') !== null;
  }

  /** Some browsers press the button that has the focus when the space bar comes up. */
  #keyUp = (event: KeyboardEvent): void => {
    if (event.key === ' ' && !this.#isAsking) event.preventDefault();
  };

  #keyDown = (event: KeyboardEvent): void => {
    this.#sound.wake();
    if (event.ctrlKey || event.altKey || event.metaKey || event.isComposing || this.#isAsking) return;
    const { key } = event;
    // The browser would press the button that has the focus, in the middle of a scan, too.
    if (key === 'Enter' || key === ' ') event.preventDefault();
    if (event.repeat) return;
    this.#pressed(this.#keys.press(key, event.timeStamp));
    // Events of keys that were pressed meanwhile may still wait: the time is theirs, with some to spare.
    setTimeout(() => this.#pressed(this.#keys.settle(performance.now() - GAP_MS)), 3 * GAP_MS);
  };

  #pressed(all: readonly Pressed[]): void {
    for (const pressed of all) {
      if (pressed.kind === 'scan') this.#scanned(pressed.text);
      else this.#key(pressed.key);
    }
  }

  #key(key: string): void {
    const focused = document.activeElement;
    if ((key === 'Enter' || key === ' ') && focused instanceof HTMLButtonElement) return focused.click();
    const act = actOf(key);
    if (act) this.#act(act);
  }

  #scanned(text: string): void {
    const station = this.#station;
    if (!station || this.#link.isOld) return;
    const verdict = judge(text, station, this.#tote);
    switch (verdict?.kind) {
      case 'piece':
        return void this.#piece(verdict.line);
      case 'right tote':
        [this.#tote, this.#slip] = [null, null];
        this.#note(t('scan.right', { tote: verdict.tote }));
        break;
      case 'mistake':
        this.#slip = { mistake: verdict.mistake, until: performance.now() + MISTAKE_MS };
        this.#sound.mistake(performance.now());
        break;
      case 'unknown':
        this.#note(t('scan.unknown', { text: verdict.text }));
        break;
      case 'nothing':
        this.#note(t('scan.nothing'));
        break;
    }
    this.#show();
  }

  /** A scan of the lit slot. */
  async #piece({ n, slot, tote }: Line): Promise<void> {
    [this.#slip, this.#tote] = [null, tote];
    this.#show();
    if (this.#answered(await changeLine(this.#options.id, n, { done: 1 }))) this.#note(t('scan.piece', { slot }));
  }

  #act(act: Act): void {
    const [station, undo, { id }] = [this.#station, this.#undo, this.#options];
    if (!station || this.#link.isOld || !possible(station, undo)[act]) return;
    const [lit, now] = [litOf(station.visit), performance.now()];
    // A line that has just been lit is not the one that was meant.
    if (['done', 'plus', 'short'].includes(act) && now - this.#litSince < SAME_PRESS_MS) return;
    // What is confirmed by hand was not scanned: its tote is not known.
    this.#tote = null;
    if (act === 'plus' && lit) {
      if (!this.#pieces.begin(now, SAME_PIECE_MS)) return;
      this.#pieces.over();
      return void changeLine(id, lit.n, { done: 1 }).then((answer) => this.#answered(answer));
    }
    if (act === 'release') return void this.#release(station);
    void this.#ask((): Promise<Answer<Changed | null>> => {
      switch (act) {
        case 'short':
          return changeLine(id, lit!.n, { short: true });
        case 'undo':
          return changeLine(id, undo!.n, { undo: true });
        case 'pause':
          return say(id, station.paused === null ? 'pause' : 'resume');
        default:
          return lit ? changeLine(id, lit.n, { done: leftOf(lit) }) : say(id, 'done');
      }
    });
  }

  async #release({ visit }: Station): Promise<void> {
    if (!visit) return;
    const isMeant = await askRelease(this.#options.host, visit.rack ?? '', linesLeft(visit));
    // Another rack may stand there by now: that one was not asked about.
    if (isMeant && this.#station?.visit?.job === visit.job) await this.#ask(() => say(this.#options.id, 'release'));
  }

  async #ask(request: () => Promise<Answer<Changed | null>>): Promise<void> {
    if (!this.#once.begin(performance.now(), SAME_PRESS_MS)) return;
    const answer = await request();
    this.#once.over();
    this.#answered(answer);
  }

  /** Says what the server did not do; whether something has changed. */
  #answered(answer: Answer<Changed | null>): boolean {
    if (answer.kind === 'locked') this.#options.onTrouble();
    else if (answer.kind !== 'ok') this.#note(refusalWords(answer));
    else if (answer.value && !answer.value.changed) this.#note(t('already'));
    return answer.kind === 'ok' && answer.value?.changed !== false;
  }
}

/** Why the server did not do it. */
export function refusalWords(answer: Exclude<Answer<unknown>, { kind: 'ok' }>): string {
  if (answer.kind === 'unreachable') return t('refused.unreachable');
  if (answer.kind !== 'refused') return t('refused.unknown');
  return answer.said === null ? t('refused.status', { status: String(answer.status) }) : said(answer.said);
}
