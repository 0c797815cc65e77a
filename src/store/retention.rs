//! What is deleted: steps that a snapshot replaces, items that have long been over, and people's identities.
//!
//! Main function: `tidy`, which every append calls in its transaction. Each call deletes a bounded number of rows, so
//! that no append waits long; SQLite reuses the pages. Refuses: to delete what is not over, and what a start may need.

use super::events::EVENTS_KEPT;
use giveway_floor::time::{Span, Time};
use sqlx::sqlite::SqliteConnection;

/// Number of steps, and of events, deleted in one call.
const SLICE: i64 = 200;

/// Number of rows of each list deleted in one call: more than an append adds, and few enough to go unnoticed after a
/// server was off for months.
const FEW: i64 = 50;

/// Deletes steps up to the older of the two snapshots.
const STEPS: &str = "DELETE FROM steps \
    WHERE seq <= (SELECT seq FROM snapshots ORDER BY seq DESC LIMIT 1 OFFSET 1) \
    AND seq < (SELECT min(seq) FROM steps) + $1";

/// Delete what is too old in each list. Each statement names the index that has the oldest first: if nothing is too
/// old, that is one look at its first entry.
const LISTS: [&str; 6] = [
    "DELETE FROM jobs WHERE id IN (SELECT id FROM jobs INDEXED BY jobs_over \
     WHERE state IN ('done', 'cancelled', 'failed') AND updated < $2 LIMIT $1)",
    "DELETE FROM assignments WHERE id IN (SELECT id FROM assignments INDEXED BY assignments_over \
     WHERE state IN ('done', 'cancelled') AND updated < $2 LIMIT $1)",
    "DELETE FROM encounters WHERE seq IN (SELECT seq FROM encounters INDEXED BY encounters_by_time \
     WHERE began < $2 LIMIT $1)",
    "DELETE FROM alarms WHERE id IN (SELECT id FROM alarms INDEXED BY alarms_by_end WHERE cleared < $2 LIMIT $1)",
    "DELETE FROM robot_changes WHERE id IN (SELECT id FROM robot_changes INDEXED BY robot_changes_by_time \
     WHERE at < $2 LIMIT $1)",
    "DELETE FROM audit WHERE id IN (SELECT id FROM audit WHERE id < $2 LIMIT $1)",
];

/// Remove people's identities from rows that stay and are over, and delete their ended alarms.
const PEOPLE: [&str; 3] = [
    "UPDATE encounters SET worker = -1 WHERE seq IN (SELECT seq FROM encounters \
     INDEXED BY encounters_of_somebody WHERE worker >= 0 AND began < $2 LIMIT $1)",
    "UPDATE assignments SET worker = NULL WHERE id IN (SELECT id FROM assignments \
     INDEXED BY assignments_of_somebody \
     WHERE worker IS NOT NULL AND state IN ('done', 'cancelled') AND updated < $2 LIMIT $1)",
    "DELETE FROM alarms WHERE id IN (SELECT id FROM alarms INDEXED BY alarms_of_people \
     WHERE cleared < $2 AND subject_kind = 'worker' LIMIT $1)",
];

/// Deletes events from the first one up to the first that is not too old, so that the kept ones have no gap.
const EVENTS: &str = "DELETE FROM events WHERE seq < (SELECT min(seq) FROM events) + $1 \
    AND seq < coalesce((SELECT seq FROM events WHERE seq < (SELECT min(seq) FROM events) + $1 AND at >= $2 \
    ORDER BY seq LIMIT 1), 9223372036854775807)";

/// Deletes some of what is too old at `now`: what was over before the last `keep`, identities from before the last
/// `people`, and steps that no start needs.
pub(super) async fn tidy(
    db: &mut SqliteConnection,
    now: Time,
    (keep, people): (Span, Span),
) -> Result<(), sqlx::Error> {
    debug_assert!(keep > Span::ZERO && people > Span::ZERO, "what has just happened is kept");
    sqlx::query(STEPS).bind(SLICE).execute(&mut *db).await?;
    for list in LISTS {
        sqlx::query(list).bind(FEW).bind((now - keep).0).execute(&mut *db).await?;
    }
    for list in PEOPLE {
        sqlx::query(list).bind(FEW).bind((now - people).0).execute(&mut *db).await?;
    }
    sqlx::query(EVENTS)
        .bind(SLICE)
        .bind((now - keep.min(people).min(EVENTS_KEPT)).0)
        .execute(&mut *db)
        .await?;
    Ok(())
}
