//! The edges from outside: a real server on a port of its own, a real database in a folder of its own.
//!
//! One file per subject; [`helper`] starts servers and speaks HTTP. Refuses: to reach into the parts.

#![cfg(feature = "edge")]

mod alarms;
mod api;
mod attacks;
mod audit;
mod authority;
mod carry;
mod command;
mod custody;
mod database;
mod description;
mod enrolment;
mod events;
mod faults;
mod feed;
mod fence;
mod filters;
mod fixture;
mod growth;
mod guard;
mod hands;
mod helper;
mod history;
mod jobs;
mod journal;
mod lines;
mod live;
mod load;
mod maps;
mod meaning;
mod measured;
mod mutated;
mod oidc;
mod once;
mod origins;
mod page_filters;
mod page_fixtures;
mod past;
mod people;
mod privacy;
mod publish;
mod recovery;
mod reports;
mod robots;
mod roles;
mod room;
mod run;
mod schema;
mod sessions;
mod set_clock;
mod stations;
mod stops;
mod store;
mod strangers;
mod tls;
mod tokens;
mod webhooks;
mod why;
