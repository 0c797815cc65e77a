//! What the statements of the store cost on an old database.

mod aged;
mod plans;
mod year;
