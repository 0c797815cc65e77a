//! Learning about people at arm's length: which place a hand goes to, where the arm will be, where the eyes look.
//!
//! Main types: [`PickLessons`] (training data), [`LearnedPicks`] (the results); main function: [`learn_picks`].
//! Back-propagation through time, dropout and Adam are written out, so that the same data and the same seed give the
//! same bytes. Refuses: to read files, and to judge a net by people it was learned from.

mod adam;
mod arm;
mod arms;
mod bones;
mod course;
mod destination;
mod ends;
mod gaze;
mod items;
mod layers;
mod learn;
mod lessons;
mod mixtures;
mod perceptron;
mod places;
mod published;
mod rules;
mod seq2seq;
mod simulated;
mod slots;

pub use arm::{ArmWindow, windows};
pub use bones::BoneForecast;
pub use ends::EndCourse;
pub use gaze::{
    GazePair, degrees_between, fit_gaze, gaze_net_degrees, gaze_pairs, gaze_quantiles, learn_gaze_from,
};
pub use items::{ReachItem, STEP_S, Variety, stepped};
pub use learn::{PickCourse, candidates_of, learn_picks, mixture_scores};
pub use lessons::PickLessons;
pub use perceptron::Perceptron;
pub use places::{
    PlaceBatch, PlaceCourse, PlaceShape, PlaceVariant, batch_scores, place_scores, teach_places,
};
pub use published::{LearnedPicks, PublishedNet, PublishedPicks};
pub use rules::{hand_scores, head_scores};
pub use simulated::{SIMULATED_COURSE, simulated_lessons, simulated_reach};
pub use slots::{END_COURSE, at_parts, end_scores, mean_scores};
