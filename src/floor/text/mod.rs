//! Text that people and other programs submit, and what they are told: names of things, tables, sentences.
//!
//! [`sentence`] lists all sentences for people, each with a code. [`name_fault`] finds names that cannot be told apart
//! by eye; [`TextTable`] reads delimited text as spreadsheets and other programs write it. Refuses: to know the purpose
//! of a name or a column.

mod name;
pub mod sentence;
mod table;

pub use name::{NameFault, name_fault};
pub use sentence::{Sentence, SentenceArg, SentenceArgs};
pub use table::{TableFault, TextTable, TextTableRow};
