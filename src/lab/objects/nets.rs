//! The published nets on simulated people: trained, evaluated in every frame, and run with objects that come and go.
//!
//! Main types: [`FeatureChoice`] (the features of a net), [`ObjectNet`], [`ObjectWatch`] (a net at run time); main
//! function: [`learn_net`]. A state steps every tenth frame, at the 12 Hz that the thesis aimed at; ten states, each a
//! frame later than the one before it, step in turn. So there is an answer in every frame, and the memory spans the
//! whole movement instead of the published 20 frames. Refuses: frames of the movements that it is judged by.

use super::body::{BodyFrame, FRAMES, ObjectMove, features};
use crate::learning::picks::{PlaceBatch, PlaceCourse, PlaceShape, PlaceVariant, batch_scores, teach_places};
use giveway_people::reach::ArmPoint;
use giveway_people::reach::net::squash::softmax;
use giveway_people::reach::places::{PlaceNet, PlaceState};
use giveway_sim::random::Stream;
use std::collections::VecDeque;

/// Number of frames between two steps of one state.
const STRIDE: usize = 10;
/// Number of steps of one state in a movement.
const STEPS: usize = FRAMES / STRIDE;
/// Number of frames that a newly added object replays: two seconds.
const REPLAYED: usize = 240;

/// The features of a net.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FeatureChoice {
    /// Indices of the features; the selected ones come first.
    pub columns: Vec<usize>,
    /// Number of selected features.
    pub selected: usize,
    /// Width of the narrow layer of `mlp`.
    pub narrow: usize,
}

/// A net, with the scaling of features to its inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectNet {
    net: PlaceNet,
    columns: Vec<usize>,
    /// For each feature, one over its mean in the training data.
    scale: Vec<f32>,
}

/// A net with random weights, for this number of objects.
pub fn random_net(
    variant: PlaceVariant,
    sight: &FeatureChoice,
    hidden: usize,
    places: usize,
    chance: &mut Stream,
) -> ObjectNet {
    let (all, selected) = (sight.columns.len(), sight.selected);
    let shape = PlaceShape { places, hidden, all, selected, narrow: sight.narrow, wide: selected };
    let net = variant.net(&shape, chance);
    let columns = sight.columns[..net.figures].to_vec();
    ObjectNet { scale: vec![1.0; columns.len()], net, columns }
}

/// Trains a variant on movements among equal numbers of objects.
pub fn learn_net(
    variant: PlaceVariant,
    sight: &FeatureChoice,
    moves: &[&ObjectMove],
    course: &PlaceCourse,
    chance: &mut Stream,
) -> ObjectNet {
    let places = moves[0].objects.len();
    let mut object_net = random_net(variant, sight, course.hidden, places, chance);
    object_net.scale = object_net.columns.iter().map(|c| 1.0 / mean_of(moves, *c)).collect();
    let net = object_net.net.clone();
    object_net.net = teach_places(net, moves.len(), course, chance, |some, chance| {
        let shown: Vec<(&ObjectMove, usize)> =
            some.iter().map(|i| (moves[*i], chance.below(STRIDE))).collect();
        object_net.batch(&shown)
    });
    object_net
}

/// Mean of a feature over frames and objects.
fn mean_of(moves: &[&ObjectMove], column: usize) -> f32 {
    let (mut sum, mut count) = (0.0f64, 0.0f64);
    for m in moves {
        for figures in m.figures.chunks_exact(super::body::FEATURES.len()).step_by(7) {
            sum += f64::from(figures[column]);
            count += 1.0;
        }
    }
    (sum / count.max(1.0)).max(1e-6) as f32
}

impl ObjectNet {
    /// The net's input for movements, each from one of its first frames on.
    fn batch(&self, shown: &[(&ObjectMove, usize)]) -> PlaceBatch {
        let (places, width) = (shown[0].0.objects.len(), self.columns.len());
        let mut figures = Vec::with_capacity(STEPS * shown.len() * places * width);
        for step in 0..STEPS {
            for (m, first) in shown {
                for object in 0..places {
                    let all = m.figures_at(step * STRIDE + first, object);
                    figures.extend(self.columns.iter().zip(&self.scale).map(|(c, s)| all[*c] * s));
                }
            }
        }
        let right = shown.iter().map(|s| s.0.right).collect();
        PlaceBatch {
            steps: STEPS,
            places,
            figures,
            right,
            weights: vec![vec![1.0 / STEPS as f32; STEPS]; shown.len()],
        }
    }

