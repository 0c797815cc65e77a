//! What the fleet's refusals mean on the wire.
//!
//! Main function: [`refused`]. Refuses: to refuse without a word of what to do.

use super::cell::new_lines::{describe, field_of};
use super::error::{FieldError, Problem};
use super::text::{assignment_name, closure_name, job_name, series_name, worker_name};
use crate::cell::LineRefusal;
use crate::fleet::{
    AreaRefusal, Bounded, JobRefusal, PickRefusal, RackRefusal, Refusal, RobotRefusal, WorkerRefusal,
};
use crate::id::{NodeId, RackId};
use crate::warehouse::{NodeKind, Warehouse};

/// A refusal as a problem.
pub fn refused(map: &Warehouse, why: Refusal) -> Problem {
    match why {
        Refusal::Job(why) => about_jobs(why),
        Refusal::Pick(why) => about_picks(map, why),
        Refusal::Rack(why) => about_racks(map, why),
        Refusal::Robot(why) => about_robots(map, why),
        Refusal::Worker(why) => about_people(map, why),
        Refusal::Area(why) => about_areas(why),
        Refusal::UnknownPlace => field("kind", "no such rack, station, node or robot"),
        Refusal::NoSuchPlace(kind) => {
            let place = if kind == NodeKind::Charger { "charger" } else { "parking place" };
            field("kind", format!("the map has no {place}: add one, or send the robot to a node with `go`"))
        }
        Refusal::TooMany(kind, n) => too_many(kind, n),
    }
}

fn field(name: &str, detail: impl Into<String>) -> Problem {
    Problem::invalid(vec![FieldError::new(name, detail.into())])
}

fn node_name(map: &Warehouse, n: NodeId) -> String {
    map.nodes.get(n).map_or_else(|| format!("{n:?}"), |node| node.name.clone())
}

/// What is picked at stations.
fn about_picks(map: &Warehouse, why: PickRefusal) -> Problem {
    match why {
        PickRefusal::NothingThere(station) => {
            let name = map.stations.get(station).map_or_else(|| format!("{station:?}"), |s| s.name.clone());
            let detail = format!("no rack stands at {name}: GET /v1/stations says what is on its way");
            Problem::conflict("nothing-to-pick", "There is nothing to pick from", detail)
        }
        PickRefusal::CannotPick(visit, line, problem) => {
            let field = if visit == 0 { "lines".to_owned() } else { format!("stops[{visit}].lines") };
            Problem::bad_lines(vec![FieldError::new(
                field_of(&field, line, problem),
                describe(problem, None),
            )])
        }
        PickRefusal::LinesPerStation => {
            let detail = "a job has lines for each of its stations, or for none";
            Problem::bad_lines(vec![FieldError::new("stops", detail)])
        }
        PickRefusal::Line(LineRefusal::NoLine(0)) => {
            let detail =
                "the job that is picked for has no lines: end the pick with POST /v1/stations/{id}/done";
            Problem::conflict("no-lines", "There are no lines", detail)
        }
        PickRefusal::Line(LineRefusal::NoLine(n)) => {
            Problem::unknown("line", format!("the visit has {n} lines, counted from 1"))
        }
        PickRefusal::Line(LineRefusal::NoPieces) => {
            Problem::invalid(vec![FieldError::new("done", "at least one piece")])
        }
        PickRefusal::Line(LineRefusal::TooMany(left)) => {
            let detail = format!("only {left} pieces are left to pick: confirm as many at most");
            Problem::invalid(vec![FieldError::new("done", detail)])
        }
    }
}

/// Workers, and what they are to do.
fn about_people(map: &Warehouse, why: WorkerRefusal) -> Problem {
    match why {
        WorkerRefusal::Unknown(worker) => {
            let name = worker_name(worker);
            Problem::unknown("worker", format!("{name} does not exist; GET /v1/workers lists all"))
        }
        WorkerRefusal::Busy(worker) => {
            let name = worker_name(worker);
            let detail = format!("{name} is on the floor, or has something to do: wait, or cancel it first");
            Problem::conflict("on-floor", "The person is on the floor", detail)
        }
        WorkerRefusal::NotLost(worker) => {
            let detail = format!("{} is seen, or not on the floor: nobody has to look", worker_name(worker));
            Problem::conflict("worker-not-lost", "The worker is not lost", detail)
        }
        WorkerRefusal::NoPlaceForPeople => {
            let detail =
                "nobody can stand there, or `within_m` is not from 0.5 to 8: choose a place on a walkway";
            Problem::invalid(vec![FieldError::new("at", detail)])
        }
        WorkerRefusal::OutOfReach(n) => {
            let node = node_name(map, n);
            field(
                "place",
                format!("nobody can walk to {node}: choose a node on, or beside, a walkway of GET /v1/map"),
            )
        }
        WorkerRefusal::UnknownAssignment(id) => {
            let detail = format!("{} is over already, or never existed", assignment_name(id));
            Problem::conflict("assignment-is-over", "The assignment is over", detail)
        }
    }
}

