//! Hands at a work cell, followed from slot to tote, on films of one hand.

use super::*;
use crate::HandPoints;
use giveway_floor::id::StationId;
use giveway_floor::warehouse::stations;

/// Observations of a right hand that goes from place to place, 60 a second; the left one rests.
struct Film {
    face: Arc<PickFace>,
    hands: CellHands,
    now: Time,
    at: FacePlace,
    person: u32,
    /// What the eyes rest on, where they are measured.
    eyes_on: Option<FacePlace>,
    events: Vec<CellHandsEvent>,
}

/// Nothing is lit.
const LIT: Option<(SlotName, usize)> = None;

impl Film {
    fn new() -> Film {
        let w = stations();
        let (station, rack) = (&w.stations[StationId(0)], w.rack_types.iter().next().unwrap());
        let face = PickFace::new(station.cell.as_ref().unwrap(), w.nodes[station.node].at, rack);
        let (hands, at, now) =
            (CellHands::default(), FacePlace::new(0.22, 0.95, 0.95), Time::from_secs_f64(10.0));
        let face = Arc::new(face);
        Film { face, hands, now, at, person: 0, eyes_on: None, events: Vec::new() }
    }

    fn hand(&self, at: FacePlace) -> HandPoints {
        let place = |back: f64| self.face.on_map(at + FacePlace::new(0.0, back, 0.0));
        HandPoints { wrist: place(0.17), palm: place(0.09), tips: [place(0.0); 2] }
    }

    fn look(&mut self, lit: Option<(SlotName, usize)>, hands: [Option<FacePlace>; 2]) {
        let hands = hands.map(|at| at.map(|at| self.hand(at)));
        let (station, person, seen) = (StationId(0), self.person, self.now);
        let head = self.face.on_map(FacePlace::new(0.0, 1.05, 1.6));
        let eyes = self.eyes_on.map(|at| (self.face.on_map(at) - head).normalize());
        let seen = HandsSeen { station, person, seen, head, facing: None, eyes, hands };
        let (lit, tote) = (lit.map(|(slot, _)| slot), lit.map(|(_, tote)| tote));
        let scene = CellHandsScene { face: &self.face, model: &PickModel::builtin(), lit, tote };
        self.events.extend(self.hands.see(scene, &seen));
        self.now += Span::from_millis(16);
    }

    /// Moves the hand by a smooth step, seen or unseen.
    fn moves(&mut self, lit: Option<(SlotName, usize)>, to: FacePlace, seconds: f64, is_seen: bool) {
        self.begins_to_move(lit, to, (seconds, 1.0), is_seen);
    }

    /// Moves the hand for the first share of the time.
    fn begins_to_move(
        &mut self,
        lit: Option<(SlotName, usize)>,
        to: FacePlace,
        (seconds, share): (f64, f64),
        is_seen: bool,
    ) {
        let (from, n) = (self.at, (seconds / 0.016) as usize);
        for i in 1..=(n as f64 * share) as usize {
            let t = i as f64 / n as f64;
            self.at = from + (to - from) * (t * t * (3.0 - 2.0 * t));
            let left = FacePlace::new(-0.22, 0.95, 0.95);
            if is_seen {
                self.look(lit, [Some(left), Some(self.at)]);
            } else {
                self.now += Span::from_millis(16);
            }
        }
    }

    /// A hand picks from a slot and comes out again.
    fn picks(&mut self, lit: Option<(SlotName, usize)>, slot: SlotName) {
        let front = self.face.slot(slot) + FacePlace::new(0.0, 0.3, 0.0);
        let inside = self.face.slot(slot) - FacePlace::new(0.0, 0.12, 0.0);
        self.moves(lit, front, 0.5, true);
        self.moves(lit, inside, 0.4, true);
        self.moves(lit, inside, 0.4, true);
        self.moves(lit, front, 0.4, true);
    }

