//! Training of the published predictor and its variants.
//!
//! Main types: [`PlaceShape`], [`PlaceCourse`], [`PlaceBatch`]; main functions: [`teach_places`] (from any features),
//! [`learn_places`] (from reaches), [`batch_scores`], [`place_scores`]. Corrected: the likelihood of the right place
//! among all its candidates is learned, instead of yes or no for each with most of the no's thrown away. Refuses:
//! groups of different sizes in one net.

use super::adam::Adam;
use super::course::{motions, rate_at, shuffle, step_weights};
use super::items::{ReachItem, Variety};
use super::layers::{ElmanTape, LstmTape, Sequence, affine, affine_back, elman, lstm};
use giveway_people::reach::features::{JOINTS, SELECTED};
use giveway_people::reach::net::squash::{sigmoid, softmax};
use giveway_people::reach::net::{Affine, Elman, Lstm};
use giveway_people::reach::places::{Bottleneck, PlaceCore, PlaceNet};
use giveway_sim::random::Stream;

/// A variant of the published predictor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceVariant {
    /// Long short-term memories with shared weights on selected features.
    Lstm,
    /// The same memories on all features, passed through a narrow layer.
    Mlp,
    /// Plain recurrent layers with shared weights on selected features.
    Rnn,
    /// One memory for all places, selected features.
    Full,
    /// One memory for all places, all features.
    All,
}

impl PlaceVariant {
    /// All variants.
    pub const ALL: [PlaceVariant; 5] =
        [PlaceVariant::Lstm, PlaceVariant::Mlp, PlaceVariant::Rnn, PlaceVariant::Full, PlaceVariant::All];

    /// The variant's name in tables.
    pub fn word(self) -> &'static str {
        match self {
            PlaceVariant::Lstm => "lstm",
            PlaceVariant::Mlp => "mlp",
            PlaceVariant::Rnn => "rnn",
            PlaceVariant::Full => "full",
            PlaceVariant::All => "all",
        }
    }

    /// Whether the variant has one net for all places, so that their number is fixed.
    pub fn is_whole(self) -> bool {
        matches!(self, PlaceVariant::Full | PlaceVariant::All)
    }

    /// A net of this variant with random weights.
    pub fn net(self, shape: &PlaceShape, chance: &mut Stream) -> PlaceNet {
        let (hidden, group) = (shape.hidden, if self.is_whole() { shape.places } else { 1 });
        let takes_all = matches!(self, PlaceVariant::Mlp | PlaceVariant::All);
        let figures = if takes_all { shape.all } else { shape.selected };
        let (narrow, wide) = (shape.narrow, shape.wide);
        let front = (self == PlaceVariant::Mlp).then(|| Bottleneck {
            narrow: affine(figures, narrow, chance),
            wide: affine(narrow, wide, chance),
        });
        let inputs = front.as_ref().map_or(figures * group, |f| f.wide.outputs);
        let core = match self {
            PlaceVariant::Rnn => PlaceCore::Elman(elman(inputs, hidden, chance)),
            _ => PlaceCore::Lstm(lstm(inputs, hidden, chance)),
        };
        PlaceNet { figures, group, front, core, out: affine(hidden, group, chance) }
    }
}

/// Sizes of a net.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaceShape {
    /// Number of places evaluated together.
    pub places: usize,
    /// Size of the state.
    pub hidden: usize,
    /// Number of features of a place.
    pub all: usize,
    /// Number of selected features; they come first.
    pub selected: usize,
    /// Width of the narrow layer.
    pub narrow: usize,
    /// Number of outputs after the narrow layer.
    pub wide: usize,
}

/// Movements with equal numbers of candidates, as input of a net.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaceBatch {
    /// Number of steps of the longest movement.
    pub steps: usize,
    /// Number of candidates of every movement.
    pub places: usize,
    /// The net's features by step, then by movement, then by candidate; zero after the end of a shorter movement.
    pub figures: Vec<f32>,
    /// Index of the right candidate of every movement.
    pub right: Vec<usize>,
    /// Weights of the steps of every movement.
    pub weights: Vec<Vec<f32>>,
}

/// Parameters of the training.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceCourse {
    /// Size of the state.
    pub hidden: usize,
    /// Number of passes over all movements.
    pub epochs: usize,
    /// Number of movements in a batch.
    pub batch: usize,
    /// First learning rate (0.01 as published).
    pub rate: f32,
}

impl PlaceCourse {
    /// Parameters for two slow cores: a smaller state than the published 128 and fewer epochs than 100.
    pub const SHORT: PlaceCourse = PlaceCourse { hidden: 16, epochs: 10, batch: 16, rate: 0.01 };
}

