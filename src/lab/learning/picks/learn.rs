//! Learns the whole model of people at arm's length.
//!
//! Main function: [`learn_picks`]. Refuses: fewer than three people, since some must be left out.

use super::arm::{ArmWindow, windows};
use super::arms::{ForecastWindow, learn_arms, regions_of};
use super::bones::BoneNet;
use super::destination::DestinationNets;
use super::ends::EndCourse;
use super::gaze::{GazePair, fit_gaze, gaze_pairs, learn_gaze_net};
use super::items::ReachItem;
use super::lessons::PickLessons;
use super::mixtures::{fit_mixture, palm_points};
use super::places::{PlaceCourse, PlaceVariant, learn_places, place_scores};
use super::published::{LearnedPicks, PublishedNet, PublishedPicks};
use super::rules::{hand_scores, head_scores};
use super::seq2seq::SeqToSeq;
use super::slots::{Scored, at_parts, learn_slots, none_of, sharpness_of, surprise};
use crate::picks::{SlotTally, tally_item};
use giveway_people::reach::ArmVector;
use giveway_people::reach::gaze::GazeModel;
use giveway_people::reach::mixtures::PalmMixture;
use giveway_people::reach::model::{ArmModel, LeftOutScores, PICK_MODEL_VERSION, PickModel, SlotModel};
use giveway_sim::random::Stream;

/// Parameters of the whole training.
#[derive(Clone, Debug, PartialEq)]
pub struct PickCourse {
    /// Seed of all random numbers.
    pub seed: u64,
    /// The command that reproduces the file.
    pub command: String,
    /// Parameters for the nets of where hands end.
    pub ends: EndCourse,
    /// Whether published methods are trained, too.
    pub published: bool,
    /// Share by which gaze is drawn to probable places, if that cannot be learned.
    pub drawn: f64,
}

/// Weights of mixtures beside the nets to try.
const MIXED: [f64; 6] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.3];
/// The slow published methods learn from every `EVERY`-th window.
const EVERY: usize = 4;

/// Trains everything and gives the model.
pub fn learn_picks(lessons: &PickLessons, course: &PickCourse, mut tell: impl FnMut(&str)) -> LearnedPicks {
    let (nets, left_out) = learn_slots(lessons, &course.ends, course.seed, &mut tell);
    let (arms, forecasts) = learn_arms(lessons, course.ends.strangers, course.seed, &mut tell);
    let arm = ArmModel { nets: arms, regions: regions_of(&forecasts) };
    let of_rule = |rule: fn(&ReachItem) -> Vec<Vec<f64>>| {
        let scored = |(i, item): (usize, &ReachItem)| Scored {
            item: i,
            scores: at_parts(item, &rule(item)),
            right: item.right,
        };
        sharpness_of(&lessons.items.iter().enumerate().map(scored).collect::<Vec<_>>())
    };
    let with_mixtures = course.published && !lessons.places.is_empty();
    let sharpness = sharpness_of(&left_out);
    let slots = SlotModel {
        nets,
        sharpness,
        none: none_of(&left_out, sharpness),
        hand_rule: of_rule(hand_scores),
        head_rule: of_rule(head_scores),
    };
    let pairs: Vec<GazePair> = lessons.gaze.iter().flat_map(gaze_pairs).collect();
    let model = PickModel {
        version: PICK_MODEL_VERSION,
        sources: lessons.sources.clone(),
        command: course.command.clone(),
        seed: course.seed,
        people: lessons.present().into_iter().map(|p| lessons.people[p].clone()).collect(),
        folds: slots.nets.len(),
        left_out: scores_of(lessons, &left_out, sharpness, &forecasts, &arm),
        gaze: GazeModel { weights: fit_gaze(&pairs), drawn: course.drawn },
        slots,
        arm,
    };
    let published = with_mixtures.then(|| {
        tell("palm mixtures beside the nets");
        let both = share_of_mixtures(lessons, &left_out, &model.arm);
        let published = learn_published(lessons, &model, &pairs, course.seed, &mut tell);
        PublishedPicks { both, ..published }
    });
    LearnedPicks { model, published }
}