    fn puts(&mut self, lit: Option<(SlotName, usize)>, tote: usize, is_seen: bool) {
        let rim = self.face.tote(tote).unwrap();
        self.moves(lit, rim, 0.7, is_seen);
        self.moves(lit, rim, 0.2, true);
    }
}

fn slot(name: &str) -> SlotName {
    name.parse().unwrap()
}

fn put(name: &str, sure: bool, tote: usize) -> CellHandsEvent {
    CellHandsEvent::Placed(HeldPiece { from: slot(name), sure, is_of_before: false }, tote)
}

#[test]
fn a_piece_is_followed_from_its_slot_to_its_tote() {
    let mut film = Film::new();
    for (name, tote) in [("C3", 1), ("A1", 0), ("D5", 2)] {
        film.events.clear();
        film.picks(LIT, slot(name));
        assert_eq!(film.hands.in_hand(slot(name)), 1, "{name}");
        film.puts(LIT, tote, true);
        let placed = put(name, true, tote);
        assert_eq!(film.events, [CellHandsEvent::Grasped(slot(name)), placed], "{name}");
        assert_eq!(film.hands.in_hand(slot(name)), 0);
    }
}

#[test]
fn a_hand_that_was_not_seen_on_its_way_confirms_nothing() {
    let mut film = Film::new();
    film.picks(LIT, slot("C3"));
    let rim = film.face.tote(1).unwrap();
    film.moves(LIT, rim, 1.5, false);
    film.moves(LIT, rim, 0.2, true);
    assert_eq!(film.events, [CellHandsEvent::Grasped(slot("C3")), put("C3", false, 1)]);
}

#[test]
fn a_hand_on_its_way_to_a_wrong_slot_is_warned_of_once_and_before_it_has_a_piece() {
    let lit = Some((slot("B2"), 0));
    for name in ["C2", "B3", "A4"] {
        let mut film = Film::new();
        let front = film.face.slot(slot(name)) + FacePlace::new(0.0, 0.3, 0.0);
        film.moves(lit, front, 0.5, true);
        film.moves(lit, film.face.slot(slot(name)) - FacePlace::new(0.0, 0.08, 0.0), 0.4, true);
        assert_eq!(film.events, [CellHandsEvent::AimsAt(slot(name))], "{name}");
    }
    let mut film = Film::new();
    film.picks(lit, slot("B2"));
    assert_eq!(
        film.events,
        [CellHandsEvent::Grasped(slot("B2"))],
        "the right slot is no reason for a warning"
    );
}

#[test]
fn a_piece_in_a_wrong_tote_counts_in_the_right_one_once_the_hand_has_been_back_for_it() {
    let lit = Some((slot("C3"), 2));
    let mut film = Film::new();
    film.picks(lit, slot("C3"));
    film.puts(lit, 0, true);
    let placed = |tote| put("C3", true, tote);
    film.puts(lit, 2, true);
    assert_eq!(
        film.events,
        [CellHandsEvent::Grasped(slot("C3")), placed(0)],
        "what is in the hand is a guess"
    );
    film.puts(lit, 0, true);
    film.puts(lit, 2, true);
    assert_eq!(film.events, [CellHandsEvent::Grasped(slot("C3")), placed(0), placed(2)]);
}

#[test]
fn the_first_glimpse_after_a_gap_is_no_stop_in_a_tote() {
    let mut film = Film::new();
    film.picks(LIT, slot("C3"));
    let (rim, left) = (film.face.tote(1).unwrap(), FacePlace::new(-0.22, 0.95, 0.95));
    film.now += Span::from_millis(600);
    film.look(LIT, [Some(left), Some(rim)]);
    assert_eq!(film.hands.in_hand(slot("C3")), 1, "it may be passing: {:?}", film.events);
    film.look(LIT, [Some(left), Some(rim)]);
    film.look(LIT, [Some(left), Some(rim)]);
    assert!(matches!(film.events.last(), Some(CellHandsEvent::Placed(_, 1))), "{:?}", film.events);
}

