// What the charts show: rates and averages from the sums in buckets, gaps where nothing is known. Pure.
import { micros, significant, type MessageKey } from '../words';
import type { Bucket, HistoryPage } from '../wire';

export interface Line {
  id: string;
  name: MessageKey;
  /** A colour by its custom property. */
  ink: string;
  /** How it is dashed, so that nobody needs the colours. */
  dash: string | null;
  of(figures: Figures): number | null;
}
/** What a bucket has; of the past, another share of searches is known. */
export type Figures = Omit<Bucket, 'at'> & { plan_us_p99?: number | null };
export interface Chart {
  id: string;
  title: MessageKey;
  unit: MessageKey;
  scale: 'linear' | 'log';
  /** Who looks at it: those who lead the floor, or those who look after the server. */
  about: 'floor' | 'system';
  lines: readonly Line[];
  format(value: number): string;
}

/** A bucket that was seen for less than this says nothing about a rate, seconds. */
const LEAST_S = 4;
const perHour = (count: (b: Figures) => number) => (b: Figures) =>
  b.covered_s < LEAST_S ? null : (3_600 * count(b)) / b.covered_s;
const perMinute = (count: (b: Figures) => number) => (b: Figures) =>
  b.covered_s < LEAST_S ? null : (60 * count(b)) / b.covered_s;
const average = (seconds: (b: Figures) => number) => (b: Figures) =>
  b.covered_s < LEAST_S ? null : seconds(b) / b.covered_s;

const ROBOTS = 'var(--chart-1)';
const PEOPLE = 'var(--chart-2)';
const ALL = 'var(--text)';
const number = (value: number): string => significant(value, 3);

export const CHARTS: readonly Chart[] = [
  {
    id: 'deliveries',
    about: 'floor',
    title: 'deliveries',
    unit: 'charts.unit.per-hour',
    scale: 'linear',
    format: number,
    lines: [
      { id: 'robots', name: 'charts.line.robots', ink: ROBOTS, dash: null, of: perHour((b) => b.robot_deliveries) },
      { id: 'people', name: 'charts.line.people', ink: PEOPLE, dash: '5 3', of: perHour((b) => b.human_deliveries) },
      {
        id: 'total',
        name: 'charts.line.total',
        ink: ALL,
        dash: '1 2',
        of: perHour((b) => b.robot_deliveries + b.human_deliveries),
      },
    ],
  },
  {
    id: 'encounters',
    about: 'floor',
    title: 'encounters',
    unit: 'charts.unit.per-worker-minute',
    scale: 'linear',
    format: number,
    // Without anybody on the floor there is no rate, rather than a rate of zero.
    lines: [
      {
        id: 'encounters',
        name: 'charts.line.encounters',
        ink: PEOPLE,
        dash: null,
        of: (b) => (b.worker_s < LEAST_S ? null : (60 * b.encounters) / b.worker_s),
      },
    ],
  },
  {
    id: 'interruptions',
    about: 'floor',
    title: 'charts.interruptions',
    unit: 'charts.unit.per-minute',
    scale: 'linear',
    format: number,
    lines: [
      {
        id: 'interruptions',
        name: 'charts.line.interruptions',
        ink: PEOPLE,
        dash: null,
        of: perMinute((b) => b.interruptions),
      },
      { id: 'replans', name: 'charts.line.replans', ink: ROBOTS, dash: '5 3', of: perMinute((b) => b.replans) },
    ],
  },
  {
    id: 'waiting',
    about: 'floor',
    title: 'charts.waiting',
    unit: 'charts.unit.average',
    scale: 'linear',
    format: number,
    lines: [
      { id: 'waiting robots', name: 'charts.line.waiting', ink: ROBOTS, dash: null, of: average((b) => b.waiting_s) },
    ],
  },
  {
    id: 'lines',
    about: 'floor',
    title: 'charts.lines',
    unit: 'charts.unit.per-hour',
    scale: 'linear',
    format: number,
    lines: [
      { id: 'lines', name: 'charts.line.lines', ink: ALL, dash: null, of: perHour((b) => b.lines) },
      { id: 'mistakes', name: 'charts.line.mistakes', ink: PEOPLE, dash: '5 3', of: perHour((b) => b.wrong_reaches) },
    ],
  },
  {
    id: 'idle',
    about: 'floor',
    title: 'charts.idle',
    unit: 'charts.unit.average',
    scale: 'linear',
    format: number,
    lines: [{ id: 'idle stations', name: 'charts.line.idle', ink: PEOPLE, dash: null, of: average((b) => b.idle_s) }],
  },
  {
    id: 'plans',
    about: 'system',
    title: 'charts.search',
    unit: 'charts.unit.log',
    scale: 'log',
    format: micros,
    lines: [
      { id: 'median', name: 'charts.line.median', ink: ROBOTS, dash: null, of: (b) => b.plan_us_p50 },
      { id: '95 %', name: 'charts.line.p95', ink: ALL, dash: '5 3', of: (b) => b.plan_us_p95 },
      { id: 'longest', name: 'charts.line.longest', ink: PEOPLE, dash: '1 2', of: (b) => b.plan_us_max },
    ],
  },
  {
    id: 'steps',
    about: 'system',
    title: 'charts.step',
    unit: 'charts.unit.log',
    scale: 'log',
    format: micros,
    lines: [
      { id: 'longest step', name: 'charts.line.longest-step', ink: ROBOTS, dash: null, of: (b) => b.step_us_max },
    ],
  },
  {
    id: 'people',
    about: 'floor',
    title: 'charts.people',
    unit: 'charts.unit.average',
    scale: 'linear',
    format: number,
    lines: [
      {
        id: 'people on the floor',
        name: 'charts.line.people-here',
        ink: PEOPLE,
        dash: null,
        of: average((b) => b.worker_s),
      },
    ],
  },
];

