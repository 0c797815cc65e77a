//! A robot arm at its station: its obstacles, and its angles at slots, at totes, and at rest.
//!
//! Main types: [`ArmSite`], [`SlotAccess`]. The angles for a slot or tote are searched for once, on first request.
//! Refuses: slots and totes that the arm cannot reach without touching anything.

use super::capsule::{Capsule, least_distance_m};
use super::kinematics::{ArmKind, Joints};
use super::mpc::ArmControl;
use super::space::{ArmSpace, CHECK_MARGIN_M};
use crate::{FacePlace, PickFace};
use giveway_floor::warehouse::{ArmMount, SlotName};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// How far before a slot the tool's tip waits, and how far into the slot it goes, metres.
const BEFORE_M: f64 = 0.06;
const INTO_M: f64 = 0.1;
/// The tool enters a slot from the arm's side by at most one of these angles, radians.
const ASLANT_RAD: [f64; 2] = [0.6, 0.3];
/// Height above a tote's rim at which the tool lets go, metres.
const ABOVE_M: f64 = 0.08;
/// Radius of boards and posts of a rack, and their depth behind its face, metres.
const BOARD_M: f64 = 0.015;
const BEHIND_M: f64 = 0.03;
/// Distance of a tote's walls from its middle, and of their top below its rim, metres.
const TOTE_M: f64 = 0.12;
const BELOW_RIM_M: f64 = 0.15;
/// Approximate distance of a picker's trunk from the opening, metres.
const PICKER_M: f64 = 0.43;
/// Angles of the resting arm: folded, with the tool down before its base.
const REST: Joints = [0.0, -2.6, 2.6, -FRAC_PI_2, -FRAC_PI_2, 0.0];
/// Bounds of the sampled angles, radians.
const LOW_RAD: Joints = [-PI, -2.8, -2.7, -4.0, -2.8, -1.0];
const HIGH_RAD: Joints = [PI, 0.0, 2.7, 1.5, 2.8, 1.0];

/// The angles of an arm at a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlotAccess {
    /// Angles with the tool in front of the slot.
    pub before: Joints,
    /// Angles with the tool at the piece.
    pub inside: Joints,
}

/// An arm beside the face of the rack that stands at its station, or stood there last.
#[derive(Clone, Debug)]
pub struct ArmSite {
    /// The control that evades people.
    pub control: ArmControl,
    /// The obstacles of the arm, people left out.
    pub space: ArmSpace,
    face: Arc<PickFace>,
    slots: BTreeMap<SlotName, Option<SlotAccess>>,
    totes: BTreeMap<usize, Option<Joints>>,
}

/// The pose of an arm's base: the stretched arm faces the mount's heading.
pub fn base_of(mount: &ArmMount) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), mount.heading + PI);
    Isometry3::from_parts(Translation3::from(mount.base.coords), turn)
}

/// The angles of a resting arm.
pub fn rest() -> Joints {
    REST
}

impl ArmSite {
    /// An arm beside a rack's face.
    pub fn new(kind: &ArmKind, mount: &ArmMount, face: Arc<PickFace>) -> ArmSite {
        let base = base_of(mount);
        let space = ArmSpace {
            kind: kind.clone(),
            base,
            obstacles: obstacles(&face),
            floor_m: 0.05,
            low_rad: LOW_RAD,
            high_rad: HIGH_RAD,
        };
        let control = ArmControl::new(kind.clone(), base, Vec::new());
        ArmSite { control, space, face, slots: BTreeMap::new(), totes: BTreeMap::new() }
    }

    /// The arm's space without any margin beyond surfaces: for an arm that is nearer than it would go.
    pub fn tight(&self) -> ArmSpace {
        let mut space = self.space.clone();
        space.obstacles.iter_mut().for_each(|o| o.radius_m = (o.radius_m - CHECK_MARGIN_M).max(-0.02));
        space
    }

    /// The rack's face.
    pub fn face(&self) -> &Arc<PickFace> {
        &self.face
    }

