//! What a robot arm does at its station: piece by piece from a slot into a tote, around the picker's arms.
//!
//! Main types: [`StationArm`], [`ArmTask`], [`ArmMode`]. Ten times a second it follows a checked path as long as every
//! step until it could stand meets a person with at most [`DELTA`]; otherwise it evades the picker's limbs, stands, or
//! goes back: the first of these that meets no person. Refuses: to move an arm that is silent, late or reports
//! impossible joints; to pick an unordered piece; and to be a safety function: the arm's own stop protects people.

use super::backoff::StopBackoff;
use super::beside::{BesidePicker, DELTA, space_beside};
use super::capsule::{Capsule, least_distance_m};
use super::choice::{Choice, choose};
use super::grip::{ArmGrip, ArmOrder, ArmSaid, GripAct, Gripped};
use super::kinematics::{ArmKind, Joints, between, joint_distance};
use super::mpc::{ArmGoal, ArmPlan, HORIZON};
use super::pace::{RunAhead, STANDS_BY, WayRun};
use super::seam::{ArmSeam, ArmTrouble};
use super::sight::PickerAhead;
use super::site::{ArmSite, SlotAccess, numbers, rest};
use super::space::ArmWay;
use super::stand::ArmStand;
use super::trees::rrt_connect;
use crate::PickFace;
use giveway_floor::id::StationId;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{ArmMount, SlotName};
use std::sync::Arc;

/// Distances that paths keep from the picker, metres: the largest for which there is room.
const CLEAR_M: [f64; 3] = [0.15, 0.08, 0.02];
/// Number of cycles without progress after which the arm looks for another path.
const BLOCKED: u32 = 15;
/// How far an arm that its own stop holds leaves at once, radians.
const LEAVES_RAD: f64 = 0.4;
/// An arm within this distance of its target has arrived, radians.
const THERE_RAD: f64 = 0.02;
/// Number of samples in one search for a path.
pub const TASK_SAMPLES: usize = 300;
/// Longest stage, cycles; a longer one is abandoned: the visit does not wait for an arm that cannot get past.
const LONGEST: u32 = 200;
/// Number of failed searches after which the line is left to the hand.
const SEARCHES: u64 = 12;
/// Number of attempts to shorten a path.
const SHORTENED: usize = 40;
/// Time after which an arm standing in the opening is stuck: a stage that takes long is abandoned before.
const STUCK: Span = Span::from_secs(60);
/// How far ahead on its path the arm is drawn while it evades, radians.
const CARROT_RAD: f64 = 0.8;

/// When an arm moves beside a picker.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ArmMode {
    /// Only while no hand is in the opening or about to be.
    Turns,
    /// Around where the picker's arms are.
    Reactive,
    /// Around where the picker's arms will be.
    #[default]
    Predictive,
}

impl ArmMode {
    /// All modes.
    pub const ALL: [ArmMode; 3] = [ArmMode::Turns, ArmMode::Reactive, ArmMode::Predictive];

    /// The word for the mode in scenarios and reports.
    pub fn word(self) -> &'static str {
        match self {
            ArmMode::Turns => "turns",
            ArmMode::Reactive => "reactive",
            ArmMode::Predictive => "predictive",
        }
    }
}

/// Pieces that an arm should pick, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmTask {
    /// The slot that the pieces come from.
    pub slot: SlotName,
    /// Number of the tote at the station that the pieces go into.
    pub tote: usize,
    /// Number of pieces.
    pub pieces: u32,
}

/// What an arm has just done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmDeed {
    /// It has put a piece into its tote.
    Placed,
    /// The slot was empty.
    FoundNothing,
}

/// What an arm is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmActivity {
    /// It has never reported.
    Off,
    /// It is at its resting place.
    Idle,
    /// It moves, waits on its path, or grips.
    Moving,
    /// It gets no trajectory, for this reason.
    Trouble(ArmTrouble),
}

