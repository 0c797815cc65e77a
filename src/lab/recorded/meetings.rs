//! Recorded people among robots that know nothing of them: which rules would brake in time, and which for nothing.
//!
//! Main types: [`MeetingReplay`], [`RuleScore`]. Robots drive timetabled paths of straight legs through the hall;
//! whenever a footprint and a person overlap, the probability counts that was stated when the robot would have had to
//! brake. Refuses: people who step aside; the recorded people saw no robot.

use super::subject::{Ground, Subject};
use super::tracks::{RecordedWalk, RecordedWalks, TrackPoint};
use crate::dice::Dice;
use crate::learning::RECORDED_M;
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::route::Kinematics;
use giveway_floor::time::{Span, Time};
use giveway_people::aware::{BEYOND, Regions, SLOW_MPS, Swept, collision};
use giveway_people::human::{BODY_M, Method, Model, Mover};

/// Probabilities from which a robot brakes, for comparison.
pub const THRESHOLDS: [f64; 6] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.4];
/// The usual robot: side of its footprint, metres, and control period, seconds.
const FOOTPRINT_M: f64 = 0.9;
const PERIOD_S: f64 = 0.05;
/// Upper ends of the classes in which stated probabilities are compared with outcomes.
pub const CLASSES: [f64; 9] = [0.002, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0];
/// Interval between two looks.
const TICK: Span = Span::from_millis(100);
/// A person farther away than this is ignored, metres.
const NEAR_M: f64 = 12.0;
/// Overlaps this close in time count as one meeting.
const APART: Span = Span::from_secs(2);
/// How long a person must be seen before a probability is stated.
const KNOWN: Span = Span::from_secs(1);
/// Least length of the legs of timetabled paths, metres.
const LEG_M: f64 = 2.0;

/// Parameters of a replay.
#[derive(Clone, Copy, Debug)]
pub struct MeetingReplay {
    /// Number of robots for each person.
    pub robots: usize,
    /// Speed of the robots, metres per second.
    pub speed_mps: f64,
    /// Half of a footprint's side, metres.
    pub half_m: f64,
    /// Time from a look to a stand at that speed, seconds.
    pub lead_s: f64,
    /// Distance between middles within which the rule without prediction brakes, from walking speed and uncertainties,
    /// metres.
    pub separation_m: f64,
    /// Seed of the robots' paths.
    pub seed: u64,
}

/// Score of one braking rule.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RuleScore {
    /// Meetings that the rule would not have braked for in time.
    pub missed: u64,
    /// Looks at which the rule would have braked.
    pub alarms: u64,
    /// Alarms after which the two would not have touched before the robot could have stopped.
    pub false_alarms: u64,
}

/// Results of a replay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meetings {
    /// How often a robot and a person would have touched.
    pub meetings: u64,
    /// Looks at a robot and a person near each other.
    pub looks: u64,
    /// Scores of the rules by probability, for each threshold.
    pub by_threshold: [RuleScore; 6],
    /// Score of the rule by distance alone.
    pub by_distance: RuleScore,
    /// Stated probabilities and how often a meeting followed, by class of the stated probability ([`CLASSES`]).
    pub said: [StatedRisk; CLASSES.len()],
}

/// Looks with about the same stated probability of a meeting.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatedRisk {
    /// Number of looks.
    pub looks: u64,
    /// Sum of the stated probabilities.
    pub stated: f64,
    /// Number of looks after which the two touched before the robot could have stopped.
    pub came: u64,
}

/// A robot's endless path: corners of straight legs along the axes, driven at a constant speed.
struct Timetable {
    corners: Vec<Point>,
    /// Metres from the start to each corner.
    metres: Vec<f64>,
}

impl Timetable {
    fn new(low: Point, high: Point, length_m: f64, dice: &mut Dice) -> Timetable {
        let mut within = |low: f64, high: f64| low + (high - low) * dice.below(1000) as f64 / 1000.0;
        let mut corners = vec![Point::new(within(low.x, high.x), within(low.y, high.y))];
        let (mut metres, mut along_x) = (vec![0.0], true);
        while metres[metres.len() - 1] < length_m {
            let from = corners[corners.len() - 1];
            let to = match along_x {
                true => Point::new(within(low.x, high.x), from.y),
                false => Point::new(from.x, within(low.y, high.y)),
            };
            along_x = !along_x;
            let leg = (to - from).norm();
            let fits = if along_x { high.y - low.y } else { high.x - low.x };
            if leg >= LEG_M.min(fits / 2.0) {
                metres.push(metres[metres.len() - 1] + leg);
                corners.push(to);
            }
        }
        Timetable { corners, metres }
    }

