-- Kinds of robots that were added over HTTP, beside those of the scenario: `figures` is what the body of the request was, a
-- JSON object with the keys of `fleet` in scenarios. They are in force from the next start on.
CREATE TABLE kinds (
    name    TEXT NOT NULL PRIMARY KEY,
    figures TEXT NOT NULL
) STRICT, WITHOUT ROWID;
