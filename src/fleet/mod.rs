//! STUB for the server side; the real core replaces this file.
pub mod fact;
pub mod io;
pub mod job;
pub mod view;
use crate::id::*;
use crate::route::Kinematics;
use crate::time::*;
use crate::warehouse::Warehouse;
pub use fact::*;
pub use io::*;
pub use job::*;
use std::sync::Arc;
pub use view::*;
/// Settings of the core.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Robots' figures.
    pub kinematics: Kinematics,
    /// Control period.
    pub period: Span,
}
/// The core.
pub struct Fleet {
    warehouse: Arc<Warehouse>,
    jobs: std::collections::BTreeMap<JobId, Job>,
}
impl Fleet {
    /// An empty fleet.
    pub fn new(warehouse: Arc<Warehouse>, _s: Settings) -> Fleet {
        Fleet { warehouse, jobs: Default::default() }
    }
    /// The fleet after these facts.
    pub fn restore(warehouse: Arc<Warehouse>, s: Settings, facts: impl IntoIterator<Item = Fact>) -> Fleet {
        let _ = facts.into_iter().count();
        Fleet::new(warehouse, s)
    }
    /// One step.
    pub fn step(&mut self, now: Time, inputs: Vec<Input>) -> Step {
        let mut out = Step::default();
        for i in inputs {
            match i {
                Input::Submit { token, request } => {
                    let job = JobId(self.jobs.len() as u64 + 1);
                    out.facts.push(Fact::Accepted { job, request: request.clone(), at: now });
                    self.jobs.insert(job, Job { request, state: JobState::Waiting, accepted: now });
                    out.replies.push(Reply::Accepted { token, job, new: true });
                }
                Input::Cancel { token, job } => {
                    out.facts.push(Fact::Progressed { job, state: JobState::Cancelled, at: now });
                    out.replies.push(Reply::Cancelled { token, job });
                }
                _ => {}
            }
        }
        out
    }
    /// The read model.
    pub fn view(&self, now: Time) -> View {
        View { now, ..View::default() }
    }
    /// The building.
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        &self.warehouse
    }
}
