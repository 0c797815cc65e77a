//! From a payload to a JSON object, within limits.
//!
//! Main function: [`object`]. Before the parser sees the text, one pass over it counts the objects and lists, so that
//! no payload takes much memory, and replaces numbers that JSON does not have (`NaN`, `Infinity`, `1e999`) by `null`:
//! some robots' libraries write them, and the parser would refuse the message. Refuses: repairs of any other kind.

use super::oddity::{Oddity, Unreadable};
use super::place::{Notes, form};
use super::{MOST_BYTES, MOST_PARTS};
use serde_json::{Map, Value};
use std::borrow::Cow;

/// The longest number that is taken for one, characters.
const LONGEST_NUMBER: usize = 100;

/// Reads the object that a payload is.
pub(super) fn object(payload: &[u8], notes: &Notes) -> Result<Map<String, Value>, Unreadable> {
    if payload.len() > MOST_BYTES {
        return Err(Unreadable::TooLong { length: payload.len() });
    }
    let text = String::from_utf8_lossy(payload);
    if matches!(text, Cow::Owned(_)) {
        notes.add(|_| Oddity::NotUtf8);
    }
    // A mark in front and zeros behind are what some editors and C programs leave there.
    let text = text.trim_start_matches('\u{feff}').trim_end_matches('\0').trim();
    if text.is_empty() {
        return Err(Unreadable::Empty);
    }
    let text = with_possible_numbers(text, notes)?;
    match serde_json::from_str(&text) {
        Ok(Value::Object(fields)) => Ok(fields),
        Ok(other) => Err(Unreadable::NotAnObject { found: form(&other) }),
        Err(error) => Err(Unreadable::NotJson { reason: error.to_string() }),
    }
}

fn with_possible_numbers<'t>(text: &'t str, notes: &Notes) -> Result<Cow<'t, str>, Unreadable> {
    let bytes = text.as_bytes();
    let (mut at, mut copied, mut parts) = (0, 0, 0);
    let mut better = String::new();
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'"' => at = end_of_text(bytes, at),
            b'{' | b'[' => {
                parts += 1;
                if parts > MOST_PARTS {
                    return Err(Unreadable::TooManyParts);
                }
                at += 1;
            }
            byte if is_of_number(*byte) => {
                let length = bytes.iter().skip(at).take_while(|b| is_of_number(**b)).count();
                let word = text.get(at..at + length).unwrap_or_default();
                if is_impossible(word) {
                    notes.add(|_| Oddity::BadNumber {
                        place: format!("the value at byte {at}"),
                        number: word.chars().take(LONGEST_NUMBER).collect(),
                    });
                    better.push_str(text.get(copied..at).unwrap_or_default());
                    better.push_str("null");
                    copied = at + length;
                }
                at += length;
            }
            _ => at += 1,
        }
    }
    if copied == 0 {
        return Ok(Cow::Borrowed(text));
    }
    better.push_str(text.get(copied..).unwrap_or_default());
    Ok(Cow::Owned(better))
}

/// The index behind the text that begins with the quotation mark at an index.
fn end_of_text(bytes: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'"' => return at + 1,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    bytes.len()
}

fn is_of_number(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'+' | b'-' | b'.')
}

/// Whether a word stands for a number that is not finite, or has more digits than anybody means.
fn is_impossible(word: &str) -> bool {
    let bare = word.trim_start_matches(['+', '-']);
    if ["nan", "inf", "infinity"].iter().any(|name| bare.eq_ignore_ascii_case(name)) {
        return true;
    }
    bare.starts_with(|first: char| first.is_ascii_digit())
        && (word.len() > LONGEST_NUMBER || word.parse::<f64>().is_ok_and(f64::is_infinite))
}
