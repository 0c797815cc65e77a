//! The laboratory from outside: what its program prints, and what docs pages show of it.

mod reports;
mod stories;
