//! Why robots and jobs do not continue, and why jobs failed.
//!
//! Constructors of sentences; each is named after its code. Refuses: to decide what is said.

use super::sentences;

sentences! {
    waits_for(place, robot) = "waits for {place}, held by {robot}";
    gives_way(worker) = "gives way to worker {worker}";
    area_ahead(area) = "stands before closed area {area}";
    queue_full(station) = "waits outside: the queue of station {station} is full";
    not_its_turn(station, robot) = "waits for its turn at station {station}: before it comes {robot}";
    station_paused(station) = "waits for {station} to resume: it is paused";
    hand_in_opening(station) = "stands while a hand is in the opening of station {station}";
    no_route() = "has found no route yet and tries again";
    cannot_drive() = "cannot drive: repair it, push it onto a free node, or take it off the floor";
    cannot_drive_with_rack(rack) =
        "cannot drive, and has rack {rack} on it: repair it, or push it onto a free node; or set the rack down in \
         storage by hand and say where with POST /v1/racks/{rack}/taken";
    emergency_stop() = "is stopped: its emergency stop is pressed; release it when the way is clear";
    driven_by_hand() = "is driven by hand: it goes on by itself once it is left on a free node";
    obstructed(node) =
        "cannot pass: something stands on its way to {node}; clear the way; the robot looks for another";
    way_obstructed(node) = "waits for {node} to be cleared: a robot reported that something stands there";
    unplugged() = "gets no current from its charger: check the plug and the charger";
    blocked_by(robot) = "waits for {robot} to be repaired or moved out of its way";
    silent() = "sends no telemetry";
    refused() = "its link takes no orders for it";
    refused_because(words) = "its link takes no orders for it: {words}";
    paused() = "is paused by hand";
    in_maintenance() = "is in maintenance";
    leaves() = "leaves the floor: switch it off before you take it away";
    has_left() = "has left the floor";
    fleet_stopped() = "is stopped with the whole fleet";
    stands_for_evacuation() = "stands while the building is evacuated";
    off_node(x, y, off_m, node) =
        "stands at ({x}, {y}), {off_m} m from the nearest node {node}: push or drive it onto a free node; it \
         rejoins the fleet there by itself";
    knows_old_route(node) =
        "stands on {node}, which it does not hold, and still has its old route: clear that (switch it off and on); \
         it rejoins the fleet there by itself";
    on_granted_node(node, robot) =
        "stands on {node}, to which {robot} may drive already: push or drive it onto a free node; it rejoins the \
         fleet there by itself, or where it is once {robot} has backed off";
    on_stored_rack(node, rack) =
        "stands with its rack on {node}, where rack {rack} is stored: push or drive it onto a free node; it \
         rejoins the fleet there by itself";
    no_way_out(node) =
        "stands on {node}, from which it has no lane to drive on: push or drive it onto a free node; it rejoins \
         the fleet there by itself";
    displaced_by_hand() =
        "is driven by hand: leave it on a free node; once that ends, it rejoins the fleet by itself";
    rack_missing(rack) =
        "carries no rack, but rack {rack} was on it: set rack {rack} onto it, and it goes on by itself; or set the \
         rack down in storage and say where with POST /v1/racks/{rack}/taken";
    rack_unexpected(rack) =
        "carries rack {rack}, but had no rack on it: take rack {rack} off it and back to its place; it goes on by \
         itself";
    other_rack(has, had) = "carries {has}, but {had} was on it: put {had} onto it instead; it goes on by itself";
    rack_named(rack) = "rack {rack}";
    no_rack() = "no rack";
    after_job(job) = "waits for {job} to be over";
    rack_on(rack, robot) = "waits for rack {rack}, which is on {robot}";
    rack_to_be_fetched(rack, robot) = "waits for rack {rack}, which was to be fetched by {robot}";
    rack_moved(rack, robot, job) = "waits for rack {rack}, which {robot} moves for {job}";
    rack_brought_back(rack, robot) = "waits for rack {rack}, which {robot} brings back to storage";
    robot_works(robot, job) = "waits for {robot}, which works on {job}";
    robot_on_its_way(robot) = "waits for {robot}, which is on its way somewhere";
    no_robot_free() = "waits for a robot: none is free";
    jobs_of_higher_priority(higher) = "waits for a robot: none is free; jobs ahead: {higher} of higher priority";
    jobs_due_sooner(others) = "waits for a robot: none is free; jobs ahead: {others} older or due sooner";
    jobs_ahead(higher, others) =
        "waits for a robot: none is free; jobs ahead: {higher} of higher priority and {others} older or due sooner";
    many_jobs_ahead(jobs) = "waits for a robot: none is free; jobs ahead: {jobs} or more";
    no_robot_of_kind() = "waits for a robot: none of a kind that can do this job has joined";
    racks_wait(station, robot) =
        "waits for room at {station}: enough racks wait for it already, first that on {robot}";
    station_full(station) = "waits for room at {station}: a robot stands in every place";
    place_closed_off() = "waits for a closed or obstructed place at its rack or destination";
    station_blocked(station, robot) = "waits for the way to or from {station}, on which stands {robot}";
    way_blocked(robot) = "waits for the only way to its rack or destination, on which stands {robot}";
    way_closed(area) = "waits for closed area {area} to open: it cuts the rack off from its destination";
    rack_blocked(rack, robot) = "waits for rack {rack}, beneath which stands {robot}";
    node_kept(node, robot) = "waits for {node}, where {robot} is or is going to stay";
    no_charger() = "waits for a charger: all are taken or closed";
    no_parking() = "waits for a parking place: all are taken or closed";
    robot_charges(robot) = "waits for {robot} to charge";
    robot_says(robot, reason) = "{robot}: {reason}";
    robot_in_trouble(robot, reason) = "{robot} ({reason})";
    predecessor_failed(job) = "{job}, which had to be over first, was cancelled or failed";
    unreachable() = "no route leads there, even on an empty floor";
    goods_missing() = "the station reported that goods were missing";
    no_place_aside() =
        "robots want one another's places, and no free place is left at which one of them could make room";
    named_robot_gone() = "the robot that it names has left the floor";
    map_changed() = "the map was changed and no longer has what this job names";
    put_elsewhere(node) = "{node} has another rack, or is reserved for one: the rack was put elsewhere";
    lifts() = "is lifting its rack";
    sets_down() = "is setting its rack down";
    is_picked_from() = "is being picked from";
    has_arrived() = "has arrived";
    drives_on() = "drives on and then frees it";
    goes_on_as_planned() = "goes on as planned";
    stays() = "stands where it may stay";
    walks() = "walks on, or is at work";
    robot_in_the_way(robot) = "waits for {robot}, which is in the way";
    told_to_stop() = "was told to stop: there is no way on";
    person_stands() = "stands, and may walk on or not";
    person_lost() = "cannot be placed: the headset has lost its place";
    line_down() = "cannot be reached, as no robot of its link can: it stands at the end of what it was granted";
    arm_is_silent() = "the arm is silent";
    arm_reports_late() = "the arm's reports are late";
    arm_joints_impossible() = "the arm reports joints that it cannot have";
    arm_joints_jump() = "the arm reports joints that it cannot have come to";
    arm_stopped() = "the arm's protective stop holds it";
}
