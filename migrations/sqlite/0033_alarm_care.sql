-- What people do about alarms besides acknowledging them, and which belong together. An alarm that was put aside calls nobody
-- until shelved_until; it holds for the subject, so a start looks for those that have not ended, also of alarms that have.
-- notes is a JSON array of [by, at, text]. grp is the alarm of which this one is a member.
ALTER TABLE alarms ADD COLUMN shelved_by TEXT;
ALTER TABLE alarms ADD COLUMN shelved INTEGER;
ALTER TABLE alarms ADD COLUMN shelved_until INTEGER;
ALTER TABLE alarms ADD COLUMN shelved_reason TEXT;
ALTER TABLE alarms ADD COLUMN notes TEXT;
ALTER TABLE alarms ADD COLUMN grp INTEGER;
CREATE INDEX alarms_by_shelf ON alarms (shelved_until) WHERE shelved_until IS NOT NULL;
CREATE INDEX alarms_by_group ON alarms (grp, id) WHERE grp IS NOT NULL;