    fn leg(&self, metres: f64) -> usize {
        (self.metres.partition_point(|m| *m <= metres).max(1) - 1).min(self.corners.len() - 2)
    }

    fn at(&self, metres: f64) -> Point {
        let i = self.leg(metres);
        let way: Vector = self.corners[i + 1] - self.corners[i];
        let share = (metres - self.metres[i]) / (self.metres[i + 1] - self.metres[i]).max(1e-9);
        self.corners[i] + way * share.clamp(0.0, 1.0)
    }

    /// The robot's position and the next corners.
    fn ahead(&self, metres: f64) -> Vec<Point> {
        let next = &self.corners[self.leg(metres) + 1..];
        std::iter::once(self.at(metres)).chain(next.iter().take(4).copied()).collect()
    }
}

/// One look at a robot and a person.
struct PairLook {
    t: Time,
    /// The stated probability; nothing until the person has been seen for a while, and nothing for a person far away.
    stated: Option<f64>,
    too_near: bool,
    touches: bool,
}

impl MeetingReplay {
    /// Replays for loaded robots at their top speed, at walking speed, and at the slow speed near people.
    pub fn of_speeds(robots: usize, seed: u64) -> [MeetingReplay; 3] {
        let kinematics = Kinematics::default();
        let regions = Regions::new(kinematics, FOOTPRINT_M, PERIOD_S);
        [kinematics.top_mps(true), 1.0, SLOW_MPS].map(|speed_mps| {
            let times = regions.times(speed_mps, true);
            let half_m = FOOTPRINT_M / 2.0;
            let separation_m = BODY_M + half_m + regions.separation_m(speed_mps, true, RECORDED_M);
            MeetingReplay {
                robots,
                speed_mps,
                half_m,
                lead_s: times.react_s + times.stop_s,
                separation_m,
                seed,
            }
        })
    }

    /// Replays all walks.
    pub fn run(&self, recording: &RecordedWalks, goals: &[Point], model: &Model) -> Meetings {
        let ground = Ground::new(goals);
        let points = || recording.walks.iter().flat_map(|w| w.seen.iter().map(|s| s.at));
        let low =
            points().fold(Point::new(f64::MAX, f64::MAX), |l, p| Point::new(l.x.min(p.x), l.y.min(p.y)));
        let high =
            points().fold(Point::new(f64::MIN, f64::MIN), |h, p| Point::new(h.x.max(p.x), h.y.max(p.y)));
        let mut dice = Dice::new(self.seed);
        let mut found = Meetings::default();
        for walk in recording.walks.iter().filter(|w| w.seen.len() > 5) {
            for _ in 0..self.robots {
                let length_s =
                    (walk.seen[walk.seen.len() - 1].t - walk.seen[0].t).as_secs_f64() + self.lead_s;
                let way = Timetable::new(low, high, self.speed_mps * length_s + LEG_M, &mut dice);
                found.count(&self.looks(walk, &way, &ground, model), Span::from_secs_f64(self.lead_s));
            }
        }
        found
    }

    /// All looks at one robot and one person.
    fn looks(&self, walk: &RecordedWalk, way: &Timetable, ground: &Ground, model: &Model) -> Vec<PairLook> {
        let (start, end) = (walk.seen[0].t, walk.seen[walk.seen.len() - 1].t);
        let mut subject = Subject::new(ground, model, Method::Detour, RECORDED_M);
        let (mut next, mut looks, mut t) = (0, Vec::new(), start);
        while t <= end {
            while let Some(s) = walk.seen.get(next).filter(|s| s.t <= t) {
                subject.see(s.t, s.at);
                next += 1;
            }
            let metres = self.speed_mps * (t - start).as_secs_f64();
            let (robot, person) = (way.at(metres), place(&walk.seen, t));
            let off: Vector = person - robot;
            let outside = |d: f64| (d.abs() - self.half_m).max(0.0);
            let touches = outside(off.x).hypot(outside(off.y)) < BODY_M;
            let stated = (t - start >= KNOWN && off.norm() < NEAR_M).then(|| {
                let swept = Swept {
                    way: way.ahead(metres),
                    speed_mps: self.speed_mps,
                    half_m: self.half_m,
                    mover: Mover::OnFoot,
                };
                let time = Span::from_secs_f64(self.lead_s) + BEYOND;
                subject.forecast(|o| collision(|t| o.at(t), &swept, t, time)).unwrap_or(1.0)
            });
            looks.push(PairLook { t, stated, too_near: off.norm() < self.separation_m, touches });
            t += TICK;
        }
        looks
    }
}