#[test]
fn a_hand_that_is_taken_for_the_other_one_while_it_alone_is_seen_stays_the_same_hand() {
    let mut film = Film::new();
    let (front, inside) = {
        let at = film.face.slot(slot("C3"));
        (at + FacePlace::new(0.0, 0.3, 0.0), at - FacePlace::new(0.0, 0.12, 0.0))
    };
    let mut look = |from: FacePlace, to: FacePlace, seconds: f64, as_left: bool| {
        let n = (seconds / 0.016) as usize;
        for i in 1..=n {
            let at = from + (to - from) * (i as f64 / n as f64);
            film.look(LIT, if as_left { [Some(at), None] } else { [None, Some(at)] });
        }
    };
    look(front, inside, 0.5, false);
    look(inside, inside, 0.3, true);
    look(inside, inside, 0.2, false);
    look(inside, front, 0.4, false);
    assert_eq!(film.events, [CellHandsEvent::Grasped(slot("C3"))]);
    assert!(!film.hands.may_be_inside(&film.face), "no other hand was ever there");
}

#[test]
fn a_second_person_beside_the_picker_keeps_hands_from_confirming_anything() {
    let mut film = Film::new();
    film.picks(LIT, slot("C3"));
    film.hands.note_company(film.now);
    film.puts(LIT, 1, true);
    assert_eq!(film.events, [CellHandsEvent::Grasped(slot("C3"))]);
}

#[test]
fn how_often_somebody_goes_to_the_lit_slot_is_learned_of_this_person_alone() {
    let lit = Some((slot("B2"), 0));
    let mut film = Film::new();
    let before = film.hands.share.get();
    for _ in 0..3 {
        film.picks(lit, slot("C2"));
    }
    assert!(film.hands.share.get() < before - 0.01, "{} after {before}", film.hands.share.get());
    film.now += Span::from_secs(5);
    film.person = 1;
    film.look(lit, [None, Some(film.at)]);
    assert_eq!(film.hands.share.get(), before, "that is somebody else");
}

#[test]
fn a_piece_where_it_belongs_counts_once_however_often_a_hand_comes_back_to_its_tote() {
    let lit = Some((slot("C3"), 2));
    let mut film = Film::new();
    film.picks(lit, slot("C3"));
    for _ in 0..3 {
        film.puts(lit, 2, true);
        film.moves(lit, FacePlace::new(0.0, 0.9, 1.1), 0.5, true);
    }
    assert_eq!(film.events, [CellHandsEvent::Grasped(slot("C3")), put("C3", true, 2)]);
}

#[test]
fn a_piece_of_the_rack_before_is_none_of_the_rack_that_is_there() {
    let mut film = Film::new();
    film.picks(LIT, slot("C3"));
    film.hands.begin();
    assert_eq!(film.hands.in_hand(slot("C3")), 0, "nobody has taken anything from this rack");
    film.puts(LIT, 1, true);
    let before = HeldPiece { from: slot("C3"), sure: true, is_of_before: true };
    assert_eq!(film.events, [CellHandsEvent::Grasped(slot("C3")), CellHandsEvent::Placed(before, 1)]);
}

#[test]
fn a_hand_that_went_in_and_was_not_seen_since_may_be_there_still() {
    let mut film = Film::new();
    film.moves(LIT, film.face.slot(slot("C3")), 0.6, true);
    film.now += Span::from_secs(5);
    assert!(!film.hands.is_inside(&film.face, film.now), "it is not seen any more");
    assert!(film.hands.may_be_inside(&film.face));
}

#[test]
fn a_hand_of_a_second_person_inside_is_not_forgotten_when_the_first_is_seen_again() {
    let mut film = Film::new();
    film.look(LIT, [None, Some(film.at)]);
    film.person = 1;
    film.look(LIT, [None, Some(film.face.slot(slot("C3")))]);
    film.person = 0;
    film.look(LIT, [None, Some(film.at)]);
    assert!(film.hands.is_inside(&film.face, film.now));
}

