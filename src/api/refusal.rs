//! What the fleet's refusals mean on the wire.
//!
//! Main function: [`refused`]. Refuses: to refuse without a word of what to do.

use super::cell::new_lines::{describe, field_of};
use super::error::{FieldError, Problem};
use super::text::{assignment_name, closure_name, job_name, series_name, worker_name};
use crate::cell::LineRefusal;
use crate::fleet::{Bounded, Refusal};
use crate::id::{NodeId, RackId};
use crate::warehouse::{NodeKind, Warehouse};

/// A refusal as a problem.
pub fn refused(map: &Warehouse, why: Refusal) -> Problem {
    let field = |field: &str, detail: String| Problem::invalid(vec![FieldError::new(field, detail)]);
    let node = |n: NodeId| map.nodes.get(n).map_or_else(|| format!("{n:?}"), |node| node.name.clone());
    match why {
        Refusal::CannotPick(..) | Refusal::LinesPerStation | Refusal::Line(_) => about_lines(why),
        Refusal::UnknownJob(_)
        | Refusal::JobIsOver(_)
        | Refusal::JobHasBegun(_)
        | Refusal::CannotBeTaken(_)
        | Refusal::NamesItsRobot(_)
        | Refusal::NotForRobot(_)
        | Refusal::SameStationTwice
        | Refusal::UnknownPredecessor(_)
        | Refusal::DeadlineIsOver
        | Refusal::HasNoStation(_)
        | Refusal::HasNoRobot(_)
        | Refusal::Priority(_) => about_jobs(why),
        Refusal::UnknownPlace => {
            Problem::invalid(vec![FieldError::new("kind", "no such rack, station, node or robot")])
        }
        Refusal::NotStorage(n) => {
            field("node", format!("{} is not a storage node; racks go onto those only", node(n)))
        }
        Refusal::StorageTaken(n) => {
            let detail = format!("{} has a rack, or is reserved for one: choose another node", node(n));
            Problem::conflict("storage-taken", "The storage node is taken", detail)
        }
        Refusal::NoSuchPlace(kind) => {
            let place = if kind == NodeKind::Charger { "charger" } else { "parking place" };
            field("kind", format!("the map has no {place}: add one, or send the robot to a node with `go`"))
        }
        Refusal::NothingToPick(station) => {
            let name = map.stations.get(station).map_or_else(|| format!("{station:?}"), |s| s.name.clone());
            let detail = format!("no rack stands at {name}: GET /v1/stations says what is on its way");
            Problem::conflict("nothing-to-pick", "There is nothing to pick from", detail)
        }
        Refusal::TooMany(kind, n) => too_many(kind, n),
        Refusal::TooManyBefore(most) => field("after", format!("a job can wait for at most {most} others")),
        Refusal::TooManyCorners(most) => field("outline", format!("an area has at most {most} corners")),
        Refusal::UnknownWorker(_)
        | Refusal::NotLost(_)
        | Refusal::WorkerBusy(_)
        | Refusal::NoPlaceForPeople
        | Refusal::UnknownAssignment(_) => about_people(why),
        Refusal::UnknownSeries(_) | Refusal::Recurrence | Refusal::NoExits | Refusal::UnknownClosure(_) => {
            about_closures(why)
        }
        Refusal::OutOfReach(n) => {
            let detail = format!(
                "nobody can walk to {}: choose a node on, or beside, a walkway of GET /v1/map",
                node(n)
            );
            field("place", detail)
        }
        Refusal::UnknownKind => field("kind", NO_SUCH_KIND.into()),
        Refusal::RobotIsGone(_) => robot_is_gone(),
        Refusal::NoKindFor(rack) => field("kind", no_kind_for(map, rack)),
        Refusal::NotForKind(n) => field("place", not_for_kind(&node(n))),
        Refusal::PlaceTaken(n) => place_taken(&node(n)),
        Refusal::RackIsStored(_) => rack_is_stored(),
        Refusal::RobotCanDrive(_) => robot_can_drive(),
        Refusal::EmptyArea => {
            field("outline", "an area needs at least three corners, and `until` must be after `from`".into())
        }
    }
}

/// What is picked at stations.
fn about_lines(why: Refusal) -> Problem {
    match why {
        Refusal::CannotPick(visit, line, problem) => {
            let field = if visit == 0 { "lines".to_owned() } else { format!("stops[{visit}].lines") };
            Problem::bad_lines(vec![FieldError::new(
                field_of(&field, line, problem),
                describe(problem, None),
            )])
        }
        Refusal::LinesPerStation => {
            let detail = "a job has lines for each of its stations, or for none";
            Problem::bad_lines(vec![FieldError::new("stops", detail)])
        }
        Refusal::Line(LineRefusal::NoLine(0)) => {
            let detail =
                "the job that is picked for has no lines: end the pick with POST /v1/stations/{id}/done";
            Problem::conflict("no-lines", "There are no lines", detail)
        }
        Refusal::Line(LineRefusal::NoLine(n)) => {
            Problem::unknown("line", format!("the visit has {n} lines, counted from 1"))
        }
        Refusal::Line(LineRefusal::NoPieces) => {
            Problem::invalid(vec![FieldError::new("done", "at least one piece")])
        }
        Refusal::Line(LineRefusal::TooMany(left)) => {
            let detail = format!("only {left} pieces are left to pick: confirm as many at most");
            Problem::invalid(vec![FieldError::new("done", detail)])
        }
        other => unreachable!("{other:?} is about no lines"),
    }
}

