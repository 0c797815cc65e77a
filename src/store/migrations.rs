//! The changes of the schema, oldest first.
//!
//! Main function: [`migrator`]. Refuses: to change one that a database may have had: a new change is a new file.

use sqlx::SqlSafeStr;
use sqlx::migrate::{Migration, MigrationType, Migrator};

/// The files' names without their ends, each with its text.
macro_rules! migrations {
    ($($stem:literal,)*) => {
        [$(($stem, include_str!(concat!("../../migrations/sqlite/", $stem, ".sql"))),)*]
    };
}

const ALL: [(&str, &str); 23] = migrations![
    "0001_journal",
    "0002_people",
    "0003_history",
    "0004_steps",
    "0005_maps",
    "0006_kinds",
    "0007_nearest",
    "0008_alarms",
    "0009_job_labels",
    "0010_robots",
    "0011_tokens",
    "0012_events",
    "0013_sessions_people",
    "0015_shift",
    "0016_answers",
    "0017_stops",
    "0019_sign_on",
    "0020_lines",
    "0021_cells",
    "0022_pages",
    "0033_alarm_care",
    "0034_job_references",
    "0035_linked_robots",
];

/// All changes.
pub(crate) fn migrator() -> Migrator {
    let change = |(stem, text): (&str, &'static str)| {
        let (number, name) = stem.split_once('_').expect("NUMBER_NAME");
        let number = number.parse().expect("a number");
        Migration::new(number, name.to_owned().into(), MigrationType::Simple, text.into_sql_str(), false)
    };
    Migrator::with_migrations(ALL.into_iter().map(change).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_a_change_and_their_numbers_rise() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../migrations/sqlite");
        let name =
            |file: std::io::Result<std::fs::DirEntry>| file.unwrap().file_name().into_string().unwrap();
        let mut files: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
        files.sort_unstable();
        assert_eq!(files, ALL.map(|(stem, _)| format!("{stem}.sql")));
        let numbers: Vec<i64> = migrator().iter().map(|change| change.version).collect();
        assert!(numbers.is_sorted_by(|a, b| a < b), "{numbers:?}");
    }
}