/// What is known of an arm's surroundings for one cycle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Surroundings<'a> {
    /// The picker's limbs, if they are seen.
    pub picker: Option<&'a PickerAhead>,
    /// Whether the arm must stand.
    pub holds: bool,
}

/// The stage of the arm's work on a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArmStage {
    /// At rest.
    Rest,
    ToSlot,
    Into,
    Take,
    Out,
    ToTote,
    Put,
    /// Back to the resting place.
    Back,
    LayAside,
}

/// The arm of a station.
#[derive(Clone, Debug)]
pub struct StationArm {
    station: StationId,
    kind: ArmKind,
    mount: ArmMount,
    seam: ArmSeam,
    site: Option<ArmSite>,
    task: Option<ArmTask>,
    access: Option<SlotAccess>,
    stage: ArmStage,
    run: Option<WayRun>,
    /// Whether the arm must leave its path.
    leaves: bool,
    /// Number of cycles without progress.
    blocked: u32,
    /// Number of cycles at this stage.
    cycles: u32,
    /// What the arm's own stop did at this stage.
    backoff: StopBackoff,
    stand: ArmStand,
    /// The trajectory that was sent last.
    plan: ArmPlan,
    grip: Option<ArmGrip>,
    grips: u64,
    holds_piece: bool,
    /// Whether a report has come that no decision has used yet.
    due: bool,
    may_search: bool,
    was_heard: bool,
    /// Whether a person has vouched that the arm is outside, until its next report.
    is_vouched: bool,
    searches: u64,
    gives_up: bool,
}

impl StationArm {
    /// The arm of a mount; nothing for a kind without a built-in table.
    pub fn new(station: StationId, mount: &ArmMount) -> Option<StationArm> {
        let kind = ArmKind::named(&mount.kind)?.clone();
        Some(StationArm {
            station,
            seam: ArmSeam::new(kind.clone()),
            kind,
            mount: mount.clone(),
            site: None,
            task: None,
            access: None,
            stage: ArmStage::Back,
            run: None,
            leaves: false,
            blocked: 0,
            cycles: 0,
            backoff: StopBackoff::default(),
            stand: ArmStand::default(),
            plan: ArmPlan::standing(&rest()),
            grip: None,
            grips: 0,
            holds_piece: false,
            due: false,
            may_search: false,
            was_heard: false,
            is_vouched: false,
            searches: 0,
            gives_up: false,
        })
    }

    /// Takes a report of the arm. Gives what the arm has done, once.
    pub fn hear(&mut self, now: Time, said: &ArmSaid) -> Option<ArmDeed> {
        self.was_heard = true;
        self.seam.take(now, said.report).ok()?;
        (self.due, self.may_search, self.is_vouched) = (true, true, false);
        self.stand.see(&said.report.joints, now);
        if said.report.is_stopped && self.stage != ArmStage::Rest {
            self.backoff.hold(&said.report.joints);
        }
        if said.report.is_stopped {
            // The trajectory that the arm was following is over.
            (self.plan, self.run, self.leaves) = (ArmPlan::standing(&said.report.joints), None, false);
        }
        let wanted = self.grip?;
        let (_, gripped) = said.gripped.filter(|(number, _)| *number == wanted.number)?;
        self.grip = None;
        self.holds_piece = matches!(wanted.act, GripAct::Take(_)) && gripped == Gripped::Done;
        match (wanted.act, gripped) {
            (GripAct::Take(_), Gripped::Empty) => {
                self.drop_task();
                Some(ArmDeed::FoundNothing)
            }
            (GripAct::Take(_), Gripped::Done) => {
                self.stage = ArmStage::Out;
                None
            }
            (GripAct::Put(_), _) => {
                self.placed();
                Some(ArmDeed::Placed)
            }
            (GripAct::LayAside, _) => {
                self.stage = ArmStage::Rest;
                None
            }
        }
    }

