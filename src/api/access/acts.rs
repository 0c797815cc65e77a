//! Acts of people and machines, one word each: the audit, the page's buttons, undo and the report of a shift use the
//! same words.
//!
//! Main type: [`AuditAct`]; [`AuditAct::of`] is the act of an audit entry, [`AuditAct::remedies`] lists the acts that
//! can remedy an alarm. Refuses: to know which roles may do an act: `access/roles.rs` knows.

use super::caller::{Caller, Role};
use super::roles::{Access, RULES};
use giveway_fleet::alarm::AlarmKind;
use serde::Serialize;
use utoipa::ToSchema;

macro_rules! acts {
    ($($(#[$doc:meta])* $name:ident $word:tt: $($what:literal)|+,)+) => {
        /// An act: a request that changes something, or is meant to.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, ToSchema)]
        pub enum AuditAct { $($(#[$doc])* #[serde(rename = $word)] $name,)+ }

        impl AuditAct {
            /// All acts.
            pub const ALL: [AuditAct; [$(AuditAct::$name),+].len()] = [$(AuditAct::$name),+];

            /// The word for the act on the wire.
            pub fn word(self) -> &'static str {
                match self { $(AuditAct::$name => $word,)+ }
            }

            /// How the audit records the act: methods with routes, and texts for acts that come another way.
            fn whats(self) -> &'static [&'static str] {
                match self { $(AuditAct::$name => &[$($what),+],)+ }
            }
        }
    };
}

acts! {
    /// All robots stop.
    StopFleet "stop_fleet": "POST /v1/fleet/stop",
    /// All robots go on.
    ResumeFleet "resume_fleet": "POST /v1/fleet/resume",
    /// The building is evacuated.
    Evacuate "evacuate": "POST /v1/evacuation",
    /// The evacuation ends.
    EndEvacuation "end_evacuation": "DELETE /v1/evacuation",
    /// An area is closed.
    CloseArea "close_area": "POST /v1/closures",
    /// A closed area is opened, or a recurring closure ends.
    OpenArea "open_area": "DELETE /v1/closures/{id}",
    /// A robot is paused.
    PauseRobot "pause_robot": "POST /v1/robots/{id}/pause",
    /// A paused robot goes on.
    ResumeRobot "resume_robot": "POST /v1/robots/{id}/resume",
    /// A robot goes out of service.
    StartMaintenance "start_maintenance": "PUT /v1/robots/{id}/maintenance",
    /// A robot comes back into service, or stays on the floor although it was to leave.
    EndMaintenance "end_maintenance": "DELETE /v1/robots/{id}/maintenance",
    /// A robot joins.
    AddRobot "add_robot": "POST /v1/robots",
    /// A robot is to leave the floor.
    RemoveRobot "remove_robot": "DELETE /v1/robots/{id}",
    /// A robot of another vendor is sent an instant action.
    SendRobotAction "send_robot_action": "POST /v1/robots/{id}/actions",
    /// A robot may drive although it does not pause when told to.
    ConsentToRobot "consent_to_robot": "PUT /v1/robots/{id}/consent",
    /// People have looked after a robot whose action failed.
    SettleRobot "settle_robot": "POST /v1/robots/{id}/settled",
    /// A job is submitted.
    SubmitJob "submit_job": "POST /v1/jobs",
    /// Many jobs are submitted at once.
    SubmitJobs "submit_jobs": "POST /v1/jobs:batch",
    /// A job gets another priority, deadline, station or robot.
    ChangeJob "change_job": "PATCH /v1/jobs/{id}",
    /// A job is cancelled.
    CancelJob "cancel_job": "DELETE /v1/jobs/{id}",
    /// A job is given to another robot.
    ReassignJob "reassign_job": "POST /v1/jobs/{id}/reassign",
    /// A person gets a task.
    AssignTask "assign_task": "POST /v1/assignments" | "POST /v1/workers/{id}/assignments",
    /// A task of a person is cancelled.
    CancelTask "cancel_task": "DELETE /v1/assignments/{id}",
    /// A task of a person is done.
    FinishTask "finish_task": "POST /v1/assignments/{id}/done" | "done, over the feed",
    /// A person is registered.
    RegisterWorker "register_worker": "POST /v1/workers",
    /// A person gets into a vehicle or off it.
    ChangeWorker "change_worker": "PATCH /v1/workers/{id}",
    /// A supervisor confirms that a lost person is not there.
    ClearWorker "clear_worker": "POST /v1/workers/{id}/clear",
    /// A supervisor reports roughly where a lost person is.
    NarrowWorker "narrow_worker": "POST /v1/workers/{id}/narrow",
    /// A wearer signs off.
    SignOff "sign_off": "signed off, over the feed",
    /// A person's name is erased.
    ErasePerson "erase_person": "DELETE /v1/people/{id}",
    /// A person acknowledges an alarm.
    AcknowledgeAlarm "acknowledge_alarm": "POST /v1/alarms/{id}/acknowledge",
    /// A line is picked, short, or taken back.
    ConfirmLine "confirm_line": "POST /v1/stations/{id}/lines/{n}",
    /// The last line at a station whose rack has left is confirmed, or taken back.
    RepeatLine "repeat_line": "POST /v1/stations/{id}/last",
    /// A rack leaves a station although lines are left.
    ReleaseRack "release_rack": "POST /v1/stations/{id}/release",
    /// A pick is done.
    FinishPick "finish_pick": "POST /v1/stations/{id}/done",
    /// Goods are reported missing in a pick.
    ReportMissing "report_missing": "POST /v1/stations/{id}/short",
    /// A station is paused.
    PauseStation "pause_station": "POST /v1/stations/{id}/pause",
    /// A paused station goes on.
    ResumeStation "resume_station": "POST /v1/stations/{id}/resume",
    /// People took a rack off a robot.
    TakeRack "take_rack": "POST /v1/racks/{id}/taken",
    /// Another map is published.
    PublishMap "publish_map": "PUT /v1/map",
    /// A robot kind is added.
    AddKind "add_kind": "PUT /v1/kinds/{name}",
    /// A robot kind is removed.
    RemoveKind "remove_kind": "DELETE /v1/kinds/{name}",
    /// A webhook is added.
    AddWebhook "add_webhook": "POST /v1/webhooks",
    /// A webhook is removed.
    RemoveWebhook "remove_webhook": "DELETE /v1/webhooks/{id}",
    /// A token is made.
    MakeToken "make_token": "POST /v1/tokens" | "giveway token add",
    /// A token gets another secret.
    RenewToken "renew_token": "POST /v1/tokens/{id}/rotate" | "giveway token rotate",
    /// A token is revoked.
    RevokeToken "revoke_token": "DELETE /v1/tokens/{id}" | "giveway token revoke",
    /// A person signs in.
    SignIn "sign_in": "POST /v1/session" | "GET /v1/session/oidc/callback",
    /// A person signs out.
    SignOut "sign_out": "DELETE /v1/session",
    /// An alarm is shelved until a time.
    ShelveAlarm "shelve_alarm": "POST /v1/alarms/{id}/shelve",
    /// A shelved alarm calls for attention again.
    UnshelveAlarm "unshelve_alarm": "DELETE /v1/alarms/{id}/shelve",
    /// A note is added to an alarm.
    NoteAlarm "note_alarm": "POST /v1/alarms/{id}/notes",
}

impl AuditAct {
    /// The act of an audit entry; nothing if the entry is from another version.
    pub fn of(what: &str) -> Option<AuditAct> {
        AuditAct::ALL.into_iter().find(|act| act.whats().contains(&what))
    }

    /// The acts that this caller may do; a device, only for its own worker or robot.
    pub fn of_caller(caller: &Caller) -> Vec<AuditAct> {
        let may = |access: Access| {
            let own = access.is_for_own() && caller.role == Role::Device && caller.subject.is_some();
            access == Access::Open || access.roles().contains(&caller.role) || own
        };
        let allowed = |act: &AuditAct| {
            let mut rules =
                RULES.iter().filter(|(method, path, _)| act.whats().contains(&&*format!("{method} {path}")));
            rules.any(|(_, _, access)| may(*access))
        };
        AuditAct::ALL.into_iter().filter(allowed).collect()
    }

    /// The acts with which a person can remedy an alarm of this kind where it is shown, the likeliest first.
    pub fn remedies(kind: AlarmKind) -> &'static [AuditAct] {
        use AlarmKind as K;
        match kind {
            K::RobotFailed => &[AuditAct::StartMaintenance, AuditAct::RemoveRobot],
            K::RobotStuck | K::WaitsInVain => &[AuditAct::PauseRobot, AuditAct::ResumeRobot],
            K::RobotFenced | K::Paused => &[AuditAct::ResumeRobot],
            K::BeyondGrant => &[AuditAct::PauseRobot],
            K::WorkerLost => &[AuditAct::ClearWorker, AuditAct::NarrowWorker],
            K::Stopped => &[AuditAct::ResumeFleet],
            K::Evacuation => &[AuditAct::EndEvacuation],
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::roles::is_audited;
    use std::collections::BTreeSet;

    #[test]
    fn every_request_that_is_audited_is_an_act_and_every_act_can_be_asked_for() {
        let mut known = BTreeSet::new();
        for (method, path, _) in RULES.iter().filter(|(method, path, _)| is_audited(method, path)) {
            let act = AuditAct::of(&format!("{method} {path}"));
            known.insert(act.unwrap_or_else(|| panic!("{method} {path} has no act")));
        }
        let besides = [AuditAct::SignIn, AuditAct::SignOut, AuditAct::SignOff];
        let left: Vec<AuditAct> =
            AuditAct::ALL.into_iter().filter(|a| !known.contains(a) && !besides.contains(a)).collect();
        assert_eq!(left, [], "no request asks for these");
        assert_eq!(AuditAct::of("done, over the feed"), Some(AuditAct::FinishTask));
        assert_eq!(AuditAct::of("POST /v1/of/another/version"), None);
    }

    #[test]
    fn what_a_caller_may_is_what_its_role_may() {
        let of = |role, subject: Option<&str>| {
            AuditAct::of_caller(&Caller { role, subject: subject.map(Into::into), ..Caller::anonymous() })
        };
        let viewer = of(Role::Viewer, None);
        assert_eq!(viewer, [AuditAct::SignIn, AuditAct::SignOut], "a viewer changes nothing");
        let operator = of(Role::Operator, None);
        for act in [
            AuditAct::StopFleet,
            AuditAct::Evacuate,
            AuditAct::SubmitJob,
            AuditAct::SubmitJobs,
            AuditAct::AssignTask,
            AuditAct::ShelveAlarm,
        ] {
            assert!(operator.contains(&act), "{act:?}");
        }
        assert!(!operator.contains(&AuditAct::PublishMap) && !operator.contains(&AuditAct::MakeToken));
        assert_eq!(of(Role::Admin, None).len(), AuditAct::ALL.len() - 1, "all but to sign off for a wearer");
        assert!(of(Role::Device, Some("w1")).contains(&AuditAct::ClearWorker));
        assert!(!of(Role::Device, None).contains(&AuditAct::ClearWorker));
    }

    #[test]
    fn the_page_knows_every_act_and_no_other() {
        let source = include_str!("../../../web/src/wire/acts.ts");
        let list = source.split_once("const ACTS = [").expect("the page lists them").1;
        let list = list.split_once(']').expect("the list ends").0;
        let words: Vec<&str> =
            list.split(',').map(|w| w.trim().trim_matches('\'')).filter(|w| !w.is_empty()).collect();
        assert_eq!(words, AuditAct::ALL.map(AuditAct::word));
    }
}
