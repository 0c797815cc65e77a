// Alarms: active ones in the live feed, and the list of active and past ones.
import type { Act } from './acts';
import type { Sentence } from './sentence';

export const SEVERITIES = ['critical', 'warning', 'notice'] as const;
export type Severity = (typeof SEVERITIES)[number];
export type SubjectKind = 'robot' | 'worker' | 'job' | 'station' | 'closure' | 'floor' | 'server';
/** An active alarm in the feed. What recordings of earlier versions lack is optional: there the id was the kind. */
export interface Alarm extends Sentence {
  id: string;
  since_s: number;
  kind?: string;
  severity?: Severity;
  subject_kind?: SubjectKind;
  /** Null for the floor and the server. */
  subject?: string | null;
  remedy?: Sentence | string;
  x?: number | null;
  y?: number | null;
  /** How many robots wait because of it. */
  waiting?: number;
  acknowledged_by?: string | null;
  /** Until when somebody has put it aside, RFC 3339. */
  shelved_until?: string | null;
  /** What can be done about it in one request. */
  acts?: readonly Act[];
  /** Of a group: the alarms of single robots in it. */
  members?: readonly { id: string; subject: string; acknowledged_by: string | null }[];
}
/** An alarm in the list, active or past. */
export interface AlarmRecord extends Sentence {
  id: string;
  kind: string;
  severity: Severity;
  state: 'active' | 'cleared';
  subject: { kind: SubjectKind; id: string };
  remedy: Sentence;
  x: number | null;
  y: number | null;
  waiting: number;
  since: string;
  acknowledged: { by: string; at: string } | null;
  shelved: { by: string; at: string; until: string; reason: string } | null;
  notes: { by: string; at: string; text: string }[];
  acts: Act[];
  group: string | null;
  members: AlarmMember[];
  cleared: string | null;
}
export interface AlarmMember extends Sentence {
  id: string;
  subject: { kind: SubjectKind; id: string };
  x: number | null;
  y: number | null;
  since: string;
  acknowledged_by: string | null;
}
export interface AlarmPage {
  items: AlarmRecord[];
  next: string | null;
}
