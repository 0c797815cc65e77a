-- Requests with an Idempotency-Key whose effect has no key of its own (closures, webhooks), so that a repeat gets the
-- answer of the first one. A row without `status` had begun, and nobody knows what came of it. `at` is
-- microseconds since 1970; old rows are deleted.
CREATE TABLE answers (
    caller   TEXT NOT NULL,
    route    TEXT NOT NULL,
    key      TEXT NOT NULL,
    digest   TEXT NOT NULL,
    at       INTEGER NOT NULL,
    status   INTEGER,
    location TEXT,
    body     TEXT,
    PRIMARY KEY (caller, route, key)
) STRICT, WITHOUT ROWID;
CREATE INDEX answers_by_time ON answers (at);
