// What a mistake sounds like: two falling tones, unlike anything else on a floor. Browsers let a page sound only after
// somebody has touched it.

const TONES_HZ = [740, 392] as const;
const TONE_S = 0.22;
/** The server's warnings last: so often they are sounded again. */
const AGAIN_MS = 1_500;

export class Sound {
  #context: AudioContext | null = null;
  #soundedAt = -Infinity;
  /** Called when it becomes possible to sound. */
  onReady: () => void = () => {};

  get isReady(): boolean {
    return this.#context?.state === 'running';
  }

  /** To be called out of a press or a key. */
  wake(): void {
    if (typeof AudioContext === 'undefined' || this.isReady) return;
    this.#context ??= new AudioContext();
    void this.#context.resume().then(
      () => this.onReady(),
      () => {},
    );
  }

  /** A mistake was made. */
  mistake(now: number): void {
    this.#soundedAt = now;
    const context = this.#context;
    if (!context || context.state !== 'running') return;
    TONES_HZ.forEach((hz, i) => {
      const tone = new OscillatorNode(context, { type: 'square', frequency: hz });
      const volume = new GainNode(context, { gain: 0.25 });
      const from = context.currentTime + i * TONE_S;
      tone.connect(volume).connect(context.destination);
      tone.start(from);
      tone.stop(from + TONE_S);
    });
  }

  /** A mistake lasts. */
  lasting(now: number): void {
    if (now - this.#soundedAt >= AGAIN_MS) this.mistake(now);
  }
}
