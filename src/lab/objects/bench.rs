//! The whole experiment as pieces of work that can run in parallel, and the report from them.
//!
//! Main types: [`ObjectsBench`] (the simulated people), [`ObjectJob`], `ObjectsReport`. Every piece draws from its own
//! random stream, so the figures do not depend on how many run at a time. Refuses: to judge by movements, or outside of
//! folds by people, that were learned from.

use super::body::{GAZE, HAND, HEAD, ObjectMove, ObjectTable};
use super::change::ChangeFigures;
use super::gaze::{degrees, learn_estimate, with_estimated_gaze};
use super::nets::{FeatureChoice, ObjectNet, learn_net};
use super::people::moves_of;
use super::rows::{RowKind, SHARED, choice_of, rows_of};
use super::rules::{enhanced, inverse, sharpened, sharpness_of};
use super::score::ObjectTally;
use crate::learning::picks::{PlaceCourse, PlaceVariant};
use giveway_sim::random::Stream;

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectsCourse {
    /// Number of simulated people in either room.
    pub people: usize,
    /// Number of movements of each person.
    pub movements: usize,
    /// Number of training steps of every net.
    pub steps: usize,
    /// Seed of people and of training.
    pub seed: u64,
}

/// Number of movements in one training step.
const BATCH: usize = 8;
/// First learning rate, as published.
const RATE: f32 = 0.01;
/// Number of parts of EG-LSTM.
const PARTS: usize = 3;
/// Purposes of random streams.
const FOLDS: u64 = 340;
const LEARNING: u64 = 341;

/// A group of figures that are scored in the same way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ObjectGroup {
    /// Folds within every person.
    Within(ObjectTable),
    /// Every person left out once.
    LeftOut(ObjectTable),
    /// Estimated gaze, three parts of every person's movements.
    Estimated,
    /// Estimated gaze, three groups of people.
    EstimatedLeftOut,
}

/// A piece of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectJob {
    /// One person's movements, one fold of them judged.
    Fold(ObjectTable, usize, usize),
    /// One person judged by nets that learned from the others.
    LeftOut(ObjectTable, usize),
    /// One person's movements in parts; the second number is the part with measured gaze.
    Parts(usize, usize),
    /// People in groups; the number is the group with measured gaze.
    PartsLeftOut(usize),
}

/// Results of one predictor for one person's movements in a piece of work.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectPiece {
    /// The group of the result.
    pub group: ObjectGroup,
    /// The word of the row.
    pub word: &'static str,
    /// Number of the person.
    pub person: usize,
    /// Scores of the predictor.
    pub tally: ObjectTally,
    /// Angles in degrees between measured and estimated gaze, and between measured gaze and the head.
    pub degrees: (Vec<f64>, Vec<f64>),
}

/// The simulated people, and the work to do with them.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectsBench {
    course: ObjectsCourse,
    /// Movements by table, then by person.
    moves: [Vec<Vec<ObjectMove>>; 2],
}

impl ObjectsBench {
    /// Simulates the people; there must be at least three.
    pub fn new(course: ObjectsCourse) -> ObjectsBench {
        let of = |table: ObjectTable| {
            (0..course.people).map(|p| moves_of(table, p, course.movements, course.seed)).collect()
        };
        ObjectsBench { course, moves: ObjectTable::ALL.map(of) }
    }

    /// All movements in the room of a table.
    pub fn moves(&self, table: ObjectTable) -> Vec<&ObjectMove> {
        self.moves[table as usize].iter().flatten().collect()
    }

    /// All pieces of work, the longest first.
    pub fn jobs(&self) -> Vec<ObjectJob> {
        let people = 0..self.course.people;
        let mut jobs = Vec::new();
        for table in ObjectTable::ALL {
            jobs.extend(people.clone().map(|p| ObjectJob::LeftOut(table, p)));
            let folds = |p: usize| (0..table.folds()).map(move |f| ObjectJob::Fold(table, p, f));
            jobs.extend(people.clone().flat_map(folds));
        }
        jobs.extend(people.flat_map(|p| (0..PARTS).map(move |turn| ObjectJob::Parts(p, turn))));
        jobs.extend((0..PARTS).map(ObjectJob::PartsLeftOut));
        jobs
    }

