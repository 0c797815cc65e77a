// A server of its own for a test: started with a scenario, stopped with everything that it wrote.
import { spawn } from 'node:child_process';
import { rmSync } from 'node:fs';

/** Starts the program with a scenario and a database in a folder that is removed at the end. */
export async function serve(program, scenario, scratch) {
  const server = spawn(program, ['serve', '--scenario', scenario, '--listen', '127.0.0.1:0', '--database', `${scratch}/db.sqlite`]);
  let log = '';
  server.stderr.on('data', (text) => { log += text; });
  server.stdout.on('data', (text) => { log += text; });
  const ended = new Promise((done) => { server.once('exit', done); });
  for (let i = 0; i < 300; i++) {
    const at = /^Giveway is at (http:\/\/[^/]*)\/$/m.exec(log)?.[1];
    if (at) return { url: at, stop: async () => { server.kill('SIGTERM'); await ended; rmSync(scratch, { recursive: true, force: true }); } };
    if (server.exitCode !== null) break;
    await new Promise((done) => { setTimeout(done, 200); });
  }
  console.error(`The server did not start:\n${log}`);
  server.kill();
  process.exit(1);
}