/// Scores on people left out.
fn scores_of(
    lessons: &PickLessons,
    left_out: &[Scored],
    sharpness: f64,
    forecasts: &[ForecastWindow],
    arm: &ArmModel,
) -> LeftOutScores {
    const HAND: usize = 2;
    let mut tally = SlotTally::default();
    for scored in left_out {
        tally_item(&mut tally, &lessons.items[scored.item], &scored.scores, sharpness);
    }
    let score = tally.score();
    let count = forecasts.len().max(1) as f64;
    let error = |f: &ForecastWindow, k: usize| (f.forecast.middle[k][HAND] - f.window.after[k].hand).norm();
    let holds = |f: &&ForecastWindow, k: usize| error(f, k) <= arm.radius_m(&f.forecast, k, HAND);
    let mean_mm = |k: usize| forecasts.iter().map(|f| error(f, k)).sum::<f64>() / count * 1000.0;
    let held = |k: usize| forecasts.iter().filter(|f| holds(f, k)).count() as f64 / count;
    LeftOutScores {
        movements: left_out.len(),
        top1_mean: score.as_ref().map_or(0.0, |s| s.top1_mean),
        nll: score.as_ref().map_or(0.0, |s| s.nll),
        ece: score.as_ref().map_or(0.0, |s| s.ece),
        hand_mm: [mean_mm(4), mean_mm(9)],
        hand_cov95: [held(4), held(9)],
    }
}

/// Scores of a movement's candidates by palm mixtures at the ten parts of its way: from observed points alone, or from
/// forecast ones as well. `mixtures[i]` belongs to candidate `i`.
pub fn mixture_scores(
    item: &ReachItem,
    mixtures: &[Option<&PalmMixture>],
    arm: Option<&ArmModel>,
) -> Vec<Vec<f64>> {
    use giveway_people::reach::arm::ARM_STEPS;
    let score = |t: usize| {
        let observed = (item.onset..=t).map(|i| item.samples[i].hand - item.samples[i].shoulder);
        let mut points: Vec<ArmVector> = observed.collect();
        if let Some(arm) = arm {
            let seen: [_; ARM_STEPS] =
                std::array::from_fn(|k| item.samples[(t + k + 1).saturating_sub(ARM_STEPS)]);
            let forecast = arm.forecast(&seen);
            points.extend(forecast.iter().flat_map(|f| f.middle.iter().map(|m| m[2] - m[0])));
        }
        mixtures.iter().map(|m| m.map_or(-1e3, |m| m.log_likelihood(&points))).collect()
    };
    crate::picks::way_samples(item).into_iter().map(score).collect()
}

/// One mixture per place, from movements of selected people.
fn mixtures_of(lessons: &PickLessons, is_one: impl Fn(usize) -> bool) -> Vec<PalmMixture> {
    let of = |place: usize| {
        let own = lessons.items.iter().filter(|i| i.places[i.right] == place && is_one(i.person));
        let points: Vec<(f64, ArmVector)> = own.flat_map(palm_points).collect();
        fit_mixture(&lessons.places[place], points)
    };
    (0..lessons.places.len()).filter_map(of).collect()
}

/// The mixtures of a movement's candidates, found by the names of their places.
pub fn candidates_of<'a>(
    names: &[String],
    item: &ReachItem,
    mixtures: &'a [PalmMixture],
) -> Vec<Option<&'a PalmMixture>> {
    item.places.iter().map(|p| mixtures.iter().find(|m| m.place == names[*p])).collect()
}

/// The weight of mixtures beside the nets that helps most on people left out, and the sharpness of both together.
fn share_of_mixtures(lessons: &PickLessons, left_out: &[Scored], arm: &ArmModel) -> [f64; 2] {
    const GROUPS: usize = 2;
    let by_group: Vec<Vec<PalmMixture>> =
        (0..GROUPS).map(|g| mixtures_of(lessons, |p| lessons.group(p, GROUPS) != g)).collect();
    // Some of the movements are enough to choose one number.
    let some: Vec<&Scored> = left_out.iter().step_by(3).collect();
    let scores = |s: &Scored| {
        let item = &lessons.items[s.item];
        let mixtures = &by_group[lessons.group(item.person, GROUPS)];
        let of_item = candidates_of(&lessons.places, item, mixtures);
        Scored { scores: mixture_scores(item, &of_item, Some(arm)), ..s.clone() }
    };
    let by_mixtures: Vec<Scored> = some.iter().map(|s| scores(s)).collect();
    let both = |share: f64| -> Vec<Scored> {
        let pairs = some.iter().zip(&by_mixtures);
        pairs.map(|(net, mixture)| mix(net, mixture, share)).collect()
    };
    let tried = MIXED.map(|share| {
        let both = both(share);
        let sharpness = sharpness_of(&both);
        (surprise(&both, sharpness), [share, sharpness])
    });
    tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or([0.0, 1.0], |best| best.1)
}

