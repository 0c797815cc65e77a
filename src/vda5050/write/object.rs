//! The fields of an object of a message, under the names of a version.
//!
//! Main type: [`ObjectWriter`]. A field for which the version has no name is not written. Refuses: numbers that are not
//! finite.

use crate::version::Version;
use crate::vocabulary::{WireName, WireWords};
use serde_json::{Map, Value};
use std::f64::consts::{PI, TAU};

/// An object that is being written.
pub(super) struct ObjectWriter {
    version: Version,
    fields: Map<String, Value>,
}

impl ObjectWriter {
    pub(super) fn new(version: Version) -> ObjectWriter {
        ObjectWriter { version, fields: Map::new() }
    }

    pub(super) fn into_value(self) -> Value {
        Value::Object(self.fields)
    }

    /// Whether the version has a field.
    pub(super) fn has(&self, name: &WireName) -> bool {
        name.of(self.version).is_some()
    }

    pub(super) fn put(&mut self, name: &WireName, value: impl Into<Value>) {
        if let Some(key) = name.of(self.version) {
            self.fields.insert(key.to_owned(), value.into());
        }
    }

    pub(super) fn put_any(&mut self, name: &WireName, value: Option<impl Into<Value>>) {
        if let Some(value) = value {
            self.put(name, value);
        }
    }

    pub(super) fn number(&mut self, name: &WireName, number: impl Into<Option<f64>>) {
        self.put_any(name, number.into().filter(|number| number.is_finite()));
    }

    /// A number that the schema does not want below 0.
    pub(super) fn magnitude(&mut self, name: &WireName, number: impl Into<Option<f64>>) {
        self.number(name, number.into().map(|number| if number < 0.0 { 0.0 } else { number }));
    }

    /// A number that must be written: 0 if it is not known.
    pub(super) fn magnitude_or_zero(&mut self, name: &WireName, number: Option<f64>) {
        self.magnitude(name, number.filter(|number| number.is_finite()).unwrap_or(0.0));
    }

    /// A share of 1, written in percent.
    pub(super) fn share(&mut self, name: &WireName, share: impl Into<Option<f64>>) {
        self.number(name, share.into().map(|share| share.clamp(0.0, 1.0) * 100.0));
    }

    pub(super) fn angle(&mut self, name: &WireName, angle: impl Into<Option<f64>>) {
        self.number(name, angle.into().map(normal_angle));
    }

    pub(super) fn word<T: Copy + PartialEq>(&mut self, name: &WireName, words: &WireWords<T>, value: T) {
        self.put_any(name, words.word(value, self.version));
    }

    /// A list of words, without the values for which the version has none.
    pub(super) fn words<T: Copy + PartialEq>(&mut self, name: &WireName, words: &WireWords<T>, values: &[T]) {
        let known: Vec<_> = values.iter().filter_map(|value| words.word(*value, self.version)).collect();
        self.put(name, known);
    }

    pub(super) fn object(&mut self, name: &WireName, write: impl FnOnce(&mut ObjectWriter)) {
        let mut object = ObjectWriter::new(self.version);
        write(&mut object);
        self.put(name, object.into_value());
    }

    pub(super) fn list<'e, T: 'e>(
        &mut self,
        name: &WireName,
        elements: impl IntoIterator<Item = &'e T>,
        write: impl Fn(&mut ObjectWriter, &T),
    ) {
        let each = |element| {
            let mut object = ObjectWriter::new(self.version);
            write(&mut object, element);
            object.into_value()
        };
        let list: Vec<Value> = elements.into_iter().map(each).collect();
        self.put(name, list);
    }
}

/// The same angle within [-π, π]; one that is already there is not changed.
fn normal_angle(angle: f64) -> f64 {
    if angle.abs() <= PI {
        return angle;
    }
    (angle - TAU * (angle / TAU).round()).clamp(-PI, PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_is_brought_within_half_a_turn_and_stays_the_same_direction() {
        for angle in [0.0, PI, -PI, 3.2, -3.2, TAU, 100.0, -1e6, 5.0 * PI] {
            let normal = normal_angle(angle);
            assert!(normal.abs() <= PI, "{angle}: {normal}");
            assert!((normal.cos() - angle.cos()).abs() < 1e-6, "{angle}: {normal}");
            assert!((normal.sin() - angle.sin()).abs() < 1e-6, "{angle}: {normal}");
        }
        assert!(normal_angle(f64::NAN).is_nan() && normal_angle(f64::INFINITY).is_nan());
    }
}
