//! Everything that can grow has a limit and something that gives room again: one list, of which docs/operate.md has a
//! table, and a test for each row that fills it and sees room given back.
//!
//! Nothing can be left out: each table of the database and each file of the server that makes a queue belongs to a row.

use super::{read, root};
use std::collections::BTreeSet;

/// A row of the table in docs/operate.md: what it is called there; the file, the name and the value of its limit, or
/// nothing
/// where time alone limits it; the tables that have it; the files that make its queues; the test that fills it.
type Grows = (
    &'static str,
    Option<(&'static str, &'static str, &'static str)>,
    &'static [&'static str],
    &'static [&'static str],
    &'static str,
);

const SETTINGS: &str = "src/fleet/state/settings.rs";

#[rustfmt::skip]
const ALL: [Grows; 31] = [
    ("jobs that are not over", Some((SETTINGS, "open_jobs", "100_000")), &[], &[],
        "one_job_too_many_is_refused_and_one_that_comes_after_too_many"),
    ("assignments that are not over", Some((SETTINGS, "open_assignments", "10_000")), &[], &[],
        "one_assignment_too_many_is_refused_until_another_is_over"),
    ("robots that have joined", Some((SETTINGS, "robots", "10_000")), &["linked_robots", "robot_tallies"], &[],
        "no_robot_joins_where_another_one_is_or_is_to_be_or_beyond_the_limit"),
    ("workers who are known", Some((SETTINGS, "workers", "1_000")), &["people"], &[],
        "a_worker_who_is_forgotten_frees_a_place_and_numbers_are_given_again_only_when_there_are_no_others"),
    ("closures announced, in force, or over for less than a day", Some((SETTINGS, "closures", "2_000")), &[], &[],
        "one_closure_too_many_is_refused_until_another_is_taken_back_and_one_with_too_many_corners"),
    ("recurring closures", Some((SETTINGS, "recurring_closures", "100")), &[], &[],
        "one_series_too_many_is_refused_until_another_is_ended"),
    ("cancelled and failed jobs that are remembered for jobs to come `after` them",
        Some(("src/fleet/state/index/mod.rs", "BAD_ENDS_MAX", "100_000")), &[], &[],
        "of_bad_ends_beyond_the_limit_the_oldest_is_forgotten_and_none_before_its_time"),
    ("keys of jobs and assignments", None, &[], &[],
        "the_memory_of_keys_is_bounded_and_no_step_forgets_many"),
    ("answers to other requests with a key", None, &["answers"], &[],
        "answers_are_forgotten_after_seven_days"),
    ("lists of jobs, assignments, encounters, changes of robots, and the audit", None,
        &["jobs", "job_labels", "job_references", "assignments", "encounters", "robot_changes", "audit"], &[],
        "what_is_over_leaves_the_lists_after_the_days_of_the_settings_in_slices"),
    ("events", None, &["events"], &[],
        "events_are_forgotten_after_a_week_from_the_first_on"),
    ("alarms that are active", Some(("src/fleet/alarm/register/mod.rs", "MOST_ACTIVE", "500")), &[], &[],
        "there_are_never_more_than_so_many_and_the_worst_have_room"),
    ("alarms that are over", Some(("src/store/alarms.rs", "MOST_PAST", "20_000")), &["alarms"], &[],
        "of_alarms_that_are_over_the_newest_are_kept"),
    ("steps of the journal", Some(("src/store/snapshot.rs", "SNAPSHOT_AFTER", "100_000")), &["steps", "snapshots"], &[],
        "steps_behind_the_older_of_two_snapshots_go_and_a_damaged_snapshot_is_not_needed"),
    ("facts that wait for the database", Some(("src/drive/gate.rs", "MOST_PENDING", "20_000")), &[],
        &["src/giveway/server/journal.rs"],
        "while_the_journal_is_full_all_robots_are_told_to_stand_and_what_is_done_by_hand_is_kept_in_its_order"),
    ("entries of the audit that wait for the database", Some(("src/api/access/audit.rs", "MOST_WAITING", "10_000")),
        &[], &["src/api/access/audit.rs"],
        "more_entries_than_may_wait_are_counted_and_said_when_there_is_room_again"),
    ("figures over time", None, &["history", "heat"], &["src/giveway/server/historian.rs"],
        "memory_is_bounded_and_old_hours_are_in_minutes"),
    ("requests that wait for the loop", Some(("src/drive/intake.rs", "MOST_REQUESTS", "10_000")), &[],
        &["src/giveway/server/running.rs"],
        "requests_beyond_the_room_wait_in_the_queue_and_those_whose_handler_has_left_are_not_carried_out"),
    ("poses that wait for the loop", Some(("src/api/feed/hub.rs", "WAITING", "12_000")), &[], &["src/api/feed/hub.rs"],
        "poses_beyond_those_that_may_wait_are_dropped_until_the_loop_has_taken_some"),
    ("tokens", Some(("src/api/access/caller.rs", "MOST_TOKENS", "1_000")), &["tokens"], &[],
        "of_tokens_a_thousand_hold_until_one_is_revoked_and_the_newest_that_hold_no_more_are_kept"),
    ("sessions", Some(("src/store/sessions.rs", "MOST_EACH", "100")), &["sessions"], &[],
        "of_sessions_the_newest_are_kept"),
    ("people who are signing in with an identity provider", Some(("src/api/oidc/pending.rs", "MOST", "1000")), &[], &[],
        "there_are_never_more_than_a_thousand_and_the_oldest_end"),
    ("webhooks", Some(("src/api/http/operate/webhooks.rs", "MOST_HOOKS", "32")), &["webhooks"],
        &["src/giveway/server/webhooks.rs"],
        "of_webhooks_there_are_thirty_two_until_one_is_removed"),
    ("messages of a webhook that were given up", Some(("src/store/webhooks.rs", "MOST_FAILED", "1000")),
        &["webhook_failures"], &[],
        "of_messages_that_were_given_up_the_newest_are_kept"),
    ("kinds of robots that were added", Some(("src/floor/warehouse/body.rs", "MOST_BODIES", "32")), &["kinds"], &[],
        "of_kinds_of_robots_there_are_thirty_two_until_one_is_removed"),
    ("names that the map no longer has", None, &["gone", "about"], &[],
        "names_that_no_row_has_any_more_go_with_the_next_change_of_the_map"),
    ("frames of the past", None, &[], &[],
        "files_follow_one_another_without_a_seam_and_old_ones_go"),
    ("bookmarks of an hour", Some(("src/api/recording/folder.rs", "MOST_MARKS", "5000")), &[], &[],
        "of_the_bookmarks_of_an_hour_the_first_are_kept_and_the_next_file_has_room_again"),
    ("connections of strangers", Some(("src/giveway/server/budget.rs", "MOST_STRANGERS", "256")), &[],
        &["src/giveway/server/tls.rs"],
        "the_oldest_stranger_of_the_address_with_most_leaves_for_a_new_one_and_known_ones_stay"),
    ("connections", None, &[], &[],
        "if_all_descriptors_are_used_strangers_leave_first_and_then_the_one_that_is_idle_for_longest"),
    ("bytes that wait for clients to take them", None, &[], &[],
        "if_too_many_bytes_wait_the_one_leaves_that_has_taken_none_for_longest"),
];

