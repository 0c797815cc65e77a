//! The published predictor and its variants: a net that evaluates the person relative to each place.
//!
//! Main types: [`PlaceNet`], [`PlaceState`], [`PlaceBank`]. One net with the same weights for every place (Petković,
//! section 5.2.1), its inputs selected, or passed through a narrow layer, or one net for all places together (FULL,
//! ALL). Corrected: it keeps a state instead of a buffer of frames; a new place replays its own last frames instead of
//! taking the state of a neighbour. Refuses: to know more of a place than distances.

use super::features::{ArmMotion, JOINTS};
use super::net::squash::{sigmoid, softmax};
use super::net::{Affine, Elman, Lstm};
use super::sample::ReachTarget;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// The recurrent part of a net.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlaceCore {
    /// A long short-term memory.
    Lstm(Lstm),
    /// A plain recurrent layer.
    Elman(Elman),
}

/// A narrow layer of sigmoids between all features and those that the core takes (section 5.2.2).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bottleneck {
    /// Map to the narrow layer.
    pub narrow: Affine,
    /// Map from the narrow layer.
    pub wide: Affine,
}

/// A net that scores places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceNet {
    /// Number of features per place: the first ones of [`ArmMotion::joints`].
    pub figures: usize,
    /// Number of places evaluated together; 1 if weights are shared.
    pub group: usize,
    /// The narrow layer, if the net has one.
    pub front: Option<Bottleneck>,
    /// The recurrent part.
    pub core: PlaceCore,
    /// Map from the state to one score per place.
    pub out: Affine,
}

impl PlaceCore {
    /// Length of the net's state.
    pub fn hidden(&self) -> usize {
        match self {
            PlaceCore::Lstm(lstm) => lstm.hidden,
            PlaceCore::Elman(elman) => elman.map.outputs,
        }
    }

    fn fault(&self, inputs: usize) -> Option<String> {
        match self {
            PlaceCore::Lstm(lstm) => lstm.fault(inputs),
            PlaceCore::Elman(elman) => elman.fault(inputs),
        }
    }
}

impl PlaceNet {
    /// Number of inputs of the core.
    pub fn core_inputs(&self) -> usize {
        self.front.as_ref().map_or(self.figures * self.group, |f| f.wide.outputs)
    }

    /// Rounds all weights to the precision of a file.
    pub fn round(&mut self) {
        let core = match &mut self.core {
            PlaceCore::Lstm(lstm) => &mut lstm.gates,
            PlaceCore::Elman(elman) => &mut elman.map,
        };
        core.round();
        self.out.round();
        if let Some(front) = &mut self.front {
            front.narrow.round();
            front.wide.round();
        }
    }

    /// What is wrong with the net's shape or weights, if anything.
    pub fn fault(&self) -> Option<String> {
        if !(1..=JOINTS).contains(&self.figures) || !(1..=1000).contains(&self.group) {
            return Some(format!("a net of {} figures for {} places cannot be", self.figures, self.group));
        }
        if let Some(front) = &self.front {
            let fault = front.narrow.fault(self.figures, front.narrow.outputs);
            let fault = fault.or_else(|| front.wide.fault(front.narrow.outputs, front.wide.outputs));
            if self.group != 1 || fault.is_some() {
                return fault.or_else(|| Some("a narrow layer is for one place at a time".into()));
            }
        }
        let core = self.core.fault(self.core_inputs());
        core.or_else(|| self.out.fault(self.core.hidden(), self.group))
    }
}

/// A net's state for its place, or for all its places, with scratch space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaceState {
    h: Vec<f32>,
    c: Vec<f32>,
    narrow: Vec<f32>,
    wide: Vec<f32>,
    z: Vec<f32>,
    scores: Vec<f32>,
}

impl PlaceNet {
    /// A state that has seen nothing.
    pub fn state(&self) -> PlaceState {
        let (n, front) = (self.core.hidden(), self.front.as_ref());
        PlaceState {
            h: vec![0.0; n],
            c: vec![0.0; n],
            narrow: vec![0.0; front.map_or(0, |f| f.narrow.outputs)],
            wide: vec![0.0; front.map_or(0, |f| f.wide.outputs)],
            z: vec![0.0; 4 * n],
            scores: vec![0.0; self.group],
        }
    }

    /// One step: `figures` has the features of all places that the net evaluates together, in order. Returns one score
    /// per place.
    pub fn step<'s>(&self, figures: &[f32], state: &'s mut PlaceState) -> &'s [f32] {
        let input = match &self.front {
            Some(front) => {
                front.narrow.apply(figures, &mut state.narrow);
                state.narrow.iter_mut().for_each(|v| *v = sigmoid(*v));
                front.wide.apply(&state.narrow, &mut state.wide);
                &state.wide[..]
            }
            None => figures,
        };
        match &self.core {
            PlaceCore::Lstm(lstm) => lstm.step(input, &mut state.h, &mut state.c, &mut state.z),
            PlaceCore::Elman(elman) => {
                let n = elman.map.outputs;
                elman.step(input, &mut state.h, &mut state.z[..n]);
            }
        }
        self.out.apply(&state.h, &mut state.scores);
        &state.scores
    }
}