    /// The angles of the arm at a slot; nothing where it does not reach.
    pub fn slot(&mut self, slot: SlotName) -> Option<SlotAccess> {
        if let Some(known) = self.slots.get(&slot) {
            return *known;
        }
        let found = self.search_slot(slot);
        self.slots.insert(slot, found);
        found
    }

    /// The angles of the arm above a tote; nothing where it does not reach.
    pub fn tote(&mut self, tote: usize) -> Option<Joints> {
        if let Some(known) = self.totes.get(&tote) {
            return *known;
        }
        let above = FacePlace::new(0.0, 0.0, ABOVE_M);
        let at = self.face.tote(tote).map(|rim| self.face.on_map(rim + above));
        let found = at.and_then(|at| self.search(at, -Vector3::z(), -FRAC_PI_2, Some));
        self.totes.insert(tote, found);
        found
    }

    /// Whether slot and tote have been searched already.
    pub fn knows(&self, slot: SlotName, tote: usize) -> bool {
        let out_of_reach = self.totes.get(&tote).is_some_and(Option::is_none);
        out_of_reach || self.totes.contains_key(&tote) && self.slots.contains_key(&slot)
    }

    /// Whether any part of the arm is in the opening or beyond it, where the rack may not move.
    pub fn is_inside(&self, joints: &Joints) -> bool {
        let pose = self.space.kind.pose(&self.space.base, joints);
        let thick = FacePlace::new(0.0, 0.06, 0.0);
        pose.points[2..].iter().any(|p| self.face.is_inside(self.face.of(*p) - thick))
    }

    fn search_slot(&self, slot: SlotName) -> Option<SlotAccess> {
        let front = self.face.slot(slot);
        let from = self.face.of(Point3::from(self.space.base.translation.vector));
        let straight = libm::atan2(front.x - from.x, (from.y - front.y).max(0.05));
        // From the arm's side, but not so aslant that the tool touches the slot beside.
        let access = |most: f64| {
            let aside = straight.clamp(-most, most);
            let along = FacePlace::new(libm::sin(aside), -libm::cos(aside), 0.0);
            let place = |m: f64| self.face.on_map(front + along * m);
            let into = place(1.0) - place(0.0);
            let before = |inside: &Joints| {
                let before = self.space.kind.reach(&self.space.base, place(-BEFORE_M), into, inside)?;
                self.space.is_free_between(&before, inside).then_some(before)
            };
            self.search(place(INTO_M), into, 0.0, |inside| {
                let access = SlotAccess { before: before(&inside)?, inside };
                let is_clear = [access.before, access.inside].iter().all(|q| self.is_clear_of_picker(q));
                is_clear.then_some(access)
            })
        };
        ASLANT_RAD.into_iter().find_map(access)
    }

    /// Whether there is room for a picker at the usual picking position.
    fn is_clear_of_picker(&self, joints: &Joints) -> bool {
        let at = |z: f64| self.face.on_map(FacePlace::new(0.0, self.face.opening_m() + PICKER_M, z));
        let trunk = Capsule { a: at(0.8), b: at(1.6), radius_m: 0.3 };
        let links = self.space.kind.capsules(&self.space.kind.pose(&self.space.base, joints), 0.0);
        least_distance_m(&links, &[trunk]) > 0.0
    }

    /// The result of `comes` for the first free angles with the tool at a place that give one. `sum` is the sum of the
    /// angles that pitch the tool there.
    fn search<T>(
        &self,
        tip: Point3<f64>,
        along: Vector3<f64>,
        sum: f64,
        comes: impl Fn(Joints) -> Option<T>,
    ) -> Option<T> {
        const FOLDS: [(f64, f64); 4] = [(-1.6, 2.0), (-0.9, 1.2), (-2.2, 2.4), (-0.4, 0.5)];
        let (kind, base) = (&self.space.kind, &self.space.base);
        let local = base.inverse_transform_point(&tip);
        let facing = libm::atan2(-local.y, -local.x);
        let turns = [0.0, 0.5, -0.5].map(|off| facing + off);
        let seeds = FOLDS.iter().flat_map(|(upper, fore)| turns.map(|turn| (turn, *upper, *fore)));
        seeds.into_iter().find_map(|(turn, upper, fore)| {
            let seed = [turn, upper, fore, sum - upper - fore, -FRAC_PI_2, 0.0];
            kind.reach(base, tip, along, &seed).filter(|q| self.space.is_free(q)).and_then(&comes)
        })
    }
}

