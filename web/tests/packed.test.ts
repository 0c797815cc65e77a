// The live feed over a socket: packed snapshots arrive as text, and before what came after them.
import { afterEach, expect, test, vi } from 'vitest';
import { Api } from '../src/wire';

class FakeSocket {
  static last: FakeSocket;
  binaryType = '';
  onmessage: (event: { data: string | ArrayBuffer }) => void = () => {};
  onclose: () => void = () => {};
  constructor(readonly url: URL) {
    FakeSocket.last = this;
  }
  close(): void {}
}

afterEach(() => {
  vi.unstubAllGlobals();
});

function open(): { socket: FakeSocket; heard: string[] } {
  vi.stubGlobal('WebSocket', FakeSocket);
  const heard: string[] = [];
  new Api().openLive(null, {
    message: (text) => {
      heard.push(text);
    },
    closed: () => {
      heard.push('closed');
    },
  });
  return { socket: FakeSocket.last, heard };
}

const packed = (text: string): Promise<ArrayBuffer> =>
  new Response(new Blob([text]).stream().pipeThrough(new CompressionStream('gzip'))).arrayBuffer();

test('a packed snapshot comes before the patches that follow it, and before the end', async () => {
  const { socket, heard } = open();
  expect(socket.url.searchParams.get('packed')).toBe('true');
  expect(socket.binaryType).toBe('arraybuffer');
  socket.onmessage({ data: await packed('{"type":"snapshot"}'.repeat(5_000)) });
  socket.onmessage({ data: 'patch 1' });
  socket.onmessage({ data: 'patch 2' });
  socket.onclose();
  await vi.waitFor(() => expect(heard).toHaveLength(4));
  expect(heard[0]).toBe('{"type":"snapshot"}'.repeat(5_000));
  expect(heard.slice(1)).toEqual(['patch 1', 'patch 2', 'closed']);
});

test('a message that cannot be unpacked is one that nobody understands, and the feed goes on', async () => {
  const { socket, heard } = open();
  socket.onmessage({ data: new TextEncoder().encode('no gzip').buffer });
  socket.onmessage({ data: 'patch' });
  await vi.waitFor(() => expect(heard).toEqual(['', 'patch']));
});
