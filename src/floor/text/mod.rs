//! Text that people and other programs hand in, and what is said to them: names of things, tables, sentences.
//!
//! [`sentence`] lists all sentences for people, each with a code. [`name_fault`] says which names cannot be told apart
//! by eye; [`TextTable`] reads delimited text as spreadsheets and other programs write it. Refuses: to know what a name
//! or a column is for.

mod name;
pub mod sentence;
mod table;

pub use name::{NameFault, name_fault};
pub use sentence::{Sentence, SentenceArg, SentenceArgs};
pub use table::{TableFault, TextTable, TextTableRow};