    /// Records that a piece is in its tote: the next piece follows, or the task is over.
    fn placed(&mut self) {
        self.task = self.task.map(|t| ArmTask { pieces: t.pieces - 1, ..t }).filter(|t| t.pieces > 0);
        self.stage = if self.task.is_some() { ArmStage::ToSlot } else { ArmStage::Back };
    }

    /// Why the arm gets no trajectory, except for its own stop, which ends by itself.
    pub fn trouble(&self, now: Time) -> Option<ArmTrouble> {
        self.seam.trouble(now).filter(|why| self.was_heard && *why != ArmTrouble::Stopped)
    }

    /// Whether the arm has ever reported.
    pub fn was_heard(&self) -> bool {
        self.was_heard
    }

    /// What the arm is doing.
    pub fn activity(&self, now: Time) -> ArmActivity {
        match self.seam.trouble(now) {
            _ if !self.was_heard => ArmActivity::Off,
            Some(why) => ArmActivity::Trouble(why),
            None if self.stage == ArmStage::Rest => ArmActivity::Idle,
            None => ArmActivity::Moving,
        }
    }

    /// Whether a report has come that no decision has used yet.
    pub fn is_due(&self) -> bool {
        self.due
    }

    /// The task of the arm.
    pub fn task(&self) -> Option<&ArmTask> {
        self.task.as_ref()
    }

    /// Whether the arm may begin another task.
    pub fn is_free(&self) -> bool {
        self.task.is_none() && !self.holds_piece && matches!(self.stage, ArmStage::Rest | ArmStage::Back)
    }

    /// Whether the arm can still leave its piece to the hand: it is not in the slot yet, and holds nothing.
    pub fn can_leave(&self) -> bool {
        !self.holds_piece && self.stage == ArmStage::ToSlot
    }

    /// Whether any part of the arm was in the opening or beyond it at its last report.
    pub fn is_inside(&self) -> bool {
        let joints = self.seam.joints().filter(|_| self.stage != ArmStage::Rest && !self.is_vouched);
        self.site.as_ref().zip(joints).is_some_and(|(site, joints)| site.is_inside(joints))
    }

    /// Whether the arm has stood in the opening, or beyond it, for so long that a person should look: meanwhile no rack
    /// comes or leaves.
    pub fn is_stuck_inside(&self, now: Time) -> bool {
        self.is_inside() && self.stand.since().is_some_and(|since| now - since >= STUCK)
    }

    /// Records a person's word that the arm is not in the opening, though it does not report.
    pub fn vouch_outside(&mut self) {
        self.is_vouched = true;
    }

    /// Sets the face of the rack that is at the station.
    pub fn turn_to(&mut self, face: &Arc<PickFace>) {
        if self.site.as_ref().is_none_or(|site| !Arc::ptr_eq(site.face(), face)) {
            self.site = Some(ArmSite::new(&self.kind, &self.mount, face.clone()));
            self.run = None;
        }
    }

    /// Whether the arm reaches slot and tote; nothing if that is not known yet. Each report allows the search for one
    /// pair of them.
    pub fn reaches(&mut self, slot: SlotName, tote: usize) -> Option<bool> {
        let site = self.site.as_mut()?;
        if !site.knows(slot, tote) && !std::mem::take(&mut self.may_search) {
            return None;
        }
        Some(site.tote(tote).is_some() && site.slot(slot).is_some())
    }

    /// Begins a task.
    pub fn begin(&mut self, task: ArmTask) {
        debug_assert!(self.is_free(), "an arm has one task at a time");
        self.access = self.site.as_mut().and_then(|site| site.slot(task.slot));
        (self.task, self.stage, self.gives_up) = (Some(task), ArmStage::ToSlot, false);
        (self.searches, self.cycles) = (0, 0);
        self.backoff.got_on();
        self.leave_way();
    }

