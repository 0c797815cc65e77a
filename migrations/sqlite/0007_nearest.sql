-- Assignments wait until the nearest worker is free: nobody has them yet. SQLite cannot drop NOT NULL, so the table is made
-- anew.
CREATE TABLE assignments_of_somebody (
    id      INTEGER PRIMARY KEY,
    worker  INTEGER,
    place   INTEGER NOT NULL,
    stay    INTEGER NOT NULL,
    what    TEXT NOT NULL,
    key     TEXT,
    state   TEXT NOT NULL,
    created INTEGER NOT NULL,
    updated INTEGER NOT NULL
) STRICT;
INSERT INTO assignments_of_somebody (id, worker, place, stay, what, key, state, created, updated)
    SELECT id, worker, place, stay, what, key, state, created, updated FROM assignments;
DROP TABLE assignments;
ALTER TABLE assignments_of_somebody RENAME TO assignments;
CREATE INDEX assignments_by_worker ON assignments (worker, id);
CREATE INDEX assignments_over ON assignments (updated) WHERE state IN ('done', 'cancelled');
