//! What to do about alarms and about marks that do not fit.
//!
//! Constructors of sentences; each is named after its code. Refuses: to decide what is said.

use super::sentences;

sentences! {
    do_repair_robot() = "Go to the robot and repair it, or take it off the floor. Others drive round it.";
    do_release_emergency_stop() = "Check why it was pressed, then release it: the robot goes on by itself.";
    do_check_radio() = "Check the robot's power and radio. Its place stays closed until it reports.";
    do_bring_robot() = "Bring the robot, or its rack, where the text says.";
    do_clear_way() = "Clear the way ahead of the robot.";
    do_clear_place() = "Clear the place: robots try it again two minutes after they last found it closed.";
    do_check_charger() = "Check the charger's power and contacts.";
    do_free_charger() = "Free a charger, or charge the robot by hand.";
    do_open_area_or_clear_goal() = "Look at why it waits: open an area that is closed, or clear its goal.";
    do_see_what_keeps_robot() = "Go to the robot and see what keeps it, or pause and resume it.";
    do_stop_robot() = "Stop the robot and check where it is.";
    do_register_or_switch_off() = "Register the robot again, or switch it off: others do not make way for it.";
    do_check_and_resume_robot() = "Check where the robot and its rack are, then resume the robot.";
    do_pause_resume_and_report() = "Pause and resume these robots, and report this.";
    do_make_room() = "Ask the person to make room, or move the robot that the others wait for.";
    do_look_at_first_named() = "Look at why the named robots and jobs wait, and start with the first.";
    do_look_at_jobs() = "Look at why the jobs wait: the list of jobs says it of each.";
    do_look_for_worker() = "Look where the worker was last seen. If nobody is there, clear the worker.";
    do_ask_worker_to_walk() = "Tell the worker to walk on: robots give way to people who walk.";
    do_call_worker_out() = "Call the worker out, or open the area.";
    do_cancel_or_add() = "Cancel these jobs, or add what they need; submit them again then.";
    do_raise_priority_or_postpone() = "Raise the priority of these jobs, or postpone others.";
    do_tell_customer() = "Tell the customer, and raise the priority of these jobs.";
    do_look_at_first_job() = "Look at why the first of these jobs waits.";
    do_look_at_first_robot() =
        "Look at what the first of these robots waits for, and clear that way; or send fewer robots.";
    do_check_arm() =
        "Check the arm's power and connection, and bring it out of the opening. If it stays off, release the rack: \
         by that you say that the arm is outside.";
    do_more_processor_or_fewer_robots() = "Give the server more processor time, or run fewer robots on it.";
    do_more_processor_or_move_robot() =
        "Give the server more processor time; if a robot blocks a main aisle, move it.";
    do_check_tags() = "Nothing at once: robots keep out of all that people can reach. Check the tags.";
    do_set_clock() =
        "Set the system's clock right and restart Giveway. If the system's clock is behind and right, stop Giveway \
         and type `giveway database set-clock` before that.";
    do_check_disk() = "Check the disk of the database: make room, or bring it back.";
    do_put_database_back() = "Put the files of the database back, or restart with a backup.";
    do_restart_if_it_stays() = "If this does not end within a minute, restart Giveway.";
    do_restart_and_restore() =
        "Keep a copy of the database, restart Giveway, and restore a backup if that does not help.";
    do_bring_receiver_back() =
        "Bring its receiver back, or remove the webhook. Events wait for about an hour; then they are given up.";
    do_find_guesser() =
        "Find out who sends them: a device with an old token, or somebody who guesses. The audit has the \
         addresses.";
    do_restart_clients() =
        "Bring the broker back. Most robots do not find it again by themselves: restart the clients of those that stay \
         silent.";
    do_end_other_server() =
        "Find the other server that uses these robots, end one of the two, and restart the one that is to go on.";
    do_ask_vendor() =
        "Look at the robot and at its messages; ask its vendor why it says what is not so. Until then keep people away \
         from where it works.";
    do_make_room_on_disk() = "Make room on the disk of the recordings.";
    do_seek_or_close() = "Seek in the recording, or close it.";
    do_resume_fleet() = "Resume the fleet when it may go on.";
    do_resume_robots() = "Resume the robots when they may go on.";
    do_end_evacuation() = "End the evacuation when everybody may come back.";
    do_touch_two_marks() = "touch two marks, or give one mark with its direction";
    do_send_nearest_marks() = "send the 32 nearest";
    do_touch_mark_again() = "touch this mark again";
    do_touch_marks_apart() = "touch marks that are at least 1 m apart, better 10 m";
    do_check_names_and_metres() = "check that each mark has the right name, and that the device counts in metres";
    do_touch_again_or_check_axes() =
        "touch that mark again; if all are wrong, send WebXR axes: x to the right, y up, z backwards, metres";
    do_send_webxr_axes() = "send WebXR axes: x to the right, y up, z backwards; from a left-handed frame negate z";
    do_send_rotation() = "send x, y, z, w of a rotation in WebXR axes, or leave the direction out";
    do_check_name_of_mark() = "check the name of that mark, and touch it again";
    do_touch_fourth_mark() = "touch a fourth mark";
    do_correct_message() = "correct the message";
}