/// The weighted sum of both scores.
pub(super) fn mix(net: &Scored, mixture: &Scored, share: f64) -> Scored {
    let rows = net.scores.iter().zip(&mixture.scores);
    let sum = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        a.iter().zip(b).map(|(a, b)| a * (1.0 - share) + b * share).collect()
    };
    Scored { scores: rows.map(sum).collect(), ..net.clone() }
}

fn learn_published(
    lessons: &PickLessons,
    model: &PickModel,
    pairs: &[GazePair],
    seed: u64,
    tell: &mut impl FnMut(&str),
) -> PublishedPicks {
    let mut nets = Vec::new();
    for (v, variant) in PlaceVariant::ALL.into_iter().enumerate() {
        // Variants for all places together: one net for the nearest places, and one for all. Shared weights learn from
        // all movements among places of one distance.
        let (all, layers) = lessons.lists.split_last().expect("there is a list of all places");
        let nearest = layers.first().unwrap_or(all);
        let count = |list: &[ReachItem]| list.first().map_or(0, |i| i.targets.len());
        let alike = layers.iter().filter(|l| count(l) == count(nearest)).flatten().cloned();
        let lists: Vec<Vec<ReachItem>> = match variant.is_whole() {
            true if layers.is_empty() => vec![all.clone()],
            true => vec![nearest.clone(), all.clone()],
            false if layers.is_empty() => vec![all.clone()],
            false => vec![alike.collect()],
        };
        for list in lists.iter().filter(|l| !l.is_empty()) {
            tell(&format!("{} of {} places", variant.word(), count(list)));
            nets.push(published_net(lessons, list, variant, seed, v as u64));
        }
    }
    tell("palm mixtures");
    let mixtures = mixtures_of(lessons, |_| true);
    let sharp = |arm: Option<&ArmModel>| {
        let halves = [0, 1].map(|g| mixtures_of(lessons, |p| lessons.group(p, 2) != g));
        let scored = |(i, item): (usize, &ReachItem)| {
            let of_item = candidates_of(&lessons.places, item, &halves[lessons.group(item.person, 2)]);
            Scored { item: i, scores: mixture_scores(item, &of_item, arm), right: item.right }
        };
        sharpness_of(&lessons.items.iter().enumerate().step_by(3).map(scored).collect::<Vec<_>>())
    };
    let (observed, ahead) = (sharp(None), sharp(Some(&model.arm)));
    let all: Vec<ArmWindow> = lessons.items.iter().flat_map(windows).collect();
    let some: Vec<ArmWindow> = all.iter().step_by(EVERY).cloned().collect();
    tell("sequence to sequence");
    let mut seq2seq = SeqToSeq::learn(&some, 3, &mut Stream::new(seed, 304, 0));
    tell("bones");
    let mut bones = BoneNet::learn(&some, 6, &mut Stream::new(seed, 304, 1));
    tell("destination first");
    let mut vae = DestinationNets::learn(&all, 6, &mut Stream::new(seed, 304, 2));
    let layers = [&mut seq2seq.encoder.gates, &mut seq2seq.decoder.gates, &mut seq2seq.out, &mut bones.out];
    let bone_layers = bones.memories.iter_mut().map(|m| &mut m.gates);
    let perceptrons = [&mut vae.encoder, &mut vae.decoder, &mut vae.posture].into_iter();
    let others = perceptrons.flat_map(|p| &mut p.layers);
    layers.into_iter().chain(bone_layers).chain(others).for_each(|layer| layer.round());
    let gaze = (!pairs.is_empty()).then(|| {
        let mut net = learn_gaze_net(pairs, &mut Stream::new(seed, 304, 3));
        net.layers.iter_mut().for_each(|l| l.round());
        net
    });
    PublishedPicks { nets, mixtures, observed, ahead, both: [0.0, 1.0], seq2seq, bones, vae, gaze }
}

