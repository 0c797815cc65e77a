// A voice that reads aloud what the page shows, where the browser has one for the language. It can be switched off, and
// nothing is said that is not shown as well.
import type { Utterance } from './announcer';
import { spoken } from './words';

const KEY = 'giveway.voice';

export class Voice {
  #on = storedOn();
  /** What was said last, for tests and for the curious. */
  said = '';

  get isOn(): boolean {
    return this.#on;
  }
  set isOn(on: boolean) {
    this.#on = on;
    if (!on) synthesis()?.cancel();
    try {
      localStorage.setItem(KEY, on ? 'on' : 'off');
    } catch {
      // The choice then lasts as long as the page.
    }
  }

  /** Whether the device has voices, and none for this language: another one would read gibberish. */
  get isMissing(): boolean {
    const voices = synthesis()?.getVoices();
    return voices === undefined || (voices.length > 0 && voiceFor(voices, spoken()) === null);
  }

  /** To be called out of a click: some browsers let a page speak only after one. */
  wake(): void {
    if (this.#on && !this.isMissing) synthesis()?.speak(new SpeechSynthesisUtterance(''));
  }

  say({ text, urgent }: Utterance): void {
    this.said = text;
    const speech = synthesis();
    if (!speech || !this.#on || this.isMissing) return;
    // What still waits to be said is older than this.
    if (urgent || speech.pending) speech.cancel();
    const utterance = new SpeechSynthesisUtterance(text);
    const voice = voiceFor(speech.getVoices(), spoken());
    [utterance.voice, utterance.lang] = [voice, voice?.lang ?? spoken()];
    speech.speak(utterance);
  }

  hush(): void {
    synthesis()?.cancel();
  }
}

/** One for the page: the browser has one mouth. */
export const voice = new Voice();

const synthesis = (): SpeechSynthesis | undefined => globalThis.speechSynthesis;

/** The voice of a language: one that works without a network first. */
export function voiceFor(voices: readonly SpeechSynthesisVoice[], language: string): SpeechSynthesisVoice | null {
  const fits = voices.filter((v) => v.lang.toLowerCase().split(/[-_]/)[0] === language);
  return fits.find((v) => v.localService && v.default) ?? fits.find((v) => v.localService) ?? fits[0] ?? null;
}

function storedOn(): boolean {
  try {
    return localStorage.getItem(KEY) !== 'off';
  } catch {
    return true;
  }
}
