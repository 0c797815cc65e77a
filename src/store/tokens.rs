//! Named tokens: what is kept of each, which is never the token itself.
//!
//! Main types: [`TokenTable`], [`TokenRow`], [`TokenDraft`]. The table can be written beside a running server, which
//! reads it again every second. Of the tokens that are no longer valid the newest are kept, so that the audit can be
//! read. Refuses: two valid tokens of one name.

use super::{AuditRow, BUSY, Store, StoreError, audit};
use giveway_floor::time::Time;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool, SqlitePoolOptions, SqliteRow};
use std::path::Path;

const TABLES: &str = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name = 'tokens'";
const ALL: &str = "SELECT * FROM tokens ORDER BY id";
const ONE: &str = "SELECT * FROM tokens WHERE id = $1";
const ADD: &str = "INSERT INTO tokens (name, role, subject, hash, created, expires) VALUES ($1, $2, $3, $4, $5, $6) \
    RETURNING id";
const FORGET: &str = "DELETE FROM tokens WHERE id IN (SELECT id FROM tokens \
    WHERE revoked IS NOT NULL OR expires <= $1 ORDER BY id DESC LIMIT -1 OFFSET $2)";
const REVOKE: &str = "UPDATE tokens SET revoked = $2 WHERE id = $1 AND revoked IS NULL";
const ROTATE: &str = "UPDATE tokens SET hash = $2, created = $3 \
    WHERE id = $1 AND revoked IS NULL AND coalesce(expires > $3, true)";
const USED: &str = "UPDATE tokens SET last_used = $2 WHERE id = $1";

/// Number of invalid tokens that are kept.
pub const MOST_OVER: i64 = 1_000;

/// What is kept of a token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TokenRow {
    /// Number of the token.
    pub id: i64,
    /// Name of the token's user.
    pub name: String,
    /// The word for the role.
    pub role: String,
    /// The worker or robot that the token speaks for.
    pub subject: Option<String>,
    /// SHA-256 of the token, 32 bytes.
    pub hash: Vec<u8>,
    /// When the token was made or rotated.
    pub created: Time,
    /// When the token expires.
    pub expires: Option<Time>,
    /// When the token was revoked.
    pub revoked: Option<Time>,
    /// About when the token was used last.
    pub last_used: Option<Time>,
}

/// A token to be stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TokenDraft {
    /// Name of the token's user.
    pub name: String,
    /// The word for the role.
    pub role: String,
    /// The worker or robot that the token speaks for.
    pub subject: Option<String>,
    /// SHA-256 of the token.
    pub hash: [u8; 32],
    /// When the token is made.
    pub created: Time,
    /// When the token expires.
    pub expires: Option<Time>,
}

/// The table of tokens.
#[derive(Clone, Debug)]
pub struct TokenTable {
    readers: SqlitePool,
    writer: SqlitePool,
}

impl Store {
    /// The table of tokens.
    pub fn tokens(&self) -> TokenTable {
        TokenTable { readers: self.readers.clone(), writer: self.writer.clone() }
    }
}

impl TokenTable {
    /// Opens the table of an existing database, even while a server has it open.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub async fn open(path: &Path) -> Result<TokenTable, StoreError> {
        let options = SqliteConnectOptions::new().filename(path).busy_timeout(BUSY);
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await;
        let pool = pool.map_err(|why| StoreError::Open { path: path.into(), why })?;
        Ok(TokenTable { readers: pool.clone(), writer: pool })
    }

    /// Closes the file. Only for a table that was opened by itself.
    pub async fn close(self) {
        self.writer.close().await;
    }

    /// Whether the database has the table: one that only an earlier Giveway had lacks it.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn is_there(&self) -> Result<bool, StoreError> {
        let tables: i64 = sqlx::query_scalar(TABLES).fetch_one(&self.readers).await?;
        Ok(tables > 0)
    }

    /// All tokens in the order in which they were added, including those that are no longer valid.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn all(&self) -> Result<Vec<TokenRow>, StoreError> {
        if !self.is_there().await? {
            return Ok(Vec::new());
        }
        let rows = sqlx::query(ALL).fetch_all(&self.readers).await?;
        Ok(rows.iter().map(read).collect::<Result<_, _>>()?)
    }

    /// One token.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn one(&self, id: i64) -> Result<Option<TokenRow>, StoreError> {
        let row = sqlx::query(ONE).bind(id).fetch_optional(&self.readers).await?;
        Ok(row.as_ref().map(read).transpose()?)
    }

    /// Adds a token. Gives its number; nothing if another token of this name is valid.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn add(&self, new: &TokenDraft) -> Result<Option<i64>, StoreError> {
        // First, so that an error means that no token was added.
        debug_assert!(new.expires.is_none_or(|end| end > new.created), "a token is of use for some time");
        sqlx::query(FORGET).bind(new.created.0).bind(MOST_OVER).execute(&self.writer).await?;
        let added = sqlx::query_scalar(ADD)
            .bind(&new.name)
            .bind(&new.role)
            .bind(&new.subject)
            .bind(&new.hash[..])
            .bind(new.created.0)
            .bind(new.expires.map(|t| t.0))
            .fetch_one(&self.writer)
            .await;
        match added {
            Ok(id) => Ok(Some(id)),
            Err(sqlx::Error::Database(e)) if e.is_unique_violation() => Ok(None),
            Err(e) => Err(e.into()),
        }
    }

    /// Revokes a token. Gives whether it existed and was not revoked yet.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn revoke(&self, id: i64, now: Time) -> Result<bool, StoreError> {
        let done = sqlx::query(REVOKE).bind(id).bind(now.0).execute(&self.writer).await?;
        Ok(done.rows_affected() > 0)
    }

    /// Puts another token in the place of a valid one. Gives whether there was a valid one.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn rotate(&self, id: i64, hash: [u8; 32], now: Time) -> Result<bool, StoreError> {
        let done = sqlx::query(ROTATE).bind(id).bind(&hash[..]).bind(now.0).execute(&self.writer).await?;
        Ok(done.rows_affected() > 0)
    }

    /// Writes to the audit that a token was made, renewed or revoked beside a server.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn note_audit(&self, row: &AuditRow) -> Result<(), StoreError> {
        let mut connection = self.writer.acquire().await?;
        Ok(audit::note(&mut connection, row).await?)
    }

    /// Notes when a token was used.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn note_use(&self, id: i64, at: Time) -> Result<(), StoreError> {
        sqlx::query(USED).bind(id).bind(at.0).execute(&self.writer).await?;
        Ok(())
    }
}

fn read(row: &SqliteRow) -> Result<TokenRow, sqlx::Error> {
    let time = |name: &str| Ok::<_, sqlx::Error>(row.try_get::<Option<i64>, _>(name)?.map(Time));
    Ok(TokenRow {
        id: row.try_get("id")?,
        name: row.try_get("name")?,
        role: row.try_get("role")?,
        subject: row.try_get("subject")?,
        hash: row.try_get("hash")?,
        created: Time(row.try_get("created")?),
        expires: time("expires")?,
        revoked: time("revoked")?,
        last_used: time("last_used")?,
    })
}
