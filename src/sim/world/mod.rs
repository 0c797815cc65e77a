//! The simulated floor: all robots, their radios and the customers.
//!
//! Main type: [`World`]. Refuses: to let the fleet see anything but telemetry and orders.

mod cells;
mod elsewhere;
mod faults;
mod handover;
mod incidents;
mod links;
mod motion_before;
mod passing;
mod starting;
mod truth;

use crate::arm::SimArms;
use crate::askers::{ROBOTS, is_made_again};
use crate::crew::workers::{Crew, TrueWorker};
use crate::customers::{Customers, OrderFileLine};
use crate::incidents::announce::Announcements;
use crate::incidents::leavers::{Leavers, may_be_taken};
use crate::incidents::outages::Outages;
use crate::incidents::pushes::{NEARBY_M, PushSurroundings};
use crate::link::{Link, LinkCounts, LinkFaults};
use crate::measure::encounter::{EncounterFigures, EncounterMeter, MeteredPerson};
use crate::picker::{Pickers, has_lines};
use crate::random::Stream;
use crate::robot::RobotBody;
use crate::robot::beside_log::BesideLog;
use crate::scenario::{Faults, Scenario};
use crate::walker::{RobotNear, Walker};
use giveway_drive::LinkOutput;
use giveway_fleet::{
    Command, Fault, Input, Ledger, RackAt, Reply, RobotAction, Service, Telemetry, Token, USUAL_LINK,
    most_dangerous,
};
use giveway_floor::geometry::Point;
use giveway_floor::id::{Dense, IdVec, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::route::Kinematics;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use links::LinkTrouble;
use motion_before::MotionBefore;
pub use starting::starting_places;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Robots of the scenario join with this token.
const JOINS: Token = Token { asker: ROBOTS, number: 0 };
/// How far the corners of a vehicle reach beyond the discs that cover it, metres.
const CORNERS_M: f64 = 0.15;
/// Longest step in which robots and people are advanced together.
const TICK: Span = Span::from_millis(20);

/// A robot with its radio.
#[derive(Debug)]
struct SimRobot {
    body: RobotBody,
    /// The rack that was on the robot at the last look.
    had: Option<RackId>,
    orders: Link<Command>,
    reports: Link<Telemetry>,
    luck: Stream,
    /// Stream for whether people push the robot, and where to.
    pushes: Stream,
    /// When people push the robot on, if it then stands between nodes, or has not been taken up where it is.
    push_on: Option<Time>,
    /// How often people found no place for the robot: then they look farther away.
    tries: u32,
    /// Whether the robot was switched off and taken away.
    off: bool,
    /// The robot's motion at the beginning of the step.
    before: MotionBefore,
    /// How far the robot's clock is ahead.
    clock: Span,
    /// Stream for whether a person sets the clock; then how often that has happened.
    setting: Stream,
    clock_steps: u64,
    /// Whether the robot reports no current because its charger gives none to any robot.
    charger_is_out: bool,
    /// Until when the robot's radio is dead.
    mute_until: Option<Time>,
    /// The fault of the robot's link.
    trouble: LinkTrouble,
}

/// The simulated floor.
#[derive(Debug)]
pub struct World {
    warehouse: Arc<Warehouse>,
    /// Kinematics of the robot that is worst to be in the way of.
    worst: Kinematics,
    faults: Faults,
    /// When the faults end.
    faults_end: Option<Time>,
    /// Whether people push robots, on purpose or onto a node.
    pushes: bool,
    outages: Outages,
    /// How often robots had each kind of fault, and message counts of replaced robots.
    afflicted: BTreeMap<&'static str, u64>,
    messages: LinkCounts,
    seed: u64,
    robots: Vec<SimRobot>,
    customers: Customers,
    leavers: Leavers,
    crew: Option<Crew>,
    meter: EncounterMeter,
    joining: Vec<(String, String, NodeId)>,
    /// Where each rack truly is.
    racks: IdVec<RackId, RackAt>,
    /// Racks that were lifted where they did not stand, or set down onto another one.
    misplaced: Vec<(RobotId, RackId)>,
    announcements: Announcements,
    /// Pickers at work cells; nothing if whole visits are picked at once.
    pickers: Option<Pickers>,
    /// Robot arms beside the pickers.
    arms: Option<SimArms>,
    /// Robots that began to move while a hand was inside.
    moved_at_hands: Vec<(RobotId, StationId)>,
    /// Stations where hands were inside at the end of the last step.
    hands_inside: Vec<StationId>,
    /// How often a station's guard stopped a robot.
    guard_stops: u64,
    beside: BesideLog,
    /// How often robots were pushed elsewhere.
    pushed: u64,
    /// Requests that were made last, and those that were refused and are made again.
    asked: Vec<Input>,
    again: Vec<Input>,
    /// Since when people have picked from robots of other links.
    picked_elsewhere: BTreeMap<RobotId, Time>,
    now: Time,
}

impl World {
    /// A floor at `now`. Robots that the fleet knows stand where its ledger has them; missing ones join.
    ///
    /// # Panics
    /// If the map does not have a node that the scenario closes: see [`Scenario::areas`].
    pub fn new(
        warehouse: Arc<Warehouse>,
        scenario: &Scenario,
        lines: &[OrderFileLine],
        seed: u64,
        ledger: &Ledger,
        now: Time,
    ) -> World {
        let known = ledger.robots.len();
        let places =
            starting_places(&warehouse, scenario.robots, |i| warehouse.body_of(&scenario.kind_of(i).name));
        let joining = places.into_iter().enumerate().skip(known);
        let kind = |i: usize| scenario.kind_of(i).name.clone();
        let joining = joining.map(|(i, n)| (format!("robot-{}", i + 1), kind(i), n)).collect();
        let customers = Customers::new(scenario, lines, &warehouse, seed);
        let racks = ledger.racks.clone();
        let faults = scenario.faults;
        let crew = Crew::new(&warehouse, scenario, seed, now);
        let meter = EncounterMeter::new(scenario.workers.encounter_m);
        let outages = Outages::new(&faults, &warehouse, seed);
        let pickers = scenario
            .cells
            .as_ref()
            .map(|cells| Pickers::new(&warehouse, cells, scenario.site.flow, seed, now));
        let arms = scenario.cells.as_ref().and_then(|cells| SimArms::new(&warehouse, cells, seed, now));
        let robots = vec![];
        let announcements = Announcements::new(scenario, &warehouse, ledger, now);
        let mut world = World {
            warehouse,
            worst: most_dangerous(ledger.kinds()),
            racks,
            misplaced: Vec::new(),
            faults_end: faults.until_s.map(|s| now + Span::from_secs_f64(s)),
            pushes: faults.robot_pushes_per_hour > 0.0 || faults.manual_drives_per_hour > 0.0,
            afflicted: BTreeMap::new(),
            messages: LinkCounts::default(),
            faults,
            seed,
            outages,
            robots,
            customers,
            leavers: Leavers::new(scenario.customers.departures_per_hour, scenario.customers.away_s, seed),
            crew,
            meter,
            joining,
            announcements,
            pickers,
            arms,
            moved_at_hands: Vec::new(),
            hands_inside: Vec::new(),
            guard_stops: 0,
            beside: BesideLog::new(scenario.local_planner.into()),
            pushed: 0,
            asked: Vec::new(),
            again: Vec::new(),
            picked_elsewhere: BTreeMap::new(),
            now,
        };
        world.meet(ledger);
        world
    }

    /// Advances everything to `now` and gives observations and requests.
    pub fn advance(&mut self, now: Time, ledger: &Ledger) -> Vec<Input> {
        self.meet(ledger);
        let mut inputs = std::mem::take(&mut self.again);
        inputs.extend(self.customers.order(now, now - self.now, ledger));
        let join = |(name, kind, node)| {
            let link = Some(USUAL_LINK.to_owned());
            Input::ask(JOINS, RobotAction::Register { name, kind, node, link })
        };
        inputs.extend(self.joining.drain(..).map(join));
        inputs.extend(self.announcements.say(now));
        inputs.extend(self.leavers.say(now, now - self.now, self.customers.have_stopped(), ledger));
        self.come_and_go(ledger);
        let from = self.now;
        if self.faults_end.take_if(|end| now >= *end).is_some() {
            self.end_faults(now);
        }
        inputs.extend(self.outages.say(from, now));
        for robot in self.robots.iter_mut().filter(|r| !r.off) {
            while let Some(order) = robot.orders.receive(from) {
                robot.body.obey(&order, &self.warehouse);
            }
            let charging = self.warehouse.nodes[robot.body.node].kind == NodeKind::Charger;
            let before = robot.body.fault;
            robot.meet_faults(&self.faults, charging, from, now);
            if let (None, Some((fault, _))) = (before, robot.body.fault) {
                *self.afflicted.entry(fault.word()).or_default() += 1;
            }
            robot.mind_charger(self.outages.at(robot.body.node));
            // A robot that was just pushed could not report where it is, and other robots would be sent there.
            let may_fail = robot.push_on.is_none();
            inputs.extend(robot.trouble.say(robot.body.id, &self.faults, may_fail, (from, now)));
        }
        self.push_robots(from, now);
        self.guard_hands(from);
        self.show_people();
        self.live(from, now);
        self.note_racks();
        self.note_racks_elsewhere(ledger);
        inputs.extend(self.picks(ledger));
        inputs.extend(self.picks_elsewhere(ledger));
        inputs.extend(self.pick_lines(from, now, ledger));
        for robot in self.robots.iter_mut().filter(|r| !r.off) {
            let report = robot.body.report(now);
            robot.mute_until = robot.mute_until.filter(|until| now < *until);
            if robot.mute_until.is_some() || !robot.trouble.is_connected() {
                continue;
            }
            robot.reports.send(now, Telemetry { seen: now + robot.clock, ..report });
            while let Some(report) = robot.reports.receive(now) {
                inputs.push(Input::Telemetry(report));
            }
        }
        self.now = now;
        if let Some(crew) = &mut self.crew {
            inputs.extend(crew.say(now, ledger));
        }
        self.asked.clear();
        self.asked.extend(inputs.iter().filter(|i| is_made_again(i)).cloned());
        inputs
    }

    /// Robots that leave are switched off and taken away; returning ones stand where they were registered.
    fn come_and_go(&mut self, ledger: &Ledger) {
        for i in 0..self.robots.len() {
            let (id, robot) = (RobotId::at(i), &self.robots[i]);
            let Some(service) = ledger.robots.get(id).map(|r| r.service) else { break };
            if World::is_elsewhere(ledger, id) {
                continue;
            }
            if !robot.off && robot.body.can_be_taken() && may_be_taken(ledger, id) {
                self.robots[i].off = true;
            } else if robot.off && !matches!(service, Service::Leaving { .. } | Service::Gone { .. }) {
                self.messages += robot.orders.counts;
                self.messages += robot.reports.counts;
                let back = self.robot(id, ledger);
                let before = std::mem::replace(&mut self.robots[i], back);
                // The link's last report stands until the next one.
                self.robots[i].trouble = before.trouble;
            }
        }
    }

    /// People push standing robots elsewhere, and later push on those that have not been taken up where they are.
    fn push_robots(&mut self, from: Time, to: Time) {
        if !self.pushes {
            return;
        }
        let often = self.faults.robot_pushes_per_hour * (to - from).as_secs_f64() / 3600.0;
        for i in 0..self.robots.len() {
            let robot = &mut self.robots[i];
            robot.push_on = robot.push_on.filter(|_| robot.body.is_astray());
            let again = robot.push_on.is_some();
            let due = match robot.push_on {
                // The robot could not report where it is, and other robots would be sent there.
                _ if !robot.trouble.is_connected() => false,
                Some(at) => to >= at,
                None if robot.off => false,
                None => often > 0.0 && robot.pushes.happens(often) && robot.body.can_be_pushed(),
            };
            if due {
                let onto_node = again || robot.pushes.happens(0.5);
                self.push(i, onto_node, (from, to));
            }
        }
    }

    /// Pushes a robot onto a node nearby or to a place between nodes, if there is one where it blocks no robot.
    fn push(&mut self, i: usize, onto_node: bool, (from, to): (Time, Time)) {
        let others: Vec<&SimRobot> =
            self.robots.iter().enumerate().filter(|(j, r)| *j != i && !r.off).map(|(_, r)| r).collect();
        let headlong = others.iter().filter(|r| !r.trouble.is_connected() || !r.body.obeys_stops());
        let floor = PushSurroundings {
            warehouse: &self.warehouse,
            racks: &self.racks,
            others: others.iter().map(|r| (r.body.pose.at, r.body.speed_mps)).collect(),
            headlong: headlong.flat_map(|r| r.body.ways_soon(&self.warehouse)).collect(),
            people: self.walkers().map(|(_, walker)| walker.pose(from).at).collect(),
            kinematics: self.worst,
            blind_s: 2.0 * self.faults.longest_delay_s() + 5.0 * (to - from).as_secs_f64(),
        };
        let robot = &mut self.robots[i];
        let (at, loaded) = (robot.body.pose.at, robot.body.rack.is_some());
        let nearby_m = NEARBY_M + f64::from(robot.tries);
        let place = floor.place_near((at, nearby_m), loaded, onto_node, &mut robot.pushes);
        robot.tries = if place.is_some() { 0 } else { robot.tries + 1 };
        if let Some((at, node)) = place {
            robot.body.put(at, node);
            self.pushed += 1;
        }
        let pause = if place.is_some() { self.faults.repair_s } else { 1.0 };
        let astray = place.is_some() || robot.push_on.is_some();
        robot.push_on = astray.then(|| to + Span::from_secs_f64(pause));
    }

    /// Repairs everything and ends all faults. People still push robots that stand between nodes onto one.
    fn end_faults(&mut self, now: Time) {
        self.faults = self.faults.ended();
        self.outages.end(now);
        self.arms.iter_mut().for_each(SimArms::end_faults);
        let links = LinkFaults::from(&self.faults);
        for robot in &mut self.robots {
            (robot.body.fault, robot.charger_is_out) = (None, false);
            robot.orders.set_faults(links);
            robot.reports.set_faults(links);
        }
        if let Some(crew) = &mut self.crew {
            crew.set_faults(links);
        }
    }

    /// The time up to which everything has moved.
    pub fn now(&self) -> Time {
        self.now
    }

    /// How often each kind of fault has happened so far, by the keys of scenario files where there are some.
    pub fn injected(&self) -> BTreeMap<&'static str, u64> {
        let mut all = self.afflicted.clone();
        let mut messages = self.messages;
        for robot in &self.robots {
            messages += robot.orders.counts;
            messages += robot.reports.counts;
        }
        let wrong = self.robots.iter().filter(|r| r.clock != Span::ZERO).count();
        let [chargers, stations] = self.outages.counts;
        all.extend([
            ("messages_lost", messages.lost),
            ("messages_late", messages.late),
            ("messages_overtaking", messages.overtaking),
            ("wrong_clocks", wrong as u64),
            ("clock_steps", self.robots.iter().map(|r| r.clock_steps).sum()),
            ("link_outages", self.robots.iter().map(|r| r.trouble.count).sum()),
            ("charger_outages", chargers),
            ("station_stops", stations),
            ("pushes", self.pushed),
        ]);
        all.extend(self.crew.iter().flat_map(Crew::injected));
        all
    }

    /// How often robots were pushed elsewhere.
    pub fn pushed(&self) -> u64 {
        self.pushed
    }

    /// From now on, customers order nothing new.
    pub fn stop_customers(&mut self) {
        self.customers.stop();
    }

    /// Delivers the fleet's output to robots, arms, people and customers, by radio if they have one.
    pub fn take<'a>(&mut self, now: Time, out: impl Into<LinkOutput<'a>>) {
        let LinkOutput { limits, orders, guidance, warnings, arms, replies, refused } = out.into();
        let was_refused =
            |input: &mut Input| matches!(input, Input::Ask { token, .. } if refused.contains(token));
        self.again.extend(self.asked.extract_if(.., was_refused));
        for reply in replies {
            if let Reply { token: JOINS, answer: Err(why) } = reply {
                tracing::warn!(?why, "a robot of the scenario cannot join");
            }
            self.customers.hear(reply, now);
        }
        for (robot, command) in limits.iter().chain(orders) {
            if let Some(robot) =
                self.robots.get_mut(robot.ix()).filter(|r| !r.off && r.trouble.passes(command))
            {
                robot.orders.send(now, command.clone());
            }
        }
        if let Some(crew) = &mut self.crew {
            guidance.iter().for_each(|(worker, g)| crew.tell(now, *worker, g.clone()));
        }
        if let Some(pickers) = &mut self.pickers {
            warnings.iter().for_each(|warning| pickers.warn(now, warning));
        }
        if let Some(arms_here) = &mut self.arms {
            arms_here.follow(arms);
        }
    }

    /// Records which racks were lifted and set down.
    fn note_racks(&mut self) {
        for robot in &mut self.robots {
            let (id, has) = (robot.body.id, robot.body.rack);
            let had = std::mem::replace(&mut robot.had, has);
            if had == has {
                continue;
            }
            let here = RackAt::Stored(robot.body.node);
            if let Some(rack) = had {
                let taken = self.racks.iter().any(|at| *at == here);
                self.racks[rack] = here;
                self.misplaced.extend(taken.then_some((id, rack)));
            }
            if let Some(rack) = has {
                let there = std::mem::replace(&mut self.racks[rack], RackAt::On(id)) == here;
                self.misplaced.extend((!there).then_some((id, rack)));
            }
        }
    }

    /// Reports of pickers that have everything they wanted; they repeat them until their screen shows that it was
    /// received.
    fn picks(&mut self, ledger: &Ledger) -> Vec<Input> {
        let mut said = Vec::new();
        for robot in &self.robots {
            let NodeKind::Station(station) = self.warehouse.nodes[robot.body.node].kind else { continue };
            let id = robot.body.id;
            let serial = ledger.chain(id).first();
            let works = !ledger.paused_stations.contains_key(&station);
            let by_line = self.pickers.is_some() && has_lines(ledger, id);
            if works && !by_line && robot.body.is_picked(serial) && ledger.is_picked_from(id) {
                said.push(self.customers.pick(station, id, serial));
            }
        }
        said
    }

    /// Where each rack truly is.
    pub fn racks(&self) -> &IdVec<RackId, RackAt> {
        &self.racks
    }

    /// Racks that were lifted where they did not stand, or set down onto another one: for the laws.
    pub fn misplaced(&self) -> &[(RobotId, RackId)] {
        &self.misplaced
    }

    /// The node that a robot truly reached last; people may have pushed the robot elsewhere since.
    pub fn node_of(&self, robot: RobotId) -> Option<NodeId> {
        self.robots.get(robot.ix()).map(|r| r.body.stood_on)
    }

    /// Advances robots and people. Without people each robot is advanced alone, which gives the same and is quicker.
    fn live(&mut self, from: Time, to: Time) {
        if to <= from {
            return;
        }
        let ticks = if self.crew.is_some() { ((to - from).0 + TICK.0 - 1) / TICK.0 } else { 1 };
        let at = |i: i64| from + Span((to - from).0 * i / ticks);
        for i in 0..ticks {
            for robot in self.robots.iter_mut().filter(|r| !r.off) {
                let charger = self.warehouse.nodes[robot.body.node].kind == NodeKind::Charger;
                let gives = self.outages.at(robot.body.node).is_none();
                let charging = charger && gives && !robot.body.has(Fault::Unplugged);
                robot.body.advance(at(i), at(i + 1), charging);
                self.beside.note(&robot.body);
            }
            self.people(at(i), at(i + 1));
        }
    }

    /// Advances people, lets robots look out for them, and measures both.
    fn people(&mut self, from: Time, to: Time) {
        let Some(crew) = &mut self.crew else { return };
        let near = |r: &SimRobot| {
            let half_m = r.body.footprint().half_m();
            RobotNear { at: r.body.pose.at, velocity: r.body.velocity(), half_m }
        };
        let robots: Vec<RobotNear> = self.robots.iter().filter(|r| !r.off).map(near).collect();
        crew.tick(to, (to - from).as_secs_f64(), &robots);
        let people: Vec<TrueWorker> = crew.present(to).collect();
        let places: Vec<Point> = people.iter().flat_map(TrueWorker::parts).collect();
        self.meter.pass_time(people.len(), &robots, to - from);
        for (robot, near) in self.robots.iter_mut().filter(|r| !r.off).zip(&robots) {
            self.beside.scan(&mut robot.body, to, near.half_m, &places);
            let (id, speed, brakes) = (robot.body.id, robot.body.speed_mps, robot.body.is_guarded());
            for p in &people {
                // Of a vehicle, the part counts that is nearest to the robot.
                let at = p.part_nearest(near.at);
                let person = MeteredPerson { worker: p.worker, at, speed_mps: p.speed_mps };
                self.meter.look(id, near, &person);
                let touches = near.gap(at) <= CORNERS_M && robot.body.touches(&p.mover, p.pose);
                self.meter.touch(id, p.worker, touches, speed, brakes);
            }
        }
        self.meter.count_pairs(to);
    }

    /// Encounters of robots and people so far, measured where both truly are.
    pub fn figures(&self) -> EncounterFigures {
        self.meter.so_far()
    }

    /// Robots that drove on into a worker, with the number of the worker: for the laws.
    pub fn run_over(&self) -> &[(RobotId, usize)] {
        &self.meter.run_over
    }

    /// Workers that have been on the floor, with the truth about them.
    pub fn walkers(&self) -> impl Iterator<Item = (WorkerId, &Walker)> {
        self.crew.iter().flat_map(|c| c.walkers())
    }

    /// Assignments that workers have truly completed.
    pub fn completed(&self) -> u64 {
        self.crew.as_ref().map_or(0, Crew::completed)
    }

    /// Creates bodies for robots that the fleet has come to know.
    fn meet(&mut self, ledger: &Ledger) {
        for i in self.robots.len()..ledger.robots.len() {
            self.worst = most_dangerous(ledger.kinds());
            let id = RobotId::at(i);
            let robot = self.robot(id, ledger);
            self.robots.push(SimRobot { off: World::is_elsewhere(ledger, id), ..robot });
        }
    }

    /// A robot with its radio, where the ledger has it.
    fn robot(&self, id: RobotId, ledger: &Ledger) -> SimRobot {
        let record = &ledger.robots[id];
        let node = ledger.node_of(id);
        let who = id.ix() as u64;
        let battery = 0.6 + 0.4 * Stream::new(self.seed, 4, who).unit();
        let at = self.warehouse.nodes[node].at;
        let kind = ledger.warehouse().body_of(&record.kind);
        let footprints = [false, true].map(|loaded| ledger.warehouse().footprint(kind, loaded).clone());
        let kind = ledger.kinds().of(&record.kind);
        let mut body = RobotBody::new(id, node, at, battery, (kind, footprints));
        let (reached, rack) = (ledger.chain(id).first(), ledger.rack_on(id));
        body.beside.method = self.beside.method;
        body.resume(reached, record.acted, record.recalls, rack);
        let stream = |purpose| Stream::new(self.seed, purpose, who);
        let links = LinkFaults::from(&self.faults);
        let skew_s = self.faults.clock_skew_ms as f64 / 1000.0;
        let clock = if skew_s > 0.0 { stream(7).between(-skew_s, skew_s) } else { 0.0 };
        SimRobot {
            had: body.rack,
            before: MotionBefore::of(&body),
            body,
            orders: Link::new(links, stream(1), stream(9)),
            reports: Link::new(links, stream(2), stream(12)),
            luck: stream(5),
            pushes: stream(6),
            clock: Span::from_secs_f64(clock),
            setting: stream(13),
            clock_steps: 0,
            charger_is_out: false,
            mute_until: None,
            trouble: LinkTrouble::new(stream(14)),
            push_on: None,
            tries: 0,
            off: record.is_gone(),
        }
    }
}
