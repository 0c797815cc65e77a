//! Webhooks: where events are sent, how far each webhook is, and what was given up.
//!
//! Main types: [`HookRow`], [`FailedRow`]. Refuses: to send anything.

use super::{Store, StoreError};
use giveway_fleet::EventKind;
use giveway_floor::time::Time;
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

/// Number of given-up messages that are kept for each webhook.
const MOST_FAILED: i64 = 1000;

const ALL: &str =
    "SELECT id, url, kinds, secret, created, cursor, attempts, pending, failed FROM webhooks ORDER BY id";
const ADD: &str = "INSERT INTO webhooks (url, kinds, secret, created, cursor) VALUES ($1, $2, $3, $4, \
    coalesce((SELECT seq FROM sqlite_sequence WHERE name = 'events'), 0)) \
    RETURNING id, url, kinds, secret, created, cursor, attempts, pending, failed";
const REMOVE: &str = "DELETE FROM webhooks WHERE id = $1";
const REACH: &str =
    "UPDATE webhooks SET cursor = $2, attempts = 0, pending = NULL, failed = NULL WHERE id = $1";
const MISS: &str = "UPDATE webhooks SET attempts = attempts + 1, pending = $2, failed = $3 WHERE id = $1";
const GIVE_UP: &str = "INSERT INTO webhook_failures (hook, first, last, at, attempts, error) \
    SELECT id, $2, $3, $4, attempts, coalesce(failed, '') FROM webhooks WHERE id = $1";
const FORGET: &str = "DELETE FROM webhook_failures WHERE hook = $1 AND id <= \
    (SELECT max(id) FROM webhook_failures WHERE hook = $1) - $2";
const FAILED: &str = "SELECT id, first, last, at, attempts, error FROM webhook_failures \
    WHERE hook = $1 AND id < $2 ORDER BY id DESC LIMIT $3";

/// A webhook.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HookRow {
    /// Number of the webhook.
    pub id: i64,
    /// Address that messages are sent to.
    pub url: String,
    /// Kinds of events that are sent; all kinds if empty.
    pub kinds: Vec<EventKind>,
    /// Secret that messages are signed with.
    pub secret: String,
    /// When the webhook was added.
    pub created: Time,
    /// The number of the last event that was delivered or given up.
    pub cursor: i64,
    /// Number of attempts to send the next message.
    pub attempts: u32,
    /// Number of the last event of that message, once an attempt has failed.
    pub pending: Option<i64>,
    /// Why the last attempt failed.
    pub failed: Option<String>,
}

/// A message that was given up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedRow {
    /// Number of the failure.
    pub id: i64,
    /// Number of the message's first event.
    pub first: i64,
    /// Number of the message's last event.
    pub last: i64,
    /// When the message was given up.
    pub at: Time,
    /// Number of attempts.
    pub attempts: u32,
    /// Why the last attempt failed.
    pub error: String,
}

impl Store {
    /// All webhooks.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn webhooks(&self) -> Result<Vec<HookRow>, StoreError> {
        let rows = sqlx::query(ALL).fetch_all(&self.readers).await?;
        rows.iter().map(hook).collect()
    }

    /// Adds a webhook that gets everything that happens from now on.
    ///
    /// # Errors
    /// If the database refuses the write, or its file was taken away.
    pub async fn add_webhook(
        &self,
        url: &str,
        kinds: &[EventKind],
        secret: &str,
        now: Time,
    ) -> Result<HookRow, StoreError> {
        self.check_place()?;
        let words: Vec<&str> = kinds.iter().map(|kind| kind.word()).collect();
        let query = sqlx::query(ADD).bind(url).bind(words.join(",")).bind(secret).bind(now.0);
        let row = query.fetch_one(&self.writer).await?;
        self.check_place()?;
        hook(&row)
    }

    /// Removes a webhook and its failures. Gives whether there was one with this number.
    ///
    /// # Errors
    /// If the database refuses the write, or its file was taken away.
    pub async fn remove_webhook(&self, id: i64) -> Result<bool, StoreError> {
        self.check_place()?;
        let done = sqlx::query(REMOVE).bind(id).execute(&self.writer).await?;
        self.check_place()?;
        Ok(done.rows_affected() > 0)
    }

    /// Notes that a webhook has received everything up to this event.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn webhook_reached(&self, id: i64, cursor: i64) -> Result<(), StoreError> {
        sqlx::query(REACH).bind(id).bind(cursor).execute(&self.writer).await?;
        Ok(())
    }

    /// Notes that a message that ends with this event was not accepted, and why.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn webhook_missed(&self, id: i64, last: i64, why: &str) -> Result<(), StoreError> {
        sqlx::query(MISS).bind(id).bind(last).bind(why).execute(&self.writer).await?;
        Ok(())
    }

    /// Gives up the events from the first to the last one, and continues after them.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn webhook_given_up(
        &self,
        id: i64,
        (first, last): (i64, i64),
        now: Time,
    ) -> Result<(), StoreError> {
        debug_assert!(first <= last, "a message has an event");
        let mut tx = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        sqlx::query(GIVE_UP).bind(id).bind(first).bind(last).bind(now.0).execute(&mut *tx).await?;
        sqlx::query(FORGET).bind(id).bind(MOST_FAILED).execute(&mut *tx).await?;
        sqlx::query(REACH).bind(id).bind(last).execute(&mut *tx).await?;
        tx.commit().await?;
        Ok(())
    }

    /// A page of given-up messages of a webhook, newest first, before a number if one is given.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn webhook_failures(
        &self,
        id: i64,
        before: Option<i64>,
        limit: u32,
    ) -> Result<Vec<FailedRow>, StoreError> {
        let query = sqlx::query(FAILED).bind(id).bind(before.unwrap_or(i64::MAX)).bind(limit);
        let rows = query.fetch_all(&self.readers).await?;
        let failed = |row: &SqliteRow| {
            Ok(FailedRow {
                id: row.try_get("id")?,
                first: row.try_get("first")?,
                last: row.try_get("last")?,
                at: Time(row.try_get("at")?),
                attempts: row.try_get("attempts")?,
                error: row.try_get("error")?,
            })
        };
        rows.iter().map(failed).collect()
    }
}

fn hook(row: &SqliteRow) -> Result<HookRow, StoreError> {
    let kinds: &str = row.try_get("kinds")?;
    Ok(HookRow {
        id: row.try_get("id")?,
        url: row.try_get("url")?,
        kinds: kinds.split(',').filter_map(EventKind::of_word).collect(),
        secret: row.try_get("secret")?,
        created: Time(row.try_get("created")?),
        cursor: row.try_get("cursor")?,
        attempts: row.try_get("attempts")?,
        pending: row.try_get("pending")?,
        failed: row.try_get("failed")?,
    })
}
