//! Rooms in which simulated people fetch objects: places, spots on them, and where a person stands to reach a spot.
//!
//! Main types: [`PickRoom`], [`RoomSpot`], [`Stance`]. Metres in the frame of the room: x and y on the floor, z up.
//! Refuses: spots that nobody can reach.

use giveway_people::reach::ArmPoint;
use giveway_sim::random::Stream;

/// A person's standing position, and where the body faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Position along x, metres.
    pub x: f64,
    /// Position along y, metres.
    pub y: f64,
    /// Direction the body faces, radians from x towards y.
    pub heading: f64,
}

/// A spot for one object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoomSpot {
    /// Number of the shelf or table.
    pub place: usize,
    /// Position of the object.
    pub at: ArmPoint,
    /// Stance of a person who reaches for it.
    pub stance: Stance,
}

/// A room with places for objects.
#[derive(Clone, Debug, PartialEq)]
pub struct PickRoom {
    /// All spots.
    pub spots: Vec<RoomSpot>,
    /// Where a person waits for instructions, if the room has such a point.
    pub start: Option<Stance>,
    /// Whether people must walk round something in the middle of the room.
    pub has_obstacle: bool,
}

/// A shelf or table: a person before its middle stands at `foot`; its spots are given from there as metres ahead, to
/// the left and up.
struct RoomPlace {
    foot: Stance,
    spots: Vec<(f64, f64, f64)>,
}

/// A grid of spots: all heights or depths combined with all lateral positions.
fn grid(ahead: &[f64], left: &[f64], up: &[f64]) -> Vec<(f64, f64, f64)> {
    let mut spots = Vec::new();
    for a in ahead {
        for z in up {
            spots.extend(left.iter().map(|l| (*a, *l, *z)));
        }
    }
    spots
}

impl PickRoom {
    /// Two shelves and a table with 23 spots, as in MoGaze: people carry objects between them.
    pub fn shelves(chance: &mut Stream) -> PickRoom {
        let tall = grid(&[0.55], &[-0.25, 0.0, 0.25], &[0.75, 1.1, 1.45]);
        let small = grid(&[0.55], &[-0.15, 0.15], &[0.8, 1.15, 1.5]);
        let table = grid(&[0.45, 0.65], &[-0.4, -0.13, 0.13, 0.4], &[0.76]);
        let half = std::f64::consts::FRAC_PI_2;
        let places = [(1.6, 0.8, 0.0, tall), (-0.3, 1.9, half, small), (0.0, -1.0, -half, table)];
        let places = places.map(|(x, y, heading, spots)| RoomPlace { foot: Stance { x, y, heading }, spots });
        PickRoom { spots: spots_of(&places, chance), start: None, has_obstacle: false }
    }

    /// Three tables with five spots, a starting point and an obstacle in the middle, as in SubMotion.
    pub fn tables(chance: &mut Stream) -> PickRoom {
        let two = || grid(&[0.55], &[-0.2, 0.2], &[0.78]);
        let one = grid(&[0.55], &[0.0], &[0.78]);
        let places = [(1.3, 0.9, 0.4, two()), (1.6, 0.0, 0.0, one), (1.3, -0.9, -0.4, two())];
        let places = places.map(|(x, y, heading, spots)| RoomPlace { foot: Stance { x, y, heading }, spots });
        let start = Stance { x: -0.8, y: 0.0, heading: 0.0 };
        PickRoom { spots: spots_of(&places, chance), start: Some(start), has_obstacle: true }
    }
}

/// The spots of all places. People vary in where they stand, and objects do not lie in straight rows.
fn spots_of(places: &[RoomPlace], chance: &mut Stream) -> Vec<RoomSpot> {
    let mut all = Vec::new();
    for (place, RoomPlace { foot, spots }) in places.iter().enumerate() {
        let (sin, cos) = (libm::sin(foot.heading), libm::cos(foot.heading));
        let at =
            |ahead: f64, left: f64| (foot.x + ahead * cos - left * sin, foot.y + ahead * sin + left * cos);
        for (ahead, left, up) in spots {
            let mut about = |sd: f64| sd * chance.normal().clamp(-2.0, 2.0);
            let (x, y) = at(ahead + about(0.02), left + about(0.02));
            // A right-handed person stands a little to the left of the object.
            let (sx, sy) = at(about(0.05), 0.75 * left + 0.1 + about(0.06));
            let stance = Stance { x: sx, y: sy, heading: foot.heading + about(0.1) };
            all.push(RoomSpot { place, at: ArmPoint::new(x, y, *up), stance });
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_spot_is_within_reach_of_its_stance_and_apart_from_the_others() {
        let mut chance = Stream::new(1, 1, 1);
        for (room, places, spots) in
            [(PickRoom::shelves(&mut chance), 3, 23), (PickRoom::tables(&mut chance), 3, 5)]
        {
            assert_eq!(room.spots.len(), spots);
            assert_eq!(room.spots.iter().map(|s| s.place).max(), Some(places - 1));
            for (i, a) in room.spots.iter().enumerate() {
                let apart = libm::hypot(a.at.x - a.stance.x, a.at.y - a.stance.y);
                assert!((0.2..0.95).contains(&apart), "{a:?}");
                for b in &room.spots[i + 1..] {
                    assert!((a.at - b.at).norm() > 0.1, "{a:?} {b:?}");
                }
            }
        }
    }
}
