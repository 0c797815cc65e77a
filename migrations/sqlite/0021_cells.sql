-- What happened at picking stations over time: lines that were over, reaches that were warned of, and how long stations had
-- nothing to pick from, microseconds, all together.
ALTER TABLE history ADD COLUMN lines INTEGER NOT NULL DEFAULT 0;
ALTER TABLE history ADD COLUMN wrong_reaches INTEGER NOT NULL DEFAULT 0;
ALTER TABLE history ADD COLUMN idle_time INTEGER NOT NULL DEFAULT 0;