/// Workers, and what they are to do.
fn about_people(why: Refusal) -> Problem {
    match why {
        Refusal::UnknownWorker(worker) => {
            let name = worker_name(worker);
            Problem::unknown("worker", format!("{name} does not exist; GET /v1/workers lists all"))
        }
        Refusal::WorkerBusy(worker) => {
            let name = worker_name(worker);
            let detail = format!("{name} is on the floor, or has something to do: wait, or cancel it first");
            Problem::conflict("on-floor", "The person is on the floor", detail)
        }
        Refusal::NotLost(worker) => {
            let detail = format!("{} is seen, or not on the floor: nobody has to look", worker_name(worker));
            Problem::conflict("worker-not-lost", "The worker is not lost", detail)
        }
        Refusal::NoPlaceForPeople => {
            let detail =
                "nobody can stand there, or `within_m` is not from 0.5 to 8: choose a place on a walkway";
            Problem::invalid(vec![FieldError::new("at", detail)])
        }
        Refusal::UnknownAssignment(id) => {
            let detail = format!("{} is over already, or never existed", assignment_name(id));
            Problem::conflict("assignment-is-over", "The assignment is over", detail)
        }
        other => unreachable!("{other:?} is about nobody"),
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
fn about_jobs(why: Refusal) -> Problem {
    let field = |field: &str, detail: String| Problem::invalid(vec![FieldError::new(field, detail)]);
    match why {
        Refusal::UnknownJob(job) => Problem::unknown("job", format!("{} does not exist", job_name(job))),
        Refusal::JobIsOver(job) => {
            let detail =
                format!("{} is over already; GET /v1/jobs/{} says how", job_name(job), job_name(job));
            Problem::conflict("job-is-over", "The job is over", detail)
        }
        Refusal::JobHasBegun(job) => {
            let detail = format!(
                "a robot works on {} already, so it cannot be changed: cancel it and submit another one, or let it \
                 go on",
                job_name(job)
            );
            Problem::conflict("job-has-begun", "The job has begun", detail)
        }
        Refusal::CannotBeTaken(job) => {
            let detail = format!(
                "the rack of {} is at its station, or on its way to where it is to stay: let it end, or cancel it",
                job_name(job)
            );
            Problem::conflict("job-cannot-be-taken", "The job cannot be taken from its robot", detail)
        }
        Refusal::NamesItsRobot(kind) => {
            let detail = format!(
                "a {kind} job names its robot: change it with PATCH before it has begun, or cancel it"
            );
            Problem::conflict("job-names-its-robot", "The job names its robot", detail)
        }
        Refusal::NotForRobot(_) => {
            field("robot", "it cannot carry the rack, or may not drive to it or to where it is wanted".into())
        }
        Refusal::SameStationTwice => field("stops", "two stops in a row are at the same station".into()),
        Refusal::UnknownPredecessor(job) => field("after", format!("{} does not exist", job_name(job))),
        Refusal::DeadlineIsOver => {
            field("deadline", "it is over already: give a time to come, or none".into())
        }
        Refusal::HasNoStation(kind) => field("station", format!("a {kind} job has no station")),
        Refusal::HasNoRobot(kind) => {
            field("robot", format!("a {kind} job names no robot: Giveway chooses the best one"))
        }
        Refusal::Priority(p) => field("priority", format!("{p} is not between 0 and 9")),
        other => unreachable!("{other:?} is about no job"),
    }
}

/// What is closed, what recurs, and evacuations.
fn about_closures(why: Refusal) -> Problem {
    match why {
        Refusal::UnknownSeries(id) => {
            let detail = format!(
                "no closure recurs as {}; GET /v1/closures/recurring lists what does",
                series_name(id)
            );
            Problem::unknown("closure", detail)
        }
        Refusal::Recurrence => {
            let detail =
                "an occurrence must be over before the next begins, and that is in five minutes or later";
            Problem::invalid(vec![FieldError::new("recurs", detail)])
        }
        Refusal::NoExits => {
            let detail = "the map has no doors (exits) to which people could be led: add them to the map";
            Problem::conflict("no-exits", "There are no doors", detail)
        }
        Refusal::UnknownClosure(id) => {
            let detail = format!("{} is not closed; GET /v1/closures lists what is", closure_name(id));
            Problem::unknown("closure", detail)
        }
        other => unreachable!("{other:?} is about no closure"),
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
        for (why, name) in [(Refusal::TooManyBefore(100), "after"), (Refusal::TooManyCorners(100), "outline")]
        {
            let problem = refused(&map, why);
            assert_eq!((problem.status, problem.errors[0].field.as_str()), (422, name));
            assert!(problem.detail.contains("100"), "{}", problem.detail);
        }
    }
}
