// The present: the map and the live link, as long as the server is there.
import type { Loaded } from '../parts';
import { whoIsHere } from '../session';
import { hearTime, Link, type Api, type FloorMap, type LinkState, type Mirror } from '../wire';
import { t, trouble } from '../words';
import { PeopleNames } from './names';

const MAP_RETRY_MS = 3_000;

export type LiveApi = Pick<Api, 'map' | 'kinds' | 'people' | 'openLive'>;

export class Live {
  map = $state.raw<Loaded<FloorMap>>({ kind: 'loading' });
  link = $state.raw<LinkState>({ kind: 'connecting' });
  /** Age of the picture in seconds; null before the first. */
  age = $state.raw<number | null>(null);
  /** Every mirror as it comes. */
  onMirror: (mirror: Mirror, how: 'glide' | 'jump') => void = () => {};
  #api: LiveApi;
  #names: PeopleNames;
  #retry: ReturnType<typeof setTimeout> | undefined;
  /** The robots whose kinds were looked up. */
  #known: Mirror['robots']['at'] | null = null;
  #link = new Link({
    open: (since, events) => this.#api.openLive(since, events),
    clock: {
      now: () => performance.now(),
      after: (ms, run) => setTimeout(run, ms),
      cancel: (timer) => clearTimeout(timer as ReturnType<typeof setTimeout>),
    },
    random: Math.random,
    onState: (state) => {
      this.link = state;
    },
    onMirror: (mirror, kind) => {
      hearTime(mirror);
      if (kind === 'snapshot') this.#follow(mirror.map);
      this.#learnKinds(mirror);
      this.onMirror(this.#names.shown(mirror), kind === 'snapshot' ? 'jump' : 'glide');
    },
  });

  constructor(api: LiveApi) {
    this.#api = api;
    this.#names = new PeopleNames(api, whoIsHere);
  }

  get mirror(): Mirror {
    return this.#names.shown(this.#link.mirror);
  }

  /** A picture of the past, with people called as in the present. */
  called(mirror: Mirror): Mirror {
    return this.#names.called(mirror);
  }

  start(): void {
    void this.#loadMap();
    this.#link.start();
  }

  stop(): void {
    this.#link.stop();
    clearTimeout(this.#retry);
  }

  retryNow(): void {
    this.#link.retryNow();
  }

  /** Looks how old the picture is by now. */
  look(): void {
    const { freshAt } = this.#link;
    const age = freshAt === null ? null : Math.floor((performance.now() - freshAt) / 1_000);
    if (age !== this.age) this.age = age;
  }

  /** Another map was published while the server was away: rows name places of that one from here on. */
  #follow(version: string | null): void {
    const { map } = this;
    if (version === null || map.kind !== 'ready' || map.value.version === undefined || map.value.version === version)
      return;
    this.map = { kind: 'loading' };
    void this.#loadMap();
  }

  /** A kind was added since: its robots would be drawn in the usual size. */
  #learnKinds({ robots }: Mirror): void {
    const { map } = this;
    if (map.kind !== 'ready' || this.#known === robots.at) return;
    this.#known = robots.at;
    const names = new Set((map.value.kinds ?? []).map((kind) => kind.name));
    if (names.size > 0 && robots.rows.some((robot) => !names.has(robot.kind))) void this.#loadMap();
  }

  async #loadMap(): Promise<void> {
    clearTimeout(this.#retry);
    const [answer, kinds] = await Promise.all([this.#api.map(), this.#api.kinds()]);
    if (answer.kind === 'ok') {
      // Without the kinds, all robots are drawn in one size.
      this.map = { kind: 'ready', value: { ...answer.value, kinds: kinds.kind === 'ok' ? kinds.value : [] } };
      return;
    }
    const locked = answer.kind === 'refused' && answer.problem.status === 401;
    this.map = { kind: 'failed', why: (locked ? t('session.nobody') : trouble(answer)) ?? '' };
    // The page to sign in comes next.
    if (!locked) this.#retry = setTimeout(() => void this.#loadMap(), MAP_RETRY_MS);
  }
}
