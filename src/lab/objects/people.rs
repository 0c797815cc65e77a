//! Simulated people who fetch objects, with the whole body 120 times a second, as a motion capture suit and an eye
//! tracker see it.
//!
//! Main function: [`moves_of`]. Walks, eyes and heads are simulated here, reaching arms are those of simulated pickers.
//! Refuses: recorded people, of whom there are none here.

use super::body::{BodyFrame, FRAMES, HZ, ObjectMove, ObjectTable, features};
use super::eyes::{EyeHabits, EyePath, EyeTarget, EyeTimes, head_after};
use super::room::{PickRoom, RoomSpot, Stance};
use super::walk::{RoomWalk, wrapped};
use giveway_people::reach::sample::{angles, ray};
use giveway_people::reach::{ArmPoint, ArmVector, ReachTarget};
use giveway_sim::picker::motion::{ArmBuild, ArmReach};
use giveway_sim::random::Stream;

/// Number of frames before those that count, in which head and eyes settle.
const BEFORE: usize = 120;
/// Noise of motion capture in positions (metres) and directions (radians): standard deviation.
const CAPTURE_NOISE: f64 = 0.003;
const DIRECTION_NOISE: f64 = 0.01;

/// One person.
struct RoomPerson {
    build: ArmBuild,
    eyes: EyeHabits,
}

/// All movements of one person in the room of a table.
pub fn moves_of(table: ObjectTable, person: usize, movements: usize, seed: u64) -> Vec<ObjectMove> {
    let mut chance = Stream::new(seed, 330 + table as u64, person as u64);
    let build = ArmBuild::any(0.0, &mut chance);
    let one = RoomPerson { build, eyes: EyeHabits::any(build.wanders, &mut chance) };
    let room = match table {
        ObjectTable::Shelves => PickRoom::shelves(&mut chance),
        ObjectTable::Tables => PickRoom::tables(&mut chance),
    };
    // The spots of the objects, followed by the free spots.
    let mut spots: Vec<usize> = (0..room.spots.len()).collect();
    shuffle(&mut spots, &mut chance);
    let count = table.objects();
    let mut stance = room.start.unwrap_or(room.spots[spots[count - 1]].stance);
    // The place that the person stands at.
    let mut here: Option<usize> = None;
    let (mut moves, mut queue): (Vec<ObjectMove>, Vec<usize>) = (Vec::new(), Vec::new());
    while moves.len() < movements {
        // Every object is fetched equally often, mostly from another place than where the last one was put.
        if queue.is_empty() {
            queue = (0..count).collect();
            shuffle(&mut queue, &mut chance);
        }
        let is_elsewhere = |o: &usize| here != Some(room.spots[spots[*o]].place);
        let next = queue.iter().position(is_elsewhere).filter(|_| chance.happens(0.8)).unwrap_or(0);
        let right = queue.remove(next);
        if room.start.is_some() && chance.happens(0.5) {
            // The second of the published scenarios: people walk about freely before they choose.
            let (x, y) = (chance.between(-0.9, 0.5), chance.between(-0.9, 0.9));
            stance = Stance { x, y, heading: chance.between(-3.0, 3.0) };
        }
        let objects: Vec<ArmPoint> = spots[..count].iter().map(|s| room.spots[*s].at).collect();
        let spot = &room.spots[spots[right]];
        let frames = one.fetch(&room, &objects, right, spot, stance, &mut chance);
        let figures = frames.iter().flat_map(|f| objects.iter().flat_map(|o| features(f, *o))).collect();
        moves.push(ObjectMove { person, frames, objects, right, figures });
        if let Some(start) = room.start {
            stance = start;
        } else {
            // The object is put down in another spot.
            let free = count + chance.below(spots.len() - count);
            spots.swap(right, free);
            let put = &room.spots[spots[right]];
            (stance, here) = (put.stance, Some(put.place));
        }
    }
    moves
}

fn shuffle(list: &mut [usize], chance: &mut Stream) {
    for i in (1..list.len()).rev() {
        list.swap(i, chance.below(i + 1));
    }
}

impl RoomPerson {
    /// Simulates one movement to an object.
    fn fetch(
        &self,
        room: &PickRoom,
        objects: &[ArmPoint],
        right: usize,
        spot: &RoomSpot,
        from: Stance,
        chance: &mut Stream,
    ) -> Vec<BodyFrame> {
        let leaves_s = chance.between(0.3, 1.3);
        let aside_m = if room.has_obstacle && spot.stance.x - from.x > 0.8 {
            let side = if spot.stance.y + from.y + 0.2 * chance.normal() > 0.0 { 1.0 } else { -1.0 };
            side * chance.between(0.25, 0.6)
        } else {
            0.2 * chance.normal()
        };
        let walk = RoomWalk::new(from, spot.stance, leaves_s, self.build.pace, aside_m, chance);
        let place = in_body(&spot.stance, spot.at);
        let to = ReachTarget { hand: place, look: place };
        let reach = ArmReach::new(&self.build, &self.build.rest(chance), &to, chance);
        // The hand sets out before the feet stand still.
        let reaches_s = walk.ends_s() - chance.between(0.05, 0.45);
        let ends_s = reaches_s + reach.duration_s();
        let first_s = ends_s - (FRAMES + BEFORE) as f64 / HZ;
        let times = EyeTimes { from_s: first_s, leaves_s, reaches_s, ends_s };
        let eyes = EyePath::new(&self.eyes, objects, right, times, chance);
        let mut head = (0.0, 0.0);
        let mut frames = Vec::with_capacity(FRAMES);
        for k in 1..=FRAMES + BEFORE {
            let t_s = first_s + k as f64 / HZ;
            let body = walk.at(t_s);
            let looked_at = match eyes.at(t_s) {
                EyeTarget::Object(i) => in_body(&body, objects[i]),
                EyeTarget::Ahead => ArmPoint::new(2.0, 0.0, 1.1),
            };
            let pose = reach.at(t_s - reaches_s);
            let eye = angles(looked_at - pose.sample.head);
            head = head_after(head, eye, (self.build.yaw_share, self.build.pitch_share), 1.0 / HZ);
            if k > BEFORE {
                let swing = ArmVector::x() * walk.swing_m(t_s);
                let hand = (pose.sample.hand + swing, pose.wrist - pose.elbow + swing * 0.3);
                let sight =
                    BodyInstant { head, eye, hand, shoulder: pose.sample.shoulder, at: pose.sample.head };
                frames.push(self.seen(&body, &sight, chance));
            }
        }
        frames
    }

