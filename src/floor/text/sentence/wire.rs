//! Sentences on the wire and in storage: `{"code", "args", "text"}`, where an argument is a text, a number, a list, or
//! a sentence of the same form.
//!
//! Main type: [`SentenceArgs`]. A bare text is read as a sentence without a code: recordings and databases of earlier
//! versions have such texts. Refuses: to make a text from a code that it read; the text is written beside it.

use super::arg::ten_to;
use super::{SENTENCES, Sentence, SentenceArg};
use serde::de::{Deserializer, Error as _};
use serde::ser::{SerializeMap, SerializeStruct, Serializer};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::borrow::Cow;

/// The values of the places of a sentence, by their names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SentenceArgs(pub(super) Box<[(Cow<'static, str>, SentenceArg)]>);

impl SentenceArgs {
    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Serialize for SentenceArgs {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, arg) in &*self.0 {
            map.serialize_entry(name, arg)?;
        }
        map.end()
    }
}

impl Serialize for SentenceArg {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            SentenceArg::Text(text) => serializer.serialize_str(text),
            SentenceArg::Number(n) => serializer.serialize_i64(*n),
            SentenceArg::Decimal(n, digits) => serializer.serialize_f64(*n as f64 / ten_to(*digits)),
            SentenceArg::Sentence(sentence) => sentence.serialize(serializer),
            SentenceArg::List(all) => all.serialize(serializer),
        }
    }
}

impl Serialize for Sentence {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut sentence = serializer.serialize_struct("Sentence", 3)?;
        sentence.serialize_field("code", &self.code)?;
        sentence.serialize_field("args", &self.args)?;
        sentence.serialize_field("text", &self.text)?;
        sentence.end()
    }
}

impl<'de> Deserialize<'de> for Sentence {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Sentence, D::Error> {
        let value = Value::deserialize(deserializer)?;
        read(&value).ok_or_else(|| D::Error::custom("neither a text nor a sentence with code, args and text"))
    }
}

fn read(value: &Value) -> Option<Sentence> {
    if let Value::String(text) = value {
        return Some(Sentence::without_code(text));
    }
    let text = value.get("text")?.as_str()?;
    let code = value.get("code").and_then(Value::as_str);
    // A newer version may know other codes.
    let known = |code| SENTENCES.into_iter().flatten().find(|entry| entry.code == code);
    let Some(entry) = code.and_then(known) else { return Some(Sentence::without_code(text)) };
    let args = value.get("args").and_then(Value::as_object).into_iter().flatten();
    let args = args.filter_map(|(name, arg)| Some((name.clone().into(), read_arg(arg)?))).collect();
    Some(Sentence { code: Some(entry.code), args: SentenceArgs(args), text: text.to_owned() })
}

fn read_arg(value: &Value) -> Option<SentenceArg> {
    match value {
        Value::String(text) => Some(text.into()),
        Value::Number(n) => Some(n.as_i64().map_or_else(|| decimal(n), SentenceArg::Number)),
        Value::Array(all) => Some(SentenceArg::List(all.iter().filter_map(read_arg).collect())),
        Value::Object(_) => read(value).map(Into::into),
        Value::Null | Value::Bool(_) => None,
    }
}

/// A decimal with as many digits as were written.
fn decimal(n: &serde_json::Number) -> SentenceArg {
    let text = n.to_string();
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len().min(9) as u8);
    SentenceArg::rounded(n.as_f64().unwrap_or_default(), digits)
}
