//! All simulated workers: they join, get assignments, enter by a door, are seen, are guided, and leave.
//!
//! Main type: [`Crew`]. Refuses: to show the fleet anything but what their devices measure and what any client
//! may read over the API.

use super::entrance::{entrance, vehicle_entrance};
use super::member::{AGAIN, Member, TASKS};
use super::pairs::{Pairs, next_to};
use super::seen_vehicles::SeenVehicles;
use super::sensor::Device;
use super::shared_tasks::{SharedTasks, unassigned};
use crate::askers::CREW;
use crate::link::LinkFaults;
use crate::random::Stream;
use crate::scenario::{Assignments, Scenario, SecondTag, TaskSharing, Workers};
use crate::walker::{PersonNear, RobotNear, Walker, WalkerSurroundings, WorkKnowledge, parts};
use giveway_fleet::{AssignmentRequest, Guidance, Input, Ledger, Token, WorkerAction};
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::id::{AssignmentId, NodeId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::walkway::Walkways;
use giveway_floor::warehouse::{NodeKind, Warehouse};
use giveway_people::human::Mover;
use std::sync::Arc;

/// Number of open assignments that each worker always has.
const AHEAD: u64 = 2;
/// A worker who was on the floor before this world began is placed at least this far from robots, metres.
const BESIDE_M: f64 = 1.0;

/// All simulated workers.
#[derive(Debug)]
pub(crate) struct Crew {
    workers: Workers,
    walkways: Walkways,
    doors: Vec<Point>,
    fronts: Vec<NodeId>,
    /// Positions of `fronts`.
    places: Vec<Point>,
    seed: u64,
    /// When the scenario began; the scenario's times count from here.
    start: Time,
    asked: u64,
    members: Vec<Member>,
    pairs: Pairs,
    shared: SharedTasks,
    /// How often devices that have left had each kind of fault.
    counts: [u64; 3],
}

/// The truth about a worker.
#[derive(Clone, Copy, Debug)]
pub struct TrueWorker {
    /// The worker's number.
    pub worker: usize,
    /// Where the worker is, and where the head faces.
    pub pose: Pose,
    /// The worker's speed, metres per second.
    pub speed_mps: f64,
    /// What the worker moves as.
    pub mover: Mover,
}

impl TrueWorker {
    /// Discs of a person's size that cover the worker: what scanners see.
    pub fn parts(&self) -> Vec<Point> {
        parts(&self.mover, self.pose)
    }

    /// The disc among these that is nearest to a place.
    pub fn part_nearest(&self, to: Point) -> Point {
        if self.mover == Mover::OnFoot {
            return self.pose.at;
        }
        let far = |p: &Point| (p - to).norm();
        self.parts().into_iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(self.pose.at)
    }
}

impl Crew {
    /// The workers of a scenario, all outside; none if the scenario has none or the map has no floor for people.
    pub fn new(warehouse: &Arc<Warehouse>, scenario: &Scenario, seed: u64, now: Time) -> Option<Crew> {
        let workers = scenario.workers.clone();
        if workers.all() == 0 {
            return None;
        }
        let walkways = Walkways::of(warehouse);
        let door = |n: &NodeId| walkways.on_floor(warehouse.nodes[*n].at);
        let mut doors: Vec<Point> =
            warehouse.nodes_where(|k| k == NodeKind::Exit).iter().filter_map(door).collect();
        doors.extend(walkways.nodes().iter().next().map(|n| n.at).filter(|_| doors.is_empty()));
        if doors.is_empty() {
            return None;
        }
        let fronts = fronts(warehouse, &workers.assignments, &walkways);
        let member = |i: usize| Member::new(i, &workers, &scenario.faults, seed, now);
        let mut members: Vec<Member> = (0..workers.all()).map(member).collect();
        let pairs = Pairs::draw(workers.pairs, workers.count, seed);
        for (i, member) in members.iter_mut().enumerate() {
            member.tasks = Stream::new(seed, TASKS, pairs.leader(i) as u64);
            member.reach(warehouse, &walkways, (&doors, &fronts));
        }
        let places = fronts.iter().map(|n| warehouse.nodes[*n].at).collect();
        let counts = [0; 3];
        Some(Crew {
            workers,
            walkways,
            doors,
            fronts,
            places,
            seed,
            start: now,
            asked: 0,
            members,
            pairs,
            shared: SharedTasks::new(seed),
            counts,
        })
    }

    /// Requests to the fleet, and what the devices have sent, by `now`.
    pub fn say(&mut self, now: Time, ledger: &Ledger) -> Vec<Input> {
        let mut inputs = Vec::new();
        self.share(now, ledger, &mut inputs);
        for i in 0..self.members.len() {
            self.join(i, ledger, &mut inputs);
            self.want_assignments(i, now, ledger, &mut inputs);
            self.confirm(i, now, ledger, &mut inputs);
            self.members[i].look_up(ledger, &self.doors, &self.walkways);
            let member = &mut self.members[i];
            if let Some(device) = &mut member.device {
                inputs.extend(device.arrivals(now).into_iter().map(Input::Sighted));
            }
            if let Some(tag) = &mut member.tag {
                inputs.extend(tag.arrivals(now).into_iter().map(Input::Sighted));
            }
            if let (Some(worker), Some(walker)) = (member.id, &member.walker)
                && walker.is_gone()
                && let Some(device) = member.device.take()
            {
                add(&mut self.counts, device.counts());
                member.tag = None;
                let by = self.members[i].name.clone();
                inputs.push(self.ask(WorkerAction::Clear { worker, by }));
            }
        }
        inputs
    }

    fn ask(&mut self, action: WorkerAction) -> Input {
        self.asked += 1;
        Input::ask(Token { asker: CREW, number: self.asked }, action)
    }

    /// Joins a worker that the fleet does not know; its number is known one step later.
    fn join(&mut self, i: usize, ledger: &Ledger, inputs: &mut Vec<Input>) {
        if self.members[i].id.is_none() {
            let name = self.members[i].name.clone();
            let known = ledger.workers.pairs().find(|(_, n)| **n == name);
            self.members[i].id = known.map(|(w, _)| w);
            let place = known.and_then(|(w, _)| ledger.on_floor.get(&w));
            if let Some(place) = place {
                self.members[i].stays = self.walkways.on_floor(place.at.into());
                self.members[i].enters = self.start;
            }
            if known.is_none() {
                inputs.push(self.ask(WorkerAction::Register(name)));
            }
        }
        let (id, mover) = (self.members[i].id, self.members[i].mover);
        if let Some(worker) = id.filter(|w| ledger.mover(*w) != mover) {
            inputs.push(self.ask(WorkerAction::MoveAs(worker, mover)));
        }
    }

    /// Keeps shared assignments open, and takes them back when the last worker leaves.
    fn share(&mut self, now: Time, ledger: &Ledger, inputs: &mut Vec<Input>) {
        if self.workers.tasks != TaskSharing::Nearest {
            return;
        }
        let (begins, ends) = (self.members[0].enters, self.members[0].leaves);
        if now >= ends {
            let left: Vec<AssignmentId> = unassigned(ledger).collect();
            let back = |assignment| self.ask(WorkerAction::Unassign(assignment));
            inputs.extend(left.into_iter().map(back));
        } else if now >= begins {
            let (count, what) = (self.members.len(), &self.workers.assignments);
            let new = self.shared.ask(count, what, &self.fronts, ledger);
            let ask = |request| self.ask(WorkerAction::Assign { worker: None, request });
            inputs.extend(new.into_iter().map(ask));
        }
    }

    /// Keeps assignments open for a worker until it leaves; then takes them back.
    fn want_assignments(&mut self, i: usize, now: Time, ledger: &Ledger, inputs: &mut Vec<Input>) {
        let Some(worker) = self.members[i].id else { return };
        if now >= self.members[i].leaves {
            let open = ledger.assignments.iter().filter(|(_, a)| a.worker == Some(worker));
            let open: Vec<AssignmentId> = open.map(|(id, _)| *id).collect();
            inputs.extend(open.into_iter().map(|assignment| self.ask(WorkerAction::Unassign(assignment))));
            return;
        }
        let stay_s = match self.workers.assignments {
            Assignments::Random { stay_s } | Assignments::List { stay_s, .. } => stay_s,
            Assignments::None => return,
        };
        let member = &self.members[i];
        let shares = self.workers.tasks == TaskSharing::Nearest;
        let fronts = member.fronts.as_ref().unwrap_or(&self.fronts);
        if now < member.enters || fronts.is_empty() || shares {
            return;
        }
        let open = ledger.assignments.iter();
        let open =
            open.filter(|(id, a)| a.worker == Some(worker) && !member.done.contains(id)).count() as u64;
        let fronts = fronts.len();
        for _ in open..AHEAD {
            let member = &mut self.members[i];
            let at = match self.workers.assignments {
                Assignments::List { .. } => member.asked as usize % fronts,
                _ => member.tasks.below(fronts),
            };
            // Both workers of a pair draw the same places; the second takes the next one.
            let at = if self.pairs.leader(i) == i { at } else { next_to(at, &self.places) };
            let place = member.fronts.as_ref().unwrap_or(&self.fronts)[at];
            member.asked += 1;
            // A world before a restart may have made the same request; the key identifies it.
            let key = Some(format!("{}/{}/{}", member.name, self.seed, member.asked));
            let stay = Span::from_secs_f64(stay_s);
            let request = AssignmentRequest { place, stay, what: "pick".into(), key: key.map(Into::into) };
            inputs.push(self.ask(WorkerAction::Assign { worker: Some(worker), request }));
        }
    }

    /// Reports what a worker has done until the fleet knows it.
    fn confirm(&mut self, i: usize, now: Time, ledger: &Ledger, inputs: &mut Vec<Input>) {
        let member = &mut self.members[i];
        let Some(worker) = member.id else { return };
        let open = |id: &AssignmentId| ledger.assignments.contains_key(id);
        if let Some(id) = member.done.iter().copied().find(open).filter(|_| now - member.pressed >= AGAIN) {
            member.pressed = now;
            member.button.send(now, id);
        }
        if let Some(assignment) = member.button.receive(now).filter(open) {
            inputs.push(self.ask(WorkerAction::Finish(worker, assignment)));
        }
    }

    /// Sends the fleet's guidance to a worker.
    pub fn tell(&mut self, now: Time, worker: WorkerId, guidance: Guidance) {
        if let Some(member) = self.members.iter_mut().find(|m| m.id == Some(worker)) {
            let number = member.told.as_ref().map_or(1, |(n, _)| n + 1);
            member.radio.send(now, (number, guidance.clone()));
            (member.told, member.sent) = (Some((number, guidance)), now);
        }
    }

    /// Advances all workers by `dt` seconds, up to `now`.
    pub fn tick(&mut self, now: Time, dt: f64, robots: &[RobotNear]) {
        let colleagues: Vec<Vec<Point>> = (0..self.members.len()).map(|i| self.colleagues(i, now)).collect();
        let seen = |m: &Member| m.walker.as_ref().filter(|w| !w.is_gone()).map(|w| w.seen(now));
        let mut people: Vec<Option<PersonNear>> = self.members.iter().map(seen).collect();
        let vehicles = SeenVehicles::of(&self.members, now);
        for (i, member) in self.members.iter_mut().enumerate() {
            member.listen(now);
            let others = || people.iter().flatten().filter(|p| p.who != i);
            if member.walker.is_none() {
                let doors = member.doors.as_ref().unwrap_or(&self.doors);
                let Some(door) = doors.get(i % doors.len().max(1)).copied() else { continue };
                let waits = now >= member.enters && now < member.leaves && member.id.is_some();
                let beside = |at: &Point| robots.iter().any(|r| (r.at - at).norm() < BESIDE_M);
                let stays = member.stays.filter(|at| !beside(at));
                let enters = || match member.mover {
                    Mover::OnFoot => entrance(door, &self.walkways, others(), robots),
                    mover => vehicle_entrance(door, mover, others(), robots),
                };
                if waits && let Some(at) = stays.or_else(enters) {
                    member.walker =
                        Some(Walker::new(&self.workers, self.seed, i as u64, at, self.start, now));
                    member.device = Some(Device::new(self.workers.sensor_of(i), self.seed, i as u64, now));
                    let second = |tag: SecondTag| Device::second(tag.sensor(), self.seed, i as u64, now);
                    let worn = self.workers.tag.filter(|_| member.mover == Mover::OnFoot);
                    member.tag = worn.map(second);
                    member.heard = 0;
                }
            }
            let (Some(walker), Some(worker)) = (&mut member.walker, member.id) else { continue };
            if walker.is_gone() {
                continue;
            }
            if now >= member.leaves {
                let far = |d: &Point| (d - walker.pose(now).at).norm();
                let doors = member.doors.as_ref().unwrap_or(&self.doors);
                let door = doors.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b)));
                walker.send_home(door.expect("checked in `new`"));
            }
            let job = member.job.filter(|j| !member.done.contains(&j.id));
            let here = walker.way_at();
            let mut near: Vec<PersonNear> = others().filter(|p| p.matters_to(here)).copied().collect();
            near.retain(|p| !vehicles.is_vehicle(p.who) && member.mover == Mover::OnFoot);
            let robots = &*vehicles.among(robots, i, others());
            let companion = self.pairs.mate(i).and_then(|mate| people[mate]);
            let work = WorkKnowledge { job, known: &member.known, colleagues: &colleagues[i], companion };
            let around = WalkerSurroundings { walkways: &self.walkways, robots, people: &near };
            walker.tick(now, dt, &around, &work);
            // Workers later in this loop see where this one is now.
            people[i] = Some(walker.seen(now)).filter(|_| !walker.is_gone());
            member.done.extend(walker.finished.drain(..));
            let (pose, walked_m) = (walker.pose(now), walker.walked_m());
            member.touch_marks(now);
            for device in member.device.iter_mut().chain(&mut member.tag) {
                device.look(now, worker, pose, walked_m);
            }
        }
    }

    /// From now on, the workers' radios have these faults.
    pub fn set_faults(&mut self, faults: LinkFaults) {
        for member in &mut self.members {
            member.radio.set_faults(faults);
            member.button.set_faults(faults);
        }
    }

    /// Silences the headset of a worker until `until`. Gives whether there is one.
    pub fn silence(&mut self, worker: WorkerId, until: Time) -> bool {
        let device = self.members.iter_mut().find(|m| m.id == Some(worker)).and_then(|m| m.device.as_mut());
        device.map(|device| device.fall_silent(until)).is_some()
    }

    /// How often the workers' devices had each kind of fault.
    pub fn injected(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let mut counts = self.counts;
        let devices = self.members.iter().filter_map(|m| m.device.as_ref());
        devices.for_each(|device| add(&mut counts, device.counts()));
        ["headset_silences", "headset_jumps", "headset_resets"].into_iter().zip(counts)
    }

    fn colleagues(&self, i: usize, now: Time) -> Vec<Point> {
        self.present(now).filter(|p| p.worker != i).map(|p| p.pose.at).collect()
    }

    /// The true workers on the floor.
    pub fn present(&self, now: Time) -> impl Iterator<Item = TrueWorker> {
        let walkers = self.members.iter().enumerate().filter_map(|(i, m)| m.walker.as_ref().map(|w| (i, w)));
        let present = walkers.filter(|(_, w)| !w.is_gone());
        present.map(move |(worker, w)| TrueWorker {
            worker,
            pose: w.pose(now),
            speed_mps: w.speed_mps(),
            mover: w.mover(),
        })
    }

    /// The truth about each worker who has been on the floor: its number in the fleet, and the walker.
    pub fn walkers(&self) -> impl Iterator<Item = (WorkerId, &Walker)> {
        self.members.iter().filter_map(|m| m.id.zip(m.walker.as_ref()))
    }

    /// Assignments that workers have truly completed.
    pub fn completed(&self) -> u64 {
        self.members.iter().map(|m| m.done.len() as u64).sum()
    }
}

