-- Every page of a list, every report and every deletion reads about as many rows as it gives, however old the database
-- is: each filter has an index that is in the order of the list (SQLite adds the row's number to the end of each).
-- Statements name the index that they need (INDEXED BY), so that one that loses it is refused and does not scan.
CREATE INDEX jobs_by_rack ON jobs (rack, state) WHERE rack IS NOT NULL;
CREATE INDEX jobs_by_station ON jobs (station, state) WHERE station IS NOT NULL;
CREATE INDEX jobs_by_robot ON jobs (worker, state) WHERE worker IS NOT NULL;
CREATE INDEX jobs_by_acceptance ON jobs (created);
CREATE INDEX jobs_by_change ON jobs (updated);
-- Jobs that were open for more than a day: all others changed within a day of their acceptance.
CREATE INDEX jobs_of_days ON jobs (updated) WHERE updated - created > 86400000000;
-- Picks of more than an hour: all others that went on at some moment ended within an hour of it.
CREATE INDEX jobs_picked_long ON jobs (ended_at) WHERE ended_at - arrived_at > 3600000000;

CREATE INDEX assignments_of_worker ON assignments (worker, state) WHERE worker IS NOT NULL;
CREATE INDEX assignments_at_place ON assignments (place, state);
CREATE INDEX assignments_by_state ON assignments (state);
CREATE INDEX assignments_by_acceptance ON assignments (created);
CREATE INDEX assignments_by_change ON assignments (updated);
CREATE INDEX assignments_of_days ON assignments (updated) WHERE updated - created > 86400000000;
DROP INDEX assignments_by_worker;

CREATE INDEX encounters_of_worker ON encounters (worker) WHERE worker >= 0;
CREATE INDEX encounters_of_robot ON encounters (robot);
CREATE INDEX encounters_by_reaction ON encounters (reaction);
CREATE INDEX encounters_by_end ON encounters (ended);
-- Encounters of more than an hour, for the same reason.
CREATE INDEX encounters_of_hours ON encounters (began) WHERE ended - began > 3600000000;

CREATE INDEX events_by_kind ON events (kind, seq);
CREATE INDEX events_of_worker ON events (worker) WHERE worker IS NOT NULL;
CREATE INDEX robot_changes_by_time ON robot_changes (at);
CREATE INDEX alarms_of_people ON alarms (cleared) WHERE subject_kind = 'worker';
CREATE INDEX alarms_by_start ON alarms (since);
CREATE INDEX alarms_of_hours ON alarms (cleared) WHERE cleared - since > 3600000000;
CREATE INDEX tokens_by_subject ON tokens (subject) WHERE subject IS NOT NULL;

-- How many of the jobs in the list each robot did, and could not do: counted where a job ends and where it is deleted.
CREATE TABLE robot_tallies (
    robot  INTEGER PRIMARY KEY,
    done   INTEGER NOT NULL,
    failed INTEGER NOT NULL
) STRICT;
INSERT INTO robot_tallies (robot, done, failed)
    SELECT worker, sum(state = 'done'), sum(state = 'failed') FROM jobs
    WHERE worker IS NOT NULL AND state IN ('done', 'failed') GROUP BY worker;
CREATE TRIGGER jobs_tallied AFTER UPDATE OF state ON jobs
    WHEN new.worker IS NOT NULL AND new.state IN ('done', 'failed') AND old.state NOT IN ('done', 'failed') BEGIN
    INSERT INTO robot_tallies (robot, done, failed) VALUES (new.worker, new.state = 'done', new.state = 'failed')
        ON CONFLICT (robot) DO UPDATE SET done = done + excluded.done, failed = failed + excluded.failed;
END;
CREATE TRIGGER jobs_untallied AFTER DELETE ON jobs
    WHEN old.worker IS NOT NULL AND old.state IN ('done', 'failed') BEGIN
    UPDATE robot_tallies SET done = done - (old.state = 'done'), failed = failed - (old.state = 'failed')
        WHERE robot = old.worker;
END;

-- Jobs and assignments are accepted in the order of their numbers, unless the clock was set back meanwhile: then no
-- page may conclude from the time to the number.
INSERT OR REPLACE INTO about (key, value) SELECT 'set_back', 'yes' WHERE
    EXISTS (SELECT 1 FROM (SELECT created, lag(created) OVER (ORDER BY id) AS before FROM jobs)
        WHERE created < before)
    OR EXISTS (SELECT 1 FROM (SELECT created, lag(created) OVER (ORDER BY id) AS before FROM assignments)
        WHERE created < before)
    OR EXISTS (SELECT 1 FROM (SELECT ended, lag(ended) OVER (ORDER BY seq) AS before FROM encounters)
        WHERE ended < before);