/// Intermediate values of a batch.
#[derive(Default)]
struct PlaceTape {
    shape: Sequence,
    narrow: Vec<f32>,
    inputs: Vec<f32>,
    lstm: LstmTape,
    elman: ElmanTape,
    scores: Vec<f32>,
}

fn zeros(net: &PlaceNet) -> PlaceNet {
    let like = |a: &Affine| Affine::new(a.inputs, a.outputs);
    let front = net.front.as_ref().map(|f| Bottleneck { narrow: like(&f.narrow), wide: like(&f.wide) });
    let core = match &net.core {
        PlaceCore::Lstm(l) => PlaceCore::Lstm(Lstm::new(l.inputs, l.hidden)),
        PlaceCore::Elman(e) => PlaceCore::Elman(Elman::new(e.inputs, e.map.outputs)),
    };
    PlaceNet { figures: net.figures, group: net.group, front, core, out: like(&net.out) }
}

fn weights(net: &mut PlaceNet) -> Vec<&mut [f32]> {
    let core = match &mut net.core {
        PlaceCore::Lstm(l) => &mut l.gates,
        PlaceCore::Elman(e) => &mut e.map,
    };
    let mut all: Vec<&mut [f32]> =
        vec![&mut core.weights, &mut core.bias, &mut net.out.weights, &mut net.out.bias];
    if let Some(Bottleneck { narrow, wide }) = &mut net.front {
        all.extend([&mut narrow.weights[..], &mut narrow.bias, &mut wide.weights, &mut wide.bias]);
    }
    all
}

impl PlaceTape {
    /// Runs the net over a batch.
    fn run(&mut self, net: &PlaceNet, batch: &PlaceBatch) {
        let (steps, rows) = (batch.steps, batch.right.len() * batch.places);
        self.shape = Sequence { steps, rows: rows / net.group };
        self.inputs.clear();
        if let Some(front) = &net.front {
            self.narrow.resize(steps * rows * front.narrow.outputs, 0.0);
            front.narrow.apply(&batch.figures, &mut self.narrow);
            self.narrow.iter_mut().for_each(|v| *v = sigmoid(*v));
            self.inputs.resize(steps * rows * front.wide.outputs, 0.0);
            front.wide.apply(&self.narrow, &mut self.inputs);
        } else {
            self.inputs.extend_from_slice(&batch.figures);
        }
        match &net.core {
            PlaceCore::Lstm(l) => self.lstm.run(l, &self.inputs, self.shape, None),
            PlaceCore::Elman(e) => self.elman.run(e, &self.inputs, self.shape),
        }
        let mut scores = std::mem::take(&mut self.scores);
        scores.resize(steps * rows, 0.0);
        net.out.apply(self.states(net), &mut scores);
        self.scores = scores;
    }

    fn states(&self, net: &PlaceNet) -> &[f32] {
        match &net.core {
            PlaceCore::Lstm(l) => self.lstm.states(self.shape.rows, l.hidden),
            PlaceCore::Elman(e) => self.elman.states(self.shape.rows, e.map.outputs),
        }
    }

    fn back(&mut self, net: &PlaceNet, batch: &PlaceBatch, slopes: &[f32], gradient: &mut PlaceNet) {
        let mut d_states = vec![0.0f32; self.states(net).len()];
        affine_back(&net.out, self.states(net), slopes, &mut gradient.out, Some(&mut d_states));
        let mut d_inputs = net.front.as_ref().map(|_| vec![0.0f32; self.inputs.len()]);
        let dx = d_inputs.as_deref_mut();
        match (&net.core, &mut gradient.core) {
            (PlaceCore::Lstm(l), PlaceCore::Lstm(g)) => {
                self.lstm.back(l, &self.inputs, &d_states, None, g, dx);
            }
            (PlaceCore::Elman(e), PlaceCore::Elman(g)) => {
                self.elman.back(e, &self.inputs, self.shape, &d_states, g, dx)
            }
            _ => unreachable!("a gradient has the form of its net"),
        }
        if let (Some(front), Some(g), Some(d)) = (&net.front, &mut gradient.front, d_inputs) {
            let mut d_narrow = vec![0.0f32; self.narrow.len()];
            affine_back(&front.wide, &self.narrow, &d, &mut g.wide, Some(&mut d_narrow));
            d_narrow.iter_mut().zip(&self.narrow).for_each(|(d, n)| *d *= n * (1.0 - n));
            affine_back(&front.narrow, &batch.figures, &d_narrow, &mut g.narrow, None);
        }
    }
}

