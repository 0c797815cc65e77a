//! What was promised and what is seen: the ledger with its facts, what goes into a step and comes out, the scene.
//!
//! Main types: [`ledger::Ledger`] (a fold over [`fact::Fact`]s), [`scene::Scene`], [`io::Input`], [`io::Step`].
//! Refuses: to decide anything; it knows no other room.

pub mod activity;
pub mod arms;
pub(in crate::fleet) mod at_hand;
pub(in crate::fleet) mod binding;
pub(in crate::fleet) mod closed_areas;
pub mod cut_off;
pub mod displaced;
pub mod fact;
pub(in crate::fleet) mod fault;
pub(in crate::fleet) mod floor;
pub(in crate::fleet) mod heard;
pub mod index;
pub mod io;
pub mod job;
pub mod job_kind;
pub(in crate::fleet) mod keys;
pub(in crate::fleet) mod kind;
pub mod ledger;
pub mod life;
pub mod local_clock;
pub(in crate::fleet) mod needs;
pub mod note;
pub(in crate::fleet) mod passing;
pub(in crate::fleet) mod planners;
pub mod recurring;
pub mod refusal;
pub(in crate::fleet) mod regions;
pub mod request;
pub(in crate::fleet) mod restrictions;
pub(in crate::fleet) mod robot_clock;
pub mod scene;
pub(in crate::fleet) mod settings;
mod stays;
pub(in crate::fleet) mod storage;
mod tasks;
pub(in crate::fleet) mod tickets;
pub(in crate::fleet) mod visits;
pub(in crate::fleet) mod wait_graph;
pub mod why;
pub(in crate::fleet) mod wishes;
pub mod worker;
pub(in crate::fleet) mod writer;
pub(in crate::fleet) mod yielding;
