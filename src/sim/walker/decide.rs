//! What a walker decides: what it notices, where it goes, when it gives up waiting.
//!
//! Refuses: to move anybody; it sets the route and the wanted speed, the legs do the rest.

use super::cause::WalkCause;
use super::impulse::{Impulse, ImpulseKind};
use super::legs::{Legs, RobotNear, WalkerSurroundings};
use super::person::BODY_M;
use super::persona::Persona;
use super::{Aside, Errand, Shown, Walker, WalkerDoing, WorkKnowledge};
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::{Dense, WalkEdgeId, WalkNodeId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::walkway::{EdgeSet, WalkPath, Walkways};
use giveway_people::human::Mover;

/// A walker this near to the place of a job can work, metres.
const AT_WORK_M: f64 = 0.6;
/// If a colleague stands at that place, this distance to it is enough, metres.
const BESIDE_WORK_M: f64 = 1.3;
/// Largest distance between the end of a shown path and the place of the job, metres.
const PATH_ENDS_M: f64 = 1.5;
/// A walker that is shown no path takes its own way after this.
const OWN_WAY: Span = Span::from_secs(10);
/// A robot that approaches is noticed within this distance, metres.
const NEAR_M: f64 = 3.0;
/// After a reaction, a walker does not react to robots again for this long.
const CALM: Span = Span::from_secs(10);
/// A walkway within this distance is the one that the walker stands on, metres.
const HERE_M: f64 = 0.3;
/// How far a walker looks along a path, in steps of the second length, metres.
const LOOK_M: f64 = 3.0;
const STEP_M: f64 = 0.2;
/// A walker that has moved this far is no longer blocked by the same robot, metres.
const GOT_AWAY_M: f64 = 0.5;
/// How long a walker that was led aside on its way home stays there.
const MAKES_ROOM: Span = Span::from_secs(20);
/// A walker this near to a place aside has arrived, metres: places beside walls are moved off them.
const ASIDE_M: f64 = 0.5;
/// A walker gives up an errand when it has come no nearer to its place for this long.
const ERRAND: Span = Span::from_secs(60);
/// How much longer than its patience a walker waits for a robot that drives past.
const PASSES: Span = Span::from_secs(5);
/// A smaller gain is no progress towards a place, metres.
const NEARER_M: f64 = 0.5;
/// Robots this near are in the way of a detour, metres.
const IN_SIGHT_M: f64 = 6.0;
/// Least distance of an unknown place from all known ones, metres.
const UNKNOWN_M: f64 = 1.5;

impl Walker {
    /// Notices what the device shows, impulses, and what robots do.
    pub(super) fn notice(&mut self, now: Time, around: &WalkerSurroundings<'_>, work: &WorkKnowledge<'_>) {
        while let Some((_, shown)) = self.news.pop_front_if(|(due, _)| *due <= now) {
            self.heed(shown, around.walkways);
        }
        while let Some(impulse) = self.impulses.due(now) {
            self.follow(impulse, now, around, work);
        }
        self.mind_robots(now, around);
    }

    /// Takes in what the device shows. The walker follows another path to work or ignores it. A walker on an errand
    /// keeps to it, but takes a path that leads there.
    fn heed(&mut self, shown: Shown, walkways: &Walkways) {
        let new = self.shown.as_ref().is_none_or(|s| s.version != shown.version);
        let busy =
            matches!(self.doing, WalkerDoing::Work(..) | WalkerDoing::Job { .. } | WalkerDoing::Wander(_));
        self.ignored = self.ignored.filter(|_| !shown.leave);
        if shown.leave && (busy || self.aside.is_some()) {
            (self.aside, self.detour, self.followed) = (None, false, None);
            self.doing = if busy { WalkerDoing::Duty } else { self.doing };
            self.legs.route.clear();
        }
        if new && shown.redirected {
            let ignores = self.heeds.happens_of(self.ignore) && !shown.leave;
            self.ignored = ignores.then_some(shown.version);
            match self.doing {
                WalkerDoing::Job { goal, until: None, .. } if !ignores && leads_to(&shown, goal) => {
                    self.legs.set_off(join(&self.legs, &shown.path, walkways), walkways);
                }
                WalkerDoing::Wander(_) if !ignores => self.doing = WalkerDoing::Duty,
                WalkerDoing::Leave(_) if !ignores && !shown.path.is_empty() => {
                    let goal = shown.path[shown.path.len() - 1];
                    self.legs.set_off(join(&self.legs, &shown.path, walkways), walkways);
                    self.aside = Some(Aside { goal, stay: MAKES_ROOM, until: None });
                }
                _ => {}
            }
        } else if new {
            self.ignored = None;
        }
        self.shown = Some(shown);
    }

    /// Follows an impulse if the walker is on its way to work. An impulse scripted by the scenario is followed at any
    /// time until the walker leaves.
    fn follow(
        &mut self,
        impulse: Impulse,
        now: Time,
        around: &WalkerSurroundings<'_>,
        work: &WorkKnowledge<'_>,
    ) {
        let Impulse { kind, pick, stay } = impulse;
        let walks = self.doing == WalkerDoing::Duty && !self.legs.route.is_empty();
        let leaves = matches!(self.doing, WalkerDoing::Leave(_) | WalkerDoing::Gone);
        if leaves || !(walks || kind == ImpulseKind::Scripted) {
            return;
        }
        let errand = |cause, goal| WalkerDoing::Job { cause, goal, stay, until: None };
        let known = || work.known.get((pick * work.known.len() as f64) as usize).copied();
        let unknown = || somewhere(around.walkways, work.known, pick);
        let doing = match kind {
            ImpulseKind::Pause => {
                self.pause_until = now + stay;
                return;
            }
            ImpulseKind::Look => {
                self.look_until = now + stay;
                return;
            }
            ImpulseKind::Mind => known().map(|goal| errand(WalkCause::ChangeOfMind, goal)),
            ImpulseKind::Unknown => unknown().map(|goal| errand(WalkCause::UnknownGoal, goal)),
            ImpulseKind::Help => {
                let colleague = work.colleagues.get((pick * work.colleagues.len() as f64) as usize).copied();
                colleague.or_else(unknown).map(|goal| errand(WalkCause::Help, goal))
            }
            ImpulseKind::Scripted => unknown().map(|goal| errand(WalkCause::Scripted, goal)),
            ImpulseKind::Wander => Some(WalkerDoing::Wander(now + stay)),
        };
        if let Some(doing) = doing {
            (self.doing, self.detour, self.aside, self.nearer_since) = (doing, false, None, None);
            self.legs.route.clear();
        }
    }

    /// Reacts to an approaching robot as the persona does, at intervals.
    fn mind_robots(&mut self, now: Time, around: &WalkerSurroundings<'_>) {
        let here = self.legs.at;
        let comes = |r: &&RobotNear| {
            let d = here - r.at;
            d.norm() < NEAR_M && r.sweeps(here, 10.0)
        };
        let Some(robot) = around.robots.iter().find(comes) else {
            if now < self.reacts_until && self.traits.persona == Persona::Freezes {
                self.reacts_until = now;
            }
            return;
        };
        if now < self.calm_until || matches!(self.doing, WalkerDoing::Work(..) | WalkerDoing::Gone) {
            return;
        }
        self.calm_until = now + CALM;
        let seconds = if self.traits.persona == Persona::Freezes { 8 } else { 3 };
        match self.traits.persona {
            Persona::CutsThrough => return,
            // A driver stops.
            Persona::Yields if self.legs.vehicle.is_some() => {}
            Persona::Yields => {
                let goal = beside(here, robot, around);
                self.aside = goal.map(|goal| Aside { goal, stay: Span::from_secs(3), until: None });
                if goal.is_some() {
                    self.legs.route.clear();
                }
            }
            Persona::Hurries | Persona::Freezes => {}
        }
        self.reacts_until = now + Span::from_secs(seconds);
    }

    /// The walker's wanted speed, metres per second.
    pub(super) fn wanted_mps(&self, now: Time) -> f64 {
        let usual = self.traits.speed_mps;
        let told_to_stand = self.shown.as_ref().is_some_and(|s| s.stop);
        let reacts = now < self.reacts_until;
        let stands = match self.traits.persona {
            Persona::Freezes => reacts,
            Persona::Yields => reacts && self.aside.is_none(),
            Persona::Hurries | Persona::CutsThrough => false,
        };
        if told_to_stand || stands || now < self.pause_until {
            return 0.0;
        }
        if let Some(vehicle) = self.legs.vehicle {
            let top = vehicle.figures().speed_mps;
            let hurries = matches!(self.doing, WalkerDoing::Job { cause: WalkCause::Help, .. });
            return if hurries { top } else { usual };
        }
        match self.doing {
            WalkerDoing::Job { cause: WalkCause::Help, .. } => 1.5 * usual,
            _ if reacts && self.traits.persona == Persona::Hurries => 1.3 * usual,
            _ => usual,
        }
    }

    /// Sets a route if there is none, and moves on to the next activity.
    pub(super) fn decide(&mut self, now: Time, around: &WalkerSurroundings<'_>, work: &WorkKnowledge<'_>) {
        if let Some(aside) = self.aside {
            return self.step_aside(aside, now, around);
        }
        let arrived = self.legs.route.is_empty();
        self.detour &= !arrived;
        match self.doing {
            WalkerDoing::Duty => self.do_duty(now, around, work),
            WalkerDoing::Work(id, until) if until <= now => {
                self.finished.push(id);
                self.doing = WalkerDoing::Duty;
                self.idle_since = now;
            }
            WalkerDoing::Work(..) | WalkerDoing::Gone => {}
            WalkerDoing::Job { until: Some(until), .. } if until <= now => self.back_to_duty(now),
            WalkerDoing::Job { until: Some(_), .. } => {}
            WalkerDoing::Job { cause, goal, stay, until: None } => {
                if arrived && !self.go(goal, around, None) {
                    self.back_to_duty(now);
                } else if self.legs.route.is_empty() {
                    self.doing = WalkerDoing::Job { cause, goal, stay, until: Some(now + stay) };
                }
            }
            WalkerDoing::Wander(until) if until <= now => self.back_to_duty(now),
            WalkerDoing::Wander(_) if arrived => self.stroll(around.walkways),
            WalkerDoing::Wander(_) => {}
            WalkerDoing::Leave(door) => {
                if arrived && !self.go(door, around, None) || (self.legs.at - door).norm() < 0.3 {
                    self.doing = WalkerDoing::Gone;
                }
            }
        }
    }

    pub(super) fn back_to_duty(&mut self, now: Time) {
        (self.doing, self.followed, self.idle_since) = (WalkerDoing::Duty, None, now);
        self.legs.route.clear();
    }

    fn do_duty(&mut self, now: Time, around: &WalkerSurroundings<'_>, work: &WorkKnowledge<'_>) {
        let shown = self.shown.as_ref().filter(|s| !s.path.is_empty());
        let version = shown.map(|s| s.version);
        let fresh = version.is_some() && version != self.followed && version != self.ignored;
        if let Some(shown) = shown.filter(|_| fresh) {
            let points = join(&self.legs, &shown.path, around.walkways);
            self.legs.set_off(points, around.walkways);
            (self.followed, self.detour) = (version, false);
        }
        if !self.legs.route.is_empty() {
            self.idle_since = now;
            return;
        }
        self.ignored = self.ignored.filter(|_| self.followed.is_none());
        let Some(job) = work.job else { return };
        let end = shown.filter(|_| version == self.followed).and_then(|s| s.path.last());
        // Two walkers who work at one place stand side by side.
        let there = |p: Point| {
            let far = if Walker::is_taken(p, around) { BESIDE_WORK_M } else { AT_WORK_M };
            (p - self.legs.at).norm() < far
        };
        let at_end = end.is_some_and(|e| (e - job.at).norm() < PATH_ENDS_M && there(*e));
        if at_end || there(job.at) {
            self.doing = WalkerDoing::Work(job.id, now + job.stay);
        } else if self.shown.is_none() || now - self.idle_since > OWN_WAY {
            self.go_to_work(job, around);
        }
    }

    fn go_to_work(&mut self, job: Errand, around: &WalkerSurroundings<'_>) {
        self.go(job.at, around, None);
    }

    /// Sets the route to a place, around the cut walkways; gives whether there is one.
    pub(super) fn go(&mut self, goal: Point, around: &WalkerSurroundings<'_>, cut: Option<&EdgeSet>) -> bool {
        if (goal - self.legs.at).norm() < 0.1 {
            self.legs.route.clear();
            return true;
        }
        let goal = match self.legs.vehicle {
            // A driver stops where the vehicle fits.
            Some(_) => match around.walkways.stand_near(goal, self.legs.wall_m()) {
                Some(stand) => stand,
                None => return false,
            },
            None => goal,
        };
        let none = self.legs.too_narrow(around.walkways);
        match around.walkways.path(self.legs.at, goal, cut.unwrap_or(&none)) {
            Some(path) => {
                self.legs.set_off(path.points.into_iter().skip(1), around.walkways);
                true
            }
            None => false,
        }
    }

    /// The next place of a walk without a goal.
    fn stroll(&mut self, walkways: &Walkways) {
        let Some((here, _)) = walkways.nearest(self.legs.at) else { return };
        let wide = |e: WalkEdgeId| {
            self.legs.vehicle.is_none() || walkways.edges()[e].clearance_m >= self.legs.wall_m()
        };
        let links: Vec<WalkNodeId> =
            walkways.links(here).iter().filter(|(e, _)| wide(*e)).map(|(_, next)| *next).collect();
        let Some(next) = links.get(self.strolls.below(links.len().max(1))) else { return };
        self.legs.route.extend([walkways.nodes()[here].at, walkways.nodes()[*next].at]);
    }

    fn step_aside(&mut self, aside: Aside, now: Time, around: &WalkerSurroundings<'_>) {
        let over = match aside.until {
            Some(until) => until <= now,
            None if (aside.goal - self.legs.at).norm() < ASIDE_M || !self.legs.route.is_empty() => false,
            None => !self.go(aside.goal, around, None),
        };
        if over {
            self.aside = None;
            self.followed = None;
            self.idle_since = now;
            self.legs.route.clear();
        } else if aside.until.is_none() && self.legs.route.is_empty() {
            self.aside = Some(Aside { until: Some(now + aside.stay), ..aside });
        }
    }

    /// Whether the walker has come no nearer to the place of its errand for long.
    fn is_kept_from_errand(&mut self, now: Time) -> bool {
        let WalkerDoing::Job { goal, until: None, .. } = self.doing else { return false };
        let far_m = (goal - self.legs.at).norm();
        let (since, nearest_m) = *self.nearer_since.get_or_insert((now, far_m));
        if far_m < nearest_m - NEARER_M {
            self.nearer_since = Some((now, far_m));
        }
        now - since > ERRAND
    }

    /// Responds to a robot in the way: after some time the walker takes another path, or goes back and tries again.
    pub(super) fn give_up_waiting(
        &mut self,
        now: Time,
        around: &WalkerSurroundings<'_>,
        work: &WorkKnowledge<'_>,
    ) {
        let here = self.legs.at;
        // A walker that shuffles to and fro in front of a robot has not got away from it.
        self.blocked_since = self.blocked_since.filter(|(_, at)| (here - at).norm() < GOT_AWAY_M);
        if self.is_kept_from_errand(now) {
            return self.back_to_duty(now);
        }
        if !self.legs.blocked {
            return;
        }
        let (since, _) = *self.blocked_since.get_or_insert((now, here));
        // A driving robot will soon be past: that is worth a longer wait than a standing one.
        let more = if self.legs.blocked_by_moving { PASSES } else { Span::ZERO };
        if now - since < self.traits.patience + more {
            return;
        }
        self.blocked_since = None;
        let cut = cut_by_robots(&self.legs, around);
        let target = match self.doing {
            WalkerDoing::Job { goal, .. } => Some(goal),
            WalkerDoing::Leave(door) => Some(door),
            _ => self.legs.route.back().copied().or(work.job.map(|j| j.at)),
        };
        if self.aside.is_none()
            && target.is_some_and(|goal| self.go(goal, around, Some(&cut)))
            && is_clear(self.legs.at, self.legs.route.iter().copied(), around)
        {
            self.detour = true;
            return;
        }
        let Some(goal) = back_off(self.legs.at, around, &cut) else { return };
        self.legs.set_off(goal.1, around.walkways);
        self.aside = Some(Aside { goal: goal.0, stay: Span::from_secs(4), until: None });
    }
}

/// Whether a shown path ends at a place.
fn leads_to(shown: &Shown, goal: Point) -> bool {
    shown.path.last().is_some_and(|end| (end - goal).norm() < PATH_ENDS_M)
}

/// The route from a place onto a path and along it.
fn join(legs: &Legs, path: &[Point], walkways: &Walkways) -> Vec<Point> {
    let at = legs.at;
    let nearest = |s: &[Point]| {
        let piece = Segment { a: s[0], b: s[s.len() - 1] };
        let d = piece.b - piece.a;
        let u = if d.norm_squared() > 0.0 { (at - piece.a).dot(&d) / d.norm_squared() } else { 0.0 };
        piece.point(u.clamp(0.0, 1.0))
    };
    let pieces: Vec<Point> =
        if path.len() == 1 { path.to_vec() } else { path.windows(2).map(nearest).collect() };
    let far = |i: &usize| (pieces[*i] - at).norm();
    let Some(i) = (0..pieces.len()).min_by(|a, b| far(a).total_cmp(&far(b))) else { return Vec::new() };
    let mut points = Vec::new();
    if !walkways.sees(at, pieces[i]) || far(&i) > 2.5 {
        let own = walkways.path(at, pieces[i], &legs.too_narrow(walkways));
        points.extend(own.into_iter().flat_map(|p| p.points.into_iter().skip(1)));
    }
    points.push(pieces[i]);
    points.extend(&path[(i + 1).min(path.len())..]);
    points
}

/// Walkways that robots nearby stand or drive on, except the one that the walker stands on, so that it can go back.
fn cut_by_robots(legs: &Legs, around: &WalkerSurroundings<'_>) -> EdgeSet {
    let at = legs.at;
    let body_m = legs.vehicle.map_or(BODY_M, |vehicle| Mover::Vehicle(vehicle).half_width_m());
    let mut cut = legs.too_narrow(around.walkways);
    for r in around.robots.iter().filter(|r| (r.at - at).norm() < IN_SIGHT_M) {
        for e in around.walkways.edges_within(r.at, r.half_m + body_m) {
            if around.walkways.segment(e).distance_to(at) > HERE_M {
                cut.insert(e);
            }
        }
    }
    cut
}

/// Whether no robot is in the way of the next steps.
fn is_clear(at: Point, route: impl Iterator<Item = Point>, around: &WalkerSurroundings<'_>) -> bool {
    let mut from = at;
    let mut far = 0.0;
    for to in route {
        let steps = ((to - from).norm() / STEP_M).ceil().max(1.0);
        for i in 1..=steps as u32 {
            let p = from + (to - from) * (f64::from(i) / steps);
            let taken = |r: &RobotNear| {
                let gap = r.gap(p);
                gap < 0.0 && gap < r.gap(at)
            };
            if around.robots.iter().any(taken) {
                return false;
            }
        }
        far += (to - from).norm();
        from = to;
        if far > LOOK_M {
            break;
        }
    }
    true
}

/// The place farthest from all robots nearby that the walker can reach, with the route there.
fn back_off(at: Point, around: &WalkerSurroundings<'_>, cut: &EdgeSet) -> Option<(Point, Vec<Point>)> {
    let walkways = around.walkways;
    let robots = around.robots.iter().filter(|r| (r.at - at).norm() < IN_SIGHT_M);
    let robots: Vec<&RobotNear> = robots.collect();
    let room = |p: Point| robots.iter().map(|r| r.gap(p)).fold(IN_SIGHT_M, f64::min);
    let here = room(at);
    let places = walkways.nodes().iter().map(|n| n.at);
    let mut places: Vec<Point> = places.filter(|p| (p - at).norm() < IN_SIGHT_M).collect();
    places.retain(|p| room(*p) > here + 0.2);
    places.sort_by(|a, b| room(*b).total_cmp(&room(*a)));
    let ways = places.into_iter().filter_map(|p| walkways.path(at, p, cut).map(|way| (p, way)));
    let is_good =
        |way: &WalkPath| way.length_m < 2.0 * IN_SIGHT_M && is_clear(at, way.points.iter().copied(), around);
    let mut ways = ways.filter(|(_, way)| is_good(way));
    ways.next().map(|(p, way)| (p, way.points.into_iter().skip(1).collect()))
}

/// A place nearby that is out of a robot's path.
fn beside(at: Point, robot: &RobotNear, around: &WalkerSurroundings<'_>) -> Option<Point> {
    let clear = |p: Point| !robot.sweeps(p, 10.0) && robot.gap(p) > 0.2;
    let near =
        around.walkways.near(at, 2.5).into_iter().filter(|(n, _)| clear(around.walkways.nodes()[*n].at));
    let best = near.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    best.map(|(n, _)| around.walkways.nodes()[n].at)
}

/// A place on the walkways that is not one of the known places.
pub(crate) fn somewhere(walkways: &Walkways, known: &[Point], pick: f64) -> Option<Point> {
    let count = walkways.nodes().len();
    let first = (pick * count as f64) as usize;
    let places = (0..count).map(|i| walkways.nodes()[WalkNodeId::at((first + i) % count)].at);
    let mut places = places.filter(|p| known.iter().all(|k| (k - p).norm() > UNKNOWN_M));
    places.next()
}
