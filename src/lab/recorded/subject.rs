//! The belief about a recorded person after some samples, by the same filters that the server runs.
//!
//! Main types: [`Ground`] (goals of a recording), [`Subject`] (one person, sample by sample). Refuses: to look ahead.

use giveway_floor::geometry::Point;
use giveway_floor::id::GoalId;
use giveway_floor::time::Time;
use giveway_people::human::motion::{Fix, Motion, Use};
use giveway_people::human::{Belief, Distances, Forecast, Hypothesis, Intention, Method, Model};

/// Goals of a recording on an open floor.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Positions of the goals.
    pub goals: Vec<Point>,
    distances: Distances,
}

impl Ground {
    /// The ground with these goals; none are known if the list is empty.
    pub fn new(goals: &[Point]) -> Ground {
        let mut distances = Distances::in_the_open();
        goals.iter().enumerate().for_each(|(i, at)| distances.add_goal(GoalId(i as u64), *at));
        Ground { goals: goals.to_vec(), distances }
    }
}

/// One person as the server would see it.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    ground: &'a Ground,
    model: &'a Model,
    motion: Motion,
    intention: Intention,
    sigma_m: f64,
    last: Option<Point>,
}

impl<'a> Subject<'a> {
    /// A person before the first sample. `sigma_m` is the stated accuracy of positions.
    pub fn new(ground: &'a Ground, model: &'a Model, method: Method, sigma_m: f64) -> Subject<'a> {
        let mut intention = Intention::new(method, model);
        for i in 0..ground.goals.len() {
            // A method without room for all goals ignores the last ones.
            let _ = intention.add_goal(GoalId(i as u64), 1.0);
        }
        intention.expect_error(sigma_m);
        Subject { ground, model, motion: Motion::new(model.motion), intention, sigma_m, last: None }
    }

    /// Processes a sample.
    pub fn see(&mut self, seen: Time, at: Point) {
        let used = self.motion.see(Fix { seen, at, sigma_m: self.sigma_m });
        if used != Use::Late && !self.ground.goals.is_empty() {
            self.intention.observe(seen, at, None, &self.ground.distances);
        }
        self.last = Some(at);
    }

    /// The person's motion filter.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// The belief about the person's goal.
    pub fn belief(&self) -> Belief {
        self.intention.belief()
    }

    /// Straight ways to all goals.
    pub fn ways(&self) -> Vec<Hypothesis> {
        let Some(from) = self.motion.seen().and_then(|t| self.motion.ahead(t)) else { return Vec::new() };
        let goals = self.belief().goals.into_iter();
        goals
            .map(|(g, probability)| {
                let path = vec![from.at, self.ground.goals[g.0 as usize]];
                Hypothesis { probability, path, stay: None }
            })
            .collect()
    }

    /// Calls `f` with the forecast of the person.
    pub fn forecast<R>(&self, f: impl FnOnce(&Forecast<'_>) -> R) -> R {
        let ways = self.ways();
        let (bound, free) = (&self.model.bound, &self.model.free);
        f(&Forecast { motion: &self.motion, ways: &ways, bound, free })
    }
}
