-- What happened over time, in buckets, for charts over a restart. The journal could tell counts, but neither who was on
-- the floor for how long, nor how long searches took. `step` and all times are microseconds, `start` since 1970;
-- `searches` counts lengths by class. Rows are written again while their bucket is not over, and deleted when too old.
CREATE TABLE history (
    step             INTEGER NOT NULL,
    start            INTEGER NOT NULL,
    covered          INTEGER NOT NULL,
    robot_deliveries INTEGER NOT NULL,
    human_deliveries INTEGER NOT NULL,
    encounters       INTEGER NOT NULL,
    deviations       INTEGER NOT NULL,
    interruptions    INTEGER NOT NULL,
    replans          INTEGER NOT NULL,
    plans            INTEGER NOT NULL,
    plan_failures    INTEGER NOT NULL,
    worker_time      INTEGER NOT NULL,
    waiting_time     INTEGER NOT NULL,
    searches         TEXT NOT NULL,
    step_max         INTEGER NOT NULL,
    PRIMARY KEY (step, start)
) STRICT, WITHOUT ROWID;

-- How long robots waited at which node of the sealed map, in buckets of five minutes.
CREATE TABLE heat (
    start  INTEGER NOT NULL,
    node   INTEGER NOT NULL,
    waited INTEGER NOT NULL,
    PRIMARY KEY (start, node)
) STRICT, WITHOUT ROWID;
