//! Lists: pages, filters by words, and errors in these parameters.
//!
//! Main types: [`Paging`]; main functions: [`page`], [`read_words`], [`named`]. Refuses: pages of more than 500.

use crate::dto::names::Page;
use crate::http::shared::named::unknown;
use crate::wire::error::{FieldError, Problem};
use axum::Json;
use giveway_floor::text::sentence::requests;
use serde::Deserialize;
use utoipa::IntoParams;

/// The most items on a page.
pub const LONGEST_PAGE: u32 = 500;

/// The page of a list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct Paging {
    /// How many items at most, 1 to 500; 100 if absent.
    pub limit: Option<u32>,
    /// `next` of the previous page; absent for the first one.
    pub cursor: Option<String>,
}

/// The limit, or `usual` if absent; an error if it is not 1 to [`LONGEST_PAGE`].
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

/// The words of a parameter, separated by commas; adds an error for each unknown word.
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

/// Whether a word is wanted; an empty list wants all words.
pub fn is_wanted(wanted: &[&'static str], word: &str) -> bool {
    wanted.is_empty() || wanted.contains(&word)
}

/// Looks up the name in a parameter, if given; adds an error if nothing has that name.
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

/// Returns the errors as a problem, if there are any.
pub fn refuse_wrong(errors: Vec<FieldError>) -> Result<(), Problem> {
    if errors.is_empty() { Ok(()) } else { Err(Problem::invalid(errors)) }
}