    /// Drops the task: its pieces are no longer wanted. The arm comes out, and lays aside what it holds.
    pub fn drop_task(&mut self) {
        self.task = None;
        self.grip = None;
        self.stage = match self.stage {
            ArmStage::Into | ArmStage::Take | ArmStage::Out => ArmStage::Out,
            ArmStage::Rest => ArmStage::Rest,
            _ => ArmStage::Back,
        };
        self.gives_up = false;
        self.leave_way();
    }

    /// Whether the arm found no path and leaves its task to the hand; asking clears it.
    pub fn gives_up(&mut self) -> bool {
        std::mem::take(&mut self.gives_up)
    }

    /// Ends the present path where the arm comes to a stand; then another path begins.
    fn leave_way(&mut self) {
        self.leaves = self.run.is_some();
    }

    /// Decides what the arm does next, once for each report.
    pub fn cycle(&mut self, now: Time, around: Surroundings<'_>) -> Option<ArmOrder> {
        if !std::mem::take(&mut self.due) {
            return None;
        }
        self.cycles += 1;
        if self.cycles > LONGEST && self.task.is_some() {
            (self.gives_up, self.cycles) = (true, 0);
        }
        let lets_pass = self.backoff.waits();
        let present = *self.seam.joints()?;
        if self.stage == ArmStage::Rest && joint_distance(&rest(), &present) > THERE_RAD {
            // It evaded a person, or was moved.
            self.stage = ArmStage::Back;
        }
        match self.seam.trouble(now) {
            // At its resting place it is in no one's way.
            Some(ArmTrouble::Stopped) if self.stage == ArmStage::Rest => return None,
            Some(ArmTrouble::Stopped) => return self.retreat(now, around),
            Some(_) => return None,
            None => {}
        }
        self.site.as_ref()?;
        if joint_distance(&self.plan.steps[0], &present) > THERE_RAD {
            // It was stopped, or a person moved it: it begins anew where it is.
            (self.plan, self.run, self.leaves) = (ArmPlan::standing(&present), None, false);
        }
        self.arrive(&present);
        if let Some(act) = self.act() {
            let grips = &mut self.grips;
            let grip = *self.grip.get_or_insert_with(|| {
                *grips += 1;
                ArmGrip { number: *grips, act }
            });
            return self.order(now, ArmPlan::standing(&present), Some(grip));
        }
        if self.stage == ArmStage::Rest && self.stands() {
            return None;
        }
        let plan = match lets_pass {
            // The person goes first: the present motion comes to its end, and the arm stands there.
            true if self.stands() => return None,
            true => self.brakes(),
            false => self.decide(&present, around),
        };
        self.order(now, plan, None)
    }

    fn order(&mut self, now: Time, plan: ArmPlan, grip: Option<ArmGrip>) -> Option<ArmOrder> {
        let trajectory = self.seam.trajectory(now, &plan).ok()?;
        self.plan = plan;
        Some(ArmOrder { station: self.station, trajectory, grip, line: None })
    }

    /// What the gripper does at this stage.
    fn act(&self) -> Option<GripAct> {
        match (self.stage, self.task) {
            (ArmStage::Take, Some(task)) => Some(GripAct::Take(task.slot)),
            (ArmStage::Put, Some(task)) => Some(GripAct::Put(task.tote)),
            (ArmStage::LayAside, _) => Some(GripAct::LayAside),
            _ => None,
        }
    }

    fn stands(&self) -> bool {
        joint_distance(&self.plan.steps[0], &self.plan.steps[1]) < 1e-3
            && self.run.as_ref().is_none_or(WayRun::stands)
    }

