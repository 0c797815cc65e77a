//! Lists: which page, which words filter them, and what is wrong with that.
//!
//! Main types: [`Paging`]; main functions: [`page`], [`read_words`], [`named`]. Refuses: pages of more than 500.

use crate::dto::names::Page;
use crate::http::shared::named::unknown;
use crate::wire::error::{FieldError, Problem};
use axum::Json;
use giveway_floor::text::sentence::requests;
use serde::Deserialize;
use utoipa::IntoParams;

/// The longest page.
pub const LONGEST_PAGE: u32 = 500;

/// Which page of a list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct Paging {
    /// How many items at most, 1 to 500; 100 if absent.
    pub limit: Option<u32>,
    /// `next` of the previous page.
    pub cursor: Option<String>,
}

/// A limit within bounds.
pub fn checked_limit(limit: Option<u32>, usual: u32) -> Result<u32, Problem> {
    match limit.unwrap_or(usual) {
        n @ 1..=LONGEST_PAGE => Ok(n),
        n => Err(Problem::invalid(vec![FieldError::new("limit", requests::not_between(n, 1, LONGEST_PAGE))])),
    }
}

/// One page of a list.
pub fn page<T>(all: Vec<T>, p: &Paging) -> Result<Json<Page<T>>, Problem> {
    let limit = checked_limit(p.limit, 100)? as usize;
    let start = match p.cursor.as_deref().map(str::parse::<usize>) {
        None => 0,
        Some(Ok(start)) => start,
        Some(Err(_)) => {
            return Err(Problem::invalid(vec![FieldError::new("cursor", requests::not_a_cursor())]));
        }
    };
    let end = start.saturating_add(limit);
    let next = (end < all.len()).then(|| end.to_string());
    Ok(Json(Page { items: all.into_iter().skip(start).take(limit).collect(), next }))
}

/// The words of a parameter, with commas between them; complains about those that are none.
pub fn read_words(
    field: &str,
    text: Option<&str>,
    known: &[&'static str],
    errors: &mut Vec<FieldError>,
) -> Vec<&'static str> {
    let mut found = Vec::new();
    for word in text.into_iter().flat_map(|text| text.split(',')).map(str::trim) {
        match known.iter().find(|known| **known == word) {
            Some(known) => found.push(*known),
            None => {
                errors.push(FieldError::new(field, requests::not_one_of(word, known.to_vec())));
            }
        }
    }
    found
}

/// Whether a word is one of those that are wanted; if none are, all of them.
pub fn is_wanted(wanted: &[&'static str], word: &str) -> bool {
    wanted.is_empty() || wanted.contains(&word)
}

/// What has the name in a parameter, if there is one; complains where nothing has.
pub fn named<T>(
    field: &str,
    name: Option<&str>,
    find: impl Fn(&str) -> Option<T>,
    errors: &mut Vec<FieldError>,
) -> Option<T> {
    let name = name?;
    let found = find(name);
    if found.is_none() {
        errors.push(FieldError::new(field, unknown(field, name)));
    }
    found
}

/// Refuses a request with wrong fields.
pub fn refuse_wrong(errors: Vec<FieldError>) -> Result<(), Problem> {
    if errors.is_empty() { Ok(()) } else { Err(Problem::invalid(errors)) }
}
