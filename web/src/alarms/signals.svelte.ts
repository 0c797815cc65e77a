// How the page calls a person who looks elsewhere: by a sound and by a notification of the browser. Both are off until
// somebody asks for them, and the choice is kept in this browser.
import type { Alarm, Severity } from '../wire';
import { said } from '../words';
import { calls, fresh, severityOf } from './shown';

const [SOUND, NOTIFY, NAME] = ['giveway.alarm-sound', 'giveway.alarm-notifications', 'giveway.name'];
/** A sound that repeats for as long as nobody acknowledges a critical alarm, milliseconds between two. */
const AGAIN_MS = 10_000;

/** What the browser gives: a sound, notifications, a memory, a clock. */
export interface Means {
  beep(severity: Severity): void;
  /** Whether the user allows notifications; asks if that is not known. */
  ask(): Promise<boolean>;
  notify(title: string, text: string, tag: string): void;
  load(key: string): string | null;
  store(key: string, value: string): void;
  now(): number;
}

export class Signals {
  sound = $state(false);
  notifications = $state(false);
  /** The browser refuses notifications: why they stay off. */
  refused = $state(false);
  /** Who acknowledges, as others see it. */
  name = $state('');
  #means: Means;
  #known = new Map<string, Severity>();
  #rang = -Infinity;

  constructor(means: Means = browserMeans()) {
    this.#means = means;
    this.sound = means.load(SOUND) === 'on';
    this.notifications = means.load(NOTIFY) === 'on';
    this.name = means.load(NAME) ?? '';
  }

  setSound(on: boolean): void {
    this.sound = on;
    this.#means.store(SOUND, on ? 'on' : 'off');
    // So that its owner knows the sound; browsers also let a page sound only after a click.
    if (on) this.#means.beep('warning');
  }

  async setNotifications(on: boolean): Promise<void> {
    const may = on && (await this.#means.ask());
    this.refused = on && !may;
    this.notifications = may;
    this.#means.store(NOTIFY, may ? 'on' : 'off');
  }

  setName(name: string): void {
    this.name = name;
    this.#means.store(NAME, name);
  }

  /** Looks at the alarms that are active, and calls for those that are new. */
  note(alarms: readonly Alarm[]): void {
    const now = this.#means.now();
    const news = fresh(alarms, this.#known);
    // Whoever was called by a group was called for its members.
    const members = alarms.flatMap((alarm) => alarm.members ?? []).map(({ id }) => [id, 'critical'] as const);
    this.#known = new Map([...members, ...alarms.map((alarm) => [alarm.id, severityOf(alarm)] as const)]);
    const rings = alarms.some((a) => severityOf(a) === 'critical' && calls(a)) && now - this.#rang >= AGAIN_MS;
    if (this.sound && (news.length > 0 || rings)) {
      this.#rang = now;
      this.#means.beep(rings || news.some((a) => severityOf(a) === 'critical') ? 'critical' : 'warning');
    }
    if (this.notifications) {
      for (const alarm of news) this.#means.notify(said(alarm), said(alarm.remedy ?? ''), alarm.id);
    }
  }
}

function browserMeans(): Means {
  let audio: AudioContext | null = null;
  const tone = (at: number, hertz: number): void => {
    const [oscillator, gain] = [audio!.createOscillator(), audio!.createGain()];
    oscillator.frequency.value = hertz;
    gain.gain.setValueAtTime(0.2, at);
    gain.gain.exponentialRampToValueAtTime(0.001, at + 0.25);
    oscillator.connect(gain).connect(audio!.destination);
    oscillator.start(at);
    oscillator.stop(at + 0.25);
  };
  return {
    beep: (severity) => {
      audio ??= new AudioContext();
      void audio.resume();
      const tones = severity === 'critical' ? [880, 660, 880] : [660];
      tones.forEach((hertz, i) => tone(audio!.currentTime + i * 0.3, hertz));
    },
    ask: async () => typeof Notification !== 'undefined' && (await Notification.requestPermission()) === 'granted',
    notify: (title, body, tag) => {
      if (typeof Notification !== 'undefined' && Notification.permission === 'granted')
        new Notification(title, { body, tag });
    },
    // Storage may be forbidden; the choice then lasts as long as the page.
    load: (key) => {
      try {
        return localStorage.getItem(key);
      } catch {
        return null;
      }
    },
    store: (key, value) => {
      try {
        localStorage.setItem(key, value);
      } catch {
        /* see above */
      }
    },
    now: () => performance.now(),
  };
}
