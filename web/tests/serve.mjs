// A server of its own for a test: started with a scenario, stopped with everything that it wrote, or killed.
import { spawn } from 'node:child_process';
import { rmSync } from 'node:fs';

/** For the `fleet` of a scenario: robots that are quick, where a test waits for what they bring. */
export const QUICK = { speed_mps: 3, speed_loaded_mps: 3, accel_unloaded_mps2: 3, accel_loaded_mps2: 3, lift_s: 0.5 };

/**
 * More arguments of a floor that runs three times as fast as time does, for scripts that wait for robots: not where a
 * person or a hand moves in the page, nor where the browser draws all the while, which binds the processor.
 */
export const FAST = ['--speed', '3'];

/**
 * Starts the program with a scenario, or with what it shows by itself where that is null, and with a database in a
 * folder that is removed when it is stopped. One that was killed can be started again on the same database and port.
 * Further arguments are in `more`.
 */
export async function serve(program, scenario, scratch, port = 0, more = []) {
  const server = spawn(program, [
    'serve',
    ...more,
    ...(scenario === null ? [] : ['--scenario', scenario]),
    '--listen',
    `127.0.0.1:${port}`,
    '--database',
    `${scratch}/db.sqlite`,
  ]);
  let log = '';
  server.stderr.on('data', (text) => {
    log += text;
  });
  server.stdout.on('data', (text) => {
    log += text;
  });
  const ended = new Promise((done) => {
    server.once('exit', done);
  });
  const ends = async (signal) => {
    server.kill(signal);
    await ended;
  };
  process.once('exit', () => server.kill('SIGKILL'));
  // A floor that works before the server begins takes a while on a machine that does much else.
  for (let i = 0; i < 1_500; i++) {
    const url = /^Giveway is at (http:\/\/[^/]*)\/$/m.exec(log)?.[1];
    const stop = async () => {
      await ends('SIGTERM');
      rmSync(scratch, { recursive: true, force: true });
    };
    if (url) return { url, stop, kill: () => ends('SIGKILL') };
    if (server.exitCode !== null) break;
    await new Promise((done) => {
      setTimeout(done, 200);
    });
  }
  console.error(`The server did not start:\n${log}`);
  server.kill();
  process.exit(1);
}