/// Number of frames that a new place replays.
const REPLAYED: usize = 25;

/// One place and the net's state for it.
#[derive(Clone, Debug, PartialEq)]
struct Watched {
    target: ReachTarget,
    state: PlaceState,
    score: f64,
}

/// A net with shared weights at run time: places come and go.
#[derive(Clone, Debug)]
pub struct PlaceBank<'a> {
    net: &'a PlaceNet,
    watched: Vec<Watched>,
    frames: VecDeque<ArmMotion>,
}

impl<'a> PlaceBank<'a> {
    /// A bank without places; nothing if the net evaluates several places together.
    pub fn new(net: &'a PlaceNet) -> Option<PlaceBank<'a>> {
        let frames = VecDeque::with_capacity(REPLAYED + 1);
        (net.group == 1).then(|| PlaceBank { net, watched: Vec::new(), frames })
    }

    /// Adds a place: the net evaluates it over the last second, as if it had been there.
    pub fn add(&mut self, target: ReachTarget) {
        let mut watched = Watched { target, state: self.net.state(), score: 0.0 };
        self.frames.iter().for_each(|motion| watched.look(self.net, motion));
        self.watched.push(watched);
    }

    /// Removes a place.
    pub fn remove(&mut self, place: usize) {
        if place < self.watched.len() {
            self.watched.remove(place);
        }
    }

    /// One step for all places.
    pub fn observe(&mut self, motion: &ArmMotion) {
        if self.frames.len() == REPLAYED {
            self.frames.pop_front();
        }
        self.frames.push_back(*motion);
        self.watched.iter_mut().for_each(|w| w.look(self.net, motion));
    }

    /// Probabilities of the places in their order, with scores multiplied by `sharpness`.
    pub fn probabilities(&self, sharpness: f64, out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.watched.iter().map(|w| w.score * sharpness));
        softmax(out);
    }
}

impl Watched {
    fn look(&mut self, net: &PlaceNet, motion: &ArmMotion) {
        let mut joints = [0.0; JOINTS];
        motion.joints(&self.target, &mut joints);
        self.score = f64::from(net.step(&joints[..net.figures], &mut self.state)[0]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reach::sample::{ArmPoint, ArmSample};

    /// A net whose state is the nearness of the hand, which it remembers.
    fn net() -> PlaceNet {
        let mut core = Elman::new(1, 1);
        core.map.weights = vec![-0.6, 0.9];
        let out = Affine { inputs: 1, outputs: 1, weights: vec![4.0], bias: vec![0.0] };
        PlaceNet { figures: 1, group: 1, front: None, core: PlaceCore::Elman(core), out }
    }

    fn place(y: f64) -> ReachTarget {
        ReachTarget { hand: ArmPoint::new(0.6, y, 1.3), look: ArmPoint::new(0.7, y, 1.3) }
    }

    fn motion(t: usize) -> ArmMotion {
        let (shoulder, head) = (ArmPoint::new(0.0, -0.2, 1.4), ArmPoint::new(0.0, 0.0, 1.6));
        let finger = ArmPoint::new(0.1 + 0.01 * t as f64, 0.01 * t as f64, 1.2);
        let forearm = shoulder + (finger - shoulder) * 0.5;
        let hand = shoulder + (finger - shoulder) * 0.9;
        let at_s = t as f64 * 0.04;
        ArmMotion::new(ArmSample { at_s, shoulder, forearm, hand, finger, head, yaw: 0.0, pitch: 0.0 })
    }

    /// Figure 5.8 of Petković: the target place appears, disappears, and appears again.
    #[test]
    fn a_place_that_comes_back_is_judged_by_its_own_last_second() {
        let net = net();
        let (mut whole, mut changed) = (PlaceBank::new(&net).unwrap(), PlaceBank::new(&net).unwrap());
        [0.4, -0.4].into_iter().for_each(|y| whole.add(place(y)));
        changed.add(place(-0.4));
        let (mut with, mut without) = (Vec::new(), Vec::new());
        for t in 0..40 {
            match t {
                10 | 22 => changed.add(place(0.4)),
                18 => changed.remove(1),
                _ => {}
            }
            whole.observe(&motion(t));
            changed.observe(&motion(t));
            whole.probabilities(1.0, &mut with);
            changed.probabilities(1.0, &mut without);
            let is_there = (10..18).contains(&t) || t >= 22;
            assert_eq!(without.len(), 1 + usize::from(is_there), "{t}");
            if is_there {
                assert!((without[1] - with[0]).abs() < 0.02, "{t}: {without:?} {with:?}");
            }
        }
        assert!(with[0] > 0.5);
    }
}
