-- Robots of other vendors that were listed over the API while the server ran. Those of the site file are not here.
CREATE TABLE linked_robots (
    name TEXT PRIMARY KEY,
    manufacturer TEXT NOT NULL,
    serial TEXT NOT NULL,
    kind TEXT NOT NULL,
    -- The version that is spoken with it; the one that it says if null.
    version TEXT,
    UNIQUE (manufacturer, serial)
) STRICT;
