//! What people with a headset or phone are told.
//!
//! Constructors of sentences; each is named after its code. Refuses: to decide what is said.

use super::sentences;

sentences! {
    you_left_path() = "you left the path";
    robot_comes(robot) = "{robot} is coming close: stand still";
    robot_blocks_path(robot) = "{robot} blocks the path and cannot move away";
    robot_waits_for_you(robot) = "{robot} waits for you: please make room";
    robot_passes(robot) = "{robot} has waited for long: stay where you are until it has passed";
    robot_crosses(robot) = "{robot} crosses your path: wait a moment, this way is still the fastest";
    place_unsure(robot) =
        "{robot} waits because the headset knows badly where you are: stand still, and touch the marks again";
    cuts_off() = "you stand where robots have work: please make room";
    round_closure(closure) = "the way leads round a closed area: {closure}";
    leaves_closure(closure) = "this area is closed, leave it along the path: {closure}";
    place_closed(closure) = "the place of your task is in a closed area, wait outside: {closure}";
    leave_building() = "the building is evacuated: leave by the door, and stay outside";
    no_way() = "no path to the place is free";
    not_tracked() = "the headset does not know where you are: stand still, and touch the marks again";
}
