// The audit: who asked for what, and what came of it.
import type { Act } from './acts';

export type AuditOutcome = 'done' | 'refused' | 'failed' | 'unanswered';
/** A request that was to change something: who asked, in which role, and what came of it. */
export interface AuditEntry {
  id: string;
  at: string;
  actor: string;
  role: string;
  what: string;
  /** The same as an act; null where another version knew it. */
  act?: Act | null;
  subject: string | null;
  outcome: AuditOutcome;
  status: number | null;
}
export interface AuditPage {
  items: AuditEntry[];
  next: string | null;
}
