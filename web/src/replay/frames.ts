// A reel as it is read: lines of JSON to frames, bookmarks, sums and lists of jobs. Frames and lists stay text until
// they are needed: a minute of a large floor is megabytes, most of it only passed over. What is wrong is said in words.
import { MARK_KINDS, type FloorMap, type Mark, type Sum } from '../wire';
import { t } from '../words';

/** What was so at a moment, in JSON: the jobs that waited, or work cells. */
export interface Listed {
  at: number;
  text: string;
}
export interface Frame {
  at: number;
  /** A key frame, or what changed since the frame before. */
  kind: 'key' | 'patch';
  /** The message of the live feed, in JSON. */
  text: string;
}
export interface Reel {
  name: string;
  /** Seconds since 1970 from which times count; null in a simulation. */
  start: number | null;
  /** Left out where the reader has it. */
  map: FloorMap | null;
  frames: Frame[];
  marks: Mark[];
  sums: Sum[];
  lists: Listed[];
  /** Work cells that changed at a moment, in JSON. */
  cells: Listed[];
}

/** What makes a reel of what a simulation recorded. */
const COMMAND = 'giveway replay FILE --reel OUT.reel';
const noReel = (): Error => new Error(t('reel.none', { command: COMMAND }));
const LINE = /^\{"at":(-?[\d.e+]+),"(key|patch|mark|sum|waiting|cells)":/;

/** Reads lines; a last one that was cut off is left out. */
export function readReel(lines: Iterable<string>): Reel {
  const all = lines[Symbol.iterator]();
  const reel: Reel = { ...headerOf(all.next().value), frames: [], marks: [], sums: [], lists: [], cells: [] };
  for (let next = all.next(); !next.done; next = all.next()) {
    const line = next.value;
    const found = LINE.exec(line);
    if (!found || !line.endsWith('}')) continue;
    const at = Number(found[1]);
    const text = line.slice(found[0].length, -1);
    const kind = found[2] as Frame['kind'] | 'mark' | 'sum' | 'waiting' | 'cells';
    if (kind === 'mark') addMark(reel.marks, text);
    else if (kind === 'sum') addSum(reel.sums, at, text);
    else if (kind === 'waiting') reel.lists.push({ at, text });
    else if (kind === 'cells') reel.cells.push({ at, text });
    else reel.frames.push({ at, kind, text });
  }
  if (!reel.frames.some((frame) => frame.kind === 'key')) throw new Error(t('reel.no-key'));
  reel.marks.sort((a, b) => a.at_s - b.at_s);
  return reel;
}

function headerOf(line: unknown): Pick<Reel, 'name' | 'start' | 'map'> {
  let header: unknown;
  try {
    header = JSON.parse(String(line));
  } catch {
    throw noReel();
  }
  if (typeof header !== 'object' || header === null) throw noReel();
  if ('giveway_recording' in header) {
    throw new Error(t('reel.of-sim', { command: COMMAND }));
  }
  if (!('reel' in header)) throw noReel();
  if (header.reel !== 1) throw new Error(t('reel.newer', { format: String(header.reel) }));
  const { name, start, map } = header as { name?: unknown; start?: unknown; map?: FloorMap | null };
  return { name: String(name ?? ''), start: typeof start === 'number' ? start : null, map: map ?? null };
}

function addSum(sums: Sum[], at_s: number, text: string): void {
  try {
    sums.push({ ...(JSON.parse(text) as Sum), at_s });
  } catch {
    // The charts have a gap there.
  }
}

function addMark(marks: Mark[], text: string): void {
  try {
    const mark = JSON.parse(text) as Mark;
    if (MARK_KINDS.includes(mark.kind)) marks.push(mark);
  } catch {
    // A bookmark that cannot be read is worth less than the rest of the reel.
  }
}