    /// Advances to the next stage where the arm stands at the end of this one.
    fn arrive(&mut self, present: &Joints) {
        let is_there = |q: &Joints| joint_distance(q, present) < THERE_RAD;
        let there = self.stands() && self.target().is_some_and(|q| is_there(&q));
        if !there {
            return;
        }
        self.stage = match self.stage {
            ArmStage::ToSlot => ArmStage::Into,
            ArmStage::Into => ArmStage::Take,
            ArmStage::Out if self.task.is_some() => ArmStage::ToTote,
            ArmStage::Out => ArmStage::Back,
            ArmStage::ToTote => ArmStage::Put,
            ArmStage::Back if self.holds_piece => ArmStage::LayAside,
            ArmStage::Back => ArmStage::Rest,
            other => other,
        };
        (self.run, self.leaves, self.searches, self.cycles) = (None, false, 0, 0);
        self.backoff.got_on();
    }

    /// The angles at which this stage ends.
    fn target(&mut self) -> Option<Joints> {
        match self.stage {
            ArmStage::ToSlot | ArmStage::Out => self.access.map(|a| a.before),
            ArmStage::Into => self.access.map(|a| a.inside),
            ArmStage::ToTote => self.task.and_then(|task| self.site.as_mut()?.tote(task.tote)),
            ArmStage::Back => Some(rest()),
            ArmStage::Rest | ArmStage::Take | ArmStage::Put | ArmStage::LayAside => None,
        }
    }

    /// The trajectory of the next second.
    fn decide(&mut self, present: &Joints, around: Surroundings<'_>) -> ArmPlan {
        if (self.leaves || self.blocked > BLOCKED) && self.stands() {
            (self.run, self.leaves) = (None, false);
        }
        if self.run.is_none() && self.stands() && !around.holds {
            self.run = self.way(present, around).map(|way| WayRun::new(&self.kind, way));
        }
        let Some(run) = &self.run else {
            // It evades, or no path is known: it comes to a stand unless it can go on evading.
            let may_evade = !self.stands() && !around.holds;
            let evading = may_evade.then(|| self.evade(present, None, around)).flatten();
            return evading.unwrap_or(self.plan.a_cycle_later());
        };
        let space = self.site.as_ref().expect("a face is known").space.clone();
        let beside = BesidePicker::new(&space, around.picker, present);
        let mut risk = |q: &Joints, step: usize| beside.risk(q, step);
        let wanted = if around.holds || self.leaves { 0.0 } else { 1.0 };
        let (ahead, brakes, back) = (run.ahead(wanted), run.ahead(0.0), run.ahead(-0.6));
        if choose(present, ahead.soon(), &[], DELTA, &mut risk) == Choice::Planned {
            self.blocked = 0;
            return self.take(&ahead);
        }
        self.blocked += 1;
        let is_free = matches!(self.stage, ArmStage::ToSlot | ArmStage::ToTote | ArmStage::Back);
        let may_evade = is_free && !around.holds && !self.leaves;
        let carrot = run.farther(CARROT_RAD);
        if let Some(plan) = may_evade.then(|| self.evade(present, Some(&carrot), around)).flatten() {
            self.run = None;
            return plan;
        }
        match choose(present, brakes.soon(), &[back.soon().to_vec()], DELTA, &mut risk) {
            Choice::Other(_) => self.take(&back),
            Choice::Planned | Choice::Stand => self.take(&brakes),
        }
    }

    /// Where the arm's own stop holds it, leads it away from the person, if some path does.
    fn retreat(&mut self, now: Time, around: Surroundings<'_>) -> Option<ArmOrder> {
        let present = *self.seam.joints()?;
        let (site, picker) = (self.site.as_mut()?, around.picker?);
        let tote = self.task.and_then(|task| site.tote(task.tote));
        let (space, kind) = (site.tight(), &self.kind);
        let limbs = [picker.body.clone(), picker.arms.first()?.capsules(0.0)].concat();
        let apart = |q: &Joints| least_distance_m(&kind.capsules(&kind.pose(&space.base, q), 0.0), &limbs);
        let leaves = |to: Joints| {
            let share = (LEAVES_RAD / joint_distance(&present, &to).max(1e-6)).min(1.0);
            let way = space.check(vec![present, between(&present, &to, share)])?;
            let plan = WayRun::new(kind, way).ahead(0.4).plan;
            let all: Vec<f64> = std::iter::once(&present).chain(&plan.steps).map(apart).collect();
            let is_away =
                all.windows(2).all(|pair| pair[1] >= pair[0] - 1e-4) && all[HORIZON] > all[0] + 0.01;
            is_away.then_some(plan)
        };
        let access = self.access.map(|access| [access.before, access.inside]);
        let plan = [rest()].into_iter().chain(access.into_iter().flatten()).chain(tote).find_map(leaves)?;
        let trajectory = self.seam.trajectory_away(now, &plan).ok()?;
        (self.plan, self.run) = (plan, None);
        Some(ArmOrder { station: self.station, trajectory, grip: None, line: None })
    }

