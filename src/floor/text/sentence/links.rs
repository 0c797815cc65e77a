//! Why a robot of another vendor is not commanded, and what was noticed of it.
//!
//! Constructors of sentences; each is named after its code. What a robot itself says stays in its own words. Refuses:
//! to decide what is said.

use super::sentences;

sentences! {
    never_heard() = "it was never heard of";
    switched_off() = "it is switched off";
    connection_lost() = "the broker has lost its connection";
    sleeps() = "it sleeps";
    does_not_answer() = "it does not answer";
    speaks_other_version(version) = "it speaks version {version}, which is not spoken here";
    not_automatic(mode) = "its operating mode is {mode}, not automatic";
    says_no_position() = "it does not say where it is";
    not_localized() = "it does not know where it is";
    on_unknown_map(map) = "it is on map \"{map}\", which is none of this floor's";
    on_no_node(off_m) = "it is on no node: the nearest is {off_m} m away";
    drives_foreign_order(order) = "it drives by order \"{order}\", which is not ours";
    paused_at_robot() = "it is paused, and not from here: let it go on at the robot";
    obedience_not_seen() = "it was not yet seen to pause and go on";
    does_not_pause() = "it does not pause when told to";
    does_not_pause_since(words) = "it does not pause when told to: {words}";
    refuses_orders(words) = "it refuses orders: {words}";
    needs_button() = "it waits for a trigger and takes none from here: press the button at it";
    no_such_link(link) = "the site has no link named {link}";
    paused_where_it_is() = "somebody has paused it where it is";
    has_left_floor() = "it has left the floor: POST /v1/robots registers it again";
    kind_waits() = "its kind waits for what it says of itself";
    kind_too_large() = "it is too large for this floor's map by its factsheet: give its kind a `footprint`";
    kind_brakes_slowly() = "it brakes too slowly for this floor by its factsheet: give its kind its figures";
    kinds_are_full() = "the floor has as many kinds of robots as it may have";
    kind_refused(why) = "its kind cannot be added: {why}";
    pauses_are_requests(action) =
        "Giveway says {action} to robots by itself: POST /v1/robots/…/pause and …/resume stop a robot and let it go on";
    cancels_are_requests(action) =
        "Giveway says {action} to robots by itself: DELETE /v1/jobs/… takes a robot's job away, and its order with it";
    nothing_reaches(why) = "nothing reaches the robot: {why}";
    kind_has_no_maps() = "the robot's kind has no `link.maps`, so that its map is unknown";
    place_goes_with(action) = "a place goes with {action} only";
    nothing_to_agree_to() = "there is nothing to agree to: the robot has not failed to pause when told to";
    nothing_to_settle() = "no action of the robot has failed, and it refuses no orders";
    no_address(why) = "that is no address of a robot: {why}";
    version_not_spoken(version) = "version {version} is not spoken: 2.0.0, 2.1.0 or 3.0.0";
    all_robots_listed(most) = "{most} robots are listed, which is the site's limit";
    no_such_kind(kind) = "there is no kind {kind}: GET /v1/kinds lists the kinds";
    listed_as(robot) = "this robot is listed as {robot}";
    is_another_robot(robot, address) = "{robot} is another robot: {address}";
    noticed_finished_and_full(action) = "says that {action} is finished, and carries something";
    noticed_finished_and_empty(action) = "says that {action} is finished, and carries nothing";
    noticed_silent_action(action) = "ended its order without a word about {action}";
    noticed_action_failed(action, words) = "{action} failed: {words}";
    noticed_false_cancel() = "says that its order is cancelled, and goes on";
    noticed_no_cancel() = "does not cancel its order";
    noticed_false_pause() = "says that it is paused, and moves";
    noticed_no_pause() = "does not pause";
    noticed_no_pause_since(words) = "does not pause: {words}";
    noticed_false_progress(said) = "says that it is where it cannot be: {said}";
    noticed_rejected(words) = "refuses an order: {words}";
    noticed_not_taken() = "does not take the order that it is sent";
    noticed_other_name(name) = "sends states in the name of {name}";
}
