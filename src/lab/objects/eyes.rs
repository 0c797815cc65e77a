//! Where simulated eyes look on the way to an object, and how the head follows them.
//!
//! Main types: [`EyePath`], [`EyeHabits`]. Eyes search, find the object before the body sets out, wander on the way,
//! and are at the object again before the hand moves; an eye tracker sees all that with a bias of its own. Refuses:
//! eyes that know where a hand will be, and heads that turn as far as the eyes.

use giveway_people::reach::ArmPoint;
use giveway_sim::random::Stream;

/// Time in which a head follows the eyes, seconds.
const HEAD_TAKES_S: f64 = 0.25;
/// Greatest turn of a head from where the body faces, radians.
const HEAD_MOST: f64 = 1.2;

/// Habits of a person's eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeHabits {
    /// Share of fixations on the way that are at the object.
    pub at_object: f64,
    /// Share of the other fixations that are at further objects instead of the way ahead.
    pub at_others: f64,
    /// Probability of a glance elsewhere while the hand reaches.
    pub wanders: f64,
    /// Bias of the eye tracker in yaw and pitch, radians.
    pub bias: (f64, f64),
    /// Noise of the eye tracker in every frame: standard deviation, radians.
    pub noise: f64,
}

impl EyeHabits {
    /// Habits of a random person.
    pub fn any(wanders: f64, chance: &mut Stream) -> EyeHabits {
        EyeHabits {
            at_object: chance.between(0.05, 0.35),
            at_others: chance.between(0.3, 0.7),
            wanders,
            bias: (0.05 * chance.normal(), 0.05 * chance.normal()),
            noise: chance.between(0.01, 0.03),
        }
    }
}

/// Target of the eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EyeTarget {
    /// An object, by its number.
    Object(usize),
    /// The way ahead.
    Ahead,
}

/// Times of a movement that the eyes follow, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeTimes {
    /// Time of the first fixation.
    pub from_s: f64,
    /// When the body sets out.
    pub leaves_s: f64,
    /// When the hand begins to move.
    pub reaches_s: f64,
    /// When the hand arrives.
    pub ends_s: f64,
}

/// Fixations of one movement, each with its end.
#[derive(Clone, Debug, PartialEq)]
pub struct EyePath {
    fixations: Vec<(f64, EyeTarget)>,
}

impl EyePath {
    /// Fixations on the way to object number `right` of `objects`.
    pub fn new(
        habits: &EyeHabits,
        objects: &[ArmPoint],
        right: usize,
        times: EyeTimes,
        chance: &mut Stream,
    ) -> EyePath {
        let mut near: Vec<usize> = (0..objects.len()).filter(|i| *i != right).collect();
        let far = |i: &usize| (objects[*i] - objects[right]).norm();
        near.sort_by(|a, b| far(a).total_cmp(&far(b)));
        let other = |chance: &mut Stream| {
            let among = if chance.happens(0.5) { near.len().min(3) } else { near.len() };
            EyeTarget::Object(near[chance.below(among)])
        };
        let mut path = EyePath { fixations: Vec::new() };
        let found_s = times.leaves_s - chance.between(0.05, 0.35);
        let mut now_s = times.from_s;
        while now_s < found_s {
            now_s = (now_s + chance.between(0.18, 0.5)).min(found_s);
            let target = other(chance);
            path.fixations.push((now_s, target));
        }
        let keeps_s = times.leaves_s + chance.between(0.0, 0.25);
        path.fixations.push((keeps_s, EyeTarget::Object(right)));
        let returns_s = times.reaches_s - chance.between(0.12, 0.4);
        now_s = keeps_s;
        while now_s < returns_s {
            now_s = (now_s + chance.between(0.2, 0.55)).min(returns_s);
            let target = if chance.happens(habits.at_object) {
                EyeTarget::Object(right)
            } else if chance.happens(habits.at_others) {
                other(chance)
            } else {
                EyeTarget::Ahead
            };
            path.fixations.push((now_s, target));
        }
        if chance.happens(habits.wanders) {
            let from_s = chance.between(returns_s.max(keeps_s), times.ends_s - 0.1);
            path.fixations.push((from_s, EyeTarget::Object(right)));
            let target = other(chance);
            path.fixations.push((from_s + chance.between(0.15, 0.3), target));
        }
        path.fixations.push((f64::INFINITY, EyeTarget::Object(right)));
        path
    }

    /// The target of the eyes at a time.
    pub fn at(&self, t_s: f64) -> EyeTarget {
        let fixation = self.fixations.iter().find(|f| t_s < f.0);
        fixation.map_or(EyeTarget::Ahead, |f| f.1)
    }
}

/// The head's yaw and pitch relative to the body, a step after `now`: it approaches a share of the eyes' direction.
pub fn head_after(now: (f64, f64), eyes: (f64, f64), shares: (f64, f64), step_s: f64) -> (f64, f64) {
    let follow = 1.0 - libm::exp(-step_s / HEAD_TAKES_S);
    let to =
        |now: f64, eye: f64, share: f64| now + ((share * eye).clamp(-HEAD_MOST, HEAD_MOST) - now) * follow;
    (to(now.0, eyes.0, shares.0), to(now.1, eyes.1, shares.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eyes_are_at_the_object_before_the_body_leaves_and_before_the_hand_moves_but_not_always_between() {
        let objects: Vec<ArmPoint> = (0..6).map(|i| ArmPoint::new(1.0, f64::from(i) * 0.3, 1.0)).collect();
        let times = EyeTimes { from_s: -3.0, leaves_s: 1.0, reaches_s: 3.0, ends_s: 4.0 };
        let mut chance = Stream::new(1, 1, 1);
        let (mut on_the_way, mut early) = (0, 0);
        for _ in 0..200 {
            let habits = EyeHabits { wanders: 0.0, ..EyeHabits::any(0.0, &mut chance) };
            let path = EyePath::new(&habits, &objects, 2, times, &mut chance);
            assert_eq!(path.at(0.96), EyeTarget::Object(2));
            assert_eq!(path.at(2.9), EyeTarget::Object(2));
            assert_eq!(path.at(3.9), EyeTarget::Object(2));
            on_the_way += usize::from(path.at(2.0) == EyeTarget::Object(2));
            early += usize::from(path.at(-1.0) == EyeTarget::Object(2));
        }
        assert!((30..120).contains(&on_the_way) && early == 0, "{on_the_way} {early}");
    }

    #[test]
    fn a_head_follows_late_and_not_the_whole_way() {
        let mut head = (0.0, 0.0);
        for k in 0..240 {
            head = head_after(head, (1.0, -0.5), (0.7, 0.4), 1.0 / 120.0);
            assert!(k > 12 || head.0 < 0.35, "{k}: {head:?}");
        }
        assert!((head.0 - 0.7).abs() < 0.01 && (head.1 + 0.2).abs() < 0.01, "{head:?}");
    }
}