    /// The trajectory that comes to a stand.
    fn brakes(&mut self) -> ArmPlan {
        let Some(run) = &self.run else { return self.plan.a_cycle_later() };
        let ahead = run.ahead(0.0);
        self.take(&ahead)
    }

    fn take(&mut self, ahead: &RunAhead) -> ArmPlan {
        self.run.as_mut().expect("it is on its way").take(ahead);
        ahead.plan
    }

    /// A trajectory around the picker's limbs, if one is found that meets nothing.
    fn evade(&self, present: &Joints, carrot: Option<&Joints>, around: Surroundings<'_>) -> Option<ArmPlan> {
        let site = self.site.as_ref()?;
        let picker = around.picker?;
        let (space, kind) = (&site.space, &self.kind);
        let aim = match (carrot, self.stage, self.access, self.task) {
            (Some(carrot), ..) => *carrot,
            (None, ArmStage::ToSlot, Some(access), _) => access.before,
            (None, ArmStage::Back, ..) => rest(),
            _ => return None,
        };
        let pose = kind.pose(&space.base, &aim);
        let goal = ArmGoal { tip: pose.points[7], along: pose.tool.matrix().column(2).into_owned() };
        let limbs: Vec<Vec<Capsule>> = picker.arms.iter().map(|limbs| limbs.thickened(1.0)).collect();
        let plan = site.control.plan(present, &self.plan, &goal, &limbs).ok()?;
        let way: Vec<Joints> = std::iter::once(*present).chain(plan.steps).collect();
        space.check(way)?;
        let beside = BesidePicker::new(space, around.picker, present);
        let is_safe = |(step, q): (usize, &Joints)| beside.risk(q, step) <= DELTA;
        let moves = joint_distance(&plan.steps[HORIZON - 1], present) > 0.1;
        (moves && plan.steps[..STANDS_BY].iter().enumerate().all(is_safe)).then_some(plan)
    }

    /// A checked path from where the arm stands to where this stage ends.
    fn way(&mut self, present: &Joints, around: Surroundings<'_>) -> Option<ArmWay> {
        let target = self.target()?;
        let site = self.site.as_ref()?;
        let straight = || site.space.check(vec![*present, target]);
        if let Some(way) = matches!(self.stage, ArmStage::Into | ArmStage::Out).then(straight).flatten() {
            return Some(way);
        }
        self.searches += 1;
        self.blocked = 0;
        let mut draw = numbers(self.searches);
        // As far from the picker as there is room; a person may have come nearer than the arm would go.
        let spaces = CLEAR_M.iter().map(|clear_m| space_beside(&site.space, around.picker, *clear_m));
        let found = spaces.chain([site.tight()]).find_map(|space| {
            let is_possible = space.is_free(present) && space.is_free(&target);
            let way =
                is_possible.then(|| rrt_connect(&space, present, &target, TASK_SAMPLES, &mut draw))??;
            Some(space.shortened(&way, SHORTENED, &mut draw))
        });
        if found.is_none() && self.searches >= SEARCHES {
            (self.gives_up, self.searches) = (self.task.is_some(), 0);
        }
        found
    }
}
