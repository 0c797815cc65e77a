//! What a walker does when people have kept it for a while: it steps out of their way, goes round, or counts as
//! arrived.
//!
//! Also how two people who walk as a pair stay side by side. Refuses: to leave two walkers blocking each other; of two,
//! the one with the higher number gives way, and a walker that has waited very long gives way whatever its number.

use super::legs::WalkerSurroundings;
use super::person::{APART_M, PersonNear};
use super::{Aside, KEPT, Walker, WalkerDoing};
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::walkway::EdgeSet;

/// A walker that has moved this far is no longer kept, metres.
const GOT_ON_M: f64 = 0.5;
/// A route that ends this near, at a place taken by a person, counts as completed, metres.
const ENDS_M: f64 = 1.3;
/// How far a walker steps out of people's way, at most, metres.
const STEPS_OUT_M: f64 = 4.0;
/// How long it stays there.
const STEPS_OUT: Span = Span::from_secs(3);
/// Range within which other people count as those who keep the walker, metres.
const NEAR_M: f64 = 1.6;
/// If there is no clear place aside, a place this far from others will do, metres.
const AWAY_M: f64 = 1.8;
/// People this near block a detour, metres.
const IN_SIGHT_M: f64 = 6.0;
/// Room that a walker leaves for people who pass, metres.
const ROOM_M: f64 = APART_M + 0.1;
/// A pair this near each other walks side by side, metres.
const TOGETHER_M: f64 = 4.0;
/// Sideways distance between a pair, metres, and the lead at which the pace correction is largest, metres.
const SIDE_BY_SIDE_M: f64 = 0.8;
const LEAD_M: f64 = 1.5;

impl Walker {
    /// Whether another person stands at a place.
    pub(super) fn is_taken(place: Point, around: &WalkerSurroundings<'_>) -> bool {
        around.people.iter().any(|p| (p.at - place).norm() < ROOM_M)
    }

    /// Responds to people in the way: after a moment one of the two does something else.
    pub(super) fn get_past_people(&mut self, now: Time, around: &WalkerSurroundings<'_>) {
        let here = self.legs.at;
        self.kept_since = self.kept_since.filter(|(_, at)| (here - at).norm() < GOT_ON_M);
        if matches!(self.doing, WalkerDoing::Work(..) | WalkerDoing::Gone) {
            return;
        }
        if self.legs.route.is_empty() {
            self.kept_since = None;
            let asks = |p: &PersonNear| p.kept && (p.at - here).norm() < NEAR_M;
            if self.aside.is_none() && around.people.iter().any(asks) {
                self.step_out(around);
            }
            return;
        }
        let other = self.legs.kept_by.and_then(|who| around.people.iter().find(|p| p.who == who));
        let Some(other) = other else { return };
        let (since, _) = *self.kept_since.get_or_insert((now, here));
        let long = now - since;
        if long < KEPT {
            return;
        }
        if let Some(aside) = self.aside.filter(|a| a.until.is_none()) {
            // The walker's current place will do as well: the others find their way round it.
            self.legs.route.clear();
            self.aside = Some(Aside { until: Some(now + aside.stay), ..aside });
            return;
        }
        let end = *self.legs.route.back().expect("seen above");
        if (end - here).norm() < ENDS_M && Walker::is_taken(end, around) {
            self.legs.route.clear();
            self.kept_since = None;
            if matches!(self.doing, WalkerDoing::Leave(_)) {
                self.doing = WalkerDoing::Gone;
            }
            return;
        }
        let rival = |p: &PersonNear| p.aim.is_some() && p.who < self.who && (p.at - here).norm() < NEAR_M;
        let gives_way = around.people.iter().any(rival);
        let stands = other.aim.is_none() && long >= self.traits.patience;
        if stands && self.go_round(end, around) {
            (self.kept_since, self.detour) = (None, true);
        } else if gives_way || long >= self.traits.patience * 2 {
            self.kept_since = None;
            self.step_out(around);
        }
    }

    /// Takes another path to the end; gives whether there is one.
    fn go_round(&mut self, end: Point, around: &WalkerSurroundings<'_>) -> bool {
        let cut = cut_by_people(self.legs.at, around);
        let before = self.legs.route.clone();
        let far = |at: Point, route: &std::collections::VecDeque<Point>| {
            route.iter().fold((at, 0.0), |(from, sum), to| (*to, sum + (to - from).norm())).1
        };
        let long = far(self.legs.at, &before);
        let found =
            self.go(end, around, Some(&cut)) && far(self.legs.at, &self.legs.route) < 2.0 * long + 10.0;
        if !found {
            self.legs.route = before;
        }
        found
    }

