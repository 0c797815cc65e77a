//! Trials of maps before anything is built: the order, the result, and running one at a time.
//!
//! Main types: [`TrialOrder`], [`TrialFigures`], [`Trials`]. The program that runs the API supplies the simulation.
//! Refuses: two trials at once, since the server's fleet uses the same processors.

use giveway_floor::id::NodeId;
use giveway_floor::time::Span;
use giveway_floor::warehouse::Warehouse;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Semaphore, oneshot};

/// The parameters of a trial.
#[derive(Clone, Debug)]
pub struct TrialOrder {
    /// The map; it has stations and racks, and a place to stay for every robot.
    pub map: Arc<Warehouse>,
    /// How many robots drive.
    pub robots: usize,
    /// Jobs per hour; nothing for as many as the robots can do.
    pub jobs_per_hour: Option<f64>,
    /// The simulated time.
    pub span: Span,
    /// The seed of the random numbers.
    pub seed: u64,
    /// The trial ends after this much real time, with the result so far.
    pub patience: Duration,
}

/// The result of a trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialFigures {
    /// How much time was simulated.
    pub simulated: Span,
    /// How much real time the trial took.
    pub took: Duration,
    /// Racks that were served.
    pub deliveries: u64,
    /// Mean time from when a robot got a job until it was done; nothing if no job was done.
    pub mean_job: Option<Span>,
    /// How long robots waited for each other, for queues and for routes, by node.
    pub waited: Vec<(NodeId, Span)>,
    /// How often a law of the floor was broken.
    pub law_violations: u64,
    /// The first violations, in words.
    pub broken: Vec<String>,
}

/// Simulates a trial. An error tells people why the map does not suit this fleet.
pub type Simulate = dyn Fn(TrialOrder) -> Result<TrialFigures, String> + Send + Sync;

/// Why a trial has no result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoTrial {
    /// Another trial runs.
    Busy,
    /// This program cannot simulate.
    Nowhere,
    /// The map does not suit this fleet, for the given reason.
    Unfit(String),
    /// The trial ended before it was done: a bug in the program.
    Broken,
}

/// Runs trials, one at a time.
#[derive(Clone)]
pub struct Trials {
    simulate: Option<Arc<Simulate>>,
    room: Arc<Semaphore>,
}

impl Default for Trials {
    fn default() -> Trials {
        Trials { simulate: None, room: Arc::new(Semaphore::new(1)) }
    }
}

impl Trials {
    /// Trials with this simulation.
    pub fn by(simulate: Arc<Simulate>) -> Trials {
        Trials { simulate: Some(simulate), ..Trials::default() }
    }

    /// Runs a trial on a thread of its own, with lower priority than all other work of the program.
    ///
    /// # Errors
    /// Why the trial has no result.
    pub async fn run(&self, order: TrialOrder) -> Result<TrialFigures, NoTrial> {
        let simulate = self.simulate.clone().ok_or(NoTrial::Nowhere)?;
        let place = self.room.clone().try_acquire_owned().map_err(|_| NoTrial::Busy)?;
        let (reply, answer) = oneshot::channel();
        let work = move || {
            // The place is kept until the work has ended, even if no client waits any more.
            let _place = place;
            #[cfg(target_os = "linux")]
            let _ = rustix::process::nice(10);
            let _ = reply.send(simulate(order));
        };
        let thread = std::thread::Builder::new().name("trial".into());
        thread.spawn(work).map_err(|_| NoTrial::Busy)?;
        answer.await.map_err(|_| NoTrial::Broken)?.map_err(NoTrial::Unfit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    fn order() -> TrialOrder {
        let map = Arc::new(giveway_floor::warehouse::lab());
        let span = Span::from_secs(60);
        TrialOrder { map, robots: 1, jobs_per_hour: None, span, seed: 1, patience: Duration::from_secs(1) }
    }

    #[tokio::test]
    async fn one_runs_at_a_time_and_the_next_one_when_it_has_ended() {
        let (go, wait) = std::sync::mpsc::channel::<()>();
        let wait = Mutex::new(wait);
        let trials = Trials::by(Arc::new(move |_| {
            let _ = wait.lock().expect("nobody panics with it").recv();
            Ok(TrialFigures::default())
        }));
        let first = tokio::spawn({
            let trials = trials.clone();
            async move { trials.run(order()).await }
        });
        while trials.room.available_permits() > 0 {
            tokio::task::yield_now().await;
        }
        assert_eq!(trials.run(order()).await, Err(NoTrial::Busy));
        go.send(()).expect("it listens");
        assert_eq!(first.await.expect("it ends"), Ok(TrialFigures::default()));
        while trials.room.available_permits() == 0 {
            tokio::task::yield_now().await;
        }
        go.send(()).expect("it listens");
        assert!(trials.run(order()).await.is_ok());
    }

    #[tokio::test]
    async fn a_simulation_that_panics_gives_its_place_back() {
        let trials = Trials::by(Arc::new(|_| panic!("a mistake")));
        assert_eq!(trials.run(order()).await, Err(NoTrial::Broken));
        while trials.room.available_permits() == 0 {
            tokio::task::yield_now().await;
        }
        assert_eq!(trials.run(order()).await, Err(NoTrial::Broken));
        assert_eq!(Trials::default().run(order()).await, Err(NoTrial::Nowhere));
    }
}
