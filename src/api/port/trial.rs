//! Maps that are tried out before anything is built: what a trial is asked, what it answers, and one at a time.
//!
//! Main types: [`TrialOrder`], [`TrialFigures`], [`Trials`]. What simulates is handed in by the program that runs the
//! API. Refuses: two at once, since the fleet of the server has the same processors.

use giveway_floor::id::NodeId;
use giveway_floor::time::Span;
use giveway_floor::warehouse::Warehouse;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Semaphore, oneshot};

/// What to try.
#[derive(Clone, Debug)]
pub struct TrialOrder {
    /// The map; it has stations and racks, and a place to stay for every robot.
    pub map: Arc<Warehouse>,
    /// How many robots.
    pub robots: usize,
    /// So many jobs an hour; nothing for as many as the robots can do.
    pub jobs_per_hour: Option<f64>,
    /// How long, of simulated time.
    pub span: Span,
    /// Of the dice.
    pub seed: u64,
    /// It ends after so much real time, with what happened until then.
    pub patience: Duration,
}

/// What came out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialFigures {
    /// How much time was simulated.
    pub simulated: Span,
    /// How much real time that took.
    pub took: Duration,
    /// Racks that were served.
    pub deliveries: u64,
    /// From when a robot was given a job until it was done, on average; nothing where none was.
    pub mean_job: Option<Span>,
    /// How long robots waited for one another, for queues and for ways, and where.
    pub waited: Vec<(NodeId, Span)>,
    /// How often a law of the floor was broken.
    pub law_violations: u64,
    /// The first of these, in words.
    pub broken: Vec<String>,
}

/// Simulates. An error says for people why the map is not for this fleet.
pub type Simulate = dyn Fn(TrialOrder) -> Result<TrialFigures, String> + Send + Sync;

/// Why there are no figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoTrial {
    /// Another one runs.
    Busy,
    /// This program simulates nothing.
    Nowhere,
    /// The map is not for this fleet, for the reason told.
    Unfit(String),
    /// It ended before it was done: a mistake in the program.
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
    /// Trials by this simulation.
    pub fn by(simulate: Arc<Simulate>) -> Trials {
        Trials { simulate: Some(simulate), ..Trials::default() }
    }

    /// Runs one on a thread of its own, after all other work of the program.
    ///
    /// # Errors
    /// Why there are no figures.
    pub async fn run(&self, order: TrialOrder) -> Result<TrialFigures, NoTrial> {
        let simulate = self.simulate.clone().ok_or(NoTrial::Nowhere)?;
        let place = self.room.clone().try_acquire_owned().map_err(|_| NoTrial::Busy)?;
        let (reply, answer) = oneshot::channel();
        let work = move || {
            // The place is kept until the work has ended, whoever still listens.
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
