// Where the page of the API begins.
import '../app.css';
import './docs.css';
import { applyTheme, storedTheme } from '../parts';
import type { Description, Messages } from './description';
import { page } from './page';

async function read<T>(path: string): Promise<T> {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(`${path} was answered with ${answer.status}`);
  return (await answer.json()) as T;
}

async function show(host: HTMLElement): Promise<void> {
  try {
    const [api, messages] = await Promise.all([read<Description>('/openapi.json'), read<Messages>('/asyncapi.json')]);
    host.replaceChildren(...page(api, messages));
    // The target of the address was not there when the browser looked for it.
    document.getElementById(decodeURIComponent(location.hash.slice(1)))?.scrollIntoView();
  } catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    host.textContent = `The description of the API cannot be shown: ${why}`;
  }
}

applyTheme(storedTheme());
const host = document.getElementById('docs');
if (host) void show(host);