    /// Movements of a person, shuffled and dealt into `count` parts.
    fn parts(&self, table: ObjectTable, person: usize, count: usize) -> Vec<Vec<&ObjectMove>> {
        let moves = &self.moves[table as usize][person];
        let mut order: Vec<usize> = (0..moves.len()).collect();
        let who = (person * 2 + table as usize) as u64 * 10 + count as u64;
        let mut chance = Stream::new(self.course.seed, FOLDS, who);
        for i in (1..order.len()).rev() {
            order.swap(i, chance.below(i + 1));
        }
        let part = |k: usize| order.iter().skip(k).step_by(count).map(|i| &moves[*i]).collect();
        (0..count).map(part).collect()
    }

    /// Figure 5.8 on the first person's movements, by a net that learned from the others.
    pub fn changes(&self) -> ChangeFigures {
        let (judged, net) = self.stranger();
        ChangeFigures::of(&net, &judged)
    }

    /// The first person's movements, and a net that learned from the others.
    pub(super) fn stranger(&self) -> (Vec<&ObjectMove>, ObjectNet) {
        let (judged, learned): (Vec<&ObjectMove>, Vec<&ObjectMove>) =
            self.moves(ObjectTable::Shelves).into_iter().partition(|m| m.person == 0);
        let lstm = (PlaceVariant::Lstm, SHARED);
        let net = self.learn(9999, 0, lstm, &choice_of(ObjectTable::Shelves), &learned);
        (judged, net)
    }

    /// Does one piece of work; `number` is its position in [`ObjectsBench::jobs`].
    pub fn run(&self, number: usize, job: ObjectJob) -> Vec<ObjectPiece> {
        match job {
            ObjectJob::Fold(table, person, fold) => {
                let mut parts = self.parts(table, person, table.folds());
                let judged = parts.swap_remove(fold);
                let learned: Vec<&ObjectMove> = parts.into_iter().flatten().collect();
                self.judge(number, table, ObjectGroup::Within(table), &learned, &judged)
            }
            ObjectJob::LeftOut(table, person) => {
                let (judged, learned): (Vec<&ObjectMove>, Vec<&ObjectMove>) =
                    self.moves(table).into_iter().partition(|m| m.person == person);
                self.judge(number, table, ObjectGroup::LeftOut(table), &learned, &judged)
            }
            ObjectJob::Parts(person, turn) => {
                let mut parts = self.parts(ObjectTable::Shelves, person, PARTS);
                parts.rotate_left(turn);
                self.estimated(number, ObjectGroup::Estimated, &parts)
            }
            ObjectJob::PartsLeftOut(turn) => {
                let all = self.moves(ObjectTable::Shelves);
                let part = |k: usize| {
                    all.iter().filter(|m| m.person % PARTS == (k + turn) % PARTS).copied().collect()
                };
                let parts: Vec<Vec<&ObjectMove>> = (0..PARTS).map(part).collect();
                self.estimated(number, ObjectGroup::EstimatedLeftOut, &parts)
            }
        }
    }

    fn course_of(&self, hidden: usize, movements: usize) -> PlaceCourse {
        let epochs = (self.course.steps * BATCH).div_ceil(movements);
        PlaceCourse { hidden, epochs, batch: BATCH, rate: RATE }
    }

    fn learn(
        &self,
        number: usize,
        row: usize,
        (variant, hidden): (PlaceVariant, usize),
        choice: &FeatureChoice,
        learned: &[&ObjectMove],
    ) -> ObjectNet {
        let mut chance = Stream::new(self.course.seed, LEARNING, (number * 100 + row) as u64);
        learn_net(variant, choice, learned, &self.course_of(hidden, learned.len()), &mut chance)
    }

