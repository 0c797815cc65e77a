//! Strategies for all messages of the model.
//!
//! Main functions: [`header`], [`message`]. Orders are well formed: edges join the nodes whose numbers are next to
//! theirs. Numbers are [`Numbers::Sane`] (what a reader keeps as it is) or [`Numbers::Any`] (whatever a caller may have
//! computed). Refuses: texts and lists beyond what a reader keeps.

use crate::*;
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use serde_json::{Map, Value};
use std::f64::consts::PI;

/// Which numbers a strategy gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Numbers {
    /// Those that can be said and are kept when read, with the bounds of what is kept.
    Sane,
    /// All, also those that are not finite.
    Any,
}

impl Numbers {
    fn length(self) -> BoxedStrategy<f64> {
        match self {
            Numbers::Sane => prop_oneof![-100.0..100.0, Just(0.0), Just(1e9), Just(-1e9)].boxed(),
            Numbers::Any => any::<f64>().boxed(),
        }
    }

    fn magnitude(self) -> BoxedStrategy<f64> {
        match self {
            Numbers::Sane => prop_oneof![0.0..100.0, Just(0.0), Just(1e9)].boxed(),
            Numbers::Any => any::<f64>().boxed(),
        }
    }

    /// Twice around, so that angles must be brought back.
    fn angle(self) -> BoxedStrategy<f64> {
        match self {
            Numbers::Sane => prop_oneof![-4.0 * PI..4.0 * PI, Just(PI), Just(-PI)].boxed(),
            Numbers::Any => any::<f64>().boxed(),
        }
    }

    fn up_to(self, most: f64) -> BoxedStrategy<f64> {
        match self {
            Numbers::Sane => prop_oneof![0.0..=most, Just(0.0), Just(most)].boxed(),
            Numbers::Any => any::<f64>().boxed(),
        }
    }
}

fn text() -> impl Strategy<Value = String> {
    prop_oneof!["[a-zA-Z0-9_.-]{0,12}", "[\\PC\"\\\\]{0,6}"]
}

fn json() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        (-1e300..1e300).prop_map(Value::from),
        text().prop_map(Value::from),
    ];
    leaf.prop_recursive(3, 12, 3, |inner| {
        let fields = vec((text(), inner.clone()), 0..3).prop_map(|all| Value::Object(Map::from_iter(all)));
        prop_oneof![vec(inner, 0..3).prop_map(Value::from), fields]
    })
}

pub(super) fn header() -> impl Strategy<Value = Header> {
    let time = (0..24u32, 0..60u32, 0..60u32, 0..1000u32)
        .prop_map(|(hour, minute, s, ms)| format!("2026-11-30T{hour:02}:{minute:02}:{s:02}.{ms:03}Z"));
    (any::<u32>(), time, text(), text(), text()).prop_map(|(id, timestamp, version, manufacturer, serial)| {
        Header { id, timestamp, version, manufacturer, serial }
    })
}

pub(super) fn message(numbers: Numbers) -> BoxedStrategy<Message> {
    prop_oneof![
        2 => order(numbers).prop_map(Message::Order),
        1 => vec(action(), 0..4).prop_map(Message::InstantActions),
        3 => state(numbers).prop_map(|state| Message::State(Box::new(state))),
        1 => visualization(numbers).prop_map(Message::Visualization),
        1 => zone_set(numbers).prop_map(Message::ZoneSet),
        1 => vec(response(), 0..4).prop_map(Message::Responses),
        1 => connection().prop_map(Message::Connection),
        1 => factsheet(numbers).prop_map(|sheet| Message::Factsheet(Box::new(sheet))),
    ]
    .boxed()
}

fn action() -> impl Strategy<Value = Action> {
    use BlockingType::*;
    let parameter = (text(), json()).prop_map(|(key, value)| Parameter { key, value });
    let blocking = prop::sample::select(vec![None, Soft, Single, Hard]);
    // Robots tell actions apart by their ids.
    let id = any::<u64>().prop_map(|id| format!("{id:016x}"));
    (text(), id, blocking, vec(parameter, 0..3), any::<bool>()).prop_map(
        |(kind, id, blocking, parameters, retriable)| Action { kind, id, blocking, parameters, retriable },
    )
}

