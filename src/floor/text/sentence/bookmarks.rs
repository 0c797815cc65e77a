//! What happened, in the bookmarks of a recording.
//!
//! Constructors of sentences; each is named after its code. Refuses: to decide what is said.

use super::sentences;

sentences! {
    left_path(worker) = "{worker} left the path";
    went_another_way_for(robot, worker) = "{robot} went another way for {worker}";
    went_round_obstruction(robot) = "{robot} went round an obstruction";
    went_round(robot, what) = "{robot} went round {what}";
    was_paused(robot) = "{robot} was paused by hand";
    goes_on(robot) = "{robot} goes on";
    all_were_stopped() = "all robots were stopped by hand";
    all_go_on() = "all robots go on";
    broke_down(robot) = "{robot} broke down";
    works_again(robot) = "{robot} works again";
    was_fenced_off(robot) = "{robot} was fenced off";
    was_evacuated() = "the building was evacuated";
    evacuation_ended() = "the evacuation ended";
    area_was_closed(area, reason) = "{area} was closed: {reason}";
    area_was_opened(area) = "{area} was opened again";
    met_and_drove_on(worker, robot, closest_m) = "{worker} met {robot} (closest {closest_m} m); the robot drove on";
    met_and_was_slowed(worker, robot, closest_m) =
        "{worker} met {robot} (closest {closest_m} m); the robot was slowed";
    met_and_had_to_wait(worker, robot, closest_m) =
        "{worker} met {robot} (closest {closest_m} m); the robot had to wait";
    met_and_rerouted(worker, robot, closest_m) =
        "{worker} met {robot} (closest {closest_m} m); the robot went another way";
    met_and_was_stopped(worker, robot, closest_m) =
        "{worker} met {robot} (closest {closest_m} m); the robot was stopped";
    worker_was_lost(worker) = "{worker} is lost: robots stop around the last known position";
}
