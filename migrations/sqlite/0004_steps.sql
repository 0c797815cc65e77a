-- A step of the fleet is one row: it is there whole or not at all, whatever ends the process. `facts` is a JSON array in
-- the wire form `wire`, `at` is when the step was, `run` says which server process wrote it. Rows that no start needs any
-- more, since a snapshot says what they led to, are deleted.
-- It replaces `journal`, which had a row for each fact. A database with rows in that table is refused before this runs.
DROP TABLE journal;
CREATE TABLE steps (
    seq   INTEGER PRIMARY KEY,
    at    INTEGER NOT NULL,
    wire  INTEGER NOT NULL,
    run   TEXT NOT NULL,
    facts TEXT NOT NULL
) STRICT;

-- The ledger after the step `seq`, in the wire form `wire` of snapshots. The last two are kept: if one cannot be read,
-- the other and the steps behind it say the same.
CREATE TABLE snapshots (
    seq  INTEGER PRIMARY KEY,
    at   INTEGER NOT NULL,
    wire INTEGER NOT NULL,
    body TEXT NOT NULL
) STRICT;

-- Several encounters may end in one step, and steps are deleted, so encounters have numbers of their own, which are never
-- given twice. Nothing was in this table without rows in `journal`.
DROP TABLE encounters;
CREATE TABLE encounters (
    seq          INTEGER PRIMARY KEY AUTOINCREMENT,
    worker       INTEGER NOT NULL,
    robot        INTEGER NOT NULL,
    began        INTEGER NOT NULL,
    ended        INTEGER NOT NULL,
    x            INTEGER NOT NULL,
    y            INTEGER NOT NULL,
    radius       INTEGER NOT NULL,
    closest      INTEGER NOT NULL,
    robot_speed  INTEGER NOT NULL,
    worker_speed INTEGER NOT NULL,
    reaction     TEXT NOT NULL,
    delay        INTEGER NOT NULL
) STRICT;
CREATE INDEX encounters_by_time ON encounters (began);

-- What is over is deleted when it is old.
CREATE INDEX jobs_over ON jobs (updated) WHERE state IN ('done', 'cancelled', 'failed');
CREATE INDEX assignments_over ON assignments (updated) WHERE state IN ('done', 'cancelled');