fn order(numbers: Numbers) -> impl Strategy<Value = Order> {
    let nodes = vec((text(), any::<bool>(), option::of(node_position(numbers)), vec(action(), 0..2)), 1..4);
    let corridor = (numbers.magnitude(), numbers.magnitude(), any::<bool>(), any::<bool>()).prop_map(
        |(left_m, right_m, of_contour, release_required)| Corridor {
            left_m,
            right_m,
            of_contour,
            release_required,
        },
    );
    let edge =
        (text(), any::<bool>(), option::of(numbers.magnitude()), option::of(corridor), vec(action(), 0..2));
    let first = prop_oneof![0..10u32, Just((u32::MAX - 6) / 2)].prop_map(|half| 2 * half);
    (text(), any::<u32>(), first, nodes, vec(edge, 3)).prop_map(|(id, update, first, nodes, edges)| {
        let nodes: Vec<Node> = (first..)
            .step_by(2)
            .zip(nodes)
            .map(|(sequence, (id, released, position, actions))| Node {
                id,
                sequence,
                released,
                position,
                actions,
            })
            .collect();
        let ends = nodes.windows(2).zip(edges);
        let edges = ends.map(|(ends, (id, released, max_speed_mps, corridor, actions))| Edge {
            id,
            sequence: ends[0].sequence + 1,
            released,
            from: ends[0].id.clone(),
            to: ends[1].id.clone(),
            max_speed_mps,
            corridor,
            actions,
        });
        Order { id, update, edges: edges.collect(), nodes }
    })
}

fn node_position(numbers: Numbers) -> impl Strategy<Value = NodePosition> {
    let place = (numbers.length(), numbers.length(), option::of(numbers.angle()), text());
    (place, option::of(numbers.magnitude()), option::of(numbers.up_to(PI))).prop_map(
        |((x, y, theta, map), deviation_m, deviation_rad)| NodePosition {
            x,
            y,
            theta,
            deviation_m,
            deviation_rad,
            map,
        },
    )
}

fn state(numbers: Numbers) -> impl Strategy<Value = State> {
    let order = (text(), any::<u32>(), text(), any::<u32>());
    let lists = (vec(left(), 0..4), vec(left(), 0..4), vec(action_state(), 0..4), vec(action_state(), 0..4));
    let motion = (option::of(position(numbers)), option::of(velocity(numbers)), any::<bool>());
    let flags = (option::of(any::<bool>()), any::<bool>(), any::<bool>(), any::<bool>());
    let load = (option::of(text()), option::of(text())).prop_map(|(id, kind)| Load { id, kind });
    let body = (option::of(vec(load, 0..3)), option::of(numbers.up_to(1.0)), mode(), e_stop());
    let rest = (vec(robot_error(), 0..3), vec(request(), 0..3), vec(stored_zone_set(), 0..3));
    (order, lists, motion, flags, body, rest).prop_map(|(order, lists, motion, flags, body, rest)| State {
        order: order.0,
        update: order.1,
        last_node: order.2,
        last_sequence: order.3,
        nodes: lists.0,
        edges: lists.1,
        actions: lists.2,
        instant_actions: lists.3,
        position: motion.0,
        velocity: motion.1,
        driving: motion.2,
        paused: flags.0,
        wants_base: flags.1,
        field_violation: flags.2,
        loads: body.0,
        power: Power { charge: body.1, charging: flags.3 },
        mode: body.2,
        e_stop: body.3,
        errors: rest.0,
        requests: rest.1,
        zone_sets: rest.2,
    })
}

fn left() -> impl Strategy<Value = NodeLeft> {
    (text(), any::<u32>(), any::<bool>()).prop_map(|(id, sequence, released)| NodeLeft {
        id,
        sequence,
        released,
    })
}

fn action_state() -> impl Strategy<Value = ActionState> {
    use ActionStatus::*;
    let status = vec![Waiting, Initializing, Running, Paused, Retriable, Finished, Failed];
    (text(), option::of(text()), prop::sample::select(status), option::of(text()))
        .prop_map(|(id, kind, status, result)| ActionState { id, kind, status, result })
}

fn position(numbers: Numbers) -> impl Strategy<Value = Position> {
    (numbers.length(), numbers.length(), numbers.angle(), text(), any::<bool>())
        .prop_map(|(x, y, theta, map, localized)| Position { x, y, theta, map, localized })
}

fn velocity(numbers: Numbers) -> impl Strategy<Value = Velocity> {
    (numbers.length(), numbers.length(), numbers.length()).prop_map(|(vx, vy, omega)| Velocity {
        vx,
        vy,
        omega,
    })
}

fn mode() -> impl Strategy<Value = OperatingMode> {
    use OperatingMode::*;
    prop::sample::select(vec![Startup, Automatic, SemiAutomatic, Intervened, Manual, Service, TeachIn])
}

