//! What a robot arm's decisions cost: for `giveway bench picks`.
//!
//! Main function: [`arm_times`]. The arm is that of the first station of the map `stations`; it goes from slots to its
//! tote while a picker's arms are at other slots. Refuses: to judge what was decided.

use super::stopwatch;
use crate::cell::arm::{
    ArmGoal, ArmKind, ArmPlan, ArmSite, Capsule, Joints, SlotAccess, TASK_SAMPLES, rrt_connect,
};
use crate::cell::{FacePlace, PickFace};
use crate::sim::picker::limbs::limbs;
use crate::sim::random::Stream;
use crate::warehouse::stations;
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::sync::Arc;

/// Cycles of the control in each situation.
const CYCLES: usize = 10;
/// Tote beside the arm.
const TOTE: usize = 2;

/// Durations of one cycle of the control, and of one search for a way, microseconds: `{"p50", "p99"}` each.
pub fn arm_times(seed: u64) -> anyhow::Result<[Value; 2]> {
    let map = stations();
    let place = map.stations.iter().next().ok_or_else(|| anyhow::anyhow!("the map has no station"))?;
    let furnished = place.cell.as_ref().and_then(|cell| Some((cell, cell.arm.as_ref()?)));
    let (cell, mount) = furnished.ok_or_else(|| anyhow::anyhow!("the map's first station has no arm"))?;
    let rack = map.rack_types.iter().next().ok_or_else(|| anyhow::anyhow!("the map's racks have no type"))?;
    let kind = ArmKind::named(&mount.kind).ok_or_else(|| anyhow::anyhow!("the arm's kind is not known"))?;
    let face = Arc::new(PickFace::new(cell, map.nodes[place.node].at, rack));
    let mut site = ArmSite::new(kind, mount, face.clone());
    let tote = site.tote(TOTE).ok_or_else(|| anyhow::anyhow!("the arm does not reach its tote"))?;
    let slots: Vec<SlotAccess> = face.slots().filter_map(|(slot, _)| site.slot(slot)).collect();
    let hands: Vec<FacePlace> = face.slots().map(|(_, at)| at).collect();
    let (mut control_us, mut search_us) = (Vec::new(), Vec::new());
    let mut chance = Stream::new(seed, 330, 0);
    for access in &slots {
        for hand in &hands {
            let head = FacePlace::new(0.0, 1.05, 1.63);
            let person = limbs(&face, 1.75, head, [FacePlace::new(-0.22, 0.95, 0.95), *hand]);
            control(&site, &access.before, &tote, &person, &mut control_us);
        }
        for (from, to) in [(access.before, tote), (tote, access.before)] {
            let begun = stopwatch();
            let way = rrt_connect(&site.space, &from, &to, TASK_SAMPLES, &mut || chance.unit());
            std::hint::black_box(way);
            search_us.push((stopwatch() - begun) as f64 / 1000.0);
        }
    }
    Ok([quantiles(control_us), quantiles(search_us)])
}

fn control(site: &ArmSite, from: &Joints, to: &Joints, person: &[Capsule], times: &mut Vec<f64>) {
    let tip = site.space.kind.pose(&site.space.base, to).points[7];
    let goal = ArmGoal { tip, along: -Vector3::z() };
    let (mut present, mut plan) = (*from, ArmPlan::standing(from));
    for _ in 0..CYCLES {
        let begun = stopwatch();
        let next = site.control.plan(&present, &plan, &goal, &[person.to_vec()]);
        times.push((stopwatch() - begun) as f64 / 1000.0);
        let Ok(next) = next else { return };
        (present, plan) = (next.steps[0], next);
    }
}

fn quantiles(mut all: Vec<f64>) -> Value {
    all.sort_by(f64::total_cmp);
    let at = |share: f64| all.get(((all.len().max(1) - 1) as f64 * share) as usize);
    json!({"p50": at(0.5), "p99": at(0.99)})
}
