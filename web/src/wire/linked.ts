// Robots of other vendors, which speak VDA 5050: what their link knows of them, and what is said to them.
import type { Answer } from './api';
import type { Sentence } from './sentence';

/** A robot that speaks VDA 5050, on the floor or still waiting to join. */
export interface LinkedRobot {
  id: string;
  manufacturer: string;
  serial: string;
  kind: string;
  /** The version of the protocol that is spoken with it. */
  version: string;
  joined: boolean;
  /** Why it is not commanded; null if it is. */
  not_ready: Sentence | null;
  /** Whether it waits for an administrator's consent, because it does not pause when told to. */
  needs_consent: boolean;
  /** The action that failed, in words; null if none did. */
  failed: string | null;
  /** Whether it waits for people: an action failed, or it refuses orders. */
  needs_care: boolean;
  /** Its order, in words. */
  order: string;
  /** Its last state; null if none has come. */
  said: SaidState | null;
  /** The newest last. */
  noticed: NoticedOfRobot[];
  /** False claims that still count. */
  false_claims: number;
  /** How far it is released at most. */
  longest_base_m: number;
  /** The figures of its kind; none until the kind is known. */
  figures: KindFigure[];
  /** Where its factsheet promises less than its kind. */
  contradictions: string[];
}
export interface KindFigure {
  figure: 'speed' | 'acceleration' | 'turning' | 'outline' | 'payload';
  /** With its unit; `-` if any value will do. */
  value: string;
  origin: 'file' | 'factsheet' | 'default';
}
/** What a robot said in its last state. */
export interface SaidState {
  at: string;
  mode: string;
  e_stop: string;
  field_violation: boolean;
  paused: boolean | null;
  last_node: string;
  /** From 0 to 1; null if it does not say. */
  charge: number | null;
  charging: boolean;
  /** Null if it cannot tell. */
  loads: string[] | null;
  errors: SaidError[];
  wants_base: boolean;
}
export interface SaidError {
  level: string;
  kind: string;
  /** Empty if the robot has none. */
  words: string;
}
export interface NoticedOfRobot {
  at: string;
  said: Sentence;
  is_false_claim: boolean;
}
/** A robot that was heard of and that nobody listed. */
export interface UnlistedRobot {
  manufacturer: string;
  serial: string;
  /** As in its topics. */
  version: string;
  heard: string;
  /** The last word about its connection; null if none came. */
  connection: string | null;
}
/** Robots that have not joined; an older server leaves both out. */
export interface NotJoined {
  waiting?: LinkedRobot[];
  unlisted?: UnlistedRobot[];
}
/** A message from or to a robot. */
export interface SaidMessage {
  at: string;
  to_robot: boolean;
  topic: string;
  text: string;
}
/** What became of an action that was sent to a robot. */
export interface ActionFate {
  id: string;
  kind: string;
  sent: string;
  /** SENT until the robot says something of it, then the robot's last word. */
  status: string;
  result: string | null;
}
/** An action to be sent: with parameters, or, for `initPosition`, with a place on the floor's map. */
export interface NewAction {
  type: string;
  parameters?: Record<string, unknown>;
  place?: { x: number; y: number; theta: number };
}
/** A robot to be listed. */
export interface NewLinked {
  name: string;
  kind: string;
  manufacturer: string;
  serial: string;
}

type Ask = <T>(method: string, path: string, body?: object) => Promise<Answer<T>>;

/** The requests about such robots. */
export function linkedRequests(ask: Ask) {
  const of = (robot: string): string => `/v1/robots/${encodeURIComponent(robot)}`;
  return {
    link: (robot: string) => ask<LinkedRobot>('GET', `${of(robot)}/link`),
    /** The last messages both ways, the newest last; for administrators. */
    messages: (robot: string) => ask<{ messages: SaidMessage[] }>('GET', `${of(robot)}/messages`),
    act: (robot: string, action: NewAction) => ask<{ action: string }>('POST', `${of(robot)}/actions`, action),
    fate: (robot: string, action: string) =>
      ask<ActionFate>('GET', `${of(robot)}/actions/${encodeURIComponent(action)}`),
    consent: (robot: string) => ask<null>('PUT', `${of(robot)}/consent`),
    settle: (robot: string) => ask<null>('POST', `${of(robot)}/settled`),
    /** Robots that have not joined; refused with 404 on a floor without such a link. */
    notJoined: () => ask<NotJoined>('GET', '/v1/robots?unlisted=true&limit=1'),
    list: (robot: NewLinked) => ask<{ id: string }>('POST', '/v1/robots', robot),
  };
}
export type LinkedApi = ReturnType<typeof linkedRequests>;
