//! What the statements of the store cost on a database that has grown old.

mod aged;
mod plans;
mod year;
