//! Tests of the virtual robot.
//!
//! Everything happens in memory, on a clock that the test sets. Refuses: JSON and brokers.

mod body;