    /// Goes to a place nearby that is out of people's paths, and stays there for a moment.
    fn step_out(&mut self, around: &WalkerSurroundings<'_>) {
        let here = self.legs.at;
        let ways: Vec<Segment> =
            around.people.iter().filter_map(|p| Some(Segment { a: p.at, b: beyond(p.at, p.aim?) })).collect();
        let free = |q: &Point, room_m: f64| {
            around.people.iter().all(|p| (p.at - q).norm() >= room_m)
                && around.robots.iter().all(|r| r.gap(*q) > 0.0)
        };
        let clear = |q: &Point| free(q, ROOM_M) && ways.iter().all(|way| way.distance_to(*q) >= ROOM_M);
        // In a long aisle there is no such place. Two can pass away from where others stand.
        let wide = |q: &Point| free(q, AWAY_M);
        let places = around.walkways.standing_places(here, STEPS_OUT_M);
        let cut = cut_by_people(here, around);
        let way = |q: Point| {
            let straight = Segment { a: here, b: q };
            let hit = |p: &PersonNear| straight.distance_to(p.at) < APART_M.min((p.at - here).norm() - 1e-6);
            if around.walkways.sees(here, q) && !around.people.iter().any(hit) {
                return Some((q, vec![q]));
            }
            let path = around.walkways.path(here, q, &cut)?;
            let short = path.length_m < 2.0 * STEPS_OUT_M;
            short.then(|| (q, path.points.into_iter().skip(1).collect()))
        };
        let first = places.iter().copied().filter(clear).find_map(way);
        if let Some((goal, points)) = first.or_else(|| places.iter().copied().filter(wide).find_map(way)) {
            self.legs.set_off(points, around.walkways);
            self.aside = Some(Aside { goal, stay: STEPS_OUT, until: None });
        }
    }

    /// The speed at which the walker stays beside the colleague of its pair.
    pub(super) fn pace_with(&mut self, companion: Option<PersonNear>, wanted: f64) -> f64 {
        self.legs.beside_m = None;
        let (Some(aim), Some(other)) = (self.legs.route.front(), companion) else { return wanted };
        let d = self.legs.at - other.at;
        let end = self.legs.route.back().map_or(0.0, |end| (end - self.legs.at).norm());
        if other.works && d.norm() < TOGETHER_M && end > 2.0 * TOGETHER_M && self.doing == WalkerDoing::Duty {
            // The walker waits until the other is done, which is never longer than the other's work takes.
            return 0.0;
        }
        let Some(their_aim) = other.aim else { return wanted };
        let (way, theirs) = (aim - self.legs.at, their_aim - other.at);
        let same = way.norm() > 0.0 && theirs.norm() > 0.0 && way.normalize().dot(&theirs.normalize()) > 0.5;
        if !same || d.norm() > TOGETHER_M || wanted <= 0.0 || self.aside.is_some() {
            return wanted;
        }
        let side = if self.who < other.who { 0.5 } else { -0.5 };
        self.legs.beside_m = Some(side * SIDE_BY_SIDE_M);
        // The walker ahead slows down, the one behind hurries a little.
        let lead = (d.dot(&way.normalize()) / LEAD_M).clamp(-1.0, 1.0);
        wanted.min(other.usual_mps) * (1.0 - if lead > 0.0 { 0.6 * lead } else { 0.25 * lead })
    }
}

/// Where a person who walks to `aim` is a little later.
fn beyond(from: Point, aim: Point) -> Point {
    let way = aim - from;
    if way.norm() > 0.0 { from + way.normalize() * way.norm().max(STEPS_OUT_M) } else { aim }
}

/// Walkways on which people nearby stand, except the one on which the walker itself stands.
fn cut_by_people(at: Point, around: &WalkerSurroundings<'_>) -> EdgeSet {
    let mut cut = around.walkways.no_edges();
    for p in around.people.iter().filter(|p| (p.at - at).norm() < IN_SIGHT_M) {
        for e in around.walkways.edges_within(p.at, APART_M) {
            if around.walkways.segment(e).distance_to(at) > 0.3 {
                cut.insert(e);
            }
        }
    }
    cut
}
