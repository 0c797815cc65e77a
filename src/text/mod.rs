//! Text that people and other programs hand in: names of things, and tables.
//!
//! [`name_fault`] says which names cannot be told apart by eye; [`TextTable`] reads delimited text as spreadsheets and
//! other programs write it. Refuses: to know what a name or a column is for.

mod name;
mod table;

pub use name::{NameFault, name_fault};
pub use table::{TableFault, TextTable, TextTableRow};