    /// Scores all rows of a table.
    fn judge(
        &self,
        number: usize,
        table: ObjectTable,
        group: ObjectGroup,
        learned: &[&ObjectMove],
        judged: &[&ObjectMove],
    ) -> Vec<ObjectPiece> {
        let person = judged[0].person;
        let mut pieces = Vec::new();
        let mut lstm: Vec<Vec<Vec<f64>>> = Vec::new();
        for (r, row) in rows_of(table).into_iter().enumerate() {
            let mut tally = ObjectTally::default();
            match row.kind {
                RowKind::Rule(feature) => judged.iter().for_each(|m| inverse(m, feature, &mut tally)),
                RowKind::Sharpened(feature) => {
                    let sharpness = sharpness_of(learned, feature);
                    judged.iter().for_each(|m| sharpened(m, feature, sharpness, &mut tally));
                }
                RowKind::Net(variant, hidden) => {
                    let net = self.learn(number, r, (variant, hidden), &choice_of(table), learned);
                    let said: Vec<Vec<Vec<f64>>> = judged.iter().map(|m| net.probabilities(m)).collect();
                    judged.iter().zip(&said).for_each(|(m, p)| add(m, p, &mut tally));
                    if variant == PlaceVariant::Lstm {
                        lstm = said;
                    }
                }
                RowKind::Narrow(narrow) => {
                    let choice = FeatureChoice { narrow, ..choice_of(table) };
                    let net = self.learn(number, r, (PlaceVariant::Mlp, SHARED), &choice, learned);
                    judged.iter().for_each(|m| add(m, &net.probabilities(m), &mut tally));
                }
                RowKind::Enhanced => {
                    judged.iter().zip(&lstm).for_each(|(m, p)| enhanced(m, p, &mut tally));
                }
            }
            pieces.push(ObjectPiece { group, word: row.word, person, tally, degrees: Default::default() });
        }
        pieces
    }

    /// Scores EG-LSTM and its rivals on the third part.
    fn estimated(&self, number: usize, group: ObjectGroup, parts: &[Vec<&ObjectMove>]) -> Vec<ObjectPiece> {
        let mut chance = Stream::new(self.course.seed, LEARNING, (number * 100 + 99) as u64);
        let estimate = learn_estimate(&parts[0], &mut chance);
        let second: Vec<ObjectMove> = parts[1].iter().map(|m| with_estimated_gaze(&estimate, m)).collect();
        let second: Vec<&ObjectMove> = second.iter().collect();
        let choice = choice_of(ObjectTable::Shelves);
        let lstm = (PlaceVariant::Lstm, SHARED);
        let with = self.learn(number, 0, lstm, &choice, &second);
        let blind = FeatureChoice { columns: vec![HAND, HEAD], selected: 2, narrow: 1 };
        let without = self.learn(number, 1, lstm, &blind, &second);
        let mut pieces = Vec::new();
        for m in &parts[2] {
            let known = with_estimated_gaze(&estimate, m);
            let apart = degrees(m, |i| known.frames[i].gaze);
            let head = degrees(m, |i| m.frames[i].head.1);
            let mut piece = |word, fill: &dyn Fn(&mut ObjectTally)| {
                let mut tally = ObjectTally::default();
                fill(&mut tally);
                let degrees = Default::default();
                pieces.push(ObjectPiece { group, word, person: m.person, tally, degrees });
            };
            piece("eg_lstm", &|t| add(&known, &with.probabilities(&known), t));
            piece("lstm_without_gaze", &|t| add(&known, &without.probabilities(&known), t));
            piece("gaze", &|t| inverse(m, GAZE, t));
            piece("estimated_gaze", &|t| inverse(&known, GAZE, t));
            piece("hand", &|t| inverse(m, HAND, t));
            piece("head", &|t| inverse(m, HEAD, t));
            if let Some(last) = pieces.last_mut() {
                last.degrees = (apart, head);
            }
        }
        pieces
    }
}

/// Adds a net's probabilities for a movement to a tally.
fn add(m: &ObjectMove, by_frame: &[Vec<f64>], tally: &mut ObjectTally) {
    by_frame.iter().enumerate().for_each(|(frame, p)| tally.add(m, frame, p));
}
