//! What the fleet's refusals mean on the wire.
//!
//! Main function: [`refused`]. Refuses: to leave a refusal without advice.

use super::cell::new_lines::{describe, field_of};
use crate::wire::error::{FieldError, Problem};
use crate::wire::text::{assignment_name, closure_name, job_name, series_name, worker_name};
use giveway_cell::LineRefusal;
use giveway_fleet::{
    AreaRefusal, Bounded, JobRefusal, KindRefusal, PickRefusal, RackRefusal, Refusal, RobotRefusal,
    WorkerRefusal,
};
use giveway_floor::id::{NodeId, RackId};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::{refusals as say, requests};
use giveway_floor::warehouse::{NodeKind, Warehouse};

/// A refusal as a problem.
pub fn refused(map: &Warehouse, why: Refusal) -> Problem {
    match why {
        Refusal::Job(why) => about_jobs(why),
        Refusal::Pick(why) => about_picks(map, why),
        Refusal::Rack(why) => about_racks(map, why),
        Refusal::Robot(why) => about_robots(map, why),
        Refusal::Worker(why) => about_people(map, why),
        Refusal::Area(why) => about_areas(why),
        Refusal::Kind(why) => about_kinds(why, ""),
        Refusal::UnknownPlace => field("kind", say::place_unknown()),
        Refusal::NoSuchPlace(kind) => {
            let charger = kind == NodeKind::Charger;
            field("kind", if charger { say::map_without_charger() } else { say::map_without_parking() })
        }
        Refusal::TooMany(kind, n) => too_many(kind, n),
    }
}

fn field(name: &str, detail: Sentence) -> Problem {
    Problem::invalid(vec![FieldError::new(name, detail)])
}

fn node_name(map: &Warehouse, n: NodeId) -> String {
    map.nodes.get(n).map_or_else(|| format!("{n:?}"), |node| node.name.clone())
}

/// Problems with picks at stations.
fn about_picks(map: &Warehouse, why: PickRefusal) -> Problem {
    match why {
        PickRefusal::NothingThere(station) => {
            let name = map.stations.get(station).map_or_else(|| format!("{station:?}"), |s| s.name.clone());
            let detail = say::no_rack_at_station(name);
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
            Problem::bad_lines(vec![FieldError::new("stops", say::lines_for_each_station())])
        }
        PickRefusal::Line(LineRefusal::NoLine(0)) => {
            let detail = say::job_has_no_lines("/v1/stations/{id}/done");
            Problem::conflict("no-lines", "There are no lines", detail)
        }
        PickRefusal::Line(LineRefusal::NoLine(n)) => Problem::unknown("line", say::lines_counted_from_one(n)),
        PickRefusal::Line(LineRefusal::NoPieces) => {
            Problem::invalid(vec![FieldError::new("done", say::at_least_one_piece())])
        }
        PickRefusal::Line(LineRefusal::TooMany(left)) => {
            Problem::invalid(vec![FieldError::new("done", say::pieces_left(left))])
        }
    }
}

/// Problems with workers and their assignments.
fn about_people(map: &Warehouse, why: WorkerRefusal) -> Problem {
    match why {
        WorkerRefusal::Unknown(worker) => {
            Problem::unknown("worker", say::worker_unknown(worker_name(worker)))
        }
        WorkerRefusal::Busy(worker) => {
            let detail = say::worker_busy(worker_name(worker));
            Problem::conflict("on-floor", "The person is on the floor", detail)
        }
        WorkerRefusal::NotLost(worker) => {
            let detail = say::worker_not_lost(worker_name(worker));
            Problem::conflict("worker-not-lost", "The worker is not lost", detail)
        }
        WorkerRefusal::NoPlaceForPeople => field("at", say::no_place_for_people()),
        WorkerRefusal::OutOfReach(n) => field("place", say::out_of_reach(node_name(map, n))),
        WorkerRefusal::UnknownAssignment(id) => {
            let detail = say::assignment_is_over(assignment_name(id));
            Problem::conflict("assignment-is-over", "The assignment is over", detail)
        }
    }
}

/// Problems with robots that join, leave, or have a rack.
fn about_robots(map: &Warehouse, why: RobotRefusal) -> Problem {
    match why {
        RobotRefusal::UnknownKind => field("kind", say::kind_may_not_join()),
        RobotRefusal::IsGone(_) => robot_is_gone(),
        RobotRefusal::NotForKind(n) => field("place", say::node_not_for_kind(node_name(map, n))),
        RobotRefusal::PlaceTaken(n) => place_taken(node_name(map, n)),
        RobotRefusal::CanDrive(_) => robot_can_drive(),
        RobotRefusal::NoLink => Problem::conflict("no-link", "The floor has no link", say::no_link()),
        RobotRefusal::UnknownLink => field("link", say::unknown_link()),
        RobotRefusal::WhichLink => field("link", say::which_link()),
    }
}

/// Problems with where racks stand, and what can carry them.
fn about_racks(map: &Warehouse, why: RackRefusal) -> Problem {
    match why {
        RackRefusal::NotStorage(n) => field("node", say::not_storage(node_name(map, n))),
        RackRefusal::StorageTaken(n) => {
            let detail = say::storage_taken(node_name(map, n));
            Problem::conflict("storage-taken", "The storage node is taken", detail)
        }
        RackRefusal::NoKindFor(rack) => field("kind", no_kind_for(map, rack)),
        RackRefusal::IsStored(_) => rack_is_stored(),
    }
}

