//! What is wrong on the floor or with the server. `{waiting}`, `{behind}` end a sentence, and may be empty.
//!
//! Constructors of sentences; each is named after its code. Refuses: to decide what is said.

use super::sentences;

sentences! {
    robots_wait_for_it(robots) = "; {robots} robots wait for it";
    one_robot_waits_for_it() = "; 1 robot waits for it";
    robots_wait_for_them(robots) = "; {robots} robots wait for them";
    one_robot_waits_for_them() = "; 1 robot waits for them";
    robot_returned(robot, waiting) = "{robot} has left the floor but still reports{waiting}.";
    robot_fenced(robot, waiting) =
        "what is known about {robot} contradicts itself: fenced off, others go round it{waiting}.";
    robot_beyond_grant(robot, waiting) = "{robot} reports more than it was granted{waiting}.";
    robot_emergency_stop(robot, waiting) = "{robot}: emergency stop pressed{waiting}.";
    robot_silent(robot, waiting) = "{robot} sends no reports{waiting}.";
    robot_unplugged(robot, waiting) = "{robot} gets no current from its charger{waiting}.";
    robot_obstructed_before(robot, node, waiting) = "something stands in the way of {robot}, before {node}{waiting}.";
    robot_obstructed(robot, waiting) = "something stands in the way of {robot}{waiting}.";
    robot_finds_no_route(robot, waiting) = "{robot} finds no route{waiting}.";
    robot_failed(robot, waiting) = "{robot} has failed and cannot drive{waiting}.";
    robot_low(robot, percent, waiting) = "{robot} has {percent} % of charge left and finds no free charger{waiting}.";
    robot_stuck(robot, waiting) = "{robot} has a task and makes no progress{waiting}.";
    robot_displaced(robot, how, waiting) = "{robot} {how}{waiting}.";
    obstacle_left(robot, node) = "something stood in the way of {robot}, before {node}: robots go round it.";
    robots_failed(count, all, names, waiting) = "{count} of {all} robots have failed: {names}{waiting}.";
    robots_emergency_stop(count, all, names, waiting) =
        "{count} of {all} robots have their emergency stop pressed: {names}{waiting}.";
    robots_silent(count, all, names, waiting) = "{count} of {all} robots send no reports: {names}{waiting}.";
    robots_displaced(count, all, names, waiting) =
        "{count} of {all} robots stand where they are not expected: {names}{waiting}.";
    robots_obstructed(count, all, names, waiting) = "{count} of {all} robots are obstructed: {names}{waiting}.";
    robots_unplugged(count, all, names, waiting) =
        "{count} of {all} robots get no current from their chargers: {names}{waiting}.";
    robots_low(count, all, names, waiting) =
        "{count} of {all} robots are low on charge and find no free charger: {names}{waiting}.";
    robots_find_no_route(count, all, names, waiting) = "{count} of {all} robots find no route: {names}{waiting}.";
    robots_stuck(count, all, names, waiting) = "{count} of {all} robots make no progress: {names}{waiting}.";
    robots_beyond_grant(count, all, names, waiting) =
        "{count} of {all} robots report more than they were granted: {names}{waiting}.";
    robots_returned(count, all, names, waiting) =
        "{count} of {all} robots have left the floor but still report: {names}{waiting}.";
    robots_in_trouble(count, all, names, waiting) = "{count} of {all} robots need attention: {names}{waiting}.";
    and_more(names, more) = "{names} and {more} more";
    and(first, last) = "{first} and {last}";
    worker_numbered(number) = "worker {number}";
    worker_lost(worker) = "{worker} is lost: no robot waits.";
    worker_lost_one_waits(worker) = "{worker} is lost: 1 robot waits.";
    worker_lost_robots_wait(worker, robots) = "{worker} is lost: {robots} robots wait.";
    worker_kept(worker) = "{worker} is kept in one spot by robots.";
    worker_kept_by(worker, robot) = "{worker} is kept in one spot by {robot}.";
    worker_in_closed_area(worker, area, reason) = "{worker} is in {area}, which is closed to people ({reason}).";
    no_deliveries() = "jobs wait and robots can drive, but nothing is delivered.";
    jobs_wait_in_vain(jobs) = "jobs wait, and nothing keeps them: {jobs}.";
    jobs_impossible(jobs) = "no robot on this floor can do {jobs}.";
    jobs_wait_in_vain_or_impossible(in_vain, impossible) =
        "jobs wait, and nothing keeps them: {in_vain}; no robot on this floor can do {impossible}.";
    deadline_missed(jobs) = "past their deadline: {jobs}.";
    deadline_at_risk(jobs) = "will probably not be done by their deadline: {jobs}.";
    station_starved(station, job) = "no rack is on its way to {station}, though {job} waits for it.";
    wait_for_one_another(who, behind) = "{who} wait for one another{behind}.";
    stands_in_the_way(who, behind) = "{who} stands in the way{behind}.";
    no_way_to_go(who, behind) = "{who} has no way to go{behind}.";
    one_waits_behind(who) = "; {who} waits for that";
    more_wait_behind(who, more) = "; {who} and {more} more wait for that";
    floor_stands(names) = "nothing on the floor moves: {names}.";
    nothing_else_moves(alarm) = "{alarm} Nothing else on the floor moves.";
    robots_idle(jobs, job, reason) =
        "no robot has anything to do, though jobs wait: {jobs}. {job} waits because {reason}.";
    no_robot_can_take_it() = "no robot can take it";
    destination_closed_off() = "its rack, or where it is to go, is closed off";
    no_place_free() = "no charger or parking place is free";
    enough_racks_wait(station) = "enough racks wait for {station}";
    its_rack_is_on_a_robot(rack) = "its rack {rack} is on a robot";
    nothing_known() = "of nothing that is known";
    stations_dry(stations, behind) =
        "no rack is picked at {stations}, though robots stand outside with racks{behind}.";
    robots_stand(waiting, robots, behind) = "{waiting} of {robots} robots at work wait{behind}.";
    stations_dry_and_robots_stand(stations, waiting, robots, behind) =
        "no rack is picked at {stations}, though robots stand outside with racks; {waiting} of {robots} robots at \
         work wait{behind}.";
    most_wait_behind(first) = "; most wait behind {first}";
    all_stopped() = "all robots are stopped by hand.";
    evacuation() = "the building is evacuated: people are led to the doors, robots stand.";
    robots_paused(robots) = "paused by hand: {robots}.";
    arm_silent(station) = "the robot arm at {station} is silent: it gets no trajectory, the picker has its lines.";
    arm_late(station) =
        "the robot arm at {station} sends its reports too late: it gets no trajectory, the picker has its lines.";
    arm_joints(station) =
        "the robot arm at {station} reports joints that it cannot have: it gets no trajectory, the picker has its \
         lines.";
    arm_jump(station) =
        "the robot arm at {station} reports joints that it cannot have come to: it gets no trajectory, the picker \
         has its lines.";
    arm_stuck(station) =
        "the robot arm at {station} has not moved in the opening for a minute: no rack comes or leaves.";
    steps_late(period_ms, percent) =
        "steps take longer than the control period of {period_ms} ms: {percent} % of the last ones.";
    plan_backlog(robots) = "robots wait for a route to be searched for them: {robots}.";
    forecasts_fail(horizons) = "forecasts of people do not hold: {horizons}.";
    forecast_horizon(seconds, percent) = "{seconds} s ahead ({percent} % within the 95 % region)";
    clock_ahead(seconds) = "the system's clock is {seconds} s ahead of the clock that Giveway goes by.";
    clock_behind(seconds) = "the system's clock is {seconds} s behind the clock that Giveway goes by.";
    journal_full() = "the journal is full: all robots were told to stop until the database takes facts again.";
    journal_slow(facts, file) =
        "the journal is slow: {facts} facts wait for {file}. Robots get no new orders meanwhile.";
    database_gone(reason) = "{reason}. Robots drive to the end of their grants and stop.";
    loop_stuck() = "the control loop is stuck: robots get no orders.";
    webhooks_fail(webhooks) = "webhooks take no events: {webhooks}.";
    wrong_secrets(addresses) = "wrong tokens or cookies come from {addresses}.";
    address_guesses(address, times) = "{address} (at least {times} times)";
    broker_gone(reason) =
        "the broker of the robots is gone ({reason}): they drive to the end of what they were released and stand.";
    robots_taken_over() = "another server has taken the robots over: this one sends them nothing any more.";
    robot_claims(robots) = "robots say what is not so: {robots}.";
    robot_claim(robot, claim) = "{robot} {claim}";
    past_not_kept(reason) = "the past is not kept: {reason}. The fleet goes on; make room on the disk.";
    past_not_begun(reason) = "the past is not kept: {reason}. The fleet goes on.";
    fleet_contradicts_itself(panic, reason) =
        "the fleet contradicts itself ({panic}), and {reason}: all robots were told to stop, nothing is accepted. \
         Keep a copy of the database, restart Giveway, and restore a backup if that does not help.";
    ledger_contradicts_itself(panic) =
        "the ledger contradicts itself: {panic}. Keep a copy of the database and restart Giveway.";
    recording_ended() = "The recording has ended.";
    recording_ended_otherwise() =
        "The recording has ended. This build decides differently from the one that recorded it.";
    webhook_fails(webhook, reason) = "{webhook} ({reason})";
    journal_not_written(reason) = "the journal cannot be written: {reason}. Robots get no new orders meanwhile.";
    robots_wait_in_vain(robots) = "robots wait for what does not keep them: {robots}.";
}
