//! Makes a failing case smaller, as long as it fails in the same way.
//!
//! Main function: [`shrink()`]. Greedy: a smaller case is kept if it fails with the same kind of failure, and the next
//! ones are derived from it, until none is smaller. Refuses: to run anything itself.

use super::case::{SwarmCase, SwarmPart};
use super::run::SwarmFailure;
use giveway_floor::time::Time;

/// The smallest case found.
#[derive(Clone, Debug)]
pub struct Shrunk {
    /// The smallest failing case.
    pub case: SwarmCase,
    /// The failure of that case.
    pub failure: SwarmFailure,
    /// How many cases were run.
    pub runs: usize,
}

/// Shrinks a failing case that has this many robots and workers. `run` runs a case; at most `most` are run.
pub fn shrink(
    case: &SwarmCase,
    (robots, workers): (usize, usize),
    failure: &SwarmFailure,
    most: usize,
    mut run: impl FnMut(&SwarmCase) -> Option<SwarmFailure>,
) -> Shrunk {
    let mut best = Shrunk { case: case.clone(), failure: failure.clone(), runs: 0 };
    loop {
        let mut smaller = false;
        for cut in SmallerBy::ALL {
            // A successful cut is tried again.
            while best.runs < most
                && let Some(next) = cut.of(&best, (robots, workers))
            {
                best.runs += 1;
                let Some(failure) = run(&next).filter(|f| f.kind == best.failure.kind) else { break };
                (best.case, best.failure, smaller) = (next, failure, true);
            }
        }
        for &part in SwarmPart::ALL {
            if best.runs >= most || best.case.without.contains(&part) {
                continue;
            }
            let mut next = best.case.clone();
            next.without.insert(part);
            best.runs += 1;
            if let Some(failure) = run(&next).filter(|f| f.kind == best.failure.kind) {
                (best.case, best.failure, smaller) = (next, failure, true);
            }
        }
        if !smaller || best.runs >= most {
            return best;
        }
    }
}

/// A way to make a case smaller.
#[derive(Clone, Copy)]
enum SmallerBy {
    UntilFailure,
    NoWorkers,
    HalfOfRobots,
    HalfOfTime,
    FewerWorkers,
    FewerRobots,
    LessTime,
}

impl SmallerBy {
    const ALL: [SmallerBy; 7] = [
        SmallerBy::UntilFailure,
        SmallerBy::NoWorkers,
        SmallerBy::HalfOfRobots,
        SmallerBy::HalfOfTime,
        SmallerBy::FewerWorkers,
        SmallerBy::FewerRobots,
        SmallerBy::LessTime,
    ];

    /// The smaller case; nothing if it would not be smaller.
    fn of(self, best: &Shrunk, (robots, workers): (usize, usize)) -> Option<SwarmCase> {
        let case = &best.case;
        let (robots, workers) = (case.robots.unwrap_or(robots), case.workers.unwrap_or(workers));
        let with_robots =
            |n: usize| (1..robots).contains(&n).then(|| SwarmCase { robots: Some(n), ..case.clone() });
        let with_workers = |n: usize| (n < workers).then(|| SwarmCase { workers: Some(n), ..case.clone() });
        let with_minutes =
            |n: u32| (1..case.minutes).contains(&n).then(|| SwarmCase { minutes: n, ..case.clone() });
        match self {
            SmallerBy::UntilFailure => {
                let minutes = (best.failure.at - Time::ZERO).as_secs_f64() / 60.0;
                with_minutes(minutes.ceil() as u32)
            }
            SmallerBy::NoWorkers => with_workers(0),
            SmallerBy::HalfOfRobots => with_robots(robots / 2),
            SmallerBy::HalfOfTime => with_minutes(case.minutes / 2),
            SmallerBy::FewerWorkers => with_workers(workers.saturating_sub(1)),
            SmallerBy::FewerRobots => with_robots(robots - 1),
            SmallerBy::LessTime => with_minutes(case.minutes - 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failure(kind: &str, seconds: f64) -> SwarmFailure {
        SwarmFailure { kind: kind.into(), at: Time::from_secs_f64(seconds), words: "planted".into() }
    }

    #[test]
    fn a_case_is_cut_down_to_what_its_failure_needs() {
        // Fails in the same way with five robots, one worker, losses and pushes, for four minutes.
        let run = |case: &SwarmCase| {
            let needed = [SwarmPart::Loss, SwarmPart::Pushes].iter().all(|p| !case.without.contains(p));
            let fails = case.robots.unwrap_or(23) >= 5 && case.workers.unwrap_or(3) >= 1 && case.minutes >= 4;
            (needed && fails).then(|| failure("stuck", 900.0))
        };
        let shrunk = shrink(&SwarmCase::whole(3, 20), (23, 3), &failure("stuck", 900.0), 200, run);
        let case = &shrunk.case;
        assert_eq!((case.robots, case.workers, case.minutes), (Some(5), Some(1), 4));
        assert_eq!(case.without.len(), SwarmPart::ALL.len() - 2);
        assert!(shrunk.runs < 80, "{}", shrunk.runs);
    }

    #[test]
    fn a_smaller_case_that_fails_in_another_way_is_not_taken() {
        let run =
            |case: &SwarmCase| Some(failure(if case.robots.is_some() { "overlap" } else { "stuck" }, 60.0));
        let shrunk = shrink(&SwarmCase::whole(3, 20), (23, 0), &failure("stuck", 60.0), 200, run);
        assert_eq!((shrunk.case.robots, shrunk.case.minutes), (None, 1));
        assert_eq!(shrunk.failure.kind, "stuck");
    }

    #[test]
    fn no_more_cases_are_run_than_are_allowed() {
        let mut runs = 0;
        let shrunk = shrink(&SwarmCase::whole(3, 20), (23, 3), &failure("stuck", 900.0), 7, |_| {
            runs += 1;
            Some(failure("stuck", 900.0))
        });
        assert_eq!((runs, shrunk.runs), (7, 7));
    }
}
