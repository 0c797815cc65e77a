//! What is wrong with the data of headsets and other devices, and marks that do not fit.
//!
//! Constructors of sentences; each is named after its code. Refuses: to decide what is said.

use super::sentences;

sentences! {
    too_few_marks() = "there are no marks, or only one without a direction";
    too_many_marks(marks) = "{marks} marks are too many";
    mark_absurd(mark) = "mark {mark} has impossible numbers";
    marks_too_close(apart_m) = "the marks are only {apart_m} m apart";
    marks_scaled(times) = "distances in the device are {times} times those on the map";
    marks_at_heights(low_m, high_m, worst) =
        "marks of one floor lie at heights from {low_m} to {high_m} m in the device, number {worst} off the most";
    marks_mirrored() = "the marks fit only as in a mirror: the device exchanges two axes, or counts one backwards";
    mark_turned(mark, degrees) = "mark {mark} points {degrees} degrees away from where the marks say that it points";
    marks_off(off_m, worst) = "the marks are {off_m} m off, number {worst} the most";
    marks_ambiguous() = "one of the marks is wrong, and the others do not show which";
    no_mark_named(pair, name) = "pairs[{pair}]: there is no mark or node \"{name}\"; GET /v1/map lists them";
    map_or_mark(pair) = "pairs[{pair}]: give map [x, y], or mark, the name of a mark or node";
    pair_is_wrong(pair, fault) = "pairs[{pair}]: {fault}";
    pose_without_clock() = "poses are accepted once the first ping is answered: answer pings with a pong";
    pose_not_aligned() = "the frame of the device is not known: send anchors";
    pose_of_old_epoch() = "the pose belongs to an earlier alignment: use the epoch of the last answer";
    pose_of_unknown_epoch() = "this epoch was never given out: use the epoch of the last answer";
    pose_without_position() = "a pose needs pos, or at in the frame of the map; one that is lost needs one before it";
    pose_absurd() = "impossible numbers: give positions in metres, accuracy from 0 to 100 m";
    pose_at_height() =
        "the eyes are below the floor of the marks, or more than 4 m above it: y is up, in metres; touch the marks \
         again";
    pose_askew() =
        "you walk where the device says that you do not face: send quat in WebXR axes (x to the right, y up, ahead \
         is -z), and pos likewise";
    pose_not_turned() = "quat must be x, y, z, w of length 1";
    pose_in_future() = "the pose lies in the future: t is the moment on the clock that answers pings";
    pose_too_old() = "the pose is more than ten seconds old: send the newest and drop queued ones";
    pose_repeated() = "this seq came already: count up within an epoch";
    pose_reordered() = "a later seq came already: only the newest counts";
    marks_on_one_line() =
        "the marks lie on one line, so left and right may be exchanged, and robots keep away from two places: \
         touch a mark beside that line, too, at least 1 m from it";
    marks_left_out(marks) =
        "marks that do not fit with the others are left out: {marks}; check their names, and touch them again";
    pose_jumped() = "the pose is farther away than anybody walks: if the origin moved, send reset";
    nobody_can_be_there() = "nobody can be there: check the frame, the marks and the clock";
    hand_left_out() =
        "a hand is left out: a joint is no four numbers, or its joints are too many, far from each other or from \
         any shoulder, or have not moved at all for a second, or left and right changed places";
    replaced_by_another() = "another connection of this worker replaced this one";
    token_ended() = "the token of this connection no longer holds";
    server_shutting_down() = "server shutting down";
    floor_is_fast(speed) = "the clock of this floor goes {speed} times as fast as yours: start it without --speed";
    no_worker_for_uuid(uuid) =
        "no worker is known as {uuid}: POST /v1/workers with this uuid as the name, or name the worker under \
         [massrobotics.workers] of the settings file";
}
