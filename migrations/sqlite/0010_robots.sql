-- What happened to each robot besides its jobs and alarms: joined, failed, paused, out of service and so on, so that its
-- history outlasts the journal, which is cut behind snapshots. `robot` is null where it happened to the whole fleet; `at`
-- is microseconds since 1970. What happened before this table was made is not in it.
CREATE TABLE robot_changes (
    id    INTEGER PRIMARY KEY,
    robot INTEGER,
    at    INTEGER NOT NULL,
    what  TEXT NOT NULL
) STRICT;

-- The history of a robot is read by robot, newest first: its changes, its jobs, and the alarms about it.
CREATE INDEX robot_changes_by_robot ON robot_changes (robot, at);
CREATE INDEX jobs_by_worker ON jobs (worker, updated);
CREATE INDEX alarms_by_subject ON alarms (subject_kind, subject, since);
