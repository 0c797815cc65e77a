-- What customers call their jobs: a text of their own, and labels by key. Both are looked for, so both have an index; rows of
-- job_labels go with their job.
ALTER TABLE jobs ADD COLUMN reference TEXT;
CREATE INDEX jobs_by_reference ON jobs (reference, id) WHERE reference IS NOT NULL;
CREATE TABLE job_labels (
    job   INTEGER NOT NULL,
    key   TEXT NOT NULL,
    value TEXT NOT NULL,
    PRIMARY KEY (job, key)
) STRICT, WITHOUT ROWID;
CREATE INDEX job_labels_by_value ON job_labels (key, value, job);
CREATE TRIGGER job_labels_end AFTER DELETE ON jobs BEGIN
    DELETE FROM job_labels WHERE job = old.id;
END;

-- When a job came to each state; NULL where it did not, or where it was before these columns were there.
ALTER TABLE jobs ADD COLUMN assigned_at INTEGER;
ALTER TABLE jobs ADD COLUMN lifted_at INTEGER;
ALTER TABLE jobs ADD COLUMN arrived_at INTEGER;
ALTER TABLE jobs ADD COLUMN ended_at INTEGER;

-- Whether it was changed after it was submitted: then a repeated submission need not have the same words.
ALTER TABLE jobs ADD COLUMN changed INTEGER NOT NULL DEFAULT 0;