#[test]
fn hands_of_two_persons_confirm_nothing_until_one_has_been_alone_for_a_while() {
    let mut film = Film::new();
    film.picks(LIT, slot("C3"));
    film.person = 1;
    film.puts(LIT, 1, true);
    assert_eq!(film.events, [CellHandsEvent::Grasped(slot("C3"))], "whose piece is it?");
    film.now += Span::from_secs(3);
    film.events.clear();
    film.picks(LIT, slot("A1"));
    film.puts(LIT, 0, true);
    assert_eq!(film.events.len(), 2, "{:?}", film.events);
}

#[test]
fn jumps_swaps_and_points_that_are_none_are_not_believed() {
    let mut film = Film::new();
    film.picks(LIT, slot("C3"));
    let (left, elsewhere) = (FacePlace::new(-0.22, 0.95, 0.95), film.face.tote(1).unwrap());
    for _ in 0..6 {
        film.look(LIT, [Some(left), Some(elsewhere)]);
    }
    assert_eq!(film.hands.in_hand(slot("C3")), 1, "a jump puts nothing down");
    let at = film.at;
    for _ in 0..20 {
        film.look(LIT, [Some(at), Some(left)]);
    }
    film.puts(LIT, 2, true);
    let placed = put("C3", true, 2);
    assert_eq!(film.events, [CellHandsEvent::Grasped(slot("C3")), placed], "left was taken for right");
    let before = film.hands.clone();
    let mut bad = film.hand(left);
    bad.palm.x = f64::NAN;
    let seen = HandsSeen {
        station: StationId(0),
        person: 0,
        seen: film.now,
        facing: None,
        eyes: None,
        head: bad.wrist,
        hands: [Some(bad), None],
    };
    let scene = CellHandsScene { face: &film.face, model: &PickModel::builtin(), lit: None, tote: None };
    assert!(film.hands.see(scene, &seen).is_empty());
    assert_eq!(film.hands.hands, before.hands);
}

#[test]
fn where_a_hand_goes_is_told_before_it_is_there_and_of_hands_at_rest_nothing() {
    for name in ["A2", "B4", "C3", "D5"] {
        let mut film = Film::new();
        let (lit, inside) =
            (Some((slot(name), 1)), film.face.slot(slot(name)) - FacePlace::new(0.0, 0.1, 0.0));
        film.moves(lit, film.at, 0.6, true);
        assert!(film.hands.reaches(film.now).is_empty(), "it rests");
        film.begins_to_move(lit, inside, (0.8, 0.7), true);
        let told = film.hands.reaches(film.now);
        let best = told.iter().max_by(|a, b| a.probability.total_cmp(&b.probability)).expect("it moves");
        assert_eq!((best.place, best.is_left), (ReachPlace::Slot(slot(name)), false), "{told:?}");
        assert!(told.iter().map(|t| t.probability).sum::<f64>() <= 1.0 + 1e-9, "{told:?}");
        film.now += Span::from_secs(2);
        assert!(film.hands.reaches(film.now).is_empty(), "nobody knows any more");
    }
}

#[test]
fn a_hand_that_carries_a_piece_is_expected_at_its_tote() {
    let lit = Some((slot("C3"), 2));
    let mut film = Film::new();
    film.picks(lit, slot("C3"));
    let rim = film.face.tote(2).unwrap();
    film.begins_to_move(lit, rim, (0.7, 0.7), true);
    let told = film.hands.reaches(film.now);
    let best = told.iter().max_by(|a, b| a.probability.total_cmp(&b.probability)).expect("it moves");
    assert_eq!(best.place, ReachPlace::Tote(2), "{told:?}");
}

