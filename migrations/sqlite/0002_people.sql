-- What workers are to do, as the facts leave it. `worker` and `place` are numbers of the journal and of the sealed
-- map; times are microseconds since 1970.
CREATE TABLE assignments (
    id      INTEGER PRIMARY KEY,
    worker  INTEGER NOT NULL,
    place   INTEGER NOT NULL,
    stay    INTEGER NOT NULL,
    what    TEXT NOT NULL,
    key     TEXT,
    state   TEXT NOT NULL,
    created INTEGER NOT NULL,
    updated INTEGER NOT NULL
) STRICT;

-- Lists are of one worker, newest first.
CREATE INDEX assignments_by_worker ON assignments (worker, id);

-- Robots that came into region 1 of a worker, for the safety engineer. `seq` is the number of the fact in the journal;
-- lengths are millimetres, speeds millimetres per second.
CREATE TABLE encounters (
    seq          INTEGER PRIMARY KEY,
    worker       INTEGER NOT NULL,
    robot        INTEGER NOT NULL,
    began        INTEGER NOT NULL,
    ended        INTEGER NOT NULL,
    x            INTEGER NOT NULL,
    y            INTEGER NOT NULL,
    radius       INTEGER NOT NULL,
    closest      INTEGER NOT NULL,
    robot_speed  INTEGER NOT NULL,
    worker_speed INTEGER NOT NULL,
    reaction     TEXT NOT NULL,
    delay        INTEGER NOT NULL
) STRICT;

-- Reports are of a shift: from one time to another.
CREATE INDEX encounters_by_time ON encounters (began);
