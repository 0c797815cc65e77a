//! No statement of the store reads more of a growing table than it gives: SQLite explains how it would run each.
//!
//! No statement can escape. sqlx takes constant texts, a `QueryBuilder`, or a text wrapped in `AssertSqlSafe`; nothing
//! else compiles. Here every constant that begins like a statement is found in the source and explained. A text that is
//! not a whole statement must be part of a page that a builder made; every builder is called with every set of filters,
//! and a new builder is noticed. The planner chooses nothing: a statement names the index that it needs, so that
//! another index, or other data, cannot change its plan.

use super::year;
use crate::listing::{LOOKED_AT, Reach};
use crate::people::EncounterReach;
use crate::{events, jobs, people};
use giveway_fleet::{AssignmentQuery, EncounterQuery, EventKind, EventQuery, JobQuery};
use giveway_floor::id::{JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::time::Time;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, Connection, Row};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Tables that do not grow with time, and why. All other tables do.
const SMALL: [(&str, &str); 15] = [
    ("about", "a handful of keys"),
    ("gone", "names that maps had and lost"),
    ("heat", "a day of places"),
    ("history", "three tiers of buckets, below 10 000 rows"),
    ("kinds", "kinds of robots that people added"),
    ("linked_robots", "as many as the floor may have robots"),
    ("people", "people who are known, 1 000 at most"),
    ("robot_tallies", "one row for each robot"),
    ("sessions", "1 000 at most"),
    ("snapshots", "two"),
    ("sqlite_schema", "tables and indexes"),
    ("sqlite_sequence", "a row for a table"),
    ("tokens", "1 000 that hold, and the newest 1 000 that do not"),
    ("webhook_failures", "1 000 for each webhook"),
    ("webhooks", "32 at most"),
];

/// Files whose statements run while nothing is served, each over a whole database: to carry it over to another map, or
/// to set its clock back.
const OFFLINE: [&str; 2] = ["carry.rs", "set_clock.rs"];

/// Other statements that read a table from one end, and why they read no more than they give.
const WALKS: [(&str, &str); 11] = [
    (
        "SELECT what, count(*) FROM audit WHERE id >= $1 AND id <",
        "a report of 31 days at most, by the numbers of requests",
    ),
    (
        "SELECT count(*), coalesce(sum(state NOT IN",
        "`giveway database check` counts everything, beside the server",
    ),
    ("SELECT seq, at, wire, facts FROM steps", "a start reads all steps behind a snapshot"),
    ("SELECT seq, causes FROM steps", "as a start does"),
    ("DELETE FROM steps", "a slice from the first one on"),
    ("DELETE FROM events WHERE seq <", "a slice from the first one on"),
    ("SELECT * FROM audit WHERE id < $1 AND id >= $2", "a page in the order of its numbers"),
    ("DELETE FROM audit WHERE id IN", "a slice from the first one on"),
    ("DELETE FROM alarms WHERE cleared IS NOT NULL", "below the 20 000 that are kept are only active ones"),
    ("SELECT * FROM alarms WHERE id < $1 AND (cleared", "after the clock was set back; 20 000 at most"),
    ("SELECT * FROM alarms WHERE id IN", "between the first and the last alarm of the time"),
];

/// Every text in double quotes of a Rust file, as the compiler reads it.
fn texts(source: &str) -> Vec<String> {
    let (mut found, mut rest) = (Vec::new(), source.chars().peekable());
    while let Some(c) = rest.next() {
        match c {
            '/' if rest.peek() == Some(&'/') => while rest.next().is_some_and(|c| c != '\n') {},
            '\'' => {
                // A character literal such as '"', or a lifetime.
                let letter = rest.next();
                if letter == Some('\\') {
                    rest.next();
                }
                if rest.peek() == Some(&'\'') {
                    rest.next();
                }
            }
            '"' => found.push(text(&mut rest)),
            _ => {}
        }
    }
    found
}

fn text(rest: &mut std::iter::Peekable<std::str::Chars<'_>>) -> String {
    let mut text = String::new();
    while let Some(c) = rest.next() {
        match c {
            '"' => break,
            '\\' => match rest.next() {
                Some('\n') => while rest.next_if(|c| c.is_whitespace()).is_some() {},
                Some('n') => text.push('\n'),
                Some(c) => text.push(c),
                None => break,
            },
            c => text.push(c),
        }
    }
    text
}

