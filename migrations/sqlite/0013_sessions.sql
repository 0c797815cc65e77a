-- Browsers that are signed in: what the cookie says stands for a token. Only the SHA-256 of both are kept. If the token is
-- revoked or rotated, no token has this digest any more, and the session is over. Times are microseconds since 1970.
CREATE TABLE sessions (
    hash    BLOB PRIMARY KEY,
    token   BLOB NOT NULL,
    created INTEGER NOT NULL,
    expires INTEGER NOT NULL
) STRICT;
