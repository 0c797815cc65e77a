// A stand-in for the server, so that `npm run dev` works alone. It speaks the public API over a toy
// floor. Alone: node dev/mock.mjs [--port 8791] [--robots 50] [--people 3] [--width 40] [--height 25] [--dist dist]
// [--token secret]; with --dist it serves the built page under the strictest policy the page must bear.
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { WebSocketServer } from 'ws';
import { thinPatch } from './thin.mjs';
import { ToyFleet } from './toyfleet.mjs';
import { toyFloor } from './toyfloor.mjs';

const POLICY =
  "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; " +
  "worker-src 'self' blob:; base-uri 'none'; form-action 'none'";
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };
const TICK_S = 0.1;

const mayEnter = (request, token) =>
  token === null || String(request.headers.cookie ?? '').includes(`mock_session=${token}`);

/** Signing in and out; the cookie is the token itself, since this is a mock. */
async function session(request, response, token) {
  const me = { name: 'mock', role: 'admin', subject: null, by: token === null ? 'nothing' : 'session', expires: null };
  if (request.method === 'DELETE') {
    response.setHeader('Set-Cookie', 'mock_session=; Path=/; Max-Age=0');
    response.writeHead(204).end();
    return;
  }
  if (request.method === 'POST') {
    let body = '';
    for await (const part of request) body += part;
    if (JSON.parse(body).token !== token)
      return send(response, 401, { title: 'Unauthorized', status: 401, detail: 'Wrong token.' });
    response.setHeader('Set-Cookie', `mock_session=${token}; Path=/; HttpOnly; SameSite=Strict`);
  } else if (!mayEnter(request, token)) {
    return send(response, 401, { title: 'Unauthorized', status: 401, detail: 'Sign in.' });
  }
  return send(response, request.method === 'POST' ? 201 : 200, me);
}

export async function startMock({ port, width = 40, height = 25, robots = 50, people = 3, dist = null, token = null }) {
  const floor = toyFloor(width, height);
  const fleet = new ToyFleet(floor, robots, people);
  let version = 1;
  let last = fleet.view();

  const http = createServer(async (request, response) => {
    const url = new URL(request.url, 'http://mock');
    if (!url.pathname.startsWith('/v1/')) return serveFile(dist, url.pathname, response);
    if (url.pathname === '/v1/session/oidc') return send(response, 200, { name: null });
    if (url.pathname === '/v1/session') return session(request, response, token);
    if (!mayEnter(request, token))
      return send(response, 401, { title: 'Unauthorized', status: 401, detail: 'Sign in.' });
    const [status, body] = await answer(fleet, floor.map, request, url);
    send(response, status, body);
  });
  const sockets = new WebSocketServer({
    noServer: true,
    handleProtocols: (offered) => (offered.has('giveway') ? 'giveway' : false),
  });
  http.on('upgrade', (request, socket, head) => {
    if (!mayEnter(request, token)) {
      socket.end('HTTP/1.1 401 Unauthorized\r\n\r\n');
      return;
    }
    sockets.handleUpgrade(request, socket, head, (client) => {
      client.send(
        JSON.stringify({ type: 'snapshot', version, started: new Date(0).toISOString(), simulated: true, ...last }),
      );
    });
  });
  const timer = setInterval(() => {
    fleet.step(TICK_S);
    const now = fleet.view();
    const patch = thinPatch(last, now, version);
    version += 1;
    last = now;
    const text = JSON.stringify(patch);
    for (const client of sockets.clients) client.send(text);
  }, TICK_S * 1000);

  await new Promise((done) => http.listen(port, '127.0.0.1', done));
  return {
    port: http.address().port,
    stop: () => {
      clearInterval(timer);
      sockets.clients.forEach((c) => c.terminate());
      http.closeAllConnections();
      http.close();
    },
  };
}

async function answer(fleet, map, request, url) {
  const [, , what, id] = url.pathname.split('/');
  if (what === 'map') return [200, map];
  if (!['jobs', 'jobs:batch'].includes(what))
    return [404, { title: 'Not found', status: 404, detail: `There is nothing at ${url.pathname}.` }];
  if (what === 'jobs:batch') return submitAll(fleet, map, request);
  if (request.method === 'POST') return submit(fleet, map, await read(request), request.headers['idempotency-key']);
  if (id) {
    const job = fleet.jobs.find((j) => j.id === id);
    if (!job) return [404, { title: 'No such job', status: 404, detail: `There is no job ${id}.` }];
    if (request.method === 'DELETE') job.state = 'cancelled';
    return [200, job];
  }
  const state = url.searchParams.get('state');
  const from = Number(url.searchParams.get('cursor') ?? 0);
  const all = fleet.jobs.filter((j) => state === null || j.state === state).reverse();
  const limit = Number(url.searchParams.get('limit') ?? 50);
  return [200, { items: all.slice(from, from + limit), next: all.length > from + limit ? String(from + limit) : null }];
}

async function read(request) {
  const chunks = [];
  for await (const chunk of request) chunks.push(chunk);
  return JSON.parse(Buffer.concat(chunks).toString());
}

async function submitAll(fleet, map, request) {
  const outcomes = (await read(request)).jobs.map(({ key, job }) => submit(fleet, map, job, key));
  const results = outcomes.map(([status, told]) =>
    status === 201 ? { id: told.id, new: true, problem: null } : { id: null, new: false, problem: told },
  );
  const accepted = results.filter((r) => r.id !== null).length;
  return [200, { accepted, refused: results.length - accepted, results }];
}

function submit(fleet, map, job, key) {
  if (fleet.keys.has(key)) return [201, fleet.keys.get(key)];
  const lists = { rack: map.racks, station: map.stations, node: map.nodes, robot: fleet.robots.map((r) => r.wire) };
  const errors = Object.entries(lists)
    .filter(([field, list]) => job[field] !== undefined && !list.some((one) => one.id === job[field]))
    .map(([field]) => ({ field, detail: `There is no ${field} named ${job[field]} on this floor.` }));
  if (errors.length > 0)
    return [422, { title: 'The job cannot be taken', status: 422, detail: errors[0].detail, errors }];
  const made = fleet.submit(job);
  fleet.keys.set(key, made);
  return [201, made];
}

function send(response, status, body) {
  response.writeHead(status, { 'content-type': status < 400 ? 'application/json' : 'application/problem+json' });
  response.end(JSON.stringify(body));
}

async function serveFile(dist, path, response) {
  try {
    if (dist === null) throw new Error('nothing built is served');
    const file = join(dist, normalize(path === '/' ? '/index.html' : path));
    const body = await readFile(file);
    response.writeHead(200, {
      'content-type': TYPES[extname(file)] ?? 'application/octet-stream',
      'content-security-policy': POLICY,
    });
    response.end(body);
  } catch {
    response.writeHead(404).end();
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { values } = parseArgs({
    options: Object.fromEntries(
      ['port', 'robots', 'people', 'width', 'height', 'dist', 'token'].map((name) => [name, { type: 'string' }]),
    ),
  });
  const number = (text, otherwise) => (text === undefined ? otherwise : Number(text));
  const { port } = await startMock({
    port: number(values.port, 8791),
    robots: number(values.robots, 50),
    people: number(values.people, 3),
    width: number(values.width, 40),
    height: number(values.height, 25),
    dist: values.dist ?? null,
    token: values.token ?? null,
  });
  console.log(`The mock server listens on http://127.0.0.1:${port}`);
}