/// Robots that join, leave, or have a rack.
fn about_robots(map: &Warehouse, why: RobotRefusal) -> Problem {
    match why {
        RobotRefusal::UnknownKind => field("kind", NO_SUCH_KIND),
        RobotRefusal::IsGone(_) => robot_is_gone(),
        RobotRefusal::NotForKind(n) => field("place", not_for_kind(&node_name(map, n))),
        RobotRefusal::PlaceTaken(n) => place_taken(&node_name(map, n)),
        RobotRefusal::CanDrive(_) => robot_can_drive(),
    }
}

/// Where racks stand, and what can carry them.
fn about_racks(map: &Warehouse, why: RackRefusal) -> Problem {
    match why {
        RackRefusal::NotStorage(n) => {
            let node = node_name(map, n);
            field("node", format!("{node} is not a storage node; racks go onto those only"))
        }
        RackRefusal::StorageTaken(n) => {
            let node = node_name(map, n);
            let detail = format!("{node} has a rack, or is reserved for one: choose another node");
            Problem::conflict("storage-taken", "The storage node is taken", detail)
        }
        RackRefusal::NoKindFor(rack) => field("kind", no_kind_for(map, rack)),
        RackRefusal::IsStored(_) => rack_is_stored(),
    }
}

/// What is wrong with a kind that a robot cannot be of now.
const NO_SUCH_KIND: &str =
    "no robots of this kind may join now; GET /v1/kinds lists all kinds, and from when on each is valid";

fn robot_is_gone() -> Problem {
    let detail = "the robot has left the floor: register it again with POST /v1/robots";
    Problem::conflict("robot-is-gone", "The robot has left the floor", detail)
}

fn rack_is_stored() -> Problem {
    let detail = "the rack is on no robot: GET /v1/racks says where it stands";
    Problem::conflict("rack-is-stored", "The rack is on no robot", detail)
}

fn robot_can_drive() -> Problem {
    let detail = "the robot with the rack can drive: send the rack to a node with a job of kind relocate";
    Problem::conflict("robot-can-drive", "The robot can drive", detail)
}

fn no_kind_for(map: &Warehouse, rack: RackId) -> String {
    let name = map.racks.get(rack).map_or_else(|| format!("{rack:?}"), |r| r.name.clone());
    format!(
        "no robot kind can carry {name}, drive to it and reach its destination; GET /v1/kinds lists the kinds"
    )
}

fn not_for_kind(node: &str) -> String {
    format!("no lanes for this robot kind lead to {node} and away from it: choose another node")
}

/// What customers want of jobs.
fn about_jobs(why: JobRefusal) -> Problem {
    match why {
        JobRefusal::Unknown(job) => Problem::unknown("job", format!("{} does not exist", job_name(job))),
        JobRefusal::IsOver(job) => {
            let detail =
                format!("{} is over already; GET /v1/jobs/{} says how", job_name(job), job_name(job));
            Problem::conflict("job-is-over", "The job is over", detail)
        }
        JobRefusal::HasBegun(job) => {
            let detail = format!(
                "a robot works on {} already, so it cannot be changed: cancel it and submit another one, or let it \
                 go on",
                job_name(job)
            );
            Problem::conflict("job-has-begun", "The job has begun", detail)
        }
        JobRefusal::CannotBeTaken(job) => {
            let detail = format!(
                "the rack of {} is at its station, or on its way to where it is to stay: let it end, or cancel it",
                job_name(job)
            );
            Problem::conflict("job-cannot-be-taken", "The job cannot be taken from its robot", detail)
        }
        JobRefusal::NamesItsRobot(kind) => {
            let detail = format!(
                "a {kind} job names its robot: change it with PATCH before it has begun, or cancel it"
            );
            Problem::conflict("job-names-its-robot", "The job names its robot", detail)
        }
        JobRefusal::NotForRobot(_) => {
            field("robot", "it cannot carry the rack, or may not drive to it or to where it is wanted")
        }
        JobRefusal::SameStationTwice => field("stops", "two stops in a row are at the same station"),
        JobRefusal::UnknownPredecessor(job) => field("after", format!("{} does not exist", job_name(job))),
        JobRefusal::DeadlineIsOver => field("deadline", "it is over already: give a time to come, or none"),
        JobRefusal::HasNoStation(kind) => field("station", format!("a {kind} job has no station")),
        JobRefusal::HasNoRobot(kind) => {
            field("robot", format!("a {kind} job names no robot: Giveway chooses the best one"))
        }
        JobRefusal::TooManyBefore(most) => {
            field("after", format!("a job can wait for at most {most} others"))
        }
        JobRefusal::Priority(p) => field("priority", format!("{p} is not between 0 and 9")),
    }
}

