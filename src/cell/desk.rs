//! The hands at one work cell, followed from slot to tote, and warned before they are in a wrong slot.
//!
//! Main types: [`Desk`], [`DeskEvent`]. Refuses: hands of two persons at once, and to confirm anything by guessing.

use super::aim::aims_wrong;
use super::belief::{ReachBeliefs, ReachPlace};
use super::face::{FacePlace, PickFace};
use super::follow::{HandEvent, HandFollower, HeldPiece};
use super::hands::{HandPoints, HandsSeen};
use super::phase::{PickPhase, PiecePhases, SpentPhase};
use crate::reach::PickModel;
use crate::time::{Span, Time};
use crate::warehouse::SlotName;
use smallvec::SmallVec;
use std::sync::Arc;

/// Hands that were not seen for so long are not known of.
const STALE: Span = Span::from_secs(1);
/// A hand that is so deep in a slot is in that one, metres; so near to its edge it may belong to the one beside.
const DEEP_M: f64 = 0.05;
const EDGE_M: f64 = 0.03;
/// A hand is expected where it will be after so long if it goes on as it does, seconds.
const SOON_S: f64 = 0.3;
/// A hand that was seen within this time is shown on its way …
const FRESH: Span = Span::from_millis(500);
/// … while it is faster than this, metres per second, or in a slot.
const MOVES_MPS: f64 = 0.2;
/// Places are told of from this probability on.
const LIKELY: f64 = 0.05;
/// For so long after two persons' hands were seen nothing is confirmed by hand.
const ALONE: Span = Span::from_secs(2);

/// What happened at a work cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeskEvent {
    /// A piece was taken out of a slot.
    Grasped(SlotName),
    /// A piece was put into a tote, by its number at the station. It confirms something only if the hand was seen all
    /// the way.
    Placed(HeldPiece, usize),
    /// A hand goes to this slot, most likely, and not to the one that is lit.
    AimsAt(SlotName),
}

/// What hands are seen at and for.
#[derive(Clone, Copy, Debug)]
pub struct DeskScene<'a> {
    /// The face of the rack that stands there, or stood there last.
    pub face: &'a Arc<PickFace>,
    /// What was learned of reaches.
    pub model: &'a Arc<PickModel>,
    /// The slot that is lit.
    pub lit: Option<SlotName>,
    /// The tote that is wanted.
    pub tote: Option<usize>,
}

/// Where a hand most likely goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenReach {
    /// Whether it is the left one.
    pub is_left: bool,
    /// The slot or tote.
    pub place: ReachPlace,
    /// Its probability.
    pub probability: f64,
}

/// What is believed of the hands at one work cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Desk {
    hands: [HandFollower; 2],
    /// Whose hands were seen last, and when.
    person: Option<(u32, Time)>,
    /// Nothing is confirmed by hand before.
    crowded_until: Option<Time>,
    /// When somebody's hand was inside while several persons' hands were seen.
    crowd_inside: Option<Time>,
    /// Pieces that were put where they do not belong, with the hands that did it, until those grasp again.
    strayed: [Option<(HeldPiece, usize)>; 2],
    /// For each hand the slot that was warned of while it goes there.
    warned: [Option<SlotName>; 2],
    /// Where they go, once something of them was seen.
    beliefs: Option<ReachBeliefs>,
    /// The phases of the piece that is picked now, from which slot.
    piece: Option<(SlotName, PiecePhases)>,
    /// A phase that has just ended.
    spent: Option<SpentPhase>,
}

impl Desk {
    /// Another rack is here.
    pub fn begin(&mut self) {
        self.hands.iter_mut().for_each(HandFollower::begin);
        self.strayed = [None; 2];
    }

    /// A line is over: nobody wants a piece from this slot any more.
    pub fn forget(&mut self, slot: SlotName) {
        self.hands.iter_mut().for_each(|hand| hand.forget(slot));
    }