    fn figures_of(&self, frame: &BodyFrame, objects: &[ArmPoint], out: &mut Vec<f32>) {
        out.clear();
        for object in objects {
            let all = features(frame, *object);
            out.extend(self.columns.iter().zip(&self.scale).map(|(c, s)| all[*c] * s));
        }
    }

    /// Probabilities of all objects in every frame of a movement.
    pub fn probabilities(&self, m: &ObjectMove) -> Vec<Vec<f64>> {
        let shown: Vec<(&ObjectMove, usize)> = (0..STRIDE).map(|first| (m, first)).collect();
        let scores = batch_scores(&self.net, &self.batch(&shown));
        let softened = |s: &[f32]| {
            let mut p: Vec<f64> = s.iter().map(|s| f64::from(*s)).collect();
            softmax(&mut p);
            p
        };
        // Ordered by step, then by first frame: in order of time.
        scores.chunks_exact(m.objects.len()).map(softened).collect()
    }
}

/// A net at run time, frame by frame. With shared weights, objects come and go.
#[derive(Clone, Debug)]
pub struct ObjectWatch<'a> {
    net: &'a ObjectNet,
    objects: Vec<ArmPoint>,
    /// The states of each object, or of all together, by frame modulo [`STRIDE`].
    states: Vec<[PlaceState; STRIDE]>,
    scores: Vec<f64>,
    past: VecDeque<BodyFrame>,
    seen: usize,
    figures: Vec<f32>,
}

impl<'a> ObjectWatch<'a> {
    /// A watch before the first frame.
    pub fn new(net: &'a ObjectNet, objects: &[ArmPoint]) -> ObjectWatch<'a> {
        let nets = objects.len() / net.net.group;
        ObjectWatch {
            net,
            objects: objects.to_vec(),
            states: (0..nets).map(|_| std::array::from_fn(|_| net.net.state())).collect(),
            scores: vec![0.0; objects.len()],
            past: VecDeque::with_capacity(REPLAYED + 1),
            seen: 0,
            figures: Vec::new(),
        }
    }

    /// Processes one frame.
    pub fn observe(&mut self, frame: &BodyFrame) {
        let phase = self.seen % STRIDE;
        let group = self.net.net.group;
        for (n, states) in self.states.iter_mut().enumerate() {
            let these = n * group..(n + 1) * group;
            self.net.figures_of(frame, &self.objects[these.clone()], &mut self.figures);
            let scores = self.net.net.step(&self.figures, &mut states[phase]);
            self.scores[these].iter_mut().zip(scores).for_each(|(s, score)| *s = f64::from(*score));
        }
        if self.past.len() == REPLAYED {
            self.past.pop_front();
        }
        self.past.push_back(*frame);
        self.seen += 1;
    }

    /// Adds an object: the last frames are replayed for it. Only nets with shared weights can; gives whether it did.
    pub fn add(&mut self, object: ArmPoint) -> bool {
        if self.net.net.group != 1 {
            return false;
        }
        let mut states: [PlaceState; STRIDE] = std::array::from_fn(|_| self.net.net.state());
        let mut score = 0.0;
        for (k, frame) in self.past.iter().enumerate() {
            let phase = (self.seen - self.past.len() + k) % STRIDE;
            self.net.figures_of(frame, &[object], &mut self.figures);
            score = f64::from(self.net.net.step(&self.figures, &mut states[phase])[0]);
        }
        self.objects.push(object);
        self.states.push(states);
        self.scores.push(score);
        true
    }

    /// Removes an object. Only nets with shared weights can; gives whether it did.
    pub fn remove(&mut self, object: usize) -> bool {
        let is_there = self.net.net.group == 1 && object < self.objects.len();
        if is_there {
            self.objects.remove(object);
            self.states.remove(object);
            self.scores.remove(object);
        }
        is_there
    }

    /// Probabilities of the objects in their order.
    pub fn probabilities(&self) -> Vec<f64> {
        let mut p = self.scores.clone();
        softmax(&mut p);
        p
    }
}