/// Rows without a limit of their own in this list: several small ones, and the tests that fill them.
const OTHERS: [(&str, &[&str], &[&str]); 2] = [
    (
        "streams of events, readers of the live feed",
        &[],
        &[
            "of_streams_of_events_a_hundred_are_open_until_one_leaves",
            "of_readers_of_the_live_feed_a_thousand_are_there_until_one_leaves",
        ],
    ),
    (
        "questions and changes of the map that wait; kinds for which the map is looked at",
        &[
            "src/giveway/server/publish.rs",
            "src/giveway/server/links/recording.rs",
            "src/giveway/server/links/mqtt/mod.rs",
            "src/giveway/server/control.rs",
        ],
        &[
            "a_question_beyond_those_that_may_wait_is_refused_until_one_is_answered",
            "a_map_beyond_those_that_may_wait_is_refused_until_one_is_answered",
            "the_map_is_looked_at_for_one_kind_at_a_time",
        ],
    ),
];

/// The rows of the table: their cells.
fn rows() -> Vec<Vec<String>> {
    let page = read("docs/operate.md");
    let table = page.split("| what can grow |").nth(1).expect("docs/operate.md has the table");
    let lines = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    lines.map(|line| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// Every file below a folder.
fn files(folder: &str) -> Vec<String> {
    let (mut found, mut folders) = (Vec::new(), vec![root().join(folder)]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
            match entry.path() {
                path if path.is_dir() => folders.push(path),
                path => found.push(path.strip_prefix(root()).expect("below").to_string_lossy().into_owned()),
            }
        }
    }
    found.sort();
    found
}

#[test]
fn the_page_has_a_row_with_its_limit_and_what_gives_room_for_everything_that_can_grow() {
    let rows = rows();
    let whats: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    let listed: Vec<&str> = ALL.iter().map(|row| row.0).chain(OTHERS.iter().map(|row| row.0)).collect();
    assert_eq!(whats, listed, "the table of docs/operate.md and this list are to have the same rows");
    for (row, (what, limit, ..)) in rows.iter().zip(&ALL) {
        assert_eq!(row.len(), 4, "{what}");
        assert!(row.iter().all(|cell| !cell.is_empty()), "{what}: an empty cell");
        let Some((file, name, value)) = limit else { continue };
        let source = read(file);
        let is_there = [format!("{name}: {value},"), format!("const {name}: usize = {value};")]
            .iter()
            .any(|s| source.contains(s))
            || ["i64", "u64"].iter().any(|kind| source.contains(&format!("const {name}: {kind} = {value};")));
        assert!(is_there, "{file} does not say that {name} is {value}");
        let digits: String = value.chars().filter(char::is_ascii_digit).collect();
        let said: String =
            row[1].split(|c: char| !c.is_ascii_digit() && c != ' ').next().unwrap_or("").split(' ').collect();
        assert_eq!(said, digits, "{what}: the page says {:?}", row[1]);
    }
}

#[test]
fn each_table_of_the_database_and_each_queue_of_the_server_belongs_to_a_row() {
    let mut tables = BTreeSet::new();
    for file in files("migrations/sqlite") {
        for line in read(&file).lines() {
            let made = line.strip_prefix("CREATE TABLE ").or(line.strip_prefix("CREATE VIRTUAL TABLE "));
            let name = made.and_then(|rest| rest.split(' ').next());
            tables.extend(name.map(str::to_owned));
            if let Some(gone) = line.strip_prefix("DROP TABLE ") {
                tables.remove(gone.trim_end_matches(';'));
            }
        }
    }
    // It took the name of another one.
    tables.remove("assignments_of_somebody");
    tables.insert("assignments".into());
    let listed: BTreeSet<String> =
        ALL.iter().flat_map(|row| row.2).map(|table| (*table).to_owned()).collect();
    assert_eq!(tables, listed, "tables of the database");

    let makes_queue = |file: &String| {
        let source = read(file);
        let source = source.split("#[cfg(test)]\nmod tests").next().unwrap_or("").to_owned();
        ["mpsc::channel(", "unbounded_channel(", "broadcast::channel("]
            .iter()
            .any(|made| source.contains(made))
    };
    let sources = [files("src/giveway/server"), files("src/api")].concat();
    let made: BTreeSet<String> =
        sources.into_iter().filter(|file| !file.contains("tests")).filter(makes_queue).collect();
    let queues = ALL.iter().map(|row| row.3).chain(OTHERS.iter().map(|row| row.1)).flatten();
    let queues: BTreeSet<String> = queues.map(|file| (*file).to_owned()).collect();
    assert!(made.is_subset(&queues), "in no row: {:?}", made.difference(&queues));
}

#[test]
fn each_row_is_filled_by_a_test() {
    let sources: String =
        [files("src"), files("tests")].concat().iter().filter(|f| f.ends_with(".rs")).map(read).collect();
    let others = OTHERS.iter().flat_map(|row| row.2.iter().map(|test| (row.0, *test)));
    for (what, test) in ALL.iter().map(|row| (row.0, row.4)).chain(others) {
        assert!(sources.contains(&format!("fn {test}(")), "{what}: there is no test {test}");
    }
}