    /// Takes in hands. Gives what happened, in order. Observations that come out of order are dropped.
    pub fn see(&mut self, scene: DeskScene<'_>, seen: &HandsSeen) -> SmallVec<[DeskEvent; 4]> {
        let (events, hands) = self.follow(scene, seen);
        for (i, hand) in hands.iter().enumerate().filter_map(|(i, hand)| Some((i, hand.as_ref()?))) {
            self.believe(scene, (i, hand), seen);
        }
        if hands.iter().any(Option::is_some) {
            self.note_phase(scene.lit, seen.seen);
        }
        events
    }

    /// Notes how far the piece of the lit line is.
    fn note_phase(&mut self, lit: Option<SlotName>, seen: Time) {
        let Some(lit) = lit else {
            self.piece = None;
            return;
        };
        let is_fresh = |h: &&HandFollower| h.last().is_some_and(|(at, _)| seen - at < FRESH);
        let hands = || self.hands.iter().filter(is_fresh);
        let phase = if self.in_hand(lit) > 0 {
            PickPhase::Carry
        } else if hands().any(HandFollower::is_in_slot) {
            PickPhase::Grasp
        } else if hands().any(|h| h.velocity().y < -MOVES_MPS) {
            PickPhase::Reach
        } else {
            PickPhase::Search
        };
        match &mut self.piece {
            Some((slot, piece)) if *slot == lit => self.spent = piece.see(phase, seen).or(self.spent),
            piece => *piece = Some((lit, PiecePhases::begin(phase, seen))),
        }
    }

    /// What a hand does with a piece of this slot, and for how long, seconds; nothing if that was not seen of late.
    pub fn phase(&self, slot: SlotName, now: Time) -> Option<(PickPhase, f64)> {
        self.piece.as_ref().filter(|(of, _)| *of == slot)?.1.now(now)
    }

    /// The phase that has ended since this was asked last.
    pub fn spent(&mut self) -> Option<SpentPhase> {
        self.spent.take()
    }

    /// What these hands, seen now, would do that is a reason for a warning. It costs little and changes nothing.
    pub fn would_warn(&self, scene: DeskScene<'_>, seen: &HandsSeen) -> Option<DeskEvent> {
        // Beliefs are large, and warnings are not made of them.
        let mut desk = Desk { beliefs: None, ..*self };
        let (events, _) = desk.follow(scene, seen);
        events.into_iter().find(|event| match event {
            DeskEvent::AimsAt(_) => true,
            DeskEvent::Grasped(slot) => scene.lit.is_some_and(|lit| lit != *slot),
            DeskEvent::Placed(piece, tote) => {
                scene.lit == Some(piece.from) && scene.tote.is_some_and(|wanted| wanted != *tote)
            }
        })
    }

    /// Follows hands from slot to tote. Gives what happened, and the hands that can be believed, each as the one that
    /// it is.
    fn follow(
        &mut self,
        scene: DeskScene<'_>,
        seen: &HandsSeen,
    ) -> (SmallVec<[DeskEvent; 4]>, [Option<HandPoints>; 2]) {
        let (face, mut events) = (scene.face, SmallVec::new());
        match self.person {
            Some((_, at)) if seen.seen <= at && at - seen.seen < STALE => return (events, [None; 2]),
            Some((person, at)) if person != seen.person && seen.seen - at < STALE => {
                self.crowded_until = Some(seen.seen + ALONE);
                self.hands = Default::default();
                self.beliefs = None;
            }
            Some((person, _)) if person != seen.person => self.beliefs = None,
            _ => {}
        }
        self.person = Some((seen.person, seen.seen));
        let is_alone = self.crowded_until.is_none_or(|until| seen.seen >= until);
        let mut hands = seen.hands.map(|hand| hand.filter(HandPoints::is_sound));
        let grips = hands.map(|hand| hand.map(|h| face.of(h.grip())));
        if self.are_swapped(&grips, seen.seen) {
            hands.swap(0, 1);
        }
        for (i, hand) in hands.iter_mut().enumerate() {
            let Some(at) = hand.map(|h| face.of(h.grip())) else { continue };
            let event = self.hands[i].see(face, at, seen.seen);
            // What a hand does in a crowd counts for nothing, but must not be taken for what it did before.
            let event = event.and_then(|event| self.took(i, event, scene.tote));
            if !is_alone {
                self.crowd_inside = Some(seen.seen).filter(|_| face.is_inside(at)).or(self.crowd_inside);
                *hand = None;
                continue;
            }
            events.extend(event);
            events.extend(scene.lit.and_then(|slot| self.aims(face, i, slot)).map(DeskEvent::AimsAt));
        }
        (events, hands)
    }

