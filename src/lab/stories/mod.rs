//! The stories that Petković 2021 tells in section 3.5 to show how intentions are recognised, told again.
//!
//! Main types: [`Story`] (beliefs over time with the events), [`StoryKind`] (which story). Floor plans and tracks of
//! the originals are lost or were never published: what the text says of them is kept, the rest is made up, and the
//! order of events is compared, not numbers. Refuses: random numbers without a seed.

mod actor;
mod grid;
mod hall;
mod lab;

use super::plot::{LineChart, Series};
use giveway_people::human::{Belief, Method};

/// A story of the thesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoryKind {
    /// Section 3.5.1: tiles, three goals, a change of mind, a dead end.
    Grid,
    /// Section 3.5.2: the laboratory; a robot closes the way.
    Lab,
    /// Section 3.5.4: a large hall with 24 robots; a goal is added.
    Hall,
}

/// An event in a story.
#[derive(Clone, Debug, PartialEq)]
pub struct StoryEvent {
    /// Time of the event: steps or seconds.
    pub at: f64,
    /// Text of the event.
    pub what: String,
}

/// Name and colour of a goal.
type Named = (&'static str, &'static str);

/// A story told.
#[derive(Clone, Debug)]
pub struct Story {
    /// Title of the story.
    pub title: String,
    /// Method and place.
    pub subtitle: String,
    /// Unit of time: `step` or `seconds`.
    pub unit: &'static str,
    /// The goals by id: name and colour.
    pub goals: Vec<Named>,
    /// Beliefs after each update or at each tick.
    pub beliefs: Vec<(f64, Belief)>,
    /// Events in order of time.
    pub events: Vec<StoryEvent>,
}

impl StoryKind {
    /// Tells the story. The story on tiles has a method of its own and takes no other; `seed` moves the robots of the
    /// hall.
    pub fn tell(self, method: Method, seed: u64) -> Story {
        match self {
            StoryKind::Grid => grid::tell(),
            StoryKind::Lab => lab::tell(method),
            StoryKind::Hall => hall::tell(method, seed),
        }
    }
}

impl Story {
    /// The belief at a time.
    pub fn at(&self, time: f64) -> &Belief {
        let before = self.beliefs.iter().rev().find(|(t, _)| *t <= time + 1e-9);
        &before.unwrap_or(&self.beliefs[0]).1
    }

    /// Time of the first event whose text contains `words`.
    ///
    /// # Panics
    /// If there is none: stories are fixed, and so are the words of their events.
    pub fn when(&self, words: &str) -> f64 {
        self.events.iter().find(|e| e.what.contains(words)).map(|e| e.at).expect("an event of this story")
    }

    /// Chart of the probabilities over time.
    pub fn chart(&self) -> LineChart {
        let line = |label: String, colour: &'static str, of: &dyn Fn(&Belief) -> Option<f64>| {
            let points = self.beliefs.iter().filter_map(|(t, b)| Some((*t, of(b)?))).collect();
            Series { label, colour, points }
        };
        let goals = self.goals.iter().enumerate().map(|(i, (name, colour))| {
            line(name.to_string(), colour, &|b| b.goals.iter().find(|g| g.0.0 == i as u64).map(|g| g.1))
        });
        let mut series: Vec<Series> = goals.collect();
        if self.beliefs.iter().any(|(_, b)| b.undecided > 0.0) {
            series.push(line("undecided".into(), "#1d2430", &|b| Some(b.undecided)));
        }
        series.push(line("elsewhere".into(), "#d92d20", &|b| Some(b.elsewhere)));
        LineChart {
            title: self.title.clone(),
            subtitle: self.subtitle.clone(),
            x: self.unit.into(),
            y: "probability".into(),
            range: (0.0, 1.0),
            series,
            marks: self.events.iter().map(|e| (e.at, e.what.clone())).collect(),
        }
    }
}

/// A method's name in a subtitle.
fn name(method: Method) -> &'static str {
    match method {
        Method::Chapter3 => "Petković 2021, chapter 3",
        Method::Chapter3Tiles => "Petković 2021, chapter 3, on tiles",
        Method::Chapter4 => "Petković 2021, chapter 4",
        Method::Detour => "detour likelihood",
    }
}