/// The files of this crate, the only one with SQL, that are not tests.
fn sources() -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from(env!("CARGO_MANIFEST_DIR"))];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    found.retain(|path| !path.components().any(|c| c.as_os_str() == "tests"));
    found.sort();
    found
}

fn begins_like_a_statement(text: &str) -> bool {
    let verbs = ["SELECT ", "INSERT ", "UPDATE ", "DELETE ", "WITH ", "REPLACE "];
    verbs.iter().any(|verb| text.starts_with(verb))
}

/// Every set of this many filters.
fn every_set(filters: u32) -> impl Iterator<Item = Vec<bool>> {
    (0..1u32 << filters).map(move |bits| (0..filters).map(|i| bits >> i & 1 == 1).collect())
}

/// Every possible page of jobs, assignments, encounters and events.
fn pages() -> Vec<String> {
    let at = Some(Time(5));
    let reach = |is_short, is_orderly| Reach { low: 0, before: 9, is_short, is_orderly };
    let mut found = vec![jobs::one(1).sql().as_str().to_owned()];
    found.push(people::one_assignment(1).sql().as_str().to_owned());
    for set in every_set(12) {
        let on = |i: usize| set[i];
        let q = JobQuery {
            states: if on(0) { vec!["waiting", "failed"] } else { vec![] },
            rack: on(1).then_some(RackId(1)),
            station: on(2).then_some(StationId(1)),
            robot: on(3).then_some(RobotId(1)),
            updated_since: at.filter(|_| on(4)),
            from: at.filter(|_| on(5)),
            to: at.filter(|_| on(6)),
            reference: on(7).then(|| "order".into()),
            reference_part: on(11).then(|| "rde".into()),
            label: on(8).then(|| ("wave".into(), "7".into())),
            before: Some(JobId(9)),
            limit: 50,
        };
        let listing = jobs::listing(&q, &reach(on(4) && on(9), on(10)));
        found.extend(listing.floor().map(|q| q.sql().as_str().to_owned()));
        found.push(listing.page(3).sql().as_str().to_owned());
        let q = AssignmentQuery {
            worker: on(0).then_some(WorkerId(1)),
            states: if on(1) { vec!["waiting", "done"] } else { vec![] },
            place: on(2).then_some(NodeId(1)),
            updated_since: at.filter(|_| on(4)),
            from: at.filter(|_| on(5)),
            to: at.filter(|_| on(6)),
            before: None,
            limit: 50,
        };
        let listing = people::list_assignments(&q, &reach(on(4) && on(9), on(10)));
        found.extend(listing.floor().map(|q| q.sql().as_str().to_owned()));
        found.push(listing.page(3).sql().as_str().to_owned());
        let q = EncounterQuery {
            from: at.filter(|_| on(5)),
            to: at.filter(|_| on(6)),
            worker: on(0).then_some(WorkerId(1)),
            robot: on(1).then_some(RobotId(1)),
            reactions: if on(2) { vec!["held", "kept"] } else { vec![] },
            updated_since: at.filter(|_| on(4)),
            before: None,
            limit: 50,
        };
        let range = match (on(5) && on(9), on(4) && on(9)) {
            (true, _) => vec![("began >= ", 5), ("began < ", 6)],
            (_, true) => vec![("ended >= ", 5)],
            _ => vec![],
        };
        let reach = EncounterReach { reach: reach(!range.is_empty(), on(10)), range };
        let listing = people::list_encounters(&q, &reach);
        found.extend(listing.floor().map(|q| q.sql().as_str().to_owned()));
        found.push(listing.page(3).sql().as_str().to_owned());
    }
    for set in every_set(EventKind::ALL.len() as u32) {
        let kinds = EventKind::ALL.into_iter().zip(set).filter(|(_, is_in)| *is_in).map(|(kind, _)| kind);
        found.push(
            events::page(&EventQuery { kinds: kinds.collect(), after: 7, limit: 50 })
                .sql()
                .as_str()
                .to_owned(),
        );
    }
    found.sort();
    found.dedup();
    found
}

/// SQLite's plan of a statement; nothing for a text that is not a whole statement.
async fn plan(db: &mut SqliteConnection, statement: &str) -> Result<Vec<String>, String> {
    let explained = AssertSqlSafe(format!("EXPLAIN QUERY PLAN {statement}"));
    let rows = sqlx::query(explained).fetch_all(db).await.map_err(|e| e.to_string())?;
    Ok(rows.iter().map(|row| row.get::<String, _>("detail")).collect())
}