    /// Follows where a hand goes, while anything is wanted.
    fn believe(&mut self, scene: DeskScene<'_>, (i, hand): (usize, &HandPoints), seen: &HandsSeen) {
        let can_be = self.hands[i].last().is_some_and(|(at, _)| at == seen.seen);
        if !can_be || (scene.lit.is_none() && scene.tote.is_none()) {
            return;
        }
        let beliefs = self.beliefs.get_or_insert_with(|| ReachBeliefs::new(scene.model, scene.face));
        beliefs.turn_to(scene.face);
        let carries = self.hands[i].held().is_some();
        beliefs.see((i, hand), (scene.lit, scene.tote), carries, seen);
    }

    /// Where hands that are on their way go, with probabilities of at least 0.05.
    pub fn reaches(&self, now: Time) -> SmallVec<[SeenReach; 4]> {
        let Some(beliefs) = &self.beliefs else { return SmallVec::new() };
        let is_moving = |i: &usize| {
            let hand = &self.hands[*i];
            let is_fresh = hand.last().is_some_and(|(seen, _)| now - seen < FRESH);
            is_fresh && (hand.velocity().norm() > MOVES_MPS || hand.is_in_slot())
        };
        let of = |i: usize| {
            let likely = beliefs.probabilities(i).filter(|(_, p)| *p >= LIKELY);
            likely.map(move |(place, probability)| SeenReach { is_left: i == 0, place, probability })
        };
        (0..2).filter(is_moving).flat_map(of).collect()
    }

    /// What a hand's deed means. A hand that stops where it put a piece that belongs elsewhere may take it out again,
    /// and one that comes from there to the wanted tote brings it. What lies where it belongs counts once.
    fn took(&mut self, hand: usize, event: HandEvent, wanted: Option<usize>) -> Option<DeskEvent> {
        match event {
            HandEvent::Grasped(slot, deepest) => {
                self.strayed[hand] = None;
                if let Some(beliefs) = &mut self.beliefs {
                    beliefs.learn(slot, deepest);
                }
                Some(DeskEvent::Grasped(slot))
            }
            HandEvent::Placed(piece, tote) => {
                self.strayed[hand] = wanted.filter(|wanted| *wanted != tote).map(|_| (piece, tote));
                Some(DeskEvent::Placed(piece, tote))
            }
            HandEvent::Searched(tote) => {
                let (piece, there) = self.strayed[hand].take()?;
                if there == tote {
                    self.hands[hand].take_up(piece);
                    return None;
                }
                Some(DeskEvent::Placed(piece, tote)).filter(|_| wanted == Some(tote))
            }
        }
    }

    /// Whether left and right have changed places since they were seen last.
    fn are_swapped(&self, grips: &[Option<FacePlace>; 2], seen: Time) -> bool {
        let can =
            |hand: usize, at: Option<FacePlace>| at.is_none_or(|at| self.hands[hand].can_be_at(at, seen));
        let [a, b] = *grips;
        !(can(0, a) && can(1, b)) && can(0, b) && can(1, a)
    }

