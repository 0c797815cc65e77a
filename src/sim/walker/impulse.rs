//! When each cause comes up: one Poisson process per cause, and the times that the scenario gives.
//!
//! Main types: [`Impulse`], [`Impulses`]. Each cause has its own stream and always takes the same number of draws, so
//! impulses and their times depend on the seed alone, whatever the fleet does. Refuses: to know whether the walker
//! heeds it.

use crate::random::Stream;
use crate::scenario::Deviations;
use giveway_floor::time::{Span, Time};

/// An impulse of a walker. `pick` in `[0, 1)` chooses the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// What the walker has an impulse to do.
    pub kind: ImpulseKind,
    /// Chooses among the available places.
    pub pick: f64,
    /// How long the activity or the stay there takes.
    pub stay: Span,
}

/// Kinds of impulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ImpulseKind {
    /// To stop for a moment.
    Pause,
    /// To look around.
    Look,
    /// To go to another known place.
    Mind,
    /// To go to a place that nobody knows of.
    Unknown,
    /// To walk about.
    Wander,
    /// To help.
    Help,
    /// To do what the scenario scripts.
    Scripted,
}

impl ImpulseKind {
    /// Shortest and longest stay, seconds.
    fn stays(self) -> (f64, f64) {
        match self {
            ImpulseKind::Pause => (3.0, 30.0),
            ImpulseKind::Look => (2.0, 5.0),
            ImpulseKind::Mind => (2.0, 8.0),
            ImpulseKind::Unknown => (5.0, 15.0),
            ImpulseKind::Wander => (10.0, 40.0),
            ImpulseKind::Help => (10.0, 30.0),
            ImpulseKind::Scripted => (3.0, 10.0),
        }
    }
}

#[derive(Debug)]
struct ImpulseClock {
    kind: ImpulseKind,
    mean_s: f64,
    next: Time,
    random: Stream,
}

/// All impulses of one walker, in order of time.
#[derive(Debug)]
pub struct Impulses {
    clocks: Vec<ImpulseClock>,
    scripted: Vec<Time>,
    random: Stream,
}

/// First purpose of the streams, see [`Stream::new`]; the other kinds follow it.
const PURPOSE: u64 = 40;

impl Impulses {
    /// The impulses of worker number `who`, from the start of the run.
    pub(crate) fn new(deviations: &Deviations, seed: u64, who: u64, start: Time) -> Impulses {
        let rates = deviations.causes.rates();
        let kinds = [
            (ImpulseKind::Pause, rates.pause_per_hour),
            (ImpulseKind::Look, rates.look_per_hour),
            (ImpulseKind::Mind, rates.mind_per_hour),
            (ImpulseKind::Unknown, rates.unknown_per_hour),
            (ImpulseKind::Wander, rates.wander_per_hour),
            (ImpulseKind::Help, rates.help_per_hour),
        ];
        let clock = |(i, (kind, per_hour)): (usize, (ImpulseKind, f64))| {
            let mean_s = 3600.0 / per_hour;
            let mut random = Stream::new(seed, PURPOSE + 1 + i as u64, who);
            let next = start + Span::from_secs_f64(random.exponential(mean_s));
            ImpulseClock { kind, mean_s, next, random }
        };
        let clocks = kinds.into_iter().enumerate().filter(|(_, (_, rate))| *rate > 0.0).map(clock).collect();
        let after = |s: &f64| start + Span::from_secs_f64(*s);
        let mut scripted: Vec<Time> = deviations.at_s.iter().map(after).collect();
        scripted.sort_unstable_by(|a, b| b.cmp(a));
        Impulses { clocks, scripted, random: Stream::new(seed, PURPOSE, who) }
    }

    /// The next impulse that has come up by `now`.
    pub fn due(&mut self, now: Time) -> Option<Impulse> {
        if self.scripted.pop_if(|at| *at <= now).is_some() {
            return Some(impulse(ImpulseKind::Scripted, &mut self.random));
        }
        let clock = self.clocks.iter_mut().find(|c| c.next <= now)?;
        let found = impulse(clock.kind, &mut clock.random);
        clock.next += Span::from_secs_f64(clock.random.exponential(clock.mean_s));
        Some(found)
    }
}

fn impulse(kind: ImpulseKind, random: &mut Stream) -> Impulse {
    let pick = random.unit();
    let (low, high) = kind.stays();
    Impulse { kind, pick, stay: Span::from_secs_f64(random.between(low, high)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Causes, Rates};
    use std::collections::BTreeMap;

    #[test]
    fn over_long_runs_each_cause_comes_up_as_often_as_its_rate_says() {
        let deviations = Deviations { at_s: vec![5.0, 3.0], causes: Causes::All };
        let mut impulses = Impulses::new(&deviations, 7, 3, Time::ZERO);
        let hours = 400;
        let mut counts: BTreeMap<ImpulseKind, u32> = BTreeMap::new();
        for second in 0..hours * 3600 {
            while let Some(i) = impulses.due(Time::from_secs_f64(f64::from(second))) {
                *counts.entry(i.kind).or_default() += 1;
                let (low, high) = i.kind.stays();
                assert!((low..=high).contains(&i.stay.as_secs_f64()) && (0.0..1.0).contains(&i.pick));
            }
        }
        let usual = Rates::USUAL;
        for (kind, rate) in [
            (ImpulseKind::Pause, usual.pause_per_hour),
            (ImpulseKind::Look, usual.look_per_hour),
            (ImpulseKind::Mind, usual.mind_per_hour),
            (ImpulseKind::Unknown, usual.unknown_per_hour),
            (ImpulseKind::Wander, usual.wander_per_hour),
            (ImpulseKind::Help, usual.help_per_hour),
        ] {
            let (found, wanted) = (f64::from(counts[&kind]), rate * f64::from(hours));
            assert!((found - wanted).abs() < 4.0 * wanted.sqrt(), "{kind:?}: {found}, not {wanted}");
        }
        assert_eq!(counts[&ImpulseKind::Scripted], 2);
    }

    #[test]
    fn one_cause_more_changes_nothing_about_the_others() {
        let only = |pause, look| {
            let rates = Rates { pause_per_hour: pause, look_per_hour: look, ..Rates::default() };
            let mut all =
                Impulses::new(&Deviations { at_s: vec![], causes: Causes::Rates(rates) }, 1, 0, Time::ZERO);
            let mut found = Vec::new();
            for second in 0..3600 {
                let now = Time::from_secs_f64(f64::from(second));
                while let Some(i) = all.due(now) {
                    found.push((now, i));
                }
            }
            found.retain(|(_, i)| i.kind == ImpulseKind::Pause);
            found
        };
        assert_eq!(only(30.0, 0.0), only(30.0, 200.0));
        assert!(!only(30.0, 0.0).is_empty());
    }
}
