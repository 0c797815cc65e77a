//! Measurements that others can repeat: published tables, stories and benchmark floors.
//!
//! Main modules: [`grid`] (benchmark floors as text), [`lifelong`] (goals reached per step under pebble rules),
//! [`planning`] (one route among many), [`distances`] (ways to goals repaired), [`stories`] (intentions recognised),
//! [`plot`] (charts), [`safe_space`] (published safe distances), [`table`] (robots and people under four policies),
//! [`price`] (what people cost robots, and robots people), [`robot_time`] (what robots wait for), [`stations`] (what
//! picking stations gain by lines and hands), [`picks`] (where recorded hands go), [`objects`] (which object a person
//! fetches), [`arm`] (a robot arm beside a picker), [`corridor`] (robots that leave the line to pass a worker),
//! [`alarms`] (which alarms follow from faults), [`steps`] (what a step costs), [`joint`] (what planning a few robots
//! together costs), [`month`] (what the fleet keeps over time), [`statistics`]. Refuses: to read files or clocks; the
//! caller passes texts in and takes figures out.

// The crate's own printing macros, which survive a closed pipe.
#[macro_use]
extern crate giveway;

pub mod alarms;
pub mod arm;
pub mod commands;
pub mod corridor;
mod dice;
pub mod distances;
pub mod grid;
pub mod joint;
pub mod learning;
pub mod lifelong;
pub mod month;
pub mod objects;
pub mod picks;
pub mod planning;
pub mod plot;
pub mod price;
pub mod recorded;
pub mod robot_time;
pub mod safe_space;
pub mod stations;
pub mod statistics;
pub mod steps;
pub mod stories;
pub mod table;
