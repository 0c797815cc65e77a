//! Whether simulated pickers follow their habits, as an observer sees them over many lines.

use super::person::SimPicker;
use super::screen::{ShownLine, StationScreen};
use super::watch::{HandWatch, TruePicker, angles_of};
use super::work::WarnedLead;
use crate::random::Stream;
use crate::scenario::{HandSensor, PickerHabits};
use giveway_cell::{CellHands, CellHandsScene, FacePlace, LineChange, PickFace};
use giveway_fleet::{StationOrder, WrongReach};
use giveway_floor::id::{JobId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{SlotName, stations};
use giveway_people::reach::PickModel;
use std::sync::{Arc, LazyLock};

const STEP: Span = Span::from_millis(10);
/// The right hand, which picks.
const MAIN: usize = 1;

/// Observation of one reach into a slot.
#[derive(Clone, Debug)]
struct ReachSeen {
    lit: SlotName,
    /// Slots that the eyes were on during the reach, each with its beginning.
    looked: Vec<(SlotName, Time)>,
    /// When the finger tips passed the face, and for how long they rested behind it, seconds.
    passed: Time,
    rested_s: f64,
    /// Position of the finger tips at their deepest.
    deepest: FacePlace,
    /// Whether the other hand was in, too.
    both: bool,
}

/// Observations of many lines.
#[derive(Debug, Default)]
struct ShiftSeen {
    reaches: Vec<ReachSeen>,
    lines: u64,
    short: u64,
    /// Lines of two pieces and more, and how many of these both hands picked.
    of_several: u64,
    by_both: u64,
    /// Pieces that were put down, and how many of these went into a wrong tote.
    pieces: u64,
    strayed: u64,
}

/// A person at work, with a screen that confirms every piece at once.
struct PickerShift {
    picker: SimPicker,
    now: Time,
    dice: Stream,
    line: ShownLine,
    seen: ShiftSeen,
    /// Slots that the eyes were on since the hand was last in one.
    looked: Vec<(SlotName, Time)>,
    before: Option<TruePicker>,
    reach: Option<ReachSeen>,
    put: u32,
    both: bool,
}

/// Habits of people who make no mistakes and do not shake.
fn steady() -> PickerHabits {
    PickerHabits {
        wanders: 0.0,
        mispick: 0.0,
        mistote: 0.0,
        changes_mind: 0.0,
        both_hands: 0.0,
        tremor_m: 0.0,
        missing: 0.0,
        away_per_hour: 0.0,
        ..PickerHabits::default()
    }
}

/// The face of a rack at `S1`.
static FACE: LazyLock<PickFace> = LazyLock::new(|| {
    let w = stations();
    let (station, rack) = (&w.stations[StationId(0)], w.rack_types.iter().next().unwrap());
    PickFace::new(station.cell.as_ref().unwrap(), w.nodes[station.node].at, rack)
});

impl PickerShift {
    fn new(habits: PickerHabits, seed: u64) -> PickerShift {
        let random = [1, 2].map(|who| Stream::new(seed, 98, who));
        let mut shift = PickerShift {
            picker: SimPicker::new(habits, false, FACE.clone(), random, Time::ZERO),
            now: Time::ZERO,
            dice: Stream::new(seed, 98, 0),
            line: ShownLine { job: JobId(0), n: 0, slot: SlotName::new(0, 0), tote: 0, left: 1 },
            seen: ShiftSeen::default(),
            looked: Vec::new(),
            before: None,
            reach: None,
            put: 0,
            both: false,
        };
        shift.light();
        shift
    }

    /// Lights another line.
    fn light(&mut self) {
        let slot = SlotName::new(self.dice.below(4) as u8, self.dice.below(5) as u8);
        let (n, left) = (self.line.n + 1, 1 + self.dice.below(3) as u32);
        self.line = ShownLine { job: JobId(0), n, slot, tote: self.dice.below(3), left };
        (self.put, self.both) = (0, false);
    }

    /// Advances by one step. Gives where the person is then.
    fn step(&mut self) -> TruePicker {
        self.now += STEP;
        let screen = StationScreen { lit: Some(self.line), is_here: true, ..StationScreen::default() };
        let said = self.picker.advance(self.now, &screen);
        let truth = self.picker.truth(self.now);
        self.note_eyes(&truth);
        self.note_hands(&truth);
        let is_short = said.iter().any(|(_, s)| matches!(s, StationOrder::Line(_, LineChange::Short)));
        self.note_pieces(&truth, is_short);
        self.before = Some(truth);
        truth
    }

    fn note_eyes(&mut self, truth: &TruePicker) {
        let is_looked_at = |front: FacePlace| {
            let (yaw, pitch) = angles_of(front - truth.head);
            (yaw - truth.looks[0]).hypot(pitch - truth.looks[1]) < 1e-9
        };
        let looked = self.picker.face().slots().find(|(_, front)| is_looked_at(*front)).map(|(slot, _)| slot);
        let slot = looked.filter(|slot| self.looked.last().is_none_or(|(last, _)| last != slot));
        self.looked.extend(slot.map(|slot| (slot, self.now)));
    }

    fn note_hands(&mut self, truth: &TruePicker) {
        let depth = |hand: usize| self.picker.face().depth_m(truth.grips[hand]);
        let at = truth.grips[MAIN];
        let rests = self.before.is_some_and(|before| before.grips[MAIN] == at);
        match &mut self.reach {
            None if depth(MAIN) > 0.0 => {
                self.reach = Some(ReachSeen {
                    lit: self.line.slot,
                    looked: self.looked.clone(),
                    passed: self.now,
                    rested_s: STEP.as_secs_f64(),
                    deepest: at,
                    both: false,
                });
            }
            Some(reach) if depth(MAIN) > 0.0 => {
                reach.rested_s += if rests { STEP.as_secs_f64() } else { 0.0 };
                reach.deepest = if at.y < reach.deepest.y { at } else { reach.deepest };
                reach.both |= depth(1 - MAIN) > 0.0;
            }
            _ => {
                let over = self.reach.take();
                if let Some(reach) = over {
                    self.looked.clear();
                    self.both |= reach.both;
                    self.seen.reaches.push(reach);
                }
            }
        }
    }

    fn note_pieces(&mut self, truth: &TruePicker, is_short: bool) {
        let of_line = |((_, n), put): ((JobId, usize), u32)| (n == self.line.n).then_some(put);
        let put = self.picker.pieces_put().and_then(of_line).unwrap_or(self.put);
        if put > self.put {
            let tote = self.picker.face().tote_at(truth.grips[MAIN]);
            self.seen.pieces += u64::from(put - self.put);
            self.seen.strayed += if tote == Some(self.line.tote) { 0 } else { u64::from(put - self.put) };
            self.put = put;
        }
        if self.put >= self.line.left || is_short {
            self.seen.lines += 1;
            self.seen.short += u64::from(is_short);
            self.seen.of_several += u64::from(self.line.left >= 2);
            self.seen.by_both += u64::from(self.both);
            self.light();
        }
    }

    /// Lets the person pick this many lines.
    fn pick(mut self, lines: u64) -> ShiftSeen {
        while self.seen.lines < lines {
            self.step();
        }
        self.seen
    }

    /// Advances until the hand is on its way to a wrong slot. Gives that slot.
    fn until_wrong(&mut self) -> SlotName {
        while self.picker.figures.wrong == 0 || self.looked.is_empty() {
            self.step();
        }
        (0..60).for_each(|_| _ = self.step());
        self.looked.last().expect("the eyes are there").0
    }

    /// When the hand first meets a condition on its depth, if nothing else happens.
    fn passes(&self, is_there: impl Fn(&PickFace, FacePlace) -> bool) -> Time {
        let (mut picker, mut at) = (self.picker.clone(), self.now);
        let screen = StationScreen { lit: Some(self.line), is_here: true, ..StationScreen::default() };
        while !is_there(&FACE, picker.truth(at).grips[MAIN]) {
            at += Span::from_millis(1);
            picker.advance(at, &screen);
        }
        at
    }
}

/// Asserts that a share matches the habit that it comes from.
fn assert_share(what: &str, (found, of): (u64, u64), habit: f64) {
    let share = found as f64 / of as f64;
    let bound = 3.5 * (habit * (1.0 - habit) / of as f64).sqrt();
    assert!((share - habit).abs() < bound, "{what}: {share} of {of}, but the habit is {habit}");
}

fn mean(all: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = all.len() as f64;
    all.sum::<f64>() / n
}

#[test]
fn mistakes_happen_as_often_as_habits_say() {
    let habits = PickerHabits { mispick: 0.05, mistote: 0.04, missing: 0.06, ..steady() };
    let seen = PickerShift::new(habits, 1).pick(1500);
    let reaches = seen.reaches.len() as u64;
    let wrong = seen.reaches.iter().filter(|r| FACE.slot_at(r.deepest) != Some(r.lit)).count();
    assert_share("mispick", (wrong as u64, reaches), 0.05);
    assert_share("mistote", (seen.strayed, seen.pieces), 0.04);
    assert_share("missing", (seen.short, seen.lines), 0.06);
}

#[test]
fn eyes_wander_before_as_many_reaches_as_habits_say_and_for_a_quarter_of_a_second_and_more() {
    let seen = PickerShift::new(PickerHabits { wanders: 0.2, ..steady() }, 2).pick(800);
    let wandered: Vec<&ReachSeen> = seen.reaches.iter().filter(|r| r.looked.len() > 1).collect();
    assert_share("wanders", (wandered.len() as u64, seen.reaches.len() as u64), 0.2);
    for reach in wandered {
        let [(_, from), (then, until)] = reach.looked[..] else { panic!("{reach:?}") };
        let glance_s = (until - from).as_secs_f64();
        assert!(then == reach.lit && (0.24..=0.46).contains(&glance_s), "{reach:?}");
    }
}

#[test]
fn minds_are_changed_and_both_hands_used_as_often_as_habits_say() {
    let seen = PickerShift::new(PickerHabits { changes_mind: 0.1, ..steady() }, 3).pick(1000);
    let changed = seen.reaches.iter().filter(|r| r.looked.len() == 2).count() as u64;
    assert_share("changes_mind", (changed, seen.reaches.len() as u64), 0.1);
    assert!(seen.reaches.iter().all(|r| FACE.slot_at(r.deepest) == Some(r.lit)));
    let seen = PickerShift::new(PickerHabits { both_hands: 0.3, ..steady() }, 4).pick(800);
    assert_share("both_hands", (seen.by_both, seen.of_several), 0.3);
}

#[test]
fn hands_rummage_as_long_as_habits_say_and_find_pieces_beside_the_middle_of_their_slot() {
    let seen = PickerShift::new(PickerHabits { rummage_s: 0.6, pace: 1.2, ..steady() }, 5).pick(800);
    let rested_s = mean(seen.reaches.iter().map(|r| r.rested_s));
    // The mean of a log-normal time is longer than its median.
    let expected_s = 0.6 * 1.2 * (0.35_f64 * 0.35 / 2.0).exp();
    assert!((rested_s - expected_s).abs() < 0.03, "{rested_s} s, but {expected_s} s by the habit");
    let aside = |r: &ReachSeen| r.deepest.x - FACE.slot(r.lit).x;
    let (middle, square) =
        (mean(seen.reaches.iter().map(aside)), mean(seen.reaches.iter().map(|r| aside(r).powi(2))));
    assert!(middle.abs() < 0.003, "{middle} m");
    assert!((square.sqrt() - 0.03).abs() < 0.003, "{} m", square.sqrt());
    assert!(seen.reaches.iter().all(|r| aside(r).abs() < 0.081));
}

#[test]
fn eyes_are_at_the_slot_three_quarters_of_a_second_before_the_hand() {
    let seen = PickerShift::new(steady(), 6).pick(300);
    let lead = |r: &ReachSeen| (r.passed - r.looked.last().expect("it was looked at").1).as_secs_f64();
    let mut leads: Vec<f64> = seen.reaches.iter().map(lead).collect();
    leads.sort_by(f64::total_cmp);
    assert!((0.6..1.0).contains(&leads[leads.len() / 2]), "median {}", leads[leads.len() / 2]);
    assert!(leads[0] > 0.3, "never with the hand: {}", leads[0]);
    assert!(seen.reaches.iter().all(|r| r.looked.len() == 1 && r.looked[0].0 == r.lit));
}

#[test]
fn while_the_hand_rummages_the_head_is_turned_by_its_shares_of_the_gaze_and_nods_where_the_person_bends() {
    let mut shift = PickerShift::new(PickerHabits { rummage_s: 3.0, ..steady() }, 7);
    let (mut upright, mut bent) = (0, 0);
    for _ in 0..40_000 {
        let truth = shift.step();
        let [yaw, pitch] = truth.looks;
        let rests = shift.reach.as_ref().is_some_and(|r| r.rested_s > 0.8);
        if !rests || FACE.depth_m(truth.grips[MAIN]) < 0.11 {
            continue;
        }
        let lowered_m = 0.93 * 1.75 - truth.head.z;
        let (turned, tilted) = (truth.faces[0] - 0.7 * yaw, truth.faces[1] - 0.4 * pitch);
        assert!(turned.abs() < 0.01 && (tilted + 0.9 * lowered_m).abs() < 0.01, "{truth:?}");
        *(if lowered_m == 0.0 { &mut upright } else { &mut bent }) += 1;
    }
    assert!(upright > 1000 && bent > 1000, "{upright} {bent}");
}

#[test]
fn a_warning_that_names_another_slot_is_false_and_does_not_help() {
    let mut shift = PickerShift::new(PickerHabits { mispick: 1.0, ..steady() }, 8);
    let aimed = shift.until_wrong();
    let beside = |s: &SlotName| *s != aimed && *s != shift.line.slot;
    let other = FACE.slots().map(|(slot, _)| slot).find(beside).unwrap();
    for (named, figures) in [(other, (1, 0)), (shift.line.slot, (2, 0)), (aimed, (2, 1)), (aimed, (2, 1))] {
        shift.picker.warn(shift.now, WrongReach::Slot(named));
        shift.step();
        let found = &shift.picker.figures;
        assert_eq!((found.false_warnings, found.wrong_warned), figures, "{named} for {aimed}");
    }
}

#[test]
fn a_warning_of_a_right_reach_is_false_and_of_a_slot_just_left_is_right() {
    let mut shift = PickerShift::new(PickerHabits { changes_mind: 1.0, ..steady() }, 9);
    while shift.looked.len() < 2 {
        shift.step();
    }
    let [(left, _), (lit, _)] = shift.looked[..] else { panic!("{:?}", shift.looked) };
    shift.picker.warn(shift.now, WrongReach::Slot(left));
    shift.picker.warn(shift.now, WrongReach::Tote(shift.line.tote));
    shift.picker.warn(shift.now, WrongReach::Slot(lit));
    shift.step();
    assert_eq!((shift.picker.figures.false_warnings, shift.picker.figures.wrong_warned), (2, 0));
    (0..110).for_each(|_| _ = shift.step());
    shift.picker.warn(shift.now, WrongReach::Slot(left));
    shift.step();
    assert_eq!(shift.picker.figures.false_warnings, 3, "that was more than a second ago");
}

#[test]
fn the_lead_of_a_warning_is_measured_to_when_the_finger_tips_pass_the_face_and_to_when_they_are_at_the_piece()
{
    for seed in 10..20 {
        let mut shift = PickerShift::new(PickerHabits { mispick: 1.0, ..steady() }, seed);
        let aimed = shift.until_wrong();
        let passes = shift.passes(|face, at| face.depth_m(at) >= 0.0);
        let deepest = shift.passes(|face, at| face.depth_m(at) >= 0.11);
        let warned = passes - Span::from_millis(100);
        shift.picker.warn(warned, WrongReach::Slot(aimed));
        while shift.picker.figures.warned_leads.is_empty() {
            shift.step();
        }
        let WarnedLead { face_s, piece_s } = shift.picker.figures.warned_leads[0];
        assert!((face_s - 0.1).abs() < 0.0015, "{face_s}");
        let near_s = (deepest - warned).as_secs_f64();
        // The last centimetre is slow.
        assert!(piece_s > near_s && piece_s < near_s + 0.6, "{piece_s}, 1 cm before it {near_s}");
    }
}

#[test]
fn a_warning_that_comes_when_the_piece_is_out_counts_as_none() {
    let mut shift = PickerShift::new(PickerHabits { mispick: 1.0, ..steady() }, 20);
    let aimed = shift.until_wrong();
    let is_in = shift.passes(|face, at| face.depth_m(at) >= 0.1);
    while shift.now < is_in {
        shift.step();
    }
    let out = shift.passes(|face, at| face.depth_m(at) < 0.0);
    shift.picker.warn(out, WrongReach::Slot(aimed));
    while shift.now < out {
        shift.step();
    }
    let found = &shift.picker.figures;
    assert_eq!((found.wrong, found.wrong_warned, found.false_warnings), (1, 0, 0));
    assert!(found.warned_leads.is_empty());
}

/// Probabilities stated for a visible hand, and what happened.
#[derive(Default)]
struct Foreseen {
    /// For each range of probabilities: number of moments, sum of the stated values, and how often the hand came
    /// inside.
    parts: [[f64; 3]; 5],
}

impl Foreseen {
    /// Lower bounds of the ranges of probabilities.
    const PARTS: [f64; 5] = [0.0, 0.1, 0.3, 0.6, 0.9];
    /// How far ahead a probability looks, in steps.
    const AHEAD: usize = 30;

    /// Adds a person who picks this many lines while a headset watches.
    fn watch(&mut self, seed: u64, lines: u64) {
        let (face, model) = (Arc::new(FACE.clone()), PickModel::builtin());
        let mut shift = PickerShift::new(PickerHabits::default(), seed);
        let mut watch = HandWatch::new(HandSensor::default(), Stream::new(seed, 97, 0), Time::ZERO);
        let mut hands = CellHands::default();
        let mut stated: Vec<(usize, [bool; 2], f64)> = Vec::new();
        let mut inside: Vec<[bool; 2]> = Vec::new();
        let mut last = [Time::ZERO; 2];
        while shift.seen.lines < lines {
            let truth = shift.step();
            inside.push(truth.grips.map(|at| face.is_inside(at)));
            while watch.next() <= shift.now {
                watch.look((StationId(0), 0), &face, &truth);
            }
            let (lit, tote) = (Some(shift.line.slot), Some(shift.line.tote));
            for seen in watch.come(shift.now) {
                hands.see(CellHandsScene { face: &face, model: &model, lit, tote }, &seen);
                let is_seen = seen.hands.map(|hand| hand.is_some());
                // A hand lost a moment ago is taken to be where it was: that is no forecast.
                let is_known = |i: usize| is_seen[i] || seen.seen - last[i] > Span::from_secs(1);
                if (0..2).all(is_known) {
                    let step = (seen.seen - Time::ZERO).0 / STEP.0;
                    stated.push((step as usize, is_seen, hands.inside_soon(&face, seen.seen)));
                }
                (0..2).filter(|i| is_seen[*i]).for_each(|i| last[i] = seen.seen);
            }
        }
        for (step, is_seen, p) in stated.into_iter().filter(|s| s.0 + Self::AHEAD < inside.len()) {
            let of = |at: &[bool; 2]| (0..2).any(|i| is_seen[i] && at[i]);
            if of(&inside[step]) {
                continue;
            }
            let part = Self::PARTS.iter().rposition(|least| p >= *least).expect("it is not below 0");
            let came = f64::from(u8::from(inside[step..=step + Self::AHEAD].iter().any(of)));
            let [n, sum, all] = self.parts[part];
            self.parts[part] = [n + 1.0, sum + p, all + came];
        }
    }
}

#[test]
fn hands_that_are_seen_come_inside_no_more_often_than_was_stated_until_they_are_sure_to() {
    let mut foreseen = Foreseen::default();
    (30..34).for_each(|seed| foreseen.watch(seed, 60));
    let shares = foreseen.parts.map(|[n, stated, came]| [n, stated / n, came / n]);
    assert!(shares[0][2] < 0.03, "hands that are not expected do not come: {shares:?}");
    assert!(shares.iter().all(|[n, ..]| *n > 300.0), "too few to say: {shares:?}");
    let found: Vec<f64> = shares.iter().map(|[_, _, found]| *found).collect();
    assert!(found[0] < found[1] && found[1] < found[2] && found[2] < found[3], "{shares:?}");
    // For hands that rest near the opening the stated probability is too high: racks wait rather than move.
    assert!(found[1] <= shares[1][1] && found[2] <= shares[2][1], "{shares:?}");
    assert!(found[3] > 0.9 && found[4] > 0.9, "{shares:?}");
}
