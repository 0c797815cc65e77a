// The link against a fake socket and a fake clock: resume, start over, back off, notice silence.
import { beforeEach, describe, expect, test } from 'vitest';
import { DEAD_MS, Link, retryDelay, SLOW_MS, type LinkState, type SocketEvents } from '../src/wire/link';
import { snapshot } from './samples';

interface FakeSocket {
  since: number | null;
  events: SocketEvents;
  state: 'open' | 'closed';
}

class World {
  time = 0;
  sockets: FakeSocket[] = [];
  states: LinkState['kind'][] = [];
  refuse = false;
  #timers: { at: number; run: () => void }[] = [];
  link = new Link({
    open: (since, events) => {
      if (this.refuse) throw new Error('no socket');
      const socket: FakeSocket = { since, events, state: 'open' };
      this.sockets.push(socket);
      return {
        close: () => {
          socket.state = 'closed';
        },
      };
    },
    clock: {
      now: () => this.time,
      after: (ms, run) => {
        const timer = { at: this.time + ms, run };
        this.#timers.push(timer);
        return timer;
      },
      cancel: (timer) => {
        this.#timers = this.#timers.filter((t) => t !== timer);
      },
    },
    random: () => 1,
    onState: (state) => this.states.push(state.kind),
    onMirror: () => {},
  });

  get socket(): FakeSocket {
    return this.sockets.at(-1)!;
  }
  say(message: object): void {
    this.socket.events.message(JSON.stringify(message));
  }
  pass(ms: number): void {
    const until = this.time + ms;
    for (;;) {
      const next = this.#timers.filter((t) => t.at <= until).sort((a, b) => a.at - b.at)[0];
      if (!next) break;
      this.#timers = this.#timers.filter((t) => t !== next);
      this.time = next.at;
      next.run();
    }
    this.time = until;
  }
}

let world: World;
beforeEach(() => {
  world = new World();
  world.link.start();
});

describe('the link', () => {
  test('the first connection asks for a snapshot and becomes live with it', () => {
    expect(world.socket.since).toBeNull();
    expect(world.link.state.kind).toBe('connecting');
    world.say(snapshot({ version: 5 }));
    expect(world.link.state.kind).toBe('live');
    expect(world.link.mirror.version).toBe(5);
  });

  test('after a break it resumes from the version it has', () => {
    world.say(snapshot({ version: 5 }));
    world.say({ type: 'patch', base: 5, version: 6 });
    world.socket.events.closed();
    expect(world.link.state.kind).toBe('lost');
    world.pass(1_000);
    expect(world.socket.since).toBe(6);
    world.say({ type: 'patch', base: 6, version: 7 });
    expect(world.link.state.kind).toBe('live');
    expect(world.link.mirror.version).toBe(7);
  });

  test('a patch on a wrong base drops the socket and asks for a new snapshot', () => {
    world.say(snapshot({ version: 5 }));
    const first = world.socket;
    world.say({ type: 'patch', base: 9, version: 10 });
    expect(first.state).toBe('closed');
    expect(world.link.mirror.version).toBe(5);
    world.pass(1_000);
    expect(world.sockets).toHaveLength(2);
    expect(world.socket.since).toBeNull();
  });

  test('a server that hangs up on a resume is asked for a snapshot next', () => {
    world.say(snapshot({ version: 5 }));
    world.socket.events.closed();
    world.pass(1_000);
    expect(world.socket.since).toBe(5);
    world.socket.events.closed();
    world.pass(2_000);
    expect(world.socket.since).toBeNull();
  });

  test('retries come ever later, up to a limit', () => {
    const delays: number[] = [];
    for (let i = 0; i < 7; i++) {
      world.socket.events.closed();
      if (world.link.state.kind === 'lost') delays.push(world.link.state.retryAt - world.time);
      world.pass(10_000);
    }
    expect(delays).toEqual([500, 1_000, 2_000, 4_000, 8_000, 10_000, 10_000]);
  });

  test('a delay is at least half its ceiling, whatever chance says', () => {
    expect(retryDelay(2, 0)).toBe(1_000);
    expect(retryDelay(2, 1)).toBe(2_000);
  });

  test('opening alone does not reset the back-off, a message does', () => {
    world.socket.events.closed();
    world.pass(1_000);
    world.socket.events.closed();
    expect(world.link.state).toMatchObject({ kind: 'lost', attempt: 1 });
    world.pass(2_000);
    world.say(snapshot());
    world.socket.events.closed();
    expect(world.link.state).toMatchObject({ kind: 'lost', attempt: 0 });
  });

  test('an open but silent socket is slow first and given up later', () => {
    world.say(snapshot({ version: 5 }));
    world.pass(SLOW_MS + 500);
    expect(world.link.state.kind).toBe('slow');
    world.pass(DEAD_MS - SLOW_MS);
    expect(world.link.state.kind).toBe('lost');
    expect(world.sockets[0]!.state).toBe('closed');
  });

  test('a floor whose clock stands is not shown as live, although messages come', () => {
    world.say(snapshot({ version: 1, time_s: 7 }));
    const hear = (version: number, time_s: number): void => {
      world.pass(900);
      world.say({ type: 'patch', base: version - 1, version, time_s });
    };
    hear(2, 7);
    expect(world.link.state.kind).toBe('live');
    for (const version of [3, 4, 5]) hear(version, 7);
    expect(world.link.state.kind).toBe('still');
    hear(6, 8);
    expect(world.link.state.kind).toBe('live');
    expect(world.states.filter((kind) => kind === 'still')).toHaveLength(1);
  });

  test('a slow link is live again with the next message', () => {
    world.say(snapshot({ version: 5 }));
    world.pass(SLOW_MS + 500);
    world.say({ type: 'patch', base: 5, version: 6, time_s: 3 });
    expect(world.link.state.kind).toBe('live');
  });

  test('words from a socket that was given up are not heard', () => {
    const first = world.socket;
    world.say(snapshot({ version: 5 }));
    world.link.retryNow();
    first.events.message(JSON.stringify(snapshot({ version: 99 })));
    first.events.closed();
    expect(world.link.mirror.version).toBe(5);
    expect(world.sockets).toHaveLength(2);
  });

  test('an unknown message counts as a sign of life and changes nothing', () => {
    world.say(snapshot({ version: 5 }));
    world.pass(1_500);
    world.say({ type: 'weather', rain: true });
    world.pass(1_500);
    // Neither slow nor live: the server speaks, but not of a floor that goes on.
    expect(world.link.state.kind).toBe('still');
    expect(world.link.mirror.version).toBe(5);
  });

  test('broken JSON is answered with a new snapshot, not with a broken page', () => {
    world.say(snapshot({ version: 5 }));
    world.socket.events.message('{"type":');
    world.pass(1_000);
    expect(world.socket.since).toBeNull();
  });

  test('a browser that refuses to open a socket is tried again', () => {
    world.refuse = true;
    world.link.retryNow();
    expect(world.link.state.kind).toBe('lost');
    world.refuse = false;
    world.pass(1_000);
    world.say(snapshot());
    expect(world.link.state.kind).toBe('live');
  });

  test('after stop nothing happens any more', () => {
    world.link.stop();
    world.pass(60_000);
    expect(world.sockets).toHaveLength(1);
    expect(world.socket.state).toBe('closed');
  });
});
