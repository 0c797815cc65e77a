// The API's descriptions, against a running server: valid for validators that are not ours, and the TypeScript that is
// generated from them compiles, as does a program that uses it.
// node tests/clients.mjs http://127.0.0.1:8080 EMPTY-FOLDER
import specs from '@asyncapi/specs';
import { Validator } from '@seriousme/openapi-schema-validator';
import Ajv from 'ajv';
import addFormats from 'ajv-formats';
import { execFileSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import openapiTS, { astToString } from 'openapi-typescript';
import { assert, check, finish } from './chromium.mjs';

const [url, folder] = process.argv.slice(2);
if (!folder) {
  console.error('Say where a server is, and a folder: node tests/clients.mjs http://127.0.0.1:8080 /tmp/clients');
  process.exit(2);
}
mkdirSync(folder, { recursive: true });
const read = async (path) => (await fetch(new URL(path, url))).json();
const api = await read('/openapi.json');
const messages = await read('/asyncapi.json');
writeFileSync(`${folder}/openapi.json`, JSON.stringify(api));

// A program that a customer might write. Words that the API does not know must not compile.
const PROGRAM = `
import type { components, operations } from './api';

type Job = components['schemas']['JobDto'];
type NewJob = components['schemas']['NewJob'];
type Problem = operations['submitJob']['responses'][422]['content']['application/problem+json'];

export const job: NewJob = { kind: 'deliver', rack: 'K1', station: 'S1', priority: 5 };
// @ts-expect-error: there is no such kind of job
export const wrong: NewJob = { kind: 'encounters' };

export async function submit(at: string, job: NewJob): Promise<Job | Problem> {
  const answer = await fetch(at + '/v1/jobs', { method: 'POST', body: JSON.stringify(job) });
  return (await answer.json()) as Job | Problem;
}

/** Every state has its words: a new one makes this an error. */
export function words(state: Job['state']): string {
  switch (state) {
    case 'waiting': return 'no robot has it yet';
    case 'assigned': return 'a robot is on its way';
    case 'carrying': return 'a robot carries the rack';
    case 'picking': return 'the rack stands at the station';
    case 'done': return 'done';
    case 'cancelled': return 'cancelled';
    case 'failed': return 'failed';
  }
}

export const late = (one: Job, now: string): boolean => one.deadline !== null && one.deadline < now;
`;

await check('The OpenAPI document is valid', async () => {
  const { valid, errors } = await new Validator().validate(structuredClone(api));
  assert(valid, JSON.stringify(errors ?? 'no reason').slice(0, 2000));
  return `${Object.keys(api.paths).length} paths, OpenAPI ${api.openapi}`;
});

await check('The AsyncAPI document is valid', () => {
  const ajv = new Ajv({ strict: false });
  addFormats(ajv);
  // Ajv knows the meta-schema already, which the file brings along.
  const rules = structuredClone(specs.schemas['3.0.0']);
  delete rules.definitions['http://json-schema.org/draft-07/schema'];
  const isValid = ajv.compile(rules);
  assert(isValid(messages), JSON.stringify(isValid.errors).slice(0, 2000));
  return `${Object.keys(messages.components.messages).length} messages`;
});

await check('TypeScript that is generated from it compiles, and so does a program that uses it', async () => {
  writeFileSync(`${folder}/api.d.ts`, astToString(await openapiTS(JSON.stringify(api))));
  writeFileSync(`${folder}/program.ts`, PROGRAM);
  const tsc = fileURLToPath(new URL('../node_modules/typescript/bin/tsc', import.meta.url));
  const flags = ['--noEmit', '--strict', '--module', 'esnext', '--moduleResolution', 'bundler', '--target', 'es2023'];
  try {
    execFileSync(process.execPath, [tsc, ...flags, `${folder}/program.ts`], { encoding: 'utf8', cwd: folder });
  } catch (error) {
    throw new Error(error.stdout || error.message);
  }
});

finish();