/** Charts about picking stations. */
export const PICKING: readonly string[] = ['lines', 'idle'];
/** Whether anything is known of picking stations. */
export const picks = (grid: Grid | null): boolean =>
  grid?.buckets.some((b) => b !== null && b.lines + b.wrong_reaches + b.idle_s > 0) ?? false;

/** A place for each step of the time shown, with its bucket or nothing. */
export interface Grid {
  from: number;
  to: number;
  step: number;
  /** When each begins, milliseconds. */
  at: number[];
  buckets: (Figures | null)[];
  /** Milliseconds are since 1970, rather than since a simulation began. */
  ofDay: boolean;
}

/** Puts buckets onto an even grid over the last `span_s` seconds, so that what is missing stays missing. */
export function gridOf(page: HistoryPage, span_s: number): Grid {
  const step = 1_000 * page.step_s;
  const to = Math.ceil(Date.parse(page.to) / step) * step;
  const from = to - Math.round((1_000 * span_s) / step) * step;
  const by = new Map(page.buckets.map((b) => [Date.parse(b.at), b]));
  const at = Array.from({ length: Math.round((to - from) / step) }, (_, i) => from + i * step);
  return { from, to, step, at, buckets: at.map((t) => by.get(t) ?? null), ofDay: true };
}

export const valuesOf = (line: Line, grid: Grid): (number | null)[] =>
  grid.buckets.map((b) => (b === null ? null : line.of(b)));

/** Runs of neighbours that have values: first and last index of each. */
export function runs(values: readonly (number | null)[]): [first: number, last: number][] {
  const found: [number, number][] = [];
  values.forEach((value, i) => {
    if (value === null) return;
    const last = found.at(-1);
    if (last && last[1] === i - 1) last[1] = i;
    else found.push([i, i]);
  });
  return found;
}

/** Stretches of which nothing is known, as shares of the width. What has not come yet is not one. */
export function gaps({ buckets }: Grid): [from: number, to: number][] {
  const n = buckets.length;
  const unknown = runs(buckets.map((b) => (b === null ? 1 : null)));
  return unknown.filter(([, last]) => last < n - 1).map(([first, last]) => [first / n, (last + 1) / n]);
}
