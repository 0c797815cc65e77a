//! A part of the floor that a query is about.
//!
//! Main type: [`Area`]. Refuses: to know what is in it.

use giveway_floor::geometry::Point;

/// An axis-aligned rectangle, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// The lower left corner.
    pub low: Point,
    /// The upper right corner.
    pub high: Point,
}

impl Area {
    /// Whether a point is in the area.
    pub fn contains(&self, p: Point) -> bool {
        (self.low.x..=self.high.x).contains(&p.x) && (self.low.y..=self.high.y).contains(&p.y)
    }

    /// How far a point is outside the area, metres; zero inside.
    pub fn distance_m(&self, p: Point) -> f64 {
        let beyond = |x: f64, low: f64, high: f64| (low - x).max(x - high).max(0.0);
        beyond(p.x, self.low.x, self.high.x).hypot(beyond(p.y, self.low.y, self.high.y))
    }
}