/// A trained variant; its sharpness comes from a net that learned from half of the people and was scored on the others.
fn published_net(
    lessons: &PickLessons,
    items: &[ReachItem],
    variant: PlaceVariant,
    seed: u64,
    number: u64,
) -> PublishedNet {
    let is_first = |i: &&ReachItem| lessons.group(i.person, 2) == 0;
    let first: Vec<ReachItem> = items.iter().filter(is_first).cloned().collect();
    let course = PlaceCourse::SHORT;
    let half = learn_places(variant, &first, &course, &mut Stream::new(seed, 303, number));
    let others = items.iter().filter(|i| !is_first(i)).enumerate();
    let scored = others.map(|(i, item)| {
        let scores = at_parts(item, &place_scores(&half, item));
        Scored { item: i, scores, right: item.right }
    });
    let sharpness = sharpness_of(&scored.collect::<Vec<_>>());
    let mut net = learn_places(variant, items, &course, &mut Stream::new(seed, 303, number + 100));
    net.round();
    PublishedNet { variant: variant.word().into(), net, sharpness }
}

#[cfg(test)]
mod tests {
    use super::super::ends::learn_ends;
    use super::super::lessons::PickLessons;
    use super::super::places::{PlaceCourse, PlaceVariant, learn_places, place_scores};
    use super::super::simulated::{SIMULATED_COURSE, simulated_lessons};
    use super::super::slots::{END_COURSE, Scored, at_parts, end_scores, surprise};
    use super::*;
    use crate::picks::SlotScore;

    fn score(items: &[ReachItem], of: impl Fn(&ReachItem) -> Vec<Vec<f64>>, sharpness: f64) -> SlotScore {
        let mut tally = SlotTally::default();
        for item in items {
            tally_item(&mut tally, item, &at_parts(item, &of(item)), sharpness);
        }
        tally.score().unwrap()
    }

    /// Simulated people, some to learn from and others for scoring.
    fn halves() -> (PickLessons, PickLessons) {
        let (all, _) = simulated_lessons(24, 5);
        (all.only(|p| p < 16), all.only(|p| p >= 16))
    }

    #[test]
    fn what_is_learned_from_some_simulated_people_beats_the_rules_on_others() {
        let (learned, asked) = halves();
        let course = EndCourse { hidden: 16, epochs: 10, ..SIMULATED_COURSE };
        let net = learn_ends(&learned.items, &course, &mut Stream::new(1, 1, 1));
        let ours = score(&asked.items, |i| end_scores(&net, i), 0.7);
        let hand = score(&asked.items, hand_scores, 7.0);
        assert!(ours.top1_mean > hand.top1_mean && ours.nll < hand.nll, "{ours:?}\n{hand:?}");
    }

    #[test]
    fn the_same_movements_and_seed_give_the_same_bytes() {
        let (lessons, _) = halves();
        let course = EndCourse { hidden: 8, epochs: 1, ..END_COURSE };
        let learn = |seed: u64| learn_ends(&lessons.items[..60], &course, &mut Stream::new(seed, 1, 1));
        let text = |seed: u64| serde_json::to_string(&learn(seed)).unwrap();
        assert_eq!(text(1), text(1));
        assert_ne!(text(1), text(2));
    }

    #[test]
    fn the_published_predictor_learns_with_shared_weights_whatever_the_number_of_places() {
        let (learned, asked) = halves();
        let six = |lessons: &PickLessons| -> Vec<ReachItem> {
            lessons
                .items
                .iter()
                .filter(|i| i.targets.len() == lessons.items[0].targets.len())
                .cloned()
                .collect()
        };
        let course = PlaceCourse { hidden: 8, epochs: 40, ..PlaceCourse::SHORT };
        let net = learn_places(PlaceVariant::Lstm, &six(&learned), &course, &mut Stream::new(1, 1, 1));
        let scored = |(i, item): (usize, &ReachItem)| Scored {
            item: i,
            scores: at_parts(item, &place_scores(&net, item)),
            right: item.right,
        };
        let all: Vec<Scored> = asked.items.iter().enumerate().map(scored).collect();
        let chance = asked.items.iter().map(|i| (i.targets.len() as f64).ln()).sum::<f64>();
        assert!(surprise(&all, 1.0) < 0.9 * chance / asked.items.len() as f64, "{}", surprise(&all, 1.0));
    }
}