    /// The wrong slot to which a hand goes, once for each reach.
    fn aims(&mut self, face: &PickFace, hand: usize, lit: SlotName) -> Option<SlotName> {
        let follower = &self.hands[hand];
        let (_, at) = follower.last()?;
        let slot = if follower.is_in_slot() {
            // At the edge of a slot beside the lit one it may still be on its way there.
            let to_lit = (face.slot(lit) - at).try_normalize(1e-6).unwrap_or_default() * EDGE_M;
            let nearer = FacePlace::new(at.x + to_lit.x, at.y, at.z + to_lit.z);
            face.slot_at(nearer).filter(|slot| *slot != lit && face.depth_m(at) > DEEP_M)
        } else if follower.velocity().y < 0.0 {
            aims_wrong(face, lit, at, follower.velocity())
        } else {
            self.warned[hand] = None;
            return None;
        };
        let slot = slot.filter(|_| self.warned[hand].is_none())?;
        self.warned[hand] = Some(slot);
        Some(slot)
    }

    /// How many pieces from a slot of the rack that is there are in hands that were seen all the time since.
    pub fn in_hand(&self, slot: SlotName) -> u32 {
        let of = |held: HeldPiece| held.sure && !held.is_of_before && held.from == slot;
        self.hands.iter().filter(|h| h.held().is_some_and(of)).count() as u32
    }

    /// Whether hands were seen within the last second.
    pub fn sees(&self, now: Time) -> bool {
        self.person.is_some_and(|(_, at)| now - at < STALE)
    }

    /// Whether a hand is in the opening or beyond it, or will be there in a moment, as far as hands are seen.
    pub fn comes_inside(&self, face: &PickFace, now: Time) -> bool {
        self.is_any(now, |at, velocity| face.is_inside(at) || face.is_inside(at + velocity * SOON_S))
    }

    /// Whether a hand is in the opening or beyond it, as far as hands are seen.
    pub fn is_inside(&self, face: &PickFace, now: Time) -> bool {
        self.is_any(now, |at, _| face.is_inside(at))
    }

    /// Whether a hand was inside when it was seen last, however long ago: it may be there still.
    pub fn may_be_inside(&self, face: &PickFace) -> bool {
        self.hands.iter().any(|h| h.last().is_some_and(|(_, at)| face.is_inside(at)))
    }

