//! The whole experiment in small.
