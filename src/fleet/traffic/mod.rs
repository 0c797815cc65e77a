//! Routes and grants: which robots need a route, what has come true, what is late, how far each robot may drive now.
//!
//! Main functions: `note_progress`, `plan`, `grant`. Refuses: to decide what a robot does.

pub(in crate::fleet) mod closed_areas;
pub(in crate::fleet) mod closures;
pub(in crate::fleet) mod displaced;
pub(in crate::fleet) mod fence;
pub(in crate::fleet) mod grant;
pub(in crate::fleet) mod joint;
pub(in crate::fleet) mod plan;
pub(in crate::fleet) mod planners;
pub(in crate::fleet) mod progress;
pub(in crate::fleet) mod truncate;