    fn is_any(&self, now: Time, is: impl Fn(FacePlace, FacePlace) -> bool) -> bool {
        let is_fresh = |seen: Time| now - seen < STALE;
        let crowd = self.crowd_inside.is_some_and(is_fresh);
        crowd
            || self
                .hands
                .iter()
                .any(|h| h.last().is_some_and(|(seen, at)| is_fresh(seen) && is(at, h.velocity())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::HandPoints;
    use crate::id::StationId;
    use crate::warehouse::stations;

    /// Observations of a right hand that goes from place to place, 60 a second; the left one rests.
    struct Film {
        face: Arc<PickFace>,
        desk: Desk,
        now: Time,
        at: FacePlace,
        person: u32,
        events: Vec<DeskEvent>,
    }

    /// Nothing is lit.
    const LIT: Option<(SlotName, usize)> = None;

    impl Film {
        fn new() -> Film {
            let w = stations();
            let (station, rack) = (&w.stations[StationId(0)], w.rack_types.iter().next().unwrap());
            let face = PickFace::new(station.cell.as_ref().unwrap(), w.nodes[station.node].at, rack);
            let (desk, at, now) =
                (Desk::default(), FacePlace::new(0.22, 0.95, 0.95), Time::from_secs_f64(10.0));
            let face = Arc::new(face);
            Film { face, desk, now, at, person: 0, events: Vec::new() }
        }

        fn hand(&self, at: FacePlace) -> HandPoints {
            let place = |back: f64| self.face.on_map(at + FacePlace::new(0.0, back, 0.0));
            HandPoints { wrist: place(0.17), palm: place(0.09), tips: [place(0.0); 2] }
        }

        fn look(&mut self, lit: Option<(SlotName, usize)>, hands: [Option<FacePlace>; 2]) {
            let hands = hands.map(|at| at.map(|at| self.hand(at)));
            let (station, person, seen) = (StationId(0), self.person, self.now);
            let head = self.face.on_map(FacePlace::new(0.0, 1.05, 1.6));
            let seen = HandsSeen { station, person, seen, head, facing: None, hands };
            let (lit, tote) = (lit.map(|(slot, _)| slot), lit.map(|(_, tote)| tote));
            let scene = DeskScene { face: &self.face, model: &PickModel::builtin(), lit, tote };
            self.events.extend(self.desk.see(scene, &seen));
            self.now += Span::from_millis(16);
        }

        /// The hand moves by a smooth step, and is seen or not.
        fn moves(&mut self, lit: Option<(SlotName, usize)>, to: FacePlace, seconds: f64, is_seen: bool) {
            self.begins_to_move(lit, to, (seconds, 1.0), is_seen);
        }

        /// The same for the first share of the time.
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

    fn put(name: &str, sure: bool, tote: usize) -> DeskEvent {
        DeskEvent::Placed(HeldPiece { from: slot(name), sure, is_of_before: false }, tote)
    }

    #[test]
    fn a_piece_is_followed_from_its_slot_to_its_tote() {
        let mut film = Film::new();
        for (name, tote) in [("C3", 1), ("A1", 0), ("D5", 2)] {
            film.events.clear();
            film.picks(LIT, slot(name));
            assert_eq!(film.desk.in_hand(slot(name)), 1, "{name}");
            film.puts(LIT, tote, true);
            let placed = put(name, true, tote);
            assert_eq!(film.events, [DeskEvent::Grasped(slot(name)), placed], "{name}");
            assert_eq!(film.desk.in_hand(slot(name)), 0);
        }
    }

    #[test]
    fn a_hand_that_was_not_seen_on_its_way_confirms_nothing() {
        let mut film = Film::new();
        film.picks(LIT, slot("C3"));
        film.puts(LIT, 1, false);
        assert_eq!(film.events, [DeskEvent::Grasped(slot("C3")), put("C3", false, 1)]);
    }

    #[test]
    fn a_hand_on_its_way_to_a_wrong_slot_is_warned_of_once_and_before_it_has_a_piece() {
        let lit = Some((slot("B2"), 0));
        for name in ["C2", "B3", "A4"] {
            let mut film = Film::new();
            let front = film.face.slot(slot(name)) + FacePlace::new(0.0, 0.3, 0.0);
            film.moves(lit, front, 0.5, true);
            film.moves(lit, film.face.slot(slot(name)) - FacePlace::new(0.0, 0.08, 0.0), 0.4, true);
            assert_eq!(film.events, [DeskEvent::AimsAt(slot(name))], "{name}");
        }
        let mut film = Film::new();
        film.picks(lit, slot("B2"));
        assert_eq!(
            film.events,
            [DeskEvent::Grasped(slot("B2"))],
            "the right slot is no reason for a warning"
        );
    }

    #[test]
    fn a_piece_that_goes_from_a_wrong_tote_to_the_right_one_counts_there() {
        let lit = Some((slot("C3"), 2));
        let mut film = Film::new();
        film.picks(lit, slot("C3"));
        film.puts(lit, 0, true);
        film.puts(lit, 2, true);
        let placed = |tote| put("C3", true, tote);
        assert_eq!(film.events, [DeskEvent::Grasped(slot("C3")), placed(0), placed(2)]);
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
        assert_eq!(film.events, [DeskEvent::Grasped(slot("C3")), put("C3", true, 2)]);
    }

    #[test]
    fn a_piece_of_the_rack_before_is_none_of_the_rack_that_is_there() {
        let mut film = Film::new();
        film.picks(LIT, slot("C3"));
        film.desk.begin();
        assert_eq!(film.desk.in_hand(slot("C3")), 0, "nobody has taken anything from this rack");
        film.puts(LIT, 1, true);
        let before = HeldPiece { from: slot("C3"), sure: true, is_of_before: true };
        assert_eq!(film.events, [DeskEvent::Grasped(slot("C3")), DeskEvent::Placed(before, 1)]);
    }

    #[test]
    fn a_hand_that_went_in_and_was_not_seen_since_may_be_there_still() {
        let mut film = Film::new();
        film.moves(LIT, film.face.slot(slot("C3")), 0.6, true);
        film.now += Span::from_secs(5);
        assert!(!film.desk.is_inside(&film.face, film.now), "it is not seen any more");
        assert!(film.desk.may_be_inside(&film.face));
    }

    #[test]
    fn a_hand_of_a_second_person_inside_is_not_forgotten_when_the_first_is_seen_again() {
        let mut film = Film::new();
        film.look(LIT, [None, Some(film.at)]);
        film.person = 1;
        film.look(LIT, [None, Some(film.face.slot(slot("C3")))]);
        film.person = 0;
        film.look(LIT, [None, Some(film.at)]);
        assert!(film.desk.is_inside(&film.face, film.now));
    }

    #[test]
    fn hands_of_two_persons_confirm_nothing_until_one_has_been_alone_for_a_while() {
        let mut film = Film::new();
        film.picks(LIT, slot("C3"));
        film.person = 1;
        film.puts(LIT, 1, true);
        assert_eq!(film.events, [DeskEvent::Grasped(slot("C3"))], "whose piece is it?");
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
        assert_eq!(film.desk.in_hand(slot("C3")), 1, "a jump puts nothing down");
        let at = film.at;
        for _ in 0..20 {
            film.look(LIT, [Some(at), Some(left)]);
        }
        film.puts(LIT, 2, true);
        let placed = put("C3", true, 2);
        assert_eq!(film.events, [DeskEvent::Grasped(slot("C3")), placed], "left was taken for right");
        let before = film.desk.clone();
        let mut bad = film.hand(left);
        bad.palm.x = f64::NAN;
        let seen = HandsSeen {
            station: StationId(0),
            person: 0,
            seen: film.now,
            facing: None,
            head: bad.wrist,
            hands: [Some(bad), None],
        };
        let scene = DeskScene { face: &film.face, model: &PickModel::builtin(), lit: None, tote: None };
        assert!(film.desk.see(scene, &seen).is_empty());
        assert_eq!(film.desk.hands, before.hands);
    }

    #[test]
    fn where_a_hand_goes_is_told_before_it_is_there_and_of_hands_at_rest_nothing() {
        for name in ["A2", "B4", "C3", "D5"] {
            let mut film = Film::new();
            let (lit, inside) =
                (Some((slot(name), 1)), film.face.slot(slot(name)) - FacePlace::new(0.0, 0.1, 0.0));
            film.moves(lit, film.at, 0.6, true);
            assert!(film.desk.reaches(film.now).is_empty(), "it rests");
            film.begins_to_move(lit, inside, (0.8, 0.7), true);
            let told = film.desk.reaches(film.now);
            let best = told.iter().max_by(|a, b| a.probability.total_cmp(&b.probability)).expect("it moves");
            assert_eq!((best.place, best.is_left), (ReachPlace::Slot(slot(name)), false), "{told:?}");
            assert!(told.iter().map(|t| t.probability).sum::<f64>() <= 1.0 + 1e-9, "{told:?}");
            film.now += Span::from_secs(2);
            assert!(film.desk.reaches(film.now).is_empty(), "nobody knows any more");
        }
    }

    #[test]
    fn a_hand_that_carries_a_piece_is_expected_at_its_tote() {
        let lit = Some((slot("C3"), 2));
        let mut film = Film::new();
        film.picks(lit, slot("C3"));
        let rim = film.face.tote(2).unwrap();
        film.begins_to_move(lit, rim, (0.7, 0.7), true);
        let told = film.desk.reaches(film.now);
        let best = told.iter().max_by(|a, b| a.probability.total_cmp(&b.probability)).expect("it moves");
        assert_eq!(best.place, ReachPlace::Tote(2), "{told:?}");
    }

    #[test]
    fn what_is_seen_late_or_twice_changes_nothing() {
        let mut film = Film::new();
        film.picks(LIT, slot("C3"));
        let before = film.desk.clone();
        film.now = film.now - Span::from_millis(200);
        let inside = film.face.slot(slot("A1")) - FacePlace::new(0.0, 0.1, 0.0);
        film.look(LIT, [None, Some(inside)]);
        assert_eq!(film.desk, before);
    }
}
