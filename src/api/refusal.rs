//! What the fleet's refusals mean on the wire.
//!
//! Main function: [`refused`]. Refuses: to leave anybody without a word of what to do.

use super::dto::job_name;
use super::error::{FieldError, Problem};
use super::people::{assignment_name, closure_name, worker_name};
use crate::fleet::Refusal;
use crate::id::NodeId;
use crate::warehouse::{NodeKind, Warehouse};

/// A refusal as a problem.
pub fn refused(map: &Warehouse, why: Refusal) -> Problem {
    let field = |field: &str, detail: String| Problem::invalid(vec![FieldError::new(field, detail)]);
    let node = |n: NodeId| map.nodes.get(n).map_or_else(|| format!("{n:?}"), |node| node.name.clone());
    match why {
        Refusal::UnknownJob(job) => Problem::unknown("job", format!("{} does not exist", job_name(job))),
        Refusal::JobIsOver(job) => {
            let detail =
                format!("{} was over already; GET /v1/jobs/{} says how", job_name(job), job_name(job));
            Problem::conflict("job-is-over", "The job is over", detail)
        }
        Refusal::JobHasBegun(job) => {
            let detail = format!("a robot works on {} already: its priority changes nothing", job_name(job));
            Problem::conflict("job-has-begun", "The job has begun", detail)
        }
        Refusal::UnknownPredecessor(job) => field("after", format!("{} does not exist", job_name(job))),
        Refusal::UnknownPlace => {
            Problem::invalid(vec![FieldError::new("kind", "no such rack, station, node or robot")])
        }
        Refusal::NotStorage(n) => {
            field("node", format!("{} is no storage node; racks go onto those only", node(n)))
        }
        Refusal::StorageTaken(n) => {
            let detail = format!("{} has a rack, or is promised to one: choose another node", node(n));
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
        Refusal::Priority(p) => field("priority", format!("{p} is not between 0 and 9")),
        Refusal::TooMany(n) => Problem::unavailable(
            format!("{n} are waiting, which is the limit: try again when some are done"),
            10,
        ),
        Refusal::UnknownWorker(worker) => {
            let name = worker_name(worker);
            Problem::unknown("worker", format!("{name} does not exist; GET /v1/workers lists all"))
        }
        Refusal::UnknownAssignment(id) => {
            let detail = format!("{} is over already, or was never made", assignment_name(id));
            Problem::conflict("assignment-is-over", "The assignment is over", detail)
        }
        Refusal::UnknownClosure(id) => {
            let detail = format!("{} is not closed; GET /v1/closures lists what is", closure_name(id));
            Problem::unknown("closure", detail)
        }
        Refusal::OutOfReach(n) => {
            let detail = format!(
                "nobody can walk to {}: choose a node on, or beside, a walkway of GET /v1/map",
                node(n)
            );
            field("place", detail)
        }
        Refusal::EmptyArea => {
            field("outline", "an area needs three corners and an end after its beginning".into())
        }
    }
}