fn e_stop() -> impl Strategy<Value = EStop> {
    prop::sample::select(vec![EStop::None, EStop::AutoAck, EStop::Manual, EStop::Remote])
}

fn robot_error() -> impl Strategy<Value = RobotError> {
    use ErrorLevel::*;
    let reference = (text(), text()).prop_map(|(key, value)| ErrorReference { key, value });
    let level = prop::sample::select(vec![Warning, Urgent, Critical, Fatal]);
    (text(), level, vec(reference, 0..3), option::of(text()), option::of(text())).prop_map(
        |(kind, level, references, description, hint)| RobotError {
            kind,
            level,
            references,
            description,
            hint,
        },
    )
}

fn request() -> impl Strategy<Value = Request> {
    use RequestStatus::*;
    let zone = (text(), text(), any::<bool>())
        .prop_map(|(zone, zone_set, replanning)| RequestSubject::Zone { zone, zone_set, replanning });
    let corridor =
        (text(), any::<u32>()).prop_map(|(edge, sequence)| RequestSubject::Corridor { edge, sequence });
    let status = prop::sample::select(vec![Requested, Granted, Revoked, Expired]);
    (text(), prop_oneof![zone, corridor], status).prop_map(|(id, subject, status)| Request {
        id,
        subject,
        status,
    })
}

fn stored_zone_set() -> impl Strategy<Value = StoredZoneSet> {
    (text(), text(), any::<bool>()).prop_map(|(id, map, enabled)| StoredZoneSet { id, map, enabled })
}

fn response() -> impl Strategy<Value = Response> {
    use Grant::*;
    let grant = prop::sample::select(vec![Granted, Queued, Revoked, Rejected]);
    let until = prop_oneof![any::<i64>(), 0..4_000_000_000_000_000_i64];
    (text(), grant, option::of(until)).prop_map(|(request, grant, until_us)| Response {
        request,
        grant,
        until_us,
    })
}

fn zone_set(numbers: Numbers) -> impl Strategy<Value = ZoneSet> {
    let kind = prop_oneof![
        Just(ZoneKind::Blocked),
        Just(ZoneKind::Release),
        numbers.magnitude().prop_map(ZoneKind::SpeedLimit)
    ];
    let least = if numbers == Numbers::Sane { 3 } else { 0 };
    let corners = vec((numbers.length(), numbers.length()), least..6);
    let zone = (text(), kind, corners).prop_map(|(id, kind, corners)| Zone { id, kind, corners });
    (text(), text(), vec(zone, 0..3)).prop_map(|(id, map, zones)| ZoneSet { id, map, zones })
}

fn visualization(numbers: Numbers) -> impl Strategy<Value = Visualization> {
    (option::of(any::<u32>()), option::of(position(numbers)), option::of(velocity(numbers)))
        .prop_map(|(state_header, position, velocity)| Visualization { state_header, position, velocity })
}

fn connection() -> impl Strategy<Value = ConnectionState> {
    use ConnectionState::*;
    prop::sample::select(vec![Online, Offline, Broken, Hibernating])
}

fn factsheet(numbers: Numbers) -> impl Strategy<Value = Factsheet> {
    use ActionScope::*;
    let scopes = vec(prop::sample::select(vec![AtOnce, Node, Edge, Zone]), 0..4);
    let offered = (text(), scopes).prop_map(|(kind, scopes)| OfferedAction { kind, scopes });
    // Zeros are read as not said.
    let measure = move || option::of(numbers.magnitude().prop_filter("not zero", |number| *number != 0.0));
    let zone = prop_oneof![Just("SPEED_LIMIT".to_owned()), Just("BLOCKED".to_owned()), text()];
    let most = || option::of(1..=u32::MAX as usize);
    let drive = (measure(), measure(), measure(), measure(), measure(), measure());
    let limits = (most(), most(), measure(), option::of(numbers.magnitude()));
    let rest = (
        option::of(vec(offered, 0..3)),
        vec(zone, 0..3),
        option::of(numbers.up_to(1.0)),
        option::of("[a-z]{1,9}"),
    );
    (drive, limits, rest).prop_map(|(drive, limits, rest)| Factsheet {
        speed_mps: drive.0,
        accel_mps2: drive.1,
        brake_mps2: drive.2,
        turn_radps: drive.5,
        length_m: drive.3,
        width_m: drive.4,
        most_nodes: limits.0,
        longest_id: limits.1,
        order_interval_s: limits.2,
        payload_kg: limits.3,
        actions: rest.0,
        zones: rest.1,
        critical: rest.2,
        series: rest.3,
    })
}
