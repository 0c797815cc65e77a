//! Tiny floors with robots whose jobs make them cross, and a worker among them.
//!
//! Main types: [`TinyFloor`], [`Manner`]. Nodes are three metres apart and named `x,y` from the lower left corner.

use giveway_fleet::JobKind;
use giveway_floor::id::{NodeId, RackId, RobotId, StationId};
use giveway_floor::warehouse::{Warehouse, sketch};

/// Distance of neighbours, metres.
pub(super) const LANE_M: f64 = 3.0;

/// What a worker may do while states are explored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Manner {
    /// Stands for ever.
    Stands,
    /// Walks as shown, and may stand for a while at any time.
    Obeys,
    /// Walks anywhere, whatever is shown, and may stand.
    Wanders,
}

/// A worker by the names of places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hired {
    pub manner: Manner,
    /// Where the worker appears.
    pub at: &'static str,
    /// Where the worker is to go, if anywhere.
    pub assignment: Option<&'static str>,
}

impl Hired {
    /// The worker in words, for a table.
    pub fn words(&self) -> String {
        let manner = match self.manner {
            Manner::Stands => "stands",
            Manner::Obeys => "obeys",
            Manner::Wanders => "walks anywhere",
        };
        let assigned = if self.assignment.is_some() { ", has an assignment" } else { "" };
        format!("{manner}{assigned}")
    }
}

/// Workers of every manner who appear at one place, some of whom are to go to another.
const fn everybody(at: &'static str, to: &'static str) -> [Hired; 5] {
    let (stands, wanders) = (Manner::Stands, Manner::Wanders);
    [
        Hired { manner: stands, at, assignment: None },
        Hired { manner: stands, at, assignment: Some(to) },
        Hired { manner: Manner::Obeys, at, assignment: Some(to) },
        Hired { manner: wanders, at, assignment: None },
        Hired { manner: wanders, at, assignment: Some(to) },
    ]
}

/// A job by the names of its places.
#[derive(Clone, Copy, Debug)]
pub(super) enum TinyJob {
    Go(u32, &'static str),
    Relocate(u32, &'static str),
    Deliver(u32),
}

/// A floor with what is to happen on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TinyFloor {
    pub name: &'static str,
    pub drawing: &'static str,
    /// Queue places of the only station, the one next to it first.
    pub queue: &'static [&'static str],
    /// Where the robots stand at first.
    pub starts: &'static [&'static str],
    pub jobs: &'static [TinyJob],
    /// Workers who may be there, one at a time, and the worker who is.
    pub workers: &'static [Hired],
    pub worker: Option<Hired>,
}

impl TinyFloor {
    /// The building, which passes the map's own check.
    pub fn build(&self) -> Warehouse {
        let mut draft = sketch(self.drawing);
        for node in &mut draft.nodes {
            node.at *= LANE_M;
        }
        for station in &mut draft.stations {
            station.queue = self.queue.iter().map(|q| (*q).to_owned()).collect();
        }
        draft.build().unwrap_or_else(|e| panic!("{}: {e}", self.name))
    }

    /// The jobs, in the order in which they are submitted.
    pub fn kinds(&self, w: &Warehouse) -> Vec<JobKind> {
        let node = |name: &str| node_of(w, name);
        let kind = |job: &TinyJob| match *job {
            TinyJob::Go(robot, to) => JobKind::Go { robot: RobotId(robot), node: node(to) },
            TinyJob::Relocate(rack, to) => JobKind::Relocate { rack: RackId(rack), node: node(to) },
            TinyJob::Deliver(rack) => {
                JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick: None }
            }
        };
        self.jobs.iter().map(kind).collect()
    }
}

/// The node with this name.
pub(super) fn node_of(w: &Warehouse, name: &str) -> NodeId {
    w.node_named(name).unwrap_or_else(|| panic!("there is no node {name}"))
}

/// The floors.
pub(super) const FLOORS: [TinyFloor; 8] = [
    TinyFloor {
        name: "corridor with a bay, 2",
        drawing: "S..P..S\n...X...",
        queue: &[],
        starts: &["0,1", "6,1"],
        jobs: &[TinyJob::Go(0, "5,0"), TinyJob::Go(1, "1,0")],
        workers: &everybody("3,0", "0,0"),
        worker: None,
    },
    TinyFloor {
        name: "corridor with a bay, 3",
        drawing: "S.PP.S\n.....X",
        queue: &[],
        starts: &["0,1", "5,1", "2,1"],
        jobs: &[TinyJob::Go(0, "4,0"), TinyJob::Go(1, "1,0"), TinyJob::Go(2, "0,0")],
        workers: &everybody("3,0", "0,0"),
        worker: None,
    },
    TinyFloor {
        name: "one-lane corridor, 2",
        drawing: "P...P\n##.##\nS...S",
        queue: &[],
        starts: &["0,0", "4,2"],
        jobs: &[TinyJob::Go(0, "3,2"), TinyJob::Go(1, "1,0")],
        workers: &everybody("2,1", "1,0"),
        worker: None,
    },
    TinyFloor {
        name: "ring, 2",
        drawing: "#P#P#\n.....\n.###.\n.....\n#P#P#",
        queue: &[],
        starts: &["1,4", "3,0"],
        jobs: &[TinyJob::Go(0, "1,1"), TinyJob::Go(1, "3,3")],
        workers: &everybody("2,3", "0,1"),
        worker: None,
    },
    TinyFloor {
        name: "ring, 4",
        drawing: "#P#P\n....\n.##.\n....\n#P#P",
        queue: &[],
        starts: &["1,4", "3,4", "1,0", "3,0"],
        jobs: &[TinyJob::Go(0, "3,1"), TinyJob::Go(1, "1,1"), TinyJob::Go(2, "3,3"), TinyJob::Go(3, "1,3")],
        workers: &everybody("2,1", "0,1"),
        worker: None,
    },
    TinyFloor {
        name: "dead end, 3",
        drawing: "S.R\nR.S\n...\nP#P",
        queue: &[],
        starts: &["0,0", "2,0", "0,3"],
        jobs: &[TinyJob::Relocate(0, "2,2"), TinyJob::Relocate(1, "0,3"), TinyJob::Go(2, "0,1")],
        workers: &everybody("1,2", "0,1"),
        worker: None,
    },
    TinyFloor {
        name: "station, 2",
        drawing: "#1.\n#..\nR..R\nP..P",
        queue: &["1,2"],
        starts: &["0,0", "3,0"],
        jobs: &[TinyJob::Deliver(0), TinyJob::Deliver(1)],
        workers: &everybody("2,1", "1,0"),
        worker: None,
    },
    TinyFloor {
        name: "station, 3",
        drawing: "#1.\n#..\nR..R\nP..P\nS..P",
        queue: &["1,3"],
        starts: &["0,1", "3,1", "3,0"],
        jobs: &[TinyJob::Deliver(0), TinyJob::Deliver(1), TinyJob::Go(2, "2,2")],
        workers: &everybody("2,1", "1,0"),
        worker: None,
    },
];
