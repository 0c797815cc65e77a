//! Names that people can tell apart: two names that look the same are the same.
//!
//! Main function: [`name_fault`]. Upper and lower case differ visibly, so `a1` and `A1` are two names; so do a wide and
//! a narrow digit. Refuses: to change a name, which would make it another one for its sender.

use super::sentence::{Sentence, requests};
use std::fmt;
use unicode_normalization::is_nfc;

/// Why a name is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameFault {
    /// The name is empty, or longer than this many characters.
    Length(usize),
    /// The name begins or ends with white space.
    Edge,
    /// The name has white space other than single plain blanks.
    Blank(char),
    /// The name has a character that is not shown.
    Unseen(char),
    /// A letter is written as a base and a mark, though there is one character for both, or in another such form.
    Form,
    /// A letter of another alphabet looks like a Latin one and is next to Latin letters.
    Alphabet(char),
}

impl NameFault {
    /// The fault and its remedy.
    pub fn sentence(&self) -> Sentence {
        let code = |c: &char| format!("U+{:04X}", u32::from(*c));
        match self {
            NameFault::Length(most) => requests::name_length(*most),
            NameFault::Edge => requests::name_edge(),
            NameFault::Blank(c) if c.is_control() => requests::name_control(code(c)),
            NameFault::Blank(c) => requests::name_blank(code(c)),
            NameFault::Unseen(c) => requests::name_unseen(code(c)),
            NameFault::Form => requests::name_form(),
            NameFault::Alphabet(c) => requests::name_alphabet(c.to_string(), code(c)),
        }
    }
}

impl fmt::Display for NameFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sentence().text())
    }
}

/// The fault of a name of at most `longest` characters; nothing if it looks like no other name.
pub fn name_fault(name: &str, longest: usize) -> Option<NameFault> {
    if name.is_empty() || name.chars().count() > longest {
        return Some(NameFault::Length(longest));
    }
    let letters: Vec<char> = name.chars().collect();
    let is_blank = |c: char| c.is_whitespace() || c.is_control();
    if let Some(c) = letters.iter().find(|c| is_blank(**c) && **c != ' ') {
        return Some(NameFault::Blank(*c));
    }
    if name.starts_with(' ') || name.ends_with(' ') {
        return Some(NameFault::Edge);
    }
    if name.contains("  ") {
        return Some(NameFault::Blank(' '));
    }
    let unseen = |i: &usize| is_unseen(letters[*i]) && !joins(&letters, *i);
    if let Some(i) = (0..letters.len()).find(unseen) {
        return Some(NameFault::Unseen(letters[i]));
    }
    if !is_nfc(name) {
        return Some(NameFault::Form);
    }
    mixed(&letters).map(NameFault::Alphabet)
}

/// Whether a character has no shape of its own: soft hyphens, joiners, marks of direction, fillers, variation
/// selectors, private and unassigned characters.
fn is_unseen(c: char) -> bool {
    matches!(c,
        '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}'..='\u{1160}' | '\u{17b4}'..='\u{17b5}'
        | '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
        | '\u{2800}' | '\u{3164}' | '\u{e000}'..='\u{f8ff}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{ffa0}'
        | '\u{fff0}'..='\u{ffff}' | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..)
}

/// Whether a joiner is between letters of a script that it joins or parts, as in Persian and Hindi: there it shows.
fn joins(letters: &[char], i: usize) -> bool {
    let is_joined = |c: Option<&char>| c.is_some_and(|c| matches!(c, '\u{620}'..='\u{dff}'));
    let before = i.checked_sub(1).and_then(|b| letters.get(b));
    matches!(letters[i], '\u{200c}' | '\u{200d}') && is_joined(before) && is_joined(letters.get(i + 1))
}

/// Greek and Cyrillic letters that look like Latin ones.
const LOOK_ALIKES: &str = "ΑΒΕΖΗΙΚΜΝΟΡΤΥΧανορυχАВЕЗІЈКМНОРСТУХаеіјорсухѕԁԛԝ";

/// A look-alike in a run of letters that also has Latin ones.
fn mixed(letters: &[char]) -> Option<char> {
    letters.split(|c| !c.is_alphabetic()).find_map(|run| {
        let alike = run.iter().find(|c| LOOK_ALIKES.contains(**c))?;
        run.iter().any(|c| matches!(c, 'A'..='Z' | 'a'..='z' | 'À'..='ɏ')).then_some(*alike)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_only_in_what_nobody_sees_are_refused() {
        for (name, fault) in [
            ("", NameFault::Length(20)),
            ("a name that is far too long", NameFault::Length(20)),
            ("rack-1 ", NameFault::Edge),
            (" rack-1", NameFault::Edge),
            ("rack  1", NameFault::Blank(' ')),
            ("rack\u{a0}1", NameFault::Blank('\u{a0}')),
            ("rack-1\u{2003}", NameFault::Blank('\u{2003}')),
            ("rack\t1", NameFault::Blank('\t')),
            ("rack\u{7f}1", NameFault::Blank('\u{7f}')),
            ("rack-1\u{200b}", NameFault::Unseen('\u{200b}')),
            ("\u{feff}rack-1", NameFault::Unseen('\u{feff}')),
            ("rack\u{ad}1", NameFault::Unseen('\u{ad}')),
            ("r\u{200d}ack", NameFault::Unseen('\u{200d}')),
            ("rack-1\u{fe0f}", NameFault::Unseen('\u{fe0f}')),
            ("rack-1\u{e0041}", NameFault::Unseen('\u{e0041}')),
            ("Cafe\u{301}", NameFault::Form),
            ("\u{212b}1", NameFault::Form),
            ("r\u{430}ck-1", NameFault::Alphabet('\u{430}')),
            ("\u{39a}a1", NameFault::Alphabet('\u{39a}')),
        ] {
            assert_eq!(name_fault(name, 20), Some(fault), "{name:?}");
            assert!(!fault.to_string().is_empty());
        }
    }

    #[test]
    fn names_that_look_like_themselves_are_taken_in_any_script() {
        let good =
            ["rack-1", "Rack 1", "A.01.02", "k \"1\"", "Café", "Größe-7", "стойка", "Ράφι", "货架 1", "رف ۱"];
        for name in good.into_iter().chain(["علی\u{200c}رضا", "Ω-3", "5µm", "a", "R2→R3"]) {
            assert_eq!(name_fault(name, 20), None, "{name:?}");
        }
    }
}
