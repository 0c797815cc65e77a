-- Named tokens: who may talk to the server, and as what. Only the SHA-256 of a token is kept. `subject` is the worker or
-- robot that a device speaks for; `role` is viewer, operator, integrator, device or admin. Times are microseconds since
-- 1970. A row is never deleted: what was done under a name is looked up by it.
CREATE TABLE tokens (
    id        INTEGER PRIMARY KEY,
    name      TEXT NOT NULL,
    role      TEXT NOT NULL,
    subject   TEXT,
    hash      BLOB NOT NULL UNIQUE,
    created   INTEGER NOT NULL,
    expires   INTEGER,
    revoked   INTEGER,
    last_used INTEGER
) STRICT;

-- A name stands for one token at a time.
CREATE UNIQUE INDEX tokens_by_name ON tokens (name) WHERE revoked IS NULL;

-- Who asked to change something, and what came of it. `id` is when the request came, microseconds since 1970, made unique;
-- `outcome` is the status of the answer, null where none is known. A request that caused facts is written in their
-- transaction.
CREATE TABLE audit (
    id      INTEGER PRIMARY KEY,
    actor   TEXT NOT NULL,
    role    TEXT NOT NULL,
    what    TEXT NOT NULL,
    subject TEXT,
    outcome INTEGER
) STRICT;

CREATE INDEX audit_by_actor ON audit (actor, id);

-- Which facts of a step which request caused, as JSON; null where the fleet decided all of them by itself.
ALTER TABLE steps ADD COLUMN causes TEXT;
