// Idempotency keys: what is sent again after a lost answer does not become two of it.

/** randomUUID exists only in secure contexts, and a warehouse LAN often has plain http. */
export function newKey(source: Crypto = crypto): string {
  if (typeof source.randomUUID === 'function') return source.randomUUID();
  const b = source.getRandomValues(new Uint8Array(16));
  b[6] = (b[6]! & 0x0f) | 0x40;
  b[8] = (b[8]! & 0x3f) | 0x80;
  const hex = Array.from(b, (n) => n.toString(16).padStart(2, '0')).join('');
  return [hex.slice(0, 8), hex.slice(8, 12), hex.slice(12, 16), hex.slice(16, 20), hex.slice(20)].join('-');
}

/** One key per intention: the same job sent again after a lost answer keeps its key; a new one does not. */
export class Keys {
  #sent: { body: string; key: string } | null = null;
  keyFor(body: string, fresh: () => string = newKey): string {
    if (this.#sent?.body !== body) this.#sent = { body, key: fresh() };
    return this.#sent.key;
  }
  answered(): void {
    this.#sent = null;
  }
}