/// Trains on `count` movements; `batch` gives the net's input for those of these numbers.
pub fn teach_places(
    mut net: PlaceNet,
    movements: usize,
    course: &PlaceCourse,
    chance: &mut Stream,
    mut batch: impl FnMut(&[usize], &mut Stream) -> PlaceBatch,
) -> PlaceNet {
    let mut gradient = zeros(&net);
    let (mut adam, mut tape) = (Adam::new(0.0), PlaceTape::default());
    let mut order: Vec<usize> = (0..movements).collect();
    let batches = movements.div_ceil(course.batch) * course.epochs;
    let mut done = 0;
    for _ in 0..course.epochs {
        shuffle(&mut order, chance);
        for some in order.chunks(course.batch) {
            let batch = batch(some, chance);
            tape.run(&net, &batch);
            let slopes = listwise(&batch, &tape.scores);
            tape.back(&net, &batch, &slopes, &mut gradient);
            let rate = rate_at(course.rate, f64::from(done) / batches as f64);
            adam.step(rate, &mut weights(&mut net), &mut weights(&mut gradient));
            done += 1;
        }
    }
    net
}

/// Trains a variant on movements with equal numbers of candidates.
pub fn learn_places(
    variant: PlaceVariant,
    items: &[ReachItem],
    course: &PlaceCourse,
    chance: &mut Stream,
) -> PlaceNet {
    let places = items[0].targets.len();
    // As published: two numbers in the narrow layer, three behind it.
    let shape =
        PlaceShape { places, hidden: course.hidden, all: JOINTS, selected: SELECTED, narrow: 2, wide: 3 };
    let net = variant.net(&shape, chance);
    let figures = net.figures;
    teach_places(net, items.len(), course, chance, |some, chance| {
        let varied: Vec<ReachItem> = some.iter().map(|i| Variety::PEOPLE.vary(&items[*i], chance)).collect();
        batch_of(&varied, figures)
    })
}

/// Reaches with equal numbers of candidates, as input of a net with that many features.
fn batch_of(items: &[ReachItem], count: usize) -> PlaceBatch {
    let places = items[0].targets.len();
    let (steps, rows) = (items.iter().map(|i| i.samples.len()).max().unwrap_or(0), items.len() * places);
    let mut joints = [0.0f32; JOINTS];
    let mut figures = vec![0.0; steps * rows * count];
    for (row, item) in items.iter().enumerate() {
        for (t, motion) in motions(item).iter().enumerate() {
            for (i, target) in item.targets.iter().enumerate() {
                motion.joints(target, &mut joints);
                let at = (t * rows + row * places + i) * count;
                figures[at..at + count].copy_from_slice(&joints[..count]);
            }
        }
    }
    let right = items.iter().map(|i| i.right).collect();
    PlaceBatch { steps, places, figures, right, weights: items.iter().map(step_weights).collect() }
}

/// Gradient of the listwise likelihood at each score.
fn listwise(batch: &PlaceBatch, scores: &[f32]) -> Vec<f32> {
    let places = batch.places;
    let rows = batch.right.len() * places;
    let mut slopes = vec![0.0f32; scores.len()];
    let mut list = Vec::with_capacity(places);
    for (row, (right, weights)) in batch.right.iter().zip(&batch.weights).enumerate() {
        for (t, weight) in weights.iter().enumerate() {
            let at = t * rows + row * places;
            list.clear();
            list.extend(scores[at..at + places].iter().map(|s| f64::from(*s)));
            softmax(&mut list);
            for (i, p) in list.iter().enumerate() {
                let wrong = *p as f32 - f32::from(u8::from(i == *right));
                slopes[at + i] = wrong * weight / batch.right.len() as f32;
            }
        }
    }
    slopes
}

/// Scores of a batch, in the order of its figures: by step, then by movement, then by candidate.
pub fn batch_scores(net: &PlaceNet, batch: &PlaceBatch) -> Vec<f32> {
    let mut tape = PlaceTape::default();
    tape.run(net, batch);
    tape.scores
}

/// Scores of all candidates at every step of a movement.
pub fn place_scores(net: &PlaceNet, item: &ReachItem) -> Vec<Vec<f64>> {
    let scores = batch_scores(net, &batch_of(std::slice::from_ref(item), net.figures));
    let places = item.targets.len();
    scores.chunks_exact(places).map(|s| s.iter().map(|v| f64::from(*v)).collect()).collect()
}
