-- For reports of a shift: how long robots were at what and waited for what in each bucket, as `word:microseconds` with
-- blanks between; and jobs by the time of their end and by deadline.
ALTER TABLE history ADD COLUMN robots TEXT NOT NULL DEFAULT '';
CREATE INDEX jobs_by_end ON jobs (ended_at);
CREATE INDEX jobs_by_deadline ON jobs (deadline) WHERE deadline IS NOT NULL;