/// The faults of a plan.
fn wrong(statement: &str, plan: &[String], grow: &BTreeSet<String>) -> Vec<String> {
    let walks = WALKS.iter().any(|(begin, _)| statement.starts_with(begin));
    let mut found = Vec::new();
    for line in plan {
        let mut words = line.split(' ');
        let (what, name) = (words.next().unwrap_or(""), words.next().unwrap_or(""));
        let is_small = SMALL.iter().any(|(table, _)| *table == name);
        let is_made = name.starts_with('(')
            || name == "json_each"
            || line.contains("CONSTANT ROW")
            || line.contains("VALUES CLAUSE");
        match what {
            // Looked up by its runs of characters.
            "SCAN" if line.contains("VIRTUAL TABLE INDEX") && statement.contains("job_references = ") => {}
            "SCAN" if !is_small && !is_made && !walks => found.push(line.clone()),
            "SEARCH" if line.contains("AUTOMATIC") => found.push(line.clone()),
            "SEARCH" if grow.contains(name) => {
                let index = line.split("INDEX ").nth(1).and_then(|rest| rest.split(' ').next());
                let named = |index: &str| statement.contains(&format!("INDEXED BY {index}"));
                let is_chosen =
                    index.is_some_and(|index| !index.starts_with("sqlite_autoindex") && !named(index));
                let is_range = line.contains("(rowid<?") || line.contains("(rowid>?");
                // Pages may walk a table by its numbers, since a floor bounds them.
                let is_page = statement.contains("LIMIT ?") || statement.contains("OFFSET ?");
                if is_chosen || (is_range && !walks && !is_page) {
                    found.push(line.clone());
                }
            }
            "SEARCH" if !is_small && !is_made => found.push(format!("{line} (which table is that?)")),
            _ => {}
        }
    }
    found
}

