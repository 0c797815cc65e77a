//! Texts that somebody broke: JSON with values changed, moved, doubled and left out, and any text with bytes changed.
//!
//! Main type: [`Mutator`]. The same seed breaks the same text in the same way. Refuses: to know what a text means.

use serde_json::{Map, Value, json};

/// A stream of numbers (SplitMix64) that breaks texts.
pub struct Mutator(u64);

impl Mutator {
    pub fn new(seed: u64) -> Mutator {
        Mutator(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// One of these.
    pub fn choose<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    /// A broken text: of JSON mostly JSON again, with one to four changes.
    pub fn text(&mut self, text: &str) -> String {
        let changes = 1 + self.below(4);
        match serde_json::from_str::<Value>(text) {
            Ok(mut value) if self.below(8) > 0 => {
                (0..changes).for_each(|_| self.value(&mut value));
                value.to_string()
            }
            _ => self.bytes(text, changes),
        }
    }

    /// Changes a value, or one somewhere inside it.
    pub fn value(&mut self, value: &mut Value) {
        let goes_in = self.below(10) > 0;
        match value {
            Value::Array(items) if goes_in && !items.is_empty() => {
                let i = self.below(items.len());
                match self.below(12) {
                    0 => drop(items.remove(i)),
                    1 => items.insert(i, items[i].clone()),
                    2 => items.reverse(),
                    _ => self.value(&mut items[i]),
                }
            }
            Value::Object(fields) if goes_in && !fields.is_empty() => self.field(fields),
            other => *other = self.other_than(other),
        }
    }

    fn field(&mut self, fields: &mut Map<String, Value>) {
        let i = self.below(fields.len());
        let key = fields.keys().nth(i).expect("there are as many").clone();
        match self.below(12) {
            0 => drop(fields.remove(&key)),
            1 => {
                let value = fields.remove(&key).expect("it was there");
                fields.insert(format!("{key}{}", self.below(10)), value);
            }
            2 => {
                let j = self.below(fields.len());
                let from = fields.values().nth(j).expect("there are as many").clone();
                fields.insert(key, from);
            }
            _ => self.value(fields.get_mut(&key).expect("it is there")),
        }
    }

    fn other_than(&mut self, value: &Value) -> Value {
        let extremes = [
            json!(0),
            json!(-1),
            json!(1),
            json!(2),
            json!(0.5),
            json!(1e-308),
            json!(1e308),
            json!(-1e308),
            json!(i64::MAX),
            json!(i64::MIN),
            json!(u64::MAX),
            json!(4_294_967_296_u64),
            Value::Null,
            json!(true),
            json!(""),
            json!("\u{0}\u{202e}\u{1f916}"),
            json!("x".repeat(300)),
            json!([]),
            json!({}),
            json!([[1.0, 2.0], [1.0, 2.0]]),
        ];
        match value {
            Value::Number(n) if n.as_i64().is_some() && self.below(3) > 0 => {
                let n = n.as_i64().unwrap_or(0);
                let others = [
                    n.wrapping_mul(2),
                    n / 3,
                    n.wrapping_neg(),
                    n.wrapping_add(1),
                    n.wrapping_sub(1),
                    n ^ 64,
                ];
                json!(*self.choose(&others))
            }
            Value::Number(n) if self.below(3) > 0 => {
                let n = n.as_f64().unwrap_or(0.0);
                json!([n * 2.0, n / 3.0, -n, n + 1.0, n - 1.0, n * 1e6][self.below(6)])
            }
            Value::String(text) if self.below(3) > 0 => json!(self.bytes(text, 1)),
            _ => self.choose(&extremes).clone(),
        }
    }

    /// Cuts, doubles, swaps and replaces characters.
    fn bytes(&mut self, text: &str, changes: usize) -> String {
        let mut all: Vec<char> = text.chars().collect();
        for _ in 0..changes {
            let (i, j) = (self.below(all.len() + 1), self.below(all.len() + 1));
            let (from, to) = (i.min(j), i.max(j));
            match self.below(7) {
                0 => all.truncate(i),
                1 => drop(all.drain(from..to.min(from + 40))),
                2 => {
                    let some: Vec<char> = all[from..to.min(from + 40)].to_vec();
                    all.splice(i..i, some);
                }
                3 => all.insert(
                    i,
                    *self.choose(&['"', '{', '}', '[', ']', ',', '\u{0}', '\n', '9', '-', 'e', 'ß']),
                ),
                4 if from < all.len() && to < all.len() => all.swap(from, to),
                _ if i < all.len() => all[i] = *self.choose(&['0', '9', 'x', ' ', ';', '.', '\u{fffd}']),
                _ => all.push('1'),
            }
        }
        all.into_iter().collect()
    }
}