fn add(sums: &mut [u64; 3], counts: [u64; 3]) {
    sums.iter_mut().zip(counts).for_each(|(sum, n)| *sum += n);
}

/// Nodes with work for people: storage places that can be reached on foot, or those that the scenario names.
fn fronts(warehouse: &Warehouse, assignments: &Assignments, walkways: &Walkways) -> Vec<NodeId> {
    let named = |n: NodeId, places: &[String]| places.contains(&warehouse.nodes[n].name);
    let all = match assignments {
        Assignments::None => Vec::new(),
        Assignments::Random { .. } => warehouse.nodes_where(|k| k == NodeKind::Storage),
        Assignments::List { places, .. } => {
            let place = |p: &String| warehouse.nodes.ids().find(|n| named(*n, std::slice::from_ref(p)));
            places.iter().filter_map(place).collect()
        }
    };
    let reached = |n: &NodeId| walkways.on_floor(warehouse.nodes[*n].at).is_some();
    all.into_iter().filter(reached).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Faults, Sensor};
    use giveway_fleet::{Fleet, Request, Settings};
    use giveway_floor::geometry::Vector;
    use giveway_floor::warehouse::thesis;
    use giveway_people::human::Presence;

    #[test]
    fn nobody_steps_through_a_door_in_front_of_a_robot_that_could_not_stop() {
        let warehouse = Arc::new(thesis());
        let workers = Workers { count: 1, ..Workers::default() };
        let text = r#"{"giveway_scenario": 1, "name": "t", "map": "", "robots": 1, "period_ms": 100,
            "duration_s": 60}"#;
        let scenario = Scenario { workers, ..Scenario::parse(text).expect("it is one") };
        let mut fleet = Fleet::new(warehouse.clone(), Settings::default());
        let mut crew = Crew::new(&warehouse, &scenario, 1, Time::ZERO).expect("it has a worker");
        let mut now = Time::ZERO;
        let mut live = |speed_mps: f64, far_m: f64, crew: &mut Crew| {
            now += Span::from_millis(100);
            let inputs = crew.say(now, fleet.ledger());
            fleet.step(now, inputs);
            let velocity = Vector::new(-speed_mps, 0.0);
            let robot = RobotNear { at: crew.doors[0] + Vector::new(far_m, 0.0), velocity, half_m: 0.45 };
            crew.tick(now, 0.1, &[robot]);
            crew.present(now).count()
        };
        for _ in 0..50 {
            assert_eq!(live(1.5, 4.0, &mut crew), 0, "it is there in three seconds");
            assert_eq!(live(0.0, 1.0, &mut crew), 0, "it stands in the way");
        }
        assert_eq!(live(0.0, 4.0, &mut crew), 1, "one that stands elsewhere does not matter");
    }

    #[test]
    fn a_worker_says_to_be_done_until_the_fleet_knows_whatever_the_radio_loses() {
        let warehouse = Arc::new(thesis());
        let workers = Workers { count: 1, enter_s: 0.0, ..Workers::default() };
        let faults = Faults { message_loss: 0.7, message_delay_ms: 100, ..Faults::default() };
        let text = r#"{"giveway_scenario": 1, "name": "t", "map": "", "robots": 1, "period_ms": 100,
            "duration_s": 60}"#;
        let scenario = Scenario { workers, faults, ..Scenario::parse(text).expect("it is one") };
        let mut fleet = Fleet::new(warehouse.clone(), Settings::default());
        let mut crew = Crew::new(&warehouse, &scenario, 1, Time::ZERO).expect("it has a worker");
        let mut now = Time::ZERO;
        let mut asked = 0;
        let mut done = |crew: &mut Crew| {
            now += Span::from_millis(100);
            let inputs = crew.say(now, fleet.ledger());
            let says_so = |i: &&Input| {
                matches!(i, Input::Ask { request: Request::Worker(WorkerAction::Finish(..)), .. })
            };
            asked += inputs.iter().filter(says_so).count();
            fleet.step(now, inputs);
            let open: Vec<AssignmentId> = fleet.ledger().assignments.keys().copied().collect();
            (fleet.ledger().counts.human_deliveries, open, asked)
        };
        let open = (0..10).map(|_| done(&mut crew).1).last().expect("ten times");
        assert_eq!(open.len() as u64, AHEAD);
        crew.members[0].done.insert(open[0]);
        let told = (0..100).map(|_| done(&mut crew)).find(|(n, ..)| *n > 0).expect("it came through");
        assert!(!told.1.contains(&open[0]));
        let later = (0..20).map(|_| done(&mut crew)).last().expect("twenty times");
        assert_eq!((later.0, later.2), (1, told.2), "said once, whatever was lost before");
    }

    #[test]
    fn a_worker_whose_headset_is_off_the_map_touches_marks_and_is_seen_again() {
        let warehouse = Arc::new(thesis());
        let sensor = Sensor { drift: 50.0, ..Sensor::default() };
        let workers = Workers { count: 1, enter_s: 0.0, sensor, ..Workers::default() };
        let text = r#"{"giveway_scenario": 1, "name": "t", "map": "", "robots": 1, "period_ms": 100,
            "duration_s": 60}"#;
        let scenario = Scenario { workers, ..Scenario::parse(text).expect("it is one") };
        let mut fleet = Fleet::new(warehouse.clone(), Settings::default());
        let mut crew = Crew::new(&warehouse, &scenario, 1, Time::ZERO).expect("it has a worker");
        let mut seen = Vec::new();
        for i in 1..1200 {
            let now = Time(i * 100_000);
            let inputs = crew.say(now, fleet.ledger());
            let step = fleet.step(now, inputs);
            step.guidance.into_iter().for_each(|(worker, guidance)| crew.tell(now, worker, guidance));
            crew.tick(now, 0.1, &[]);
            let presence = fleet.view(now).workers.first().map(|w| w.presence);
            if seen.last() != Some(&presence) {
                seen.push(presence);
            }
        }
        let found = |w: &[Option<Presence>]| w == [Some(Presence::Lost), Some(Presence::Tracked)];
        assert!(seen.windows(2).filter(|w| found(w)).count() >= 2, "{seen:?}");
    }
}
