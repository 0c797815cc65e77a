//! Points in time, lengths of time and half-open windows, all in integer microseconds.
//!
//! Main types: [`Time`] (a point on the fleet's own clock), [`Span`] (a length of time),
//! [`Window`] (half-open, never empty). Refuses: reading any clock, comparing floats, empty windows.

use std::fmt;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A point on the fleet's clock, in microseconds since the clock's zero.
///
/// [`Time::MAX`] means "for ever": adding a span to it stays there.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Time(pub i64);

/// A length of time in microseconds; may be negative (a delay that is an advance).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span(pub i64);

impl Time {
    /// The clock's zero.
    pub const ZERO: Time = Time(0);
    /// For ever.
    pub const MAX: Time = Time(i64::MAX);

    /// The point `s` seconds after zero, rounded to the microsecond.
    pub fn from_secs_f64(s: f64) -> Time {
        Time(Span::from_secs_f64(s).0)
    }

    /// Seconds since zero.
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 / 1e6
    }

    /// Whether this is "for ever".
    pub fn is_forever(self) -> bool {
        self == Time::MAX
    }
}

impl Span {
    /// No time at all.
    pub const ZERO: Span = Span(0);
    /// The longest span.
    pub const MAX: Span = Span(i64::MAX);

    /// `ms` milliseconds.
    pub const fn from_millis(ms: i64) -> Span {
        Span(ms * 1_000)
    }

    /// `s` whole seconds.
    pub const fn from_secs(s: i64) -> Span {
        Span(s * 1_000_000)
    }

    /// `s` seconds, rounded to the microsecond; values beyond the range saturate.
    pub fn from_secs_f64(s: f64) -> Span {
        Span((s * 1e6).round() as i64)
    }

    /// The length in seconds.
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 / 1e6
    }
}

impl Add<Span> for Time {
    type Output = Time;
    fn add(self, d: Span) -> Time {
        if self.is_forever() { Time::MAX } else { Time(self.0.saturating_add(d.0)) }
    }
}

impl AddAssign<Span> for Time {
    fn add_assign(&mut self, d: Span) {
        *self = *self + d;
    }
}

impl Sub<Span> for Time {
    type Output = Time;
    fn sub(self, d: Span) -> Time {
        self + -d
    }
}

impl Sub for Time {
    type Output = Span;
    fn sub(self, earlier: Time) -> Span {
        Span(self.0.saturating_sub(earlier.0))
    }
}

impl Add for Span {
    type Output = Span;
    fn add(self, o: Span) -> Span {
        Span(self.0.saturating_add(o.0))
    }
}

impl AddAssign for Span {
    fn add_assign(&mut self, o: Span) {
        *self = *self + o;
    }
}

impl Sub for Span {
    type Output = Span;
    fn sub(self, o: Span) -> Span {
        Span(self.0.saturating_sub(o.0))
    }
}

impl Neg for Span {
    type Output = Span;
    fn neg(self) -> Span {
        Span(-self.0)
    }
}

impl Mul<i64> for Span {
    type Output = Span;
    fn mul(self, k: i64) -> Span {
        Span(self.0.saturating_mul(k))
    }
}

impl fmt::Debug for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_forever() { f.write_str("∞") } else { write!(f, "{:.3}s", self.as_secs_f64()) }
    }
}

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

impl fmt::Debug for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3}s", self.as_secs_f64())
    }
}

/// A half-open interval `[start, end)`, never empty.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Window {
    start: Time,
    end: Time,
}

impl Window {
    /// The window `[start, end)`.
    ///
    /// # Panics
    /// If it would be empty: an empty hold is a planning bug, not a value.
    pub fn new(start: Time, end: Time) -> Window {
        assert!(start < end, "a window must not be empty: [{start}, {end})");
        Window { start, end }
    }

    /// `[start, ∞)`.
    pub fn from(start: Time) -> Window {
        Window::new(start, Time::MAX)
    }

    /// First instant inside.
    pub fn start(self) -> Time {
        self.start
    }

    /// First instant after.
    pub fn end(self) -> Time {
        self.end
    }

    /// Whether the two share an instant.
    pub fn overlaps(self, o: Window) -> bool {
        self.start < o.end && o.start < self.end
    }

    /// Whether `t` is inside.
    pub fn contains(self, t: Time) -> bool {
        self.start <= t && t < self.end
    }
}

impl fmt::Debug for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {})", self.start, self.end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forever_stays_forever_whatever_is_added() {
        assert_eq!(Time::MAX + Span::from_secs(5), Time::MAX);
        assert_eq!(Time::MAX - Span::from_secs(5), Time::MAX);
    }

    #[test]
    fn touching_windows_do_not_overlap() {
        let a = Window::new(Time(0), Time(5));
        let b = Window::new(Time(5), Time(9));
        assert!(!a.overlaps(b) && !b.overlaps(a));
        assert!(a.overlaps(Window::new(Time(4), Time(6))));
    }

    #[test]
    #[should_panic(expected = "must not be empty")]
    fn an_empty_window_cannot_be_made() {
        Window::new(Time(3), Time(3));
    }
}
