// Asks again and again, as long as somebody looks.

/** Runs `ask`, and again as many milliseconds after it as it says; null ends it. To be called in an effect; returns
 *  what ends it. After an `await`, `ask` must look at `over()`: the answer is no longer wanted then. */
export function poll(ask: (over: () => boolean) => Promise<number | null>): () => void {
  let ended = false;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const next = async (): Promise<void> => {
    const pause = await ask(() => ended);
    if (!ended && pause !== null) timer = setTimeout(() => void next(), pause);
  };
  void next();
  return () => {
    ended = true;
    clearTimeout(timer);
  };
}
