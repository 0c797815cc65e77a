//! The fields of an object in a message, found under any spelling and brought into the wanted form.
//!
//! Main type: [`ObjectReader`]. Each function returns nothing if the field is missing, null, or has a form that cannot
//! be understood (which it notes); those with `need` refuse the message then, those with `or` note what they assume.
//! Refuses: to know which field is needed.

use super::oddity::{Oddity, Unreadable};
use super::place::{Notes, PayloadPath, form};
use super::{GREATEST_NUMBER, LONGEST_LIST, LONGEST_TEXT};
use crate::vocabulary::{WireName, WireWords, is_alike};
use serde_json::{Map, Value};

/// The most fields of an object among which similar keys are looked for: the standard has none with half as many.
const MOST_COMPARED: usize = 200;

/// The most characters of a text that an oddity repeats.
const LONGEST_QUOTE: usize = 100;

/// An object in a message. An element of a list that is no object reads as one without fields.
#[derive(Clone, Copy)]
pub(super) struct ObjectReader<'r> {
    fields: Option<&'r Map<String, Value>>,
    spot: PayloadPath<'r>,
    notes: &'r Notes,
}

impl<'r> ObjectReader<'r> {
    /// The object that a message is.
    pub(super) fn message(fields: &'r Map<String, Value>, notes: &'r Notes) -> ObjectReader<'r> {
        ObjectReader { fields: Some(fields), spot: PayloadPath::Message, notes }
    }

    /// Whether the message's version has a field: if not, it is not odd that the field is missing.
    pub(super) fn expects(&self, name: &WireName) -> bool {
        name.of(self.notes.version()).is_some()
    }

    /// Whether a field is there, and not null.
    pub(super) fn has(&self, name: &WireName) -> bool {
        self.find(name).is_some()
    }

    /// Whether the value of a field is an object.
    pub(super) fn is_object(&self, name: &WireName) -> bool {
        self.find(name).is_some_and(|(_, value)| value.is_object())
    }

    /// A text; numbers and truth values are taken as they are written.
    pub(super) fn text(&self, name: &WireName) -> Option<String> {
        let value = self.value(name)?;
        match value {
            Value::String(text) => Some(self.kept(text, self.field(name))),
            Value::Number(_) | Value::Bool(_) => {
                self.converted(name, value, "a text");
                Some(value.to_string())
            }
            _ => self.wrong_form(name, value, "a text"),
        }
    }

    pub(super) fn need_text(&self, name: &WireName) -> Result<String, Unreadable> {
        self.text(name).ok_or_else(|| self.missing(name))
    }

    pub(super) fn text_or_empty(&self, name: &WireName) -> String {
        self.text(name).unwrap_or_else(|| self.assumed(name, "empty", String::new()))
    }

    /// A number of at most [`GREATEST_NUMBER`]; texts are read as numbers.
    pub(super) fn number(&self, name: &WireName) -> Option<f64> {
        let number = self.any_number(name, "a number")?;
        if number.abs() <= GREATEST_NUMBER { Some(number) } else { self.bad_number(name, number) }
    }

    /// A number that is not negative.
    pub(super) fn magnitude(&self, name: &WireName) -> Option<f64> {
        let number = self.number(name)?;
        if number >= 0.0 { Some(number) } else { self.bad_number(name, number) }
    }

    /// A share of 1, which messages have in percent. A little more than 100 % is full.
    pub(super) fn share(&self, name: &WireName) -> Option<f64> {
        let percent = self.number(name)?;
        if (0.0..=101.0).contains(&percent) {
            Some((percent / 100.0).min(1.0))
        } else {
            self.bad_number(name, percent)
        }
    }

    pub(super) fn need_number(&self, name: &WireName) -> Result<f64, Unreadable> {
        self.number(name).ok_or_else(|| self.missing(name))
    }

    pub(super) fn number_or_zero(&self, name: &WireName) -> f64 {
        self.number(name).unwrap_or_else(|| self.assumed(name, "0", 0.0))
    }

    /// A whole number from 0 to the greatest of 32 bits, also if written with a fraction of 0.
    pub(super) fn count(&self, name: &WireName) -> Option<u32> {
        let number = self.any_number(name, "a whole number")?;
        if number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number) {
            // Whole and within the bounds, so nothing is lost.
            return Some(number as u32);
        }
        self.bad_number(name, number)
    }

    pub(super) fn need_count(&self, name: &WireName) -> Result<u32, Unreadable> {
        self.count(name).ok_or_else(|| self.missing(name))
    }

    pub(super) fn count_or_zero(&self, name: &WireName) -> u32 {
        self.count(name).unwrap_or_else(|| self.assumed(name, "0", 0))
    }

    /// A truth value, also if written as a text, or as 0 or 1.
    pub(super) fn flag(&self, name: &WireName) -> Option<bool> {
        let value = self.value(name)?;
        let understood = match value {
            Value::Bool(flag) => return Some(*flag),
            Value::Number(number) if number.as_f64() == Some(0.0) => Some(false),
            Value::Number(number) if number.as_f64() == Some(1.0) => Some(true),
            Value::String(text) if is_alike(text, "true") => Some(true),
            Value::String(text) if is_alike(text, "false") => Some(false),
            _ => None,
        };
        if understood.is_none() {
            return self.wrong_form(name, value, "true or false");
        }
        self.converted(name, value, "true or false");
        understood
    }

    pub(super) fn flag_or(&self, name: &WireName, assumed: bool) -> bool {
        self.flag(name).unwrap_or_else(|| self.assumed(name, if assumed { "true" } else { "false" }, assumed))
    }

    /// The value of a word. An unknown word gives the careful value, if the enumeration has one.
    pub(super) fn word<T: Copy + PartialEq>(&self, name: &WireName, words: &WireWords<T>) -> Option<T> {
        let value = self.value(name)?;
        let Value::String(text) = value else {
            return self.wrong_form(name, value, "a word");
        };
        self.meaning(text, self.field(name), words)
    }

    pub(super) fn word_or_careful<T: Copy + PartialEq>(
        &self,
        name: &WireName,
        words: &WireWords<T>,
    ) -> Result<T, Unreadable> {
        if let Some(value) = self.word(name, words) {
            return Ok(value);
        }
        let careful = words.careful.ok_or_else(|| self.missing(name))?;
        let word = words.word(careful, self.notes.version()).unwrap_or("nothing");
        Ok(self.assumed(name, word, careful))
    }

    /// The values of a list of words, without unknown ones.
    pub(super) fn words<T: Copy + PartialEq>(&self, name: &WireName, words: &WireWords<T>) -> Vec<T> {
        self.texts(name).iter().filter_map(|text| self.meaning(text, self.field(name), words)).collect()
    }

    /// The texts of a list, without what is no text.
    pub(super) fn texts(&self, name: &WireName) -> Vec<String> {
        let list = self.field(name);
        let mut texts = Vec::new();
        for (index, value) in self.elements(name).unwrap_or_default().iter().enumerate() {
            let spot = PayloadPath::Item(&list, index);
            match value {
                Value::String(text) => texts.push(self.kept(text, spot)),
                other => self.wrong_form_at(spot, other, "a text"),
            }
        }
        texts
    }

    /// Any value, with its texts and lists cut to the limits.
    pub(super) fn anything(&self, name: &WireName) -> Option<Value> {
        Some(self.within_limits(self.value(name)?, self.field(name)))
    }

    pub(super) fn object(&self, name: &WireName) -> Option<ObjectReader<'_>> {
        let value = self.value(name)?;
        let Value::Object(fields) = value else {
            return self.wrong_form(name, value, "an object");
        };
        Some(ObjectReader { fields: Some(fields), spot: self.field(name), notes: self.notes })
    }

    /// An object, or one without fields, of which everything that is needed is missing.
    pub(super) fn object_or_empty(&self, name: &WireName) -> ObjectReader<'_> {
        let empty = ObjectReader { fields: None, spot: self.field(name), notes: self.notes };
        self.object(name).unwrap_or(empty)
    }

    /// An object and what a function reads from it; if the function refuses, the object is left out.
    pub(super) fn part<T>(
        &self,
        name: &WireName,
        read: impl FnOnce(&ObjectReader<'_>) -> Result<T, Unreadable>,
    ) -> Option<T> {
        let object = self.object(name)?;
        read(&object).map_err(|why| object.left_out(why)).ok()
    }

    /// What a function reads from each element of a list; if it refuses one, the message cannot be read.
    pub(super) fn all<T>(
        &self,
        name: &WireName,
        mut read: impl FnMut(&ObjectReader<'_>) -> Result<T, Unreadable>,
    ) -> Result<Option<Vec<T>>, Unreadable> {
        let Some(elements) = self.elements(name) else {
            return Ok(None);
        };
        let list = self.field(name);
        let mut all = Vec::new();
        for (index, value) in elements.iter().enumerate() {
            if let Some(element) = self.element(value, PayloadPath::Item(&list, index)) {
                all.push(read(&element)?);
            }
        }
        Ok(Some(all))
    }

    /// What a function reads from each element of a list, without the elements that it refuses.
    pub(super) fn readable<T>(
        &self,
        name: &WireName,
        mut read: impl FnMut(&ObjectReader<'_>) -> Result<T, Unreadable>,
    ) -> Option<Vec<T>> {
        let each = |element: &ObjectReader<'_>| Ok(read(element).map_err(|why| element.left_out(why)).ok());
        Some(self.all(name, each).ok()??.into_iter().flatten().collect())
    }

    /// Notes that a field is missing, and returns what is assumed.
    pub(super) fn assumed<T>(&self, name: &WireName, words: &str, value: T) -> T {
        let (place, taken_as) = (self.field(name), words);
        self.notes.add(|_| Oddity::Missing { place: place.to_string(), taken_as: taken_as.to_owned() });
        value
    }

    /// The refusal of a message that lacks a field.
    pub(super) fn missing(&self, name: &WireName) -> Unreadable {
        Unreadable::Missing { place: self.field(name).to_string() }
    }

    /// The value of a field; an unofficial key is noted.
    fn value(&self, name: &WireName) -> Option<&'r Value> {
        let (similar, value) = self.find(name)?;
        if let Some(key) = similar {
            let official = name.shown(self.notes.version());
            let place = self.spot;
            self.notes.add(|_| Oddity::Spelling { place: place.to_string(), found: quote(key), official });
        }
        Some(value)
    }

    /// The value under an official key of any version, or else a similar key and the value under that.
    fn find(&self, name: &WireName) -> Option<(Option<&'r str>, &'r Value)> {
        let fields = self.fields?;
        let said = |key: &str| fields.get(key).filter(|value| !value.is_null());
        if let Some(value) = name.spellings().find_map(said) {
            return Some((None, value));
        }
        if fields.len() > MOST_COMPARED {
            return None;
        }
        let is_similar = |key: &str| name.spellings().any(|official| is_alike(official, key));
        let (key, value) = fields.iter().find(|(key, value)| !value.is_null() && is_similar(key))?;
        Some((Some(key), value))
    }

    fn left_out(&self, why: Unreadable) {
        self.notes.add(|_| Oddity::LeftOut { place: self.spot.to_string(), why });
    }

    fn field(&self, name: &WireName) -> PayloadPath<'_> {
        PayloadPath::Field(&self.spot, name.shown(self.notes.version()))
    }

    fn elements(&self, name: &WireName) -> Option<&'r [Value]> {
        let value = self.value(name)?;
        let Value::Array(elements) = value else {
            return self.wrong_form(name, value, "a list");
        };
        Some(self.cut(elements, self.field(name)))
    }

    fn cut<'e>(&self, elements: &'e [Value], spot: PayloadPath<'_>) -> &'e [Value] {
        let Some(kept) = elements.get(..LONGEST_LIST).filter(|kept| kept.len() < elements.len()) else {
            return elements;
        };
        self.notes.add(|_| Oddity::LongList { place: spot.to_string(), length: elements.len() });
        kept
    }

    fn element<'e>(&'e self, value: &'e Value, spot: PayloadPath<'e>) -> Option<ObjectReader<'e>> {
        if !value.is_object() {
            self.wrong_form_at(spot, value, "an object");
        }
        (!value.is_null()).then_some(ObjectReader { fields: value.as_object(), spot, notes: self.notes })
    }

    fn meaning<T: Copy + PartialEq>(
        &self,
        text: &str,
        spot: PayloadPath<'_>,
        words: &WireWords<T>,
    ) -> Option<T> {
        let Some((value, official)) = words.value(text) else {
            self.notes.add(|version| Oddity::UnknownWord {
                place: spot.to_string(),
                word: quote(text),
                taken_as: words
                    .careful
                    .and_then(|value| words.word(value, version))
                    .unwrap_or("nothing")
                    .to_owned(),
            });
            return words.careful;
        };
        if official != text {
            self.notes.add(|_| Oddity::Spelling { place: spot.to_string(), found: quote(text), official });
        }
        Some(value)
    }

    fn any_number(&self, name: &WireName, wanted: &'static str) -> Option<f64> {
        let value = self.value(name)?;
        let number = match value {
            Value::Number(number) => number.as_f64(),
            Value::String(text) => text.trim().parse().ok(),
            _ => None,
        };
        if number.is_none() {
            return self.wrong_form(name, value, wanted);
        }
        if value.is_string() {
            self.converted(name, value, wanted);
        }
        number
    }

    fn kept(&self, text: &str, spot: PayloadPath<'_>) -> String {
        let Some((end, _)) = text.char_indices().nth(LONGEST_TEXT) else {
            return text.to_owned();
        };
        self.notes.add(|_| Oddity::LongText { place: spot.to_string(), length: text.chars().count() });
        text.get(..end).unwrap_or_default().to_owned()
    }

    /// The parser bounds the depth, and so the recursion.
    fn within_limits(&self, value: &Value, spot: PayloadPath<'_>) -> Value {
        match value {
            Value::String(text) => Value::String(self.kept(text, spot)),
            Value::Array(elements) => {
                let elements = self.cut(elements, spot).iter().enumerate();
                elements
                    .map(|(index, element)| self.within_limits(element, PayloadPath::Item(&spot, index)))
                    .collect()
            }
            Value::Object(fields) => {
                let kept = |key: &str| key.chars().take(LONGEST_TEXT).collect::<String>();
                let fields = fields.iter();
                fields.map(|(key, field)| (kept(key), self.within_limits(field, spot))).collect()
            }
            plain => plain.clone(),
        }
    }

    fn converted(&self, name: &WireName, value: &Value, wanted: &'static str) {
        let place = self.field(name);
        self.notes.add(|_| Oddity::Converted { place: place.to_string(), found: form(value), wanted });
    }

    fn bad_number<T>(&self, name: &WireName, number: f64) -> Option<T> {
        let place = self.field(name);
        self.notes.add(|_| Oddity::BadNumber { place: place.to_string(), number: number.to_string() });
        None
    }

    fn wrong_form<T>(&self, name: &WireName, value: &Value, wanted: &'static str) -> Option<T> {
        self.wrong_form_at(self.field(name), value, wanted);
        None
    }

    fn wrong_form_at(&self, spot: PayloadPath<'_>, value: &Value, wanted: &'static str) {
        self.notes.add(|_| Oddity::WrongForm { place: spot.to_string(), found: form(value), wanted });
    }
}

fn quote(text: &str) -> String {
    text.chars().take(LONGEST_QUOTE).collect()
}
