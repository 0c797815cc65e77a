// Bytes to lines. A file that ends too soon gives the lines up to there: that is what a server leaves that was killed.

export async function linesOf(bytes: Blob): Promise<string[]> {
  const head = new Uint8Array(await bytes.slice(0, 2).arrayBuffer());
  const packed = head[0] === 0x1f && head[1] === 0x8b;
  const stream = packed ? bytes.stream().pipeThrough(new DecompressionStream('gzip')) : bytes.stream();
  const reader = stream.pipeThrough(new TextDecoderStream()).getReader();
  const lines: string[] = [];
  let rest = '';
  for (;;) {
    let part;
    try {
      part = await reader.read();
    } catch {
      break;
    }
    if (part.done) break;
    const pieces = (rest + part.value).split('\n');
    rest = pieces.pop() ?? '';
    for (const piece of pieces) lines.push(piece);
  }
  return lines;
}
