//! Requests with an `Idempotency-Key` whose effect has no key of its own, and their answers.
//!
//! Main functions: [`Store::begin_keyed`], [`Store::finish_keyed`]. Refuses: to keep a request longer than jobs keep
//! their keys.

use super::{Store, StoreError};
use giveway_fleet::KEY_LIFE;
use giveway_floor::time::Time;
use sqlx::Row;

const BEGIN_ONE: &str = "INSERT INTO answers (caller, route, key, digest, at) VALUES ($1, $2, $3, $4, $5) \
    ON CONFLICT DO NOTHING";
const FOUND: &str =
    "SELECT digest, status, location, body FROM answers WHERE caller = $1 AND route = $2 AND key = $3";
const FINISH: &str = "UPDATE answers SET status = $4, location = $5, body = $6 \
    WHERE caller = $1 AND route = $2 AND key = $3";
const FORGET: &str = "DELETE FROM answers WHERE caller = $1 AND route = $2 AND key = $3";
const FORGET_OLD: &str = "DELETE FROM answers INDEXED BY answers_by_time WHERE at < $1";

/// The caller, the route and the key of a request.
pub type AnswerKey<'a> = [&'a str; 3];

/// What is kept of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnswerRow {
    /// Digest of the request's body.
    pub digest: String,
    /// Status, location and body of the answer; nothing while there is none.
    pub answer: Option<(u16, Option<String>, String)>,
}

impl Store {
    /// Records that a request begins; gives what is known of it if it is not the first with its key.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing was written.
    pub async fn begin_keyed(
        &self,
        key: AnswerKey<'_>,
        digest: &str,
        now: Time,
    ) -> Result<Option<AnswerRow>, StoreError> {
        self.check_place()?;
        sqlx::query(FORGET_OLD).bind((now - KEY_LIFE).0).execute(&self.writer).await?;
        let [caller, route, name] = key;
        let query = sqlx::query(BEGIN_ONE).bind(caller).bind(route).bind(name).bind(digest).bind(now.0);
        if query.execute(&self.writer).await?.rows_affected() > 0 {
            return Ok(None);
        }
        let found = sqlx::query(FOUND).bind(caller).bind(route).bind(name);
        let row = found.fetch_one(&self.writer).await?;
        let status: Option<u16> = row.try_get("status")?;
        let answer = match status {
            Some(status) => Some((status, row.try_get("location")?, row.try_get("body")?)),
            None => None,
        };
        Ok(Some(AnswerRow { digest: row.try_get("digest")?, answer }))
    }

    /// Keeps the answer of a request that has begun.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing was written.
    pub async fn finish_keyed(
        &self,
        key: AnswerKey<'_>,
        answer: (u16, Option<String>, String),
    ) -> Result<(), StoreError> {
        let [caller, route, name] = key;
        let (status, location, body) = answer;
        debug_assert!((100..600).contains(&status), "{status} is no status of an answer");
        let query = sqlx::query(FINISH).bind(caller).bind(route).bind(name);
        query.bind(status).bind(location).bind(body).execute(&self.writer).await?;
        Ok(())
    }

    /// Deletes a request that came to nothing.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing was written.
    pub async fn forget_keyed(&self, [caller, route, name]: AnswerKey<'_>) -> Result<(), StoreError> {
        sqlx::query(FORGET).bind(caller).bind(route).bind(name).execute(&self.writer).await?;
        Ok(())
    }
}
