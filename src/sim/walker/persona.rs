//! A walker's character: its speed, its patience, and how it responds to robots.
//!
//! Main types: [`Traits`], [`Persona`] (after the personas of HuNavSim, Pérez-Higueras et al. 2023). Refuses: to change
//! after it was drawn.

use crate::random::Stream;
use crate::scenario::Personas;
use giveway_floor::time::Span;
use giveway_people::human::Mover;

/// How a walker responds to a robot that comes nearer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Persona {
    /// It steps aside, or stops.
    Yields,
    /// It walks faster by three tenths.
    Hurries,
    /// It stands until the robot stands, or is away.
    Freezes,
    /// It takes no notice.
    CutsThrough,
}

/// Traits that are drawn once for a walker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traits {
    /// How the walker responds to robots.
    pub persona: Persona,
    /// Usual speed, metres per second: normal with mean 1.2 and deviation 0.2.
    pub speed_mps: f64,
    /// Reaction time: from a message to the response.
    pub reaction: Span,
    /// How long the walker waits behind a robot before it tries another path.
    pub patience: Span,
    /// How far before a corner the walker turns, metres.
    pub cut_m: f64,
    /// Initial phase of the walker's stride, radians.
    pub phase: f64,
}

/// Slowest and fastest usual speed, metres per second.
pub const SPEEDS: (f64, f64) = (0.8, 1.6);

impl Traits {
    /// Draws the traits of a walker.
    pub(crate) fn draw(mix: &Personas, mut random: Stream) -> Traits {
        let share = random.unit();
        let persona = match share {
            s if s < mix.yields => Persona::Yields,
            s if s < mix.yields + mix.hurries => Persona::Hurries,
            s if s < mix.yields + mix.hurries + mix.freezes => Persona::Freezes,
            _ => Persona::CutsThrough,
        };
        Traits {
            persona,
            speed_mps: (1.2 + 0.2 * random.normal()).clamp(SPEEDS.0, SPEEDS.1),
            reaction: Span::from_secs_f64(random.between(0.5, 1.5)),
            patience: Span::from_secs_f64(random.between(3.0, 8.0)),
            cut_m: random.between(0.1, 0.5),
            phase: random.between(0.0, std::f64::consts::TAU),
        }
    }

    /// The same person at the wheel of a vehicle: as much faster than others as on foot, and never faster than the
    /// vehicle.
    pub(super) fn at_the_wheel(self, mover: Mover) -> Traits {
        let speed_mps = self.speed_mps / Mover::OnFoot.usual_mps() * mover.usual_mps();
        Traits { speed_mps: speed_mps.min(mover.fastest_mps()), ..self }
    }

    /// How far ahead in time the walker considers where a robot is going, seconds.
    pub fn foresight_s(&self) -> f64 {
        if self.persona == Persona::CutsThrough { 0.4 } else { 1.5 }
    }
}