/// Boards and posts of the rack, and the totes.
fn obstacles(face: &PickFace) -> Vec<Capsule> {
    let half = face.width_m() / 2.0;
    let capsule = |a: FacePlace, b: FacePlace, radius_m: f64| Capsule {
        a: face.on_map(a),
        b: face.on_map(b),
        radius_m,
    };
    let heights = face.heights_m();
    let pitch = heights.windows(2).map(|h| h[1] - h[0]).fold(f64::INFINITY, f64::min);
    let half_row = if pitch.is_finite() { pitch / 2.0 } else { 0.18 };
    let boards = heights.iter().map(|h| h - half_row).chain(heights.last().map(|h| h + half_row));
    let mut all: Vec<Capsule> = Vec::new();
    for z in boards {
        for behind_m in [BEHIND_M, BEHIND_M + 0.12] {
            let y = face.face_m() - behind_m;
            all.push(capsule(FacePlace::new(-half, y, z), FacePlace::new(half, y, z), BOARD_M));
        }
    }
    let y = face.face_m() - BEHIND_M;
    let top = heights.last().map_or(2.0, |h| h + half_row);
    for x in [-half, half] {
        all.push(capsule(FacePlace::new(x, y, 0.1), FacePlace::new(x, y, top), BOARD_M));
    }
    for rim in (0..face.totes()).filter_map(|tote| face.tote(tote)) {
        let top = rim - FacePlace::new(0.0, 0.0, BELOW_RIM_M + TOTE_M);
        all.push(capsule(FacePlace::new(rim.x, rim.y, TOTE_M), top, TOTE_M));
    }
    all
}

/// Numbers of `0..1`, the same for each seed.
pub(super) fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::id::StationId;
    use giveway_floor::warehouse::stations;

    fn site(station: u32, kind: &ArmKind) -> ArmSite {
        let w = stations();
        let place = &w.stations[StationId(station)];
        let cell = place.cell.as_ref().unwrap();
        let rack = w.rack_types.iter().next().unwrap();
        let face = PickFace::new(cell, w.nodes[place.node].at, rack);
        ArmSite::new(kind, cell.arm.as_ref().unwrap(), Arc::new(face))
    }

    #[test]
    fn the_arm_rests_free_and_outside_and_reaches_much_of_the_rack_and_the_tote_beside_it() {
        for station in [0, 1] {
            let mut site = site(station, ArmKind::long_reach());
            assert!(site.space.is_free(&rest()) && !site.is_inside(&rest()));
            let face = site.face().clone();
            let reached: Vec<String> = face
                .slots()
                .map(|(s, _)| s)
                .filter(|s| site.slot(*s).is_some())
                .map(|s| s.to_string())
                .collect();
            assert!((8..16).contains(&reached.len()), "{reached:?}");
            let tote = site.tote(2).expect("the tote is beside it");
            assert!(!site.is_inside(&tote) && site.tote(0).is_none(), "the other side is out of reach");
            for (slot, _) in face.slots() {
                let Some(access) = site.slot(slot) else { continue };
                let tip = site.space.kind.pose(&site.space.base, &access.inside).points[7];
                assert_eq!(face.slot_at(face.of(tip)), Some(slot));
                assert!(
                    site.is_inside(&access.inside)
                        && site.space.is_free_between(&access.before, &access.inside)
                );
            }
        }
    }

    #[test]
    fn a_shorter_arm_reaches_less() {
        let mut short = site(0, ArmKind::collaborative());
        let reached = short.face().clone().slots().filter(|(s, _)| short.slot(*s).is_some()).count();
        assert!(reached < 8, "{reached}");
    }
}
