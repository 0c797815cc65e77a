-- Browsers that are signed in: what the cookie says stands for a token. Only the SHA-256 of both are kept. If the token is
-- revoked or rotated, no token has this digest any more, and the session is over. Times are microseconds since 1970.
CREATE TABLE sessions (
    hash    BLOB PRIMARY KEY,
    token   BLOB NOT NULL,
    created INTEGER NOT NULL,
    expires INTEGER NOT NULL
) STRICT;

-- Names of people, in this table alone: everything else, the journal included, knows a worker by a pseudonym. Who is erased
-- has no row any more.
CREATE TABLE people (
    pseudonym TEXT PRIMARY KEY,
    name      TEXT NOT NULL UNIQUE,
    since     INTEGER NOT NULL
) STRICT;

-- Lists forget after some days who it was: `worker` becomes null in assignments and, since that table was made without
-- nulls, -1 in encounters. These indexes find the rows that still say it.
CREATE INDEX encounters_of_somebody ON encounters (began) WHERE worker >= 0;
CREATE INDEX assignments_of_somebody ON assignments (updated)
    WHERE worker IS NOT NULL AND state IN ('done', 'cancelled');
