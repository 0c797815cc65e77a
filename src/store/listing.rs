//! How a page of a list is read, so that it costs the same however long the list is.
//!
//! Main types: [`Reach`] (what times leave of a list), [`Listing`] (where a page comes from), [`Arm`] (one index, read
//! in the order of the list), [`RowCondition`] (what no index answers). A page has the best rows of its arms. Where
//! conditions drop rows, it looks at a bounded number of rows and tells where to continue. Refuses: to sort a list, and
//! to choose an index by itself: each arm names one, and SQLite refuses a statement whose index is missing.

use super::{Store, StoreError};
use giveway_floor::time::{Span, Time};
use sqlx::sqlite::SqlitePool;
use sqlx::{QueryBuilder, Sqlite};

/// Number of rows that a page looks at beyond the rows that it gives.
pub(super) const LOOKED_AT: i64 = 2_000;

/// Rows that were open for longer than this have an index of their own (`jobs_of_days`).
const DAYS: Span = Span::from_secs(24 * 3600);

/// What a column is compared with.
#[derive(Clone, Debug)]
pub(super) enum Given {
    Number(i64),
    Word(String),
}

/// One index, or a table by its numbers, with the columns of it that must be equal to given values.
#[derive(Clone, Debug)]
pub(super) struct Arm {
    /// The table with its index.
    pub from: &'static str,
    /// The column with the number of a row.
    pub id: &'static str,
    /// Columns and the values that they must equal.
    pub equal: Vec<(&'static str, Given)>,
    /// Ranges of a column of a short index, which is not in the order of the list.
    pub within: Vec<(&'static str, i64)>,
}

impl Arm {
    /// An index whose rows are in the order of the list where these columns are equal.
    pub fn of(from: &'static str, id: &'static str, equal: Vec<(&'static str, Given)>) -> Arm {
        Arm { from, id, equal, within: Vec::new() }
    }

    /// A range of a short index, by comparisons with numbers.
    pub fn short(from: &'static str, id: &'static str, within: Vec<(&'static str, i64)>) -> Arm {
        Arm { from, id, equal: Vec::new(), within }
    }

    /// One arm for each of these words in the last column of an index.
    pub fn for_each(
        from: &'static str,
        id: &'static str,
        first: Option<(&'static str, i64)>,
        (column, words): (&'static str, &[&'static str]),
    ) -> Vec<Arm> {
        let first = first.map(|(column, number)| (column, Given::Number(number)));
        let arm = |word: &&str| {
            let equal = first.clone().into_iter().chain([(column, Given::Word((*word).to_owned()))]);
            Arm::of(from, id, equal.collect())
        };
        words.iter().map(arm).collect()
    }
}

/// A further condition on a row: pieces of SQL, each with the value that follows it.
#[derive(Clone, Debug)]
pub(super) struct RowCondition {
    parts: Vec<(&'static str, Given)>,
    end: &'static str,
}

impl RowCondition {
    /// A comparison with a number.
    pub fn number(comparison: &'static str, number: i64) -> RowCondition {
        RowCondition { parts: vec![(comparison, Given::Number(number))], end: "" }
    }

    /// A condition of pieces with words behind them.
    pub fn words(parts: Vec<(&'static str, String)>, end: &'static str) -> RowCondition {
        RowCondition { parts: parts.into_iter().map(|(sql, word)| (sql, Given::Word(word))).collect(), end }
    }

    /// The condition that a column has one of these words, if there are any.
    pub fn one_of(begin: &'static str, words: &[&'static str]) -> Option<RowCondition> {
        let part = |(i, word): (usize, &&str)| (if i == 0 { begin } else { ", " }, (*word).to_owned());
        (!words.is_empty()).then(|| RowCondition::words(words.iter().enumerate().map(part).collect(), ")"))
    }
}

/// The rows of a list that the times in a query allow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Least number of a row.
    pub low: i64,
    /// Row numbers are below this.
    pub before: i64,
    /// Whether a range of time has so few rows that they may be looked at one by one.
    pub is_short: bool,
    /// Whether the bounds fully replace conditions on times of acceptance.
    pub is_orderly: bool,
}

impl Reach {
    /// The conditions on times that the bounds do not cover.
    pub fn conditions(
        &self,
        (from, to, since): (Option<Time>, Option<Time>, Option<Time>),
    ) -> impl Iterator<Item = RowCondition> + use<> {
        let (from, to) = if self.is_orderly { (None, None) } else { (from, to) };
        let times = [(" AND created >= ", from), (" AND created < ", to), (" AND updated >= ", since)];
        times.into_iter().filter_map(|(sql, t)| t.map(|t| RowCondition::number(sql, t.0)))
    }

    /// A listing within these bounds.
    pub fn listing(
        &self,
        (rows, order): (&'static str, &'static str),
        arms: Vec<Arm>,
        conditions: Vec<RowCondition>,
        limit: u32,
    ) -> Listing {
        let Reach { low, before, is_short, .. } = *self;
        Listing { rows, order, arms, conditions, low, before, is_short, limit }
    }
}

/// Statements about a list whose rows are accepted in the order of their numbers, and change later.
pub(super) struct TimeStatements {
    /// Finds the first row that was accepted at a time or later.
    pub first: &'static str,
    /// Finds the first row that was open for more than [`DAYS`] and changed at a time or later.
    pub first_of_days: &'static str,
    /// Counts the rows that changed at a time or later, up to a limit.
    pub changed: &'static str,
}

impl TimeStatements {
    /// The rows of a list that the times of acceptance and of the last change allow.
    pub async fn reach(
        &self,
        store: &Store,
        (from, to, since): (Option<Time>, Option<Time>, Option<Time>),
        before: i64,
    ) -> Result<Reach, StoreError> {
        let db = &store.readers;
        let mut reach = Reach { low: i64::MIN, before, is_short: false, is_orderly: store.is_orderly };
        if let Some(since) = since {
            reach.is_short = count(db, self.changed, &[since.0]).await? <= LOOKED_AT;
        }
        if !store.is_orderly {
            return Ok(reach);
        }
        if let Some(from) = from {
            reach.low = first(db, self.first, from).await?;
        }
        if let Some(to) = to {
            reach.before = before.min(first(db, self.first, to).await?);
        }
        if let (Some(since), false) = (since, reach.is_short) {
            let quick = first(db, self.first, since - DAYS).await?;
            reach.low = reach.low.max(quick.min(first(db, self.first_of_days, since).await?));
        }
        Ok(reach)
    }
}

/// The first number that a statement finds, or the largest number if there is none.
pub(super) async fn first(db: &SqlitePool, statement: &'static str, at: Time) -> Result<i64, StoreError> {
    let found: Option<Option<i64>> = sqlx::query_scalar(statement).bind(at.0).fetch_optional(db).await?;
    Ok(found.flatten().unwrap_or(i64::MAX))
}

/// Number of rows in a range, or one more than may be looked at.
pub(super) async fn count(
    db: &SqlitePool,
    statement: &'static str,
    range: &[i64],
) -> Result<i64, StoreError> {
    let query = range.iter().fold(sqlx::query_scalar(statement), |query, n| query.bind(*n));
    Ok(query.bind(LOOKED_AT + 1).fetch_one(db).await?)
}

/// The source of a page. Numbers fall within a page, and from page to page.
#[derive(Clone, Debug)]
pub(super) struct Listing {
    /// The columns that are read, up to the numbers of the rows.
    pub rows: &'static str,
    /// The order of the page.
    pub order: &'static str,
    /// The indexes from which rows may come.
    pub arms: Vec<Arm>,
    /// The further conditions on rows.
    pub conditions: Vec<RowCondition>,
    /// Least number of a row.
    pub low: i64,
    /// Row numbers are below this.
    pub before: i64,
    /// Whether the arms have no more rows than may be looked at.
    pub is_short: bool,
    /// Largest number of rows of the page.
    pub limit: u32,
}

impl Listing {
    /// The query of how far down the list this page looks; nothing if it need not look at more than it gives.
    pub fn floor(&self) -> Option<QueryBuilder<Sqlite>> {
        if self.conditions.is_empty() || self.is_short {
            return None;
        }
        let mut query = QueryBuilder::new("SELECT max(floor) FROM (");
        for (i, arm) in self.arms.iter().enumerate() {
            query.push(if i == 0 { "SELECT (SELECT " } else { " UNION ALL SELECT (SELECT " });
            push_arm(&mut query, arm, (self.low, self.before));
            query.push(" ORDER BY ").push(arm.id).push(" DESC LIMIT 1 OFFSET ");
            query.push_bind(LOOKED_AT + i64::from(self.limit)).push(") AS floor");
        }
        query.push(")");
        Some(query)
    }

    /// The rows of the page whose numbers are not below the floor.
    pub fn page(&self, floor: i64) -> QueryBuilder<Sqlite> {
        debug_assert!(self.limit > 0, "a page has room for a row");
        debug_assert!(!self.arms.is_empty(), "a list is read from somewhere");
        let mut query = QueryBuilder::new(self.rows);
        for (i, arm) in self.arms.iter().enumerate() {
            query.push(if i == 0 { "SELECT * FROM (SELECT " } else { " UNION ALL SELECT * FROM (SELECT " });
            push_arm(&mut query, arm, (self.low.max(floor), self.before));
            for condition in &self.conditions {
                for (sql, given) in &condition.parts {
                    push_given(query.push(sql), given);
                }
                query.push(condition.end);
            }
            query.push(" ORDER BY ").push(arm.id).push(" DESC LIMIT ").push_bind(self.limit).push(")");
        }
        query.push(self.order).push_bind(self.limit);
        query
    }

    /// Reads the page. Gives its rows, and, if it looked at as many rows as it may and found too few, the number before
    /// which the list continues.
    pub async fn read(
        &self,
        db: &SqlitePool,
    ) -> Result<(Vec<sqlx::sqlite::SqliteRow>, Option<i64>), StoreError> {
        let floor: Option<i64> = match self.floor() {
            Some(mut query) => query.build_query_scalar().fetch_one(db).await?,
            None => None,
        };
        let rows = self.page(floor.unwrap_or(i64::MIN)).build().fetch_all(db).await?;
        debug_assert!(rows.len() <= self.limit as usize, "a page is no longer than was asked for");
        let is_full = rows.len() >= self.limit as usize;
        Ok((rows, floor.filter(|_| !is_full)))
    }
}

fn push_arm(query: &mut QueryBuilder<Sqlite>, arm: &Arm, (low, before): (i64, i64)) {
    query.push(arm.id).push(" FROM ").push(arm.from).push(" WHERE ");
    for (column, given) in &arm.equal {
        push_given(query.push(column).push(" = "), given);
        query.push(" AND ");
    }
    for (comparison, number) in &arm.within {
        query.push(comparison).push_bind(*number).push(" AND ");
    }
    query.push(arm.id).push(" < ").push_bind(before).push(" AND ").push(arm.id).push(" >= ").push_bind(low);
}

fn push_given(query: &mut QueryBuilder<Sqlite>, given: &Given) {
    match given {
        Given::Number(number) => query.push_bind(*number),
        Given::Word(word) => query.push_bind(word.clone()),
    };
}
