-- Alarms, active and past, so that both, and who acknowledged them, outlast a restart. The journal does not have them: most
-- are about what was seen, not about what was promised. Subjects are names and not numbers, so that a row can be read when
-- its robot has left. Times are microseconds since 1970, x and y millimetres on the map. Rows are written again when an
-- alarm changes, and deleted when they are too old or too many.
CREATE TABLE alarms (
    id              INTEGER PRIMARY KEY,
    kind            TEXT NOT NULL,
    severity        TEXT NOT NULL,
    subject_kind    TEXT NOT NULL,
    subject         TEXT NOT NULL,
    text            TEXT NOT NULL,
    remedy          TEXT NOT NULL,
    x               INTEGER,
    y               INTEGER,
    waiting         INTEGER NOT NULL,
    since           INTEGER NOT NULL,
    acknowledged_by TEXT,
    acknowledged    INTEGER,
    cleared         INTEGER
) STRICT;
CREATE INDEX alarms_by_end ON alarms (cleared);
