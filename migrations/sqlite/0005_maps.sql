-- Names of nodes, stations and racks that rows of the past speak of and that the map no longer has, after the database was
-- carried over to a changed map. `kind` is node, station or rack; `id` is far beyond every position in a map.
-- The map itself, in Giveway's own format, is in `about` under the key `floor`: positions alone do not say how to read them.
CREATE TABLE gone (
    kind TEXT NOT NULL,
    id   INTEGER NOT NULL,
    name TEXT NOT NULL,
    PRIMARY KEY (kind, id)
) STRICT, WITHOUT ROWID;
