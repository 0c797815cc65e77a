//! A person who does one thing after the other: walks, stands, turns.
//!
//! Main type: [`Actor`]. Refuses: to react to anything.

use giveway_floor::geometry::{Point, Pose, Segment};

/// One act of the person.
#[derive(Clone, Copy, Debug)]
pub(super) enum StoryAct {
    /// Walk straight to a place at a speed in metres per second, facing it.
    Walk(f64, f64, f64),
    /// Stand for this many seconds.
    Stand(f64),
    /// Turn on the spot by this many radians, in this many seconds.
    Turn(f64, f64),
}

/// The person's pose at any time.
#[derive(Clone, Debug)]
pub(super) struct Actor {
    /// Start and end of each part, seconds, and the poses at both.
    parts: Vec<(f64, f64, Pose, Pose)>,
    first: Pose,
}

impl Actor {
    pub fn new(at: Point, heading: f64, acts: &[StoryAct]) -> Actor {
        let first = Pose { at, heading };
        let (mut now, mut pose, mut parts) = (0.0, first, Vec::new());
        for act in acts {
            let (from, takes) = match *act {
                StoryAct::Walk(x, y, speed) => {
                    let leg = Segment { a: pose.at, b: Point::new(x, y) };
                    (Pose { heading: leg.heading(), ..pose }, leg.length() / speed)
                }
                StoryAct::Stand(seconds) | StoryAct::Turn(_, seconds) => (pose, seconds),
            };
            let to = match *act {
                StoryAct::Walk(x, y, _) => Pose { at: Point::new(x, y), ..from },
                StoryAct::Stand(_) => from,
                StoryAct::Turn(by, _) => Pose { heading: from.heading + by, ..from },
            };
            parts.push((now, now + takes, from, to));
            (now, pose) = (now + takes, to);
        }
        Actor { parts, first }
    }

    /// When all acts are over, seconds.
    pub fn end(&self) -> f64 {
        self.parts.last().map_or(0.0, |p| p.1)
    }

    /// When act number `i` begins.
    pub fn begins(&self, i: usize) -> f64 {
        self.parts[i].0
    }

    pub fn pose(&self, t: f64) -> Pose {
        let Some(&(start, end, from, to)) = self.parts.iter().find(|p| t < p.1).or(self.parts.last()) else {
            return self.first;
        };
        let u = if end > start { ((t - start) / (end - start)).clamp(0.0, 1.0) } else { 1.0 };
        Pose { at: from.at + (to.at - from.at) * u, heading: from.heading + (to.heading - from.heading) * u }
    }
}