async fn aged(name: &str) -> (PathBuf, SqliteConnection) {
    let folder = std::env::temp_dir().join(format!("giveway-plans-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("aged.sqlite");
    year::fill(&path, 2).await;
    let db = SqliteConnection::connect_with(&SqliteConnectOptions::new().filename(&path)).await.unwrap();
    (folder, db)
}

#[tokio::test]
async fn no_statement_reads_more_of_a_table_that_grows_than_it_gives() {
    let (folder, mut db) = aged("statements").await;
    let tables = "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%'";
    let tables: Vec<String> = sqlx::query_scalar(tables).fetch_all(&mut db).await.unwrap();
    let is_small = |name: &String| SMALL.iter().any(|(small, _)| small == name);
    let grow: BTreeSet<String> = tables.into_iter().filter(|name| !is_small(name)).collect();
    let (mut found, built) = (Vec::new(), pages());
    assert!(built.len() > 900 && LOOKED_AT > 0, "{} pages", built.len());
    for statement in &built {
        match plan(&mut db, statement).await {
            Ok(plan) => found
                .extend(wrong(statement, &plan, &grow).into_iter().map(|w| format!("{w}\n  {statement}"))),
            Err(e) => found.push(format!("{e}\n  {statement}")),
        }
    }
    for path in sources() {
        let (source, file) =
            (std::fs::read_to_string(&path).unwrap(), path.file_name().unwrap().to_string_lossy());
        // No other module has SQL, as a test below checks.
        if OFFLINE.contains(&&*file) || !path.components().any(|c| c.as_os_str() == "store") {
            continue;
        }
        for statement in texts(&source).iter().filter(|text| begins_like_a_statement(text)) {
            match plan(&mut db, statement).await {
                Ok(plan) => {
                    let wrong = wrong(statement, &plan, &grow).into_iter();
                    found.extend(wrong.map(|w| format!("{}: {w}\n  {statement}", path.display())));
                }
                Err(e) if e.contains("incomplete input") || e.contains("syntax error") => {
                    if !built.iter().any(|page| page.contains(statement.as_str())) {
                        found.push(format!("{}: part of no page: {statement}", path.display()));
                    }
                }
                // Databases from before the first release, which are refused.
                Err(e) if e.contains("no such table: journal") => {}
                Err(e) => found.push(format!("{}: {e}\n  {statement}", path.display())),
            }
        }
    }
    db.close().await.unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    assert!(found.is_empty(), "{} statements:\n{}", found.len(), found.join("\n"));
}

#[tokio::test]
async fn what_triggers_do_reads_no_more_than_a_row() {
    let (folder, mut db) = aged("triggers").await;
    let triggers = "SELECT sql FROM sqlite_schema WHERE type = 'trigger'";
    let triggers: Vec<String> = sqlx::query_scalar(triggers).fetch_all(&mut db).await.unwrap();
    assert_eq!(triggers.len(), 5);
    for trigger in triggers {
        let body = trigger.split_once("BEGIN").unwrap().1.rsplit_once("END").unwrap().0;
        for statement in body.split(';').map(str::trim).filter(|s| !s.is_empty()) {
            let plain: Vec<&str> = statement.split_inclusive(['(', ' ', ',', ')', '=', '\n']).collect();
            let bound = plain.iter().map(|word| {
                let end = word.len() - word.trim_end_matches(['(', ' ', ',', ')', '=', '\n']).len();
                let is_row = word.starts_with("old.") || word.starts_with("new.");
                if is_row { format!("?{}", &word[word.len() - end..]) } else { (*word).to_owned() }
            });
            let plan = plan(&mut db, &bound.collect::<String>()).await.unwrap();
            let is_row = |line: &String| {
                let by_number = line == "SCAN job_references VIRTUAL TABLE INDEX 0:=";
                by_number || !line.starts_with("SCAN") && !line.contains("<?") && !line.contains(">?")
            };
            assert!(plan.iter().all(is_row), "{statement}: {plan:?}");
        }
    }
    db.close().await.unwrap();
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn sql_is_made_by_the_builders_that_are_called_here_and_by_no_other() {
    let mut builders = Vec::new();
    for path in sources() {
        let source = std::fs::read_to_string(&path).unwrap();
        let file = path.strip_prefix(env!("CARGO_MANIFEST_DIR")).unwrap().to_string_lossy().into_owned();
        let source = source.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let count = |what: &str| source.matches(what).count();
        if count("QueryBuilder::new") > 0 || count("AssertSqlSafe(") > 0 {
            builders.push((file.clone(), count("QueryBuilder::new"), count("AssertSqlSafe(")));
        }
    }
    let known = [
        ("events.rs", 1, 0),
        ("jobs.rs", 1, 0),
        // A pragma with a number.
        ("lib.rs", 0, 1),
        ("listing.rs", 2, 0),
        ("people.rs", 1, 0),
    ];
    let known: Vec<_> = known.iter().map(|(file, q, a)| ((*file).to_owned(), *q, *a)).collect();
    assert_eq!(builders, known, "a new builder is to be called in `pages`");
}

#[test]
fn texts_are_read_as_the_compiler_reads_them() {
    let source = "const A: &str = \"SELECT 1 \\\n    FROM a\"; // \"no\"\nlet b = '\"'; fn f<'a>() \
        { g(\"x \\\"y\\\"\") }";
    assert_eq!(texts(source), ["SELECT 1 FROM a", "x \"y\""]);
}

#[tokio::test]
async fn a_scan_and_an_index_of_the_planners_choice_are_found() {
    let (folder, mut db) = aged("planted").await;
    let grow: BTreeSet<String> = ["jobs", "events"].map(str::to_owned).into();
    for bad in [
        "SELECT id FROM jobs WHERE robot = $1",
        "SELECT id FROM jobs WHERE state IN ('done', 'cancelled', 'failed') AND updated < $2 LIMIT $1",
        "SELECT seq FROM events WHERE at < $2 ORDER BY seq LIMIT $1",
        "SELECT id FROM jobs WHERE id < $1 AND robot = $2",
        "SELECT id FROM jobs AS j WHERE j.robot = $2",
    ] {
        let plan = plan(&mut db, bad).await.unwrap();
        assert!(!wrong(bad, &plan, &grow).is_empty(), "{bad}: {plan:?}");
    }
    let good = "SELECT id FROM jobs INDEXED BY jobs_by_rack WHERE rack = $1 AND state = 'done'";
    assert!(wrong(good, &plan(&mut db, good).await.unwrap(), &grow).is_empty());
    db.close().await.unwrap();
    std::fs::remove_dir_all(folder).unwrap();
}
