//! What was promised and what is seen: the ledger with its facts, what goes into a step and comes out, the scene.
//!
//! Main types: [`ledger::Ledger`] (a fold over [`fact::Fact`]s), [`scene::Scene`], [`io::Input`], [`io::Step`].
//! Refuses: to decide anything; it knows no other part of the core.

pub mod activity;
pub mod arms;
pub(crate) mod at_hand;
pub(crate) mod binding;
pub(crate) mod closed_areas;
pub mod cut_off;
pub mod displaced;
pub mod fact;
pub(crate) mod fault;
pub(crate) mod floor;
pub(crate) mod heard;
pub mod index;
pub mod io;
pub mod job;
pub mod job_kind;
pub(crate) mod keys;
pub(crate) mod kind;
pub(crate) mod kinds;
pub mod ledger;
pub mod life;
pub mod link;
pub mod local_clock;
pub(crate) mod needs;
pub mod note;
pub(crate) mod passing;
pub(crate) mod planners;
pub mod recurring;
pub mod refusal;
pub(crate) mod regions;
pub mod request;
pub(crate) mod restrictions;
pub(crate) mod robot_clock;
pub mod scene;
pub(crate) mod settings;
mod stays;
pub(crate) mod storage;
mod tasks;
pub(crate) mod tickets;
pub(crate) mod visits;
pub(crate) mod wait_graph;
pub mod why;
pub(crate) mod wishes;
pub mod worker;
pub(crate) mod writer;
pub(crate) mod yielding;