fn robot_is_gone() -> Problem {
    Problem::conflict("robot-is-gone", "The robot has left the floor", say::robot_is_gone())
}

fn rack_is_stored() -> Problem {
    Problem::conflict("rack-is-stored", "The rack is on no robot", say::rack_is_stored())
}

fn robot_can_drive() -> Problem {
    Problem::conflict("robot-can-drive", "The robot can drive", say::robot_can_drive())
}

fn no_kind_for(map: &Warehouse, rack: RackId) -> Sentence {
    say::no_kind_for(map.racks.get(rack).map_or_else(|| format!("{rack:?}"), |r| r.name.clone()))
}

/// Problems with jobs.
fn about_jobs(why: JobRefusal) -> Problem {
    match why {
        JobRefusal::Unknown(job) => Problem::unknown("job", say::job_unknown(job_name(job))),
        JobRefusal::IsOver(job) => {
            Problem::conflict("job-is-over", "The job is over", say::job_is_over(job_name(job)))
        }
        JobRefusal::HasBegun(job) => {
            Problem::conflict("job-has-begun", "The job has begun", say::job_has_begun(job_name(job)))
        }
        JobRefusal::CannotBeTaken(job) => {
            let detail = say::job_cannot_be_taken(job_name(job));
            Problem::conflict("job-cannot-be-taken", "The job cannot be taken from its robot", detail)
        }
        JobRefusal::NamesItsRobot(kind) => {
            let detail = say::job_names_its_robot(kind);
            Problem::conflict("job-names-its-robot", "The job names its robot", detail)
        }
        JobRefusal::NotForRobot(_) => field("robot", say::not_for_robot()),
        JobRefusal::SameStationTwice => field("stops", say::same_station_twice()),
        JobRefusal::UnknownPredecessor(job) => field("after", say::job_unknown(job_name(job))),
        JobRefusal::DeadlineIsOver => field("deadline", say::deadline_is_over()),
        JobRefusal::HasNoStation(kind) => field("station", say::job_without_station(kind)),
        JobRefusal::HasNoRobot(kind) => field("robot", say::job_without_robot(kind)),
        JobRefusal::TooManyBefore(most) => field("after", say::too_many_predecessors(most)),
        JobRefusal::Priority(p) => field("priority", say::priority_out_of_range(p)),
    }
}

/// Problems with closures, recurring closures and evacuations.
fn about_areas(why: AreaRefusal) -> Problem {
    match why {
        AreaRefusal::Empty => field("outline", say::area_empty()),
        AreaRefusal::TooManyCorners(most) => field("outline", say::area_too_many_corners(most)),
        AreaRefusal::UnknownSeries(id) => Problem::unknown("closure", say::series_unknown(series_name(id))),
        AreaRefusal::Recurrence => field("recurs", say::recurs_too_soon()),
        AreaRefusal::NoExits => Problem::conflict("no-exits", "There are no doors", say::no_exits()),
        AreaRefusal::UnknownClosure(id) => {
            Problem::unknown("closure", say::closure_unknown(closure_name(id)))
        }
    }
}

/// Problems with adding or removing a robot kind; `name` is the kind's name.
pub fn about_kinds(why: KindRefusal, name: &str) -> Problem {
    match why {
        KindRefusal::OfSite => {
            let detail = requests::kind_of_scenario(name);
            Problem::conflict("kind-of-scenario", "The scenario has this kind", detail)
        }
        KindRefusal::Unknown => Problem::unknown("kind", requests::kind_unknown(name)),
        KindRefusal::InUse(robots) => {
            let detail = requests::kind_in_use(robots, name);
            Problem::conflict("kind-in-use", "Robots are of this kind", detail)
        }
        KindRefusal::TooLarge => field("footprint", requests::malformed("the map is for smaller robots")),
        KindRefusal::Clearance => field("kind", requests::malformed("holds on this floor are too short")),
    }
}

fn place_taken(node: String) -> Problem {
    Problem::conflict("place-taken", "The place is taken", say::node_taken(node))
}

/// The limit on a kind of thing is reached.
fn too_many(kind: Bounded, n: usize) -> Problem {
    let detail = match kind {
        Bounded::Jobs => say::too_many_jobs(n),
        Bounded::Assignments => say::too_many_assignments(n),
        Bounded::Robots => say::too_many_robots(n),
        Bounded::Workers => say::too_many_workers(n, "/v1/people/{id}"),
        Bounded::Series => say::too_many_series(n),
        Bounded::Closures => say::too_many_closures(n),
        Bounded::Kinds => requests::too_many_kinds(n),
    };
    // Only things that end by themselves make a later retry worthwhile.
    let ends = matches!(kind, Bounded::Jobs | Bounded::Assignments | Bounded::Closures);
    if ends { Problem::too_many(detail, 10) } else { Problem::no_room(detail) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_meets_a_limit_is_told_which_one_and_what_to_do() {
        let map = giveway_floor::warehouse::lab();
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
