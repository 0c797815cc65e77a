//! What is wrong with requests. `malformed` and `unavailable` carry the words of a parser, of the server or of a check
//! for developers and operators.
//!
//! Constructors of sentences; each is named after its code. Refuses: to decide what is said.

use super::sentences;

sentences! {
    malformed(detail) = "{detail}";
    unavailable(detail) = "{detail}";
    field_is_wrong(field, detail) = "{field}: {detail}";
    fields_are_wrong(errors) = "{errors}";
    required_for(kind) = "required for {kind}";
    no_such_thing(what, name, path) = "there is no {what} \"{name}\"; GET {path} lists them";
    no_robot_link() =
        "the floor has no link to robots of other vendors: give the site `links.mqtt`, or start with --mqtt";
    robot_not_linked(name) =
        "no robot \"{name}\" speaks VDA 5050 here; GET /v1/robots?unlisted=true lists who is heard";
    action_not_remembered(action) = "no action \"{action}\" is remembered; the last 50 of each robot are";
    node_or_address() =
        "say where a robot stands with `node`, or how to reach it with `manufacturer` and `serial`: not both";
    no_such_name(what, name, fault) = "there is no {what} \"{name}\": {fault}";
    stops_have_their_own() = "leave it out where there are stops: each of them has its own";
    station_twice(station) = "\"{station}\" comes twice in a row: put the picks into one";
    seconds_out_of_range(most) = "must be 0 to {most} seconds";
    stops_out_of_range(count, most) = "{count} stops; 1 to {most} are allowed";
    no_such_field(kind, fields) = "no such field; a {kind} job has {fields}";
    characters_without_line_breaks(most) = "1 to {most} characters without line breaks";
    at_most_allowed(most) = "at most {most} are allowed";
    plain_key(most) = "keys have 1 to {most} letters, digits, `-`, `_` or `.`";
    plain_name(most) = "1 to {most} letters, digits, `-`, `_` or `.`";
    predecessors_out_of_range(count, most) = "{count} jobs; at most {most} are allowed";
    not_a_job_id(text) = "\"{text}\" is not a job id; ids look like j17";
    not_an_assignment_id(text) = "\"{text}\" is not an assignment id; ids look like a3";
    not_a_closure_id(text) = "\"{text}\" is not a closure id; ids look like c2, or s1 for what recurs";
    does_not_exist(id) = "{id} does not exist";
    not_one_of(word, known) = "\"{word}\" is not one of {known}";
    time_too_late(text, latest) = "\"{text}\" is later than {latest}, the latest time";
    not_a_time(text) = "\"{text}\" is not a time such as 2027-01-31T12:00:00Z";
    say_who_you_are(most) = "say who you are, in 1 to {most} characters";
    give_a_text(most) = "give a text of 1 to {most} characters";
    shelving_out_of_range() = "must be from 60 to 43200 (twelve hours)";
    alarm_not_active(alarm) = "no alarm \"{alarm}\" is active; GET /v1/alarms lists those that are";
    alarm_always_calls(alarm) =
        "{alarm} says that nothing can be promised, or that people have to leave: it always calls";
    too_many_notes(alarm, most) = "{alarm} has {most} notes, as many as an alarm may have";
    too_many_shelved(most) = "{most} alarms are put aside: take one back up first";
    binds_whom() = "must be \"robots\", \"people\" or \"both\"";
    outline_or_nodes() = "give either outline or nodes";
    until_after_from() = "must be after `from` and in the future";
    say_why_closed(most) = "say in 1 to {most} characters why the area is closed";
    corners_out_of_range(most) = "must be 3 to {most} corners [x, y] in metres";
    node_names_out_of_range(most) = "must be the names of 1 to {most} nodes";
    not_a_time_of_day(text) = "\"{text}\" is not a time of day such as 22:30";
    not_a_zone() = "must be the name of a time zone such as Europe/Berlin, or an offset such as +01:00 or -05:30";
    recurs_never() = "must be on some day, and from one time to another";
    assignment_waits(assignment) =
        "{assignment} waits for a worker who is free: cancel it if it is not wanted any more";
    too_many_characters(most) = "must have at most {most} characters";
    metres_out_of_range(least, most) = "must be from {least} to {most} metres";
    node_not_on_map(node) = "the map has no node \"{node}\"";
    at_or_node() = "give either `at`, two numbers in metres, or `node`";
    person_on_floor(person) = "{person} is on the floor: wait until the person has left, or clear a lost worker";
    person_assigned(person, assignment) = "{person} has the assignment {assignment}: cancel it first";
    token_of_worker(worker) = "this token is for the worker {worker} alone: sign in with that worker's name";
    kind_in_use(robots, kind) =
        "{robots} robots are of kind \"{kind}\", or were when they left: add a kind of another name";
    kind_of_scenario(kind) = "the scenario has a kind \"{kind}\": change it there, or choose another name";
    kind_unknown(kind) = "no kind \"{kind}\" was added; GET /v1/kinds lists all kinds";
    too_many_kinds(most) = "there are {most} kinds, which is the limit: remove one that was added";
    token_wrong() = "the token is wrong, has expired or was revoked";
    too_many_tokens(most) = "{most} tokens hold, which is the limit: revoke one that nobody uses";
    token_name_taken(name) = "a token of \"{name}\" holds: rotate or revoke it, or take another name";
    token_name_reserved(name) = "\"{name}\" is the name of callers without one";
    is_over_already() = "is over already";
    no_worker_or_robot(name) = "there is no worker and no robot \"{name}\": name one as `w1` or `robot-2`";
    name_the_subject() = "name the worker or robot that the device speaks for";
    only_devices_speak() = "only devices speak for somebody";
    token_unknown(token) = "there is no token \"{token}\" that could be: GET /v1/tokens lists them";
    line_unknown(line) = "there is no line \"{line}\"; lines count from 1";
    pieces_at_least_one() = "how many more pieces, at least one";
    role_needed(name, role, needed) = "\"{name}\" has the role {role}, and this needs the role {needed}";
    role_needed_for_subject(name, role, subject, needed) =
        "\"{name}\" has the role {role} of {subject}, and this needs the role {needed}";
    token_needed() =
        "this server needs a token that holds: send `Authorization: Bearer TOKEN`, offer the WebSocket protocols \
         `giveway` and `bearer.TOKEN`, or sign in at /sign-in";
    of_recording() = "a recording is shown here, and nothing in it can be changed: ask a running server";
    internal_error() = "The server hit an internal error and logged it. Nothing that was acknowledged is lost.";
    nothing_accepted(reason) = "nothing was accepted: {reason}. Try again soon.";
    too_many_requests_wait() = "too many requests are waiting";
    journal_takes_nothing() = "the journal accepts no facts, or the server is shutting down";
    not_durable_yet() =
        "not durable after ten seconds: whether it was accepted will be known later. Try again with the same \
         Idempotency-Key, which never makes a second one.";
    busy() = "too many requests are waiting: ask again in a second";
    fleet_did_not_answer() = "the fleet did not answer in time: ask again soon";
    shutting_down() = "the server is shutting down";
    map_busy() = "another map is being checked or published: try again soon";
    map_changes() = "the server is shutting down or switching to another map: look at the map again";
    database_does_not_answer() = "the database does not answer; the server's log says why. Nothing was changed.";
    area_too_large(nodes, most) = "the area has {nodes} nodes, more than {most}: choose a smaller area";
    nothing_kept() = "nothing is kept of that time: GET /v1/past lists what is";
    no_past() = "this server keeps no frames of the past: start it with --past-hours 24, or see its log";
    no_provider() = "the settings of this server name no identity provider: sign in with a token at /sign-in";
    server_starting() = "the server is starting: it loads its journal. Try again soon.";
    map_being_changed() = "the server is switching to another map and loads its journal again. Try again soon.";
    robots_unheard(robots) = "{robots} robots have not reported yet; they are known to be silent in three seconds";
    no_step_yet() = "the fleet has not made its first step yet";
    map_not_published(reasons) = "the map is not published, and nothing was changed: {reasons}";
    map_of_other_version(based_on, version) =
        "the map is based on version {based_on}, and the map in operation is \"{version}\": somebody published \
         another one since. Look at what is different, take it over, and publish again";
    trial_busy() = "another trial runs: try again when it has ended";
    no_trials() = "this server tries no maps";
    name_length(most) = "use 1 to {most} characters";
    name_edge() = "it begins or ends with a blank, which nobody sees: leave that out";
    name_control(code) = "it has a tab, a line break or another control character ({code}): leave it out";
    name_blank(code) = "it has white space ({code}) other than single plain blanks: use one plain blank";
    name_unseen(code) = "it has a character that is not shown ({code}): leave it out";
    name_form() =
        "it has a letter in two parts, or in a form of its own, that looks like another one: write it in Unicode's \
         composed form (NFC)";
    name_alphabet(letter, code) =
        "{letter} ({code}) is of another alphabet and looks like a Latin letter: use one alphabet";
    area_too_small(area_m2, least_m2) =
        "it encloses {area_m2} m², and must enclose an area of at least {least_m2} m²";
    area_off_floor(corner, x, y, reach) =
        "corner {corner} at ({x}, {y}) is far off the floor: {reach}; are these millimetres, or another map's?";
    area_covers_nothing(reach) = "it covers nothing that could be closed: no node and no floor to walk on; {reach}";
    map_reaches(x0, y0, x1, y1) = "the map reaches from ({x0}, {y0}) to ({x1}, {y1}) metres";
    outline_corners(corners) = "{corners} corners enclose no area: an outline needs three or more that differ";
    outline_far(corner, most) = "corner {corner} is absurdly far away or not a number: give metres within ±{most}";
    outline_flat(area_m2) = "it encloses {area_m2} m², which is no area: draw it with its width";
    outline_crosses(first, second) =
        "the outline crosses itself: the side from corner {first} meets the side from corner {second}; list the \
         corners in the order in which one walks round the area";
    not_a_cursor() = "use the value of `next` in the previous page";
    not_between(value, least, most) = "{value} is not between {least} and {most}";
    alarms_say(alarms) = "{alarms}";
    give_key_and_value() = "give a key and a value, such as wave:7";
    give_three_characters() = "give three characters or more";
    must_be_before_to() = "must be before `to`";
    report_too_long() = "must be 31 days before `to` at most: older figures are not kept";
    metres_on_the_map(most) = "must be metres on the map, up to {most}";
    too_many_positions() = "too many positions are waiting: send only the newest of each worker";
    time_in_future(seconds) = "lies {seconds} s in the future: set the clock by NTP, or leave the time out";
    time_too_old(seconds) = "is {seconds} s old: send the newest only, and set the clock by NTP";
    key_of_another(what) =
        "the Idempotency-Key was used for {what}, which is another one: use a new key for a new one";
    pace_is_private() =
        "assignments of one person that are over are for administrators, since their times tell how fast the \
         person works: ask for those that are waiting, walking or working, or for those of all people at \
         /v1/assignments";
    too_many_feeds(most) = "{most} live feeds are open, which is the limit";
    provider_does_not_answer(provider) =
        "{provider} does not answer as an identity provider should. Sign in with a token meanwhile, or try again; \
         the log of the server says what is wrong";
    too_many_webhooks(most) = "there are {most} webhooks, which is the limit: remove one first";
    batch_out_of_range(count, most) = "{count} jobs; 1 to {most} are allowed: send the rest in another request";
}
