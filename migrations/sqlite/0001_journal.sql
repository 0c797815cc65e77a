-- What is known about the database itself: the seal of the map whose ids the facts use.
CREATE TABLE about (
    key   TEXT PRIMARY KEY,
    value TEXT NOT NULL
) STRICT;

-- Every fact, in order. `wire` says in which version of the wire form it is written, `at` when its step was.
CREATE TABLE journal (
    seq  INTEGER PRIMARY KEY,
    at   INTEGER NOT NULL,
    wire INTEGER NOT NULL,
    fact TEXT NOT NULL
) STRICT;

-- Jobs as the facts leave them, written with the facts in one transaction, so that lists need no replay.
-- Racks, stations, nodes and robots are positions in the sealed map; times are microseconds since 1970.
CREATE TABLE jobs (
    id       INTEGER PRIMARY KEY,
    kind     TEXT NOT NULL,
    rack     INTEGER,
    station  INTEGER,
    node     INTEGER,
    robot    INTEGER,
    pick     INTEGER,
    priority INTEGER NOT NULL,
    deadline INTEGER,
    after    TEXT NOT NULL,
    key      TEXT,
    state    TEXT NOT NULL,
    why      TEXT,
    worker   INTEGER,
    created  INTEGER NOT NULL,
    updated  INTEGER NOT NULL
) STRICT;

-- Lists are filtered by state, newest first.
CREATE INDEX jobs_by_state ON jobs (state, id);
