// The reel in a page that is a file.

/** The reel that a page without a server has in it. */
export function embeddedReel(): Blob | null {
  const text = document.getElementById('reel')?.textContent;
  if (!text) return null;
  return new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]);
}
