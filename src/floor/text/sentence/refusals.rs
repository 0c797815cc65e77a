//! Why the fleet refuses a request.
//!
//! Constructors of sentences; each is named after its code. Refuses: to decide what is said.

use super::sentences;

sentences! {
    no_rack_at_station(station) = "no rack stands at {station}: GET /v1/stations says what is on its way";
    lines_for_each_station() = "a job has lines for each of its stations, or for none";
    job_has_no_lines(path) = "the job that is picked for has no lines: end the pick with POST {path}";
    lines_counted_from_one(lines) = "the visit has {lines} lines, counted from 1";
    at_least_one_piece() = "at least one piece";
    pieces_left(pieces) = "only {pieces} pieces are left to pick: confirm as many at most";
    worker_unknown(worker) = "{worker} does not exist; GET /v1/workers lists all";
    worker_busy(worker) = "{worker} is on the floor, or has something to do: wait, or cancel it first";
    worker_not_lost(worker) = "{worker} is seen, or not on the floor: nobody has to look";
    no_place_for_people() = "nobody can stand there, or `within_m` is not from 0.5 to 8: choose a place on a walkway";
    out_of_reach(node) = "nobody can walk to {node}: choose a node on, or beside, a walkway of GET /v1/map";
    assignment_is_over(assignment) = "{assignment} is over already, or never existed";
    kind_may_not_join() =
        "there is no such kind of robots; GET /v1/kinds lists all kinds";
    no_link() =
        "this floor has no link to robots, so no robot can join: add one to `links` of the site file and start again";
    unknown_link() = "the floor has no link of this name; `links` of the site file names those that it has";
    which_link() =
        "the floor has several links: name the one by which the robot is reached, as `links` of the site file does";
    robot_is_gone() = "the robot has left the floor: register it again with POST /v1/robots";
    rack_is_stored() = "the rack is on no robot: GET /v1/racks says where it stands";
    robot_can_drive() = "the robot with the rack can drive: send the rack to a node with a job of kind relocate";
    no_kind_for(rack) =
        "no robot kind can carry {rack}, drive to it and reach its destination; GET /v1/kinds lists the kinds";
    node_not_for_kind(node) = "no lanes for this robot kind lead to {node} and away from it: choose another node";
    node_taken(node) = "a robot holds {node}, or is on its way there: choose another node";
    not_storage(node) = "{node} is not a storage node; racks go onto those only";
    storage_taken(node) = "{node} has a rack, or is reserved for one: choose another node";
    job_unknown(job) = "{job} does not exist";
    job_is_over(job) = "{job} is over already; GET /v1/jobs/{job} says how";
    job_has_begun(job) =
        "a robot works on {job} already, so it cannot be changed: cancel it and submit another one, or let it go \
         on";
    job_cannot_be_taken(job) =
        "the rack of {job} is at its station, or on its way to where it is to stay: let it end, or cancel it";
    job_names_its_robot(kind) =
        "a {kind} job names its robot: change it with PATCH before it has begun, or cancel it";
    not_for_robot() = "it cannot carry the rack, or may not drive to it or to where it is wanted";
    same_station_twice() = "two stops in a row are at the same station";
    deadline_is_over() = "it is over already: give a time to come, or none";
    job_without_station(kind) = "a {kind} job has no station";
    job_without_robot(kind) = "a {kind} job names no robot: Giveway chooses the best one";
    too_many_predecessors(most) = "a job can wait for at most {most} others";
    priority_out_of_range(priority) = "{priority} is not between 0 and 9";
    area_empty() = "an area needs at least three corners, and `until` must be after `from`";
    area_too_many_corners(most) = "an area has at most {most} corners";
    series_unknown(series) = "no closure recurs as {series}; GET /v1/closures/recurring lists what does";
    recurs_too_soon() = "an occurrence must be over before the next begins, and that is in five minutes or later";
    no_exits() = "the map has no doors (exits) to which people could be led: add them to the map";
    closure_unknown(area) = "{area} is not closed; GET /v1/closures lists what is";
    place_unknown() = "no such rack, station, node or robot";
    map_without_charger() = "the map has no charger: add one, or send the robot to a node with `go`";
    map_without_parking() = "the map has no parking place: add one, or send the robot to a node with `go`";
    too_many_jobs(count) = "{count} jobs are open, which is the limit: try again when some are over";
    too_many_assignments(count) =
        "{count} assignments are open, which is the limit: try again when some are done or cancelled";
    too_many_robots(count) =
        "{count} robots have joined, which is the limit: use the name of a robot that has joined already";
    too_many_workers(count, path) =
        "{count} workers are known, which is the limit: erase a person who no longer works here (DELETE {path}): \
         the place is free then";
    too_many_series(count) = "{count} closures recur, which is the limit: end some that are no longer needed";
    too_many_closures(count) =
        "{count} areas are closed or announced, which is the limit: open some that are no longer needed";
    no_work_cell(station) = "{station} has no work cell: add one to the map, or submit the job without lines";
    no_slots_known(rack) = "the map does not say which slots {rack} has: give it a rack type";
    no_such_slot(rack, slot) = "{rack} has no slot {slot}";
    no_such_tote(station, tote, totes) = "{station} has no tote \"{tote}\"; it has {totes}";
    pieces_out_of_range(most) = "1 to {most} pieces";
    line_twice(line) = "the same slot, tote and item as in line {line}: put the quantities into one";
    no_arm(station) = "{station} has no arm";
    too_many_lines(most) = "at most {most} lines for one visit";
    slot_unknown(rack) = "{rack} has no such slot";
    tote_unknown(station) = "{station} has no such tote";
    this_rack() = "this rack";
    this_station() = "this station";
}