#[test]
fn eyes_that_rest_on_a_wrong_slot_are_a_warning_sooner_but_none_without_a_hand_that_goes_there() {
    // Distance of the hand from the face when the warning comes, on its way to the slot beside the lit one.
    let warned_m = |eyes_on: Option<&str>, goes_to: &str| {
        let mut film = Film::new();
        film.eyes_on = eyes_on.map(|name| film.face.slot(slot(name)));
        let inside = film.face.slot(slot(goes_to)) - FacePlace::new(0.0, 0.12, 0.0);
        (0..20).for_each(|_| film.moves(Some((slot("C3"), 1)), film.at, 0.016, true));
        for step in 1..=60 {
            let share = f64::from(step) / 60.0;
            let to = film.at + (inside - film.at) * (1.0 / (61.0 - f64::from(step)));
            film.moves(Some((slot("C3"), 1)), to, 0.016, true);
            if film.events.iter().any(|event| matches!(event, CellHandsEvent::AimsAt(_))) {
                assert_eq!(film.events, [CellHandsEvent::AimsAt(slot(goes_to))], "at {share}");
                return Some(-film.face.depth_m(film.at));
            }
        }
        None
    };
    let (seen, unseen) = (warned_m(Some("C4"), "C4").unwrap(), warned_m(None, "C4").unwrap());
    assert!(seen > unseen + 0.02, "{seen} m with eyes, {unseen} m without");
    let elsewhere = warned_m(Some("A1"), "C4").unwrap();
    assert!((elsewhere - unseen).abs() < 0.06, "eyes wander: {elsewhere} m, {unseen} m");
    assert_eq!(warned_m(Some("C4"), "C3"), None, "a hand that goes right");
    assert_eq!(warned_m(Some("C3"), "C3"), None);
}

#[test]
fn eyes_raise_the_probability_of_the_slot_on_which_they_rest_and_lower_that_of_others() {
    let probability = |eyes_on: Option<&str>| {
        let (mut film, lit) = (Film::new(), Some((slot("C3"), 1)));
        film.eyes_on = eyes_on.map(|name| film.face.slot(slot(name)));
        (0..20).for_each(|_| film.moves(lit, film.at, 0.016, true));
        let ahead = film.face.slot(slot("C4")) + FacePlace::new(0.0, 0.1, 0.0);
        film.begins_to_move(lit, ahead, (0.8, 0.6), true);
        let told = film.hands.reaches(film.now);
        let right = || told.iter().filter(|reach| !reach.is_left);
        assert!(right().map(|reach| reach.probability).sum::<f64>() <= 1.0 + 1e-9, "{told:?}");
        right().filter(|r| r.place == ReachPlace::Slot(slot("C4"))).map(|r| r.probability).sum::<f64>()
    };
    let [there, unknown, elsewhere] = [Some("C4"), None, Some("A1")].map(probability);
    assert!(there > unknown + 0.1 && elsewhere <= unknown, "{there} {unknown} {elsewhere}");
}

#[test]
fn hands_are_said_to_be_seen_while_those_of_one_person_alone_are() {
    let mut film = Film::new();
    assert!(!film.hands.saw_of_late(film.now));
    film.moves(LIT, film.at, 0.1, true);
    assert!(film.hands.saw_of_late(film.now) && !film.hands.saw_of_late(film.now + OF_LATE));
    film.hands.note_company(film.now);
    assert!(!film.hands.saw_of_late(film.now), "nobody's hands confirm anything then");
}

#[test]
fn what_is_seen_late_or_twice_changes_nothing() {
    let mut film = Film::new();
    film.picks(LIT, slot("C3"));
    let before = film.hands.clone();
    film.now = film.now - Span::from_millis(200);
    let inside = film.face.slot(slot("A1")) - FacePlace::new(0.0, 0.1, 0.0);
    film.look(LIT, [None, Some(inside)]);
    assert_eq!(film.hands, before);
}
