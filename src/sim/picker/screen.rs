//! What a picker sees: the screen of the station, and whether a rack stands there.
//!
//! Main types: [`StationScreen`], [`ShownLine`]. Refuses: to show what a real screen would not.

use giveway_cell::Lines;
use giveway_fleet::Ledger;
use giveway_floor::id::{JobId, RobotId, StationId};
use giveway_floor::warehouse::SlotName;

/// A line on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShownLine {
    /// The job that the line belongs to.
    pub job: JobId,
    /// The line's number in the job, from 0.
    pub n: usize,
    /// The slot that holds the pieces.
    pub slot: SlotName,
    /// The number of the tote that the pieces go to.
    pub tote: usize,
    /// How many pieces are still to be picked.
    pub left: u32,
}

/// What a picker sees.
#[derive(Clone, Copy, Debug, Default)]
pub struct StationScreen {
    /// The line that is lit.
    pub lit: Option<ShownLine>,
    /// The line of the previous rack that is not confirmed yet.
    pub last: Option<ShownLine>,
    /// Whether a rack stands there.
    pub is_here: bool,
    /// Whether a rack stands there with all its lines over.
    pub is_over: bool,
}

/// What the screen of a station shows.
pub(super) fn screen(ledger: &Ledger, station: StationId, robot: Option<RobotId>) -> StationScreen {
    let cell = ledger.warehouse().stations[station].cell.as_ref();
    let tote = |name: &str| cell?.totes.iter().position(|t| t.name == name);
    let is_paused = ledger.paused_stations.contains_key(&station);
    let job = robot.filter(|_| !is_paused).and_then(|robot| ledger.robots[robot].task.job());
    let visit = job.and_then(|id| Some((id, ledger.jobs.get(&id)?.lines_now()?)));
    StationScreen {
        lit: visit.and_then(|(id, lines)| shown(id, lines, &tote)),
        last: ledger.unconfirmed.get(&station).and_then(|u| shown(u.job, &u.lines, &tote)),
        is_here: robot.is_some(),
        is_over: visit.is_some_and(|(_, lines)| lines.are_over()),
    }
}

/// The lit line of a visit.
pub(super) fn shown(job: JobId, lines: &Lines, tote: &impl Fn(&str) -> Option<usize>) -> Option<ShownLine> {
    let n = lines.lit()?;
    let p = &lines.all()[n];
    Some(ShownLine { job, n, slot: p.line.slot, tote: tote(&p.line.tote)?, left: p.left() })
}
