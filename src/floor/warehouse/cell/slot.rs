//! Names of slots: a letter for the column from the picker's left, a number for the row from below.
//!
//! Main type: [`SlotName`]. Refuses: names that no rack can have.

use std::fmt;
use std::str::FromStr;

/// Largest number of columns of a rack, `A` to `Z` …
pub const COLUMNS_MAX: u8 = 26;
/// … and largest number of rows.
pub const ROWS_MAX: u8 = 20;

/// A slot of a rack: `A1` is in the leftmost column and the lowest row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SlotName {
    row: u8,
    column: u8,
}

/// A text that is not the name of a slot.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no slot: give a column from A to Z and a row from 1 to {ROWS_MAX}, such as C3")]
pub struct SlotNameError(String);

impl SlotName {
    /// The slot of a column and a row, both from 0.
    ///
    /// # Panics
    /// If no rack has that many columns or rows.
    pub fn new(column: u8, row: u8) -> SlotName {
        assert!(column < COLUMNS_MAX && row < ROWS_MAX, "column {column}, row {row}");
        SlotName { row, column }
    }

    /// The column from the picker's left, from 0.
    pub fn column(self) -> u8 {
        self.column
    }

    /// The row from below, from 0.
    pub fn row(self) -> u8 {
        self.row
    }
}

impl fmt::Display for SlotName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", char::from(b'A' + self.column), self.row + 1)
    }
}

impl FromStr for SlotName {
    type Err = SlotNameError;

    fn from_str(text: &str) -> Result<SlotName, SlotNameError> {
        let parts = || {
            let (column, row) = text.split_at_checked(1)?;
            let column = column.bytes().next().filter(u8::is_ascii_uppercase)? - b'A';
            // Neither a sign nor leading zeros: each slot has one name.
            let is_plain = row.bytes().all(|b| b.is_ascii_digit()) && !row.starts_with('0');
            let row = row.parse::<u8>().ok().filter(|r| is_plain && (1..=ROWS_MAX).contains(r))? - 1;
            Some(SlotName { row, column })
        };
        parts().ok_or_else(|| SlotNameError(text.chars().take(40).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_as_it_is_written() {
        for column in 0..COLUMNS_MAX {
            for row in 0..ROWS_MAX {
                let slot = SlotName::new(column, row);
                assert_eq!(slot.to_string().parse(), Ok(slot));
            }
        }
        assert_eq!(SlotName::new(2, 2).to_string(), "C3");
    }

    #[test]
    fn what_is_no_slot_is_refused_with_an_example() {
        for text in
            ["", "A", "1", "A0", "a1", "A01", "A21", "A+1", "AA1", "A1 ", "Ä1", "1A", "A1.0", "A256", "A-1"]
        {
            let error = text.parse::<SlotName>().unwrap_err();
            assert!(error.to_string().contains("such as C3"), "{text}: {error}");
        }
    }
}