    /// The whole body as measured.
    fn seen(&self, body: &Stance, sight: &BodyInstant, chance: &mut Stream) -> BodyFrame {
        let left = ArmPoint::new(self.build.shoulder.x, -self.build.shoulder.y, self.build.shoulder.z);
        let middle = left + (sight.shoulder - left) * 0.5;
        let across = left - sight.shoulder;
        let faces = ArmVector::new(across.y, -across.x, 0.0).normalize();
        // Half of a lean comes from the hips.
        let hips = ArmPoint::new(0.25 * (middle.x - left.x), 0.25 * (middle.y - 0.0), 0.66 * left.z);
        let up = (middle - hips).normalize();
        let ahead = (faces + ArmVector::x()).normalize();
        let upright = (ahead - up * ahead.dot(&up)).normalize();
        let own = (self.build.ahead.0 + sight.head.0, self.build.ahead.1 + sight.head.1);
        let mut seen = |at: ArmPoint, along: ArmVector| {
            let mut noise = |sd: f64| ArmVector::new(chance.normal(), chance.normal(), chance.normal()) * sd;
            let along = (turned(body, along.normalize()) + noise(DIRECTION_NOISE)).normalize();
            (in_room(body, at) + noise(CAPTURE_NOISE), along)
        };
        let hand = seen(sight.hand.0, sight.hand.1);
        let head = seen(sight.at, ray(own.0, own.1));
        let shoulders = seen(middle, faces);
        let pelvis = seen(hips, ArmVector::x());
        let torso = seen(hips + (middle - hips) * 0.6, upright);
        let (yaw, pitch) = (sight.eye.0 + self.eyes.bias.0, sight.eye.1 + self.eyes.bias.1);
        let noise = self.eyes.noise;
        let gaze = ray(yaw + noise * chance.normal(), pitch + noise * chance.normal());
        BodyFrame { hand, head, shoulders, pelvis, torso, gaze: turned(body, gaze) }
    }
}

/// Head, eyes and arm at one instant in the body's frame.
struct BodyInstant {
    head: (f64, f64),
    eye: (f64, f64),
    hand: (ArmPoint, ArmVector),
    shoulder: ArmPoint,
    at: ArmPoint,
}

/// A point of the room in the body's frame: x ahead of it, y to its left.
fn in_body(body: &Stance, at: ArmPoint) -> ArmPoint {
    let (sin, cos) = (libm::sin(body.heading), libm::cos(body.heading));
    let (x, y) = (at.x - body.x, at.y - body.y);
    ArmPoint::new(cos * x + sin * y, cos * y - sin * x, at.z)
}

/// A direction of the body's frame in the room.
fn turned(body: &Stance, along: ArmVector) -> ArmVector {
    let heading = wrapped(body.heading);
    let (sin, cos) = (libm::sin(heading), libm::cos(heading));
    ArmVector::new(cos * along.x - sin * along.y, sin * along.x + cos * along.y, along.z)
}

/// A point of the body's frame in the room.
fn in_room(body: &Stance, at: ArmPoint) -> ArmPoint {
    ArmPoint::new(body.x, body.y, 0.0) + turned(body, at.coords)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hands_end_at_the_right_object_and_the_same_seed_gives_the_same_people() {
        for table in ObjectTable::ALL {
            let moves = moves_of(table, 3, 20, 5);
            assert_eq!(moves, moves_of(table, 3, 20, 5));
            let mut near = 0;
            for m in &moves {
                assert_eq!((m.frames.len(), m.objects.len()), (FRAMES, table.objects()));
                assert!(m.figures.iter().all(|f| f.is_finite()));
                let hand = m.frames[FRAMES - 1].hand.0;
                let far = |i: &usize| (m.objects[*i] - hand).norm();
                assert!(far(&m.right) < 0.35, "{}", far(&m.right));
                let nearest = (0..m.objects.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
                near += usize::from(nearest == Some(m.right));
            }
            assert!(near >= 16, "the nearest object at the end is the right one: {near} of 20");
        }
    }

    #[test]
    fn people_walk_and_nothing_of_them_jumps() {
        let moves = moves_of(ObjectTable::Shelves, 1, 20, 1);
        let way = |m: &ObjectMove| (m.frames[FRAMES - 1].pelvis.0 - m.frames[0].pelvis.0).norm();
        let walked = moves.iter().filter(|m| way(m) > 1.0).count();
        assert!((5..20).contains(&walked), "{walked} of 20 walked");
        for m in &moves {
            for pair in m.frames.windows(2) {
                assert!((pair[1].hand.0 - pair[0].hand.0).norm() < 0.08);
                assert!((pair[1].pelvis.0 - pair[0].pelvis.0).norm() < 0.05);
                assert!((pair[1].head.1 - pair[0].head.1).norm() < 0.15);
            }
        }
    }
}
