-- What happened, for other systems: one row for each change of state of a job, robot, worker, assignment, closure or
-- alarm, and for each encounter. Written with the facts in one transaction, so that nobody who follows it misses
-- anything; numbers are never used again. `subject` is the number of what changed, null for the whole fleet; `at` is
-- microseconds since 1970. What happened before this table was made is not in it.
CREATE TABLE events (
    seq     INTEGER PRIMARY KEY AUTOINCREMENT,
    at      INTEGER NOT NULL,
    kind    TEXT NOT NULL,
    subject INTEGER,
    old     TEXT,
    new     TEXT NOT NULL,
    robot   INTEGER,
    worker  INTEGER,
    text    TEXT
) STRICT;

-- The state before is that of the last event about the same subject.
CREATE INDEX events_by_subject ON events (kind, subject, seq);
-- Old ones are deleted.
CREATE INDEX events_by_time ON events (at);

-- Those who want to be told: where, of what, and how far they are. `pending` is the last event of a message that was tried
-- and not taken: it is tried again with the same events.
CREATE TABLE webhooks (
    id       INTEGER PRIMARY KEY AUTOINCREMENT,
    url      TEXT NOT NULL,
    kinds    TEXT NOT NULL,
    secret   TEXT NOT NULL,
    created  INTEGER NOT NULL,
    cursor   INTEGER NOT NULL,
    attempts INTEGER NOT NULL DEFAULT 0,
    pending  INTEGER,
    failed   TEXT
) STRICT;

-- Messages that were given up.
CREATE TABLE webhook_failures (
    id       INTEGER PRIMARY KEY AUTOINCREMENT,
    hook     INTEGER NOT NULL REFERENCES webhooks (id) ON DELETE CASCADE,
    first    INTEGER NOT NULL,
    last     INTEGER NOT NULL,
    at       INTEGER NOT NULL,
    attempts INTEGER NOT NULL,
    error    TEXT NOT NULL
) STRICT;
CREATE INDEX webhook_failures_by_hook ON webhook_failures (hook, id);