/// What is closed, what recurs, and evacuations.
fn about_areas(why: AreaRefusal) -> Problem {
    match why {
        AreaRefusal::Empty => {
            field("outline", "an area needs at least three corners, and `until` must be after `from`")
        }
        AreaRefusal::TooManyCorners(most) => field("outline", format!("an area has at most {most} corners")),
        AreaRefusal::UnknownSeries(id) => {
            let detail = format!(
                "no closure recurs as {}; GET /v1/closures/recurring lists what does",
                series_name(id)
            );
            Problem::unknown("closure", detail)
        }
        AreaRefusal::Recurrence => {
            let detail =
                "an occurrence must be over before the next begins, and that is in five minutes or later";
            Problem::invalid(vec![FieldError::new("recurs", detail)])
        }
        AreaRefusal::NoExits => {
            let detail = "the map has no doors (exits) to which people could be led: add them to the map";
            Problem::conflict("no-exits", "There are no doors", detail)
        }
        AreaRefusal::UnknownClosure(id) => {
            let detail = format!("{} is not closed; GET /v1/closures lists what is", closure_name(id));
            Problem::unknown("closure", detail)
        }
    }
}

fn place_taken(node: &str) -> Problem {
    let detail = format!("a robot holds {node}, or is on its way there: choose another node");
    Problem::conflict("place-taken", "The place is taken", detail)
}

/// There is no room for another one of a kind.
fn too_many(kind: Bounded, n: usize) -> Problem {
    let (what, remedy) = match kind {
        Bounded::Jobs => ("jobs are open", "try again when some are over"),
        Bounded::Assignments => ("assignments are open", "try again when some are done or cancelled"),
        Bounded::Robots => ("robots have joined", "use the name of a robot that has joined already"),
        Bounded::Workers => (
            "workers are known",
            "erase a person who no longer works here (DELETE /v1/people/{id}): the place is free then",
        ),
        Bounded::Series => ("closures recur", "end some that are no longer needed"),
        Bounded::Closures => ("areas are closed or announced", "open some that are no longer needed"),
    };
    // Only what ends by itself is worth another try later.
    let ends = matches!(kind, Bounded::Jobs | Bounded::Assignments | Bounded::Closures);
    let detail = format!("{n} {what}, which is the limit: {remedy}");
    if ends { Problem::too_many(detail, 10) } else { Problem::no_room(detail) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_meets_a_limit_is_told_which_one_and_what_to_do() {
        let map = crate::warehouse::lab();
        for (kind, what) in [
            (Bounded::Jobs, "7 jobs are open"),
            (Bounded::Assignments, "7 assignments are open"),
            (Bounded::Robots, "7 robots have joined"),
            (Bounded::Workers, "7 workers are known"),
            (Bounded::Series, "7 closures recur"),
            (Bounded::Closures, "7 areas are closed or announced"),
        ] {
            let problem = refused(&map, Refusal::TooMany(kind, 7));
            let ends = matches!(kind, Bounded::Jobs | Bounded::Assignments | Bounded::Closures);
            let again = ends.then_some(10);
            assert_eq!(
                (problem.status, problem.retry_after),
                (429, again),
                "no promise that cannot come true"
            );
            assert!(problem.detail.starts_with(what), "{}", problem.detail);
        }
        for (why, name) in [
            (Refusal::Job(JobRefusal::TooManyBefore(100)), "after"),
            (Refusal::Area(AreaRefusal::TooManyCorners(100)), "outline"),
        ] {
            let problem = refused(&map, why);
            assert_eq!((problem.status, problem.errors[0].field.as_str()), (422, name));
            assert!(problem.detail.contains("100"), "{}", problem.detail);
        }
    }
}