impl Meetings {
    fn count(&mut self, looks: &[PairLook], lead: Span) {
        let mut touched: Option<Time> = None;
        for (i, look) in looks.iter().enumerate() {
            if look.touches {
                let begins = touched.is_none_or(|t| look.t - t > APART);
                touched = Some(look.t);
                // The statement when there was just time to brake.
                let then = looks[..=i].iter().rev().find(|l| look.t - l.t >= lead);
                if let Some(then) = then.filter(|l| begins && l.t - looks[0].t >= KNOWN) {
                    self.meetings += 1;
                    let stated = then.stated.unwrap_or(0.0);
                    for (score, threshold) in self.by_threshold.iter_mut().zip(THRESHOLDS) {
                        score.missed += u64::from(stated < threshold);
                    }
                    self.by_distance.missed += u64::from(!then.too_near);
                }
            }
            let Some(stated) = look.stated else { continue };
            self.looks += 1;
            let comes = looks[i..].iter().take_while(|l| l.t - look.t <= lead + BEYOND).any(|l| l.touches);
            let class = CLASSES.iter().position(|high| stated <= *high).unwrap_or(CLASSES.len() - 1);
            let said = &mut self.said[class];
            (said.looks, said.stated, said.came) =
                (said.looks + 1, said.stated + stated, said.came + u64::from(comes));
            let alarm = |score: &mut RuleScore, is: bool| {
                score.alarms += u64::from(is);
                score.false_alarms += u64::from(is && !comes);
            };
            for (score, threshold) in self.by_threshold.iter_mut().zip(THRESHOLDS) {
                alarm(score, stated >= threshold);
            }
            alarm(&mut self.by_distance, look.too_near);
        }
    }
}

/// A person's position, on a straight line between samples.
fn place(seen: &[TrackPoint], t: Time) -> Point {
    let i = seen.partition_point(|s| s.t <= t).clamp(1, seen.len() - 1);
    let (a, b) = (seen[i - 1], seen[i]);
    let share = (t - a.t).as_secs_f64() / (b.t - a.t).as_secs_f64().max(1e-9);
    a.at + (b.at - a.at) * share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::tracks::Format;
    use super::*;

    /// People who walk to and fro in a hall of ten by six metres.
    fn hall() -> RecordedWalks {
        let walk = |k: usize| {
            let at = |i: i64| {
                let s = (i as f64 * 0.48 + k as f64 * 3.0) % 20.0;
                Point::new(if s < 10.0 { s } else { 20.0 - s }, 1.5 * k as f64)
            };
            let seen = (0..150).map(|i| TrackPoint { t: Time(i * 400_000), step: i, at: at(i) });
            RecordedWalk { person: format!("{k}"), seen: seen.collect(), tracklets: Vec::new() }
        };
        RecordedWalks { format: Format::Thor, walks: (0..5).map(walk).collect() }
    }

    #[test]
    fn most_meetings_are_foreseen_and_lower_thresholds_miss_fewer_and_alarm_more() {
        let replay = MeetingReplay {
            robots: 4,
            speed_mps: 1.5,
            half_m: 0.45,
            lead_s: 1.8,
            separation_m: 5.0,
            seed: 1,
        };
        let found = replay.run(&hall(), &[], &Model::builtin());
        assert!(found.meetings >= 20, "{found:?}");
        let five = found.by_threshold[2];
        assert!(five.missed * 2 < found.meetings, "people here turn on the spot, and still: {found:?}");
        for pair in found.by_threshold.windows(2) {
            assert!(pair[0].missed <= pair[1].missed && pair[0].alarms >= pair[1].alarms);
        }
        assert!(five.alarms < found.by_distance.alarms, "prediction alarms less than distance: {found:?}");
        let often = found.said[8];
        assert!(often.came * 2 > often.looks, "what is said to be probable happens: {often:?}");
        let never = found.said[0];
        assert!(never.came * 50 < never.looks, "what is said not to happen does not: {never:?}");
        assert_eq!(found, replay.run(&hall(), &[], &Model::builtin()), "the same seed, the same outcome");
    }
}
