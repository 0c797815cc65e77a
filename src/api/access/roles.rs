//! The roles that each route needs: one table.
//!
//! Main function: [`check_role`]; [`access_of`] is the row of a route. Refuses: routes without a row, except for
//! administrators.

use super::caller::{Caller, Role};
use crate::wire::error::Problem;
use axum::http::StatusCode;
use giveway_floor::text::sentence::requests;

/// The callers that may use a route.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Every client, even without a token.
    Open,
    /// Every client with a token.
    Known,
    /// Roles that read.
    Read,
    /// Roles that read, and a device for its own worker or robot.
    ReadOwn,
    /// Roles that run the floor.
    Operate,
    /// Roles that run the floor, and a device for its own worker: the wearer signs off.
    OperateOwn,
    /// Roles of other systems, for what only these need.
    Order,
    /// Roles that run the floor, and roles that order: jobs and assignments.
    Change,
    /// Roles that report positions, and a device for its own worker.
    Report,
    /// A device for its own worker or robot.
    Own,
    /// Roles that register workers, and a device that signs in as its own worker; the route checks the worker's name.
    Enrol,
    /// Administrators.
    Administer,
}

use Access::{
    Administer, Change, Enrol, Known, Open, Operate, OperateOwn, Order, Own, Read, ReadOwn, Report,
};

/// Each route by method and path, and who may use it.
pub const RULES: &[(&str, &str, Access)] = &[
    ("GET", "/v1/health", Open),
    ("GET", "/v1/health/live", Open),
    ("GET", "/v1/health/ready", Open),
    ("GET", "/metrics", Read),
    ("GET", "/v1/live", Read),
    ("GET", "/v1/map", Known),
    ("PUT", "/v1/map", Administer),
    ("POST", "/v1/map:check", Administer),
    ("GET", "/v1/kinds", Known),
    ("PUT", "/v1/kinds/{name}", Administer),
    ("DELETE", "/v1/kinds/{name}", Administer),
    ("GET", "/v1/map:file", Read),
    ("POST", "/v1/maps:check", Change),
    ("POST", "/v1/maps:try", Change),
    ("GET", "/v1/events", Read),
    ("GET", "/v1/webhooks", Order),
    ("POST", "/v1/webhooks", Administer),
    ("DELETE", "/v1/webhooks/{id}", Administer),
    ("GET", "/v1/webhooks/{id}/failures", Order),
    ("GET", "/v1/racks", Read),
    ("POST", "/v1/racks/{id}/taken", Operate),
    ("GET", "/v1/stations", Read),
    ("GET", "/v1/stations/{id}", Read),
    ("GET", "/v1/stations/{id}/live", Read),
    ("POST", "/v1/stations/{id}/lines/{n}", Operate),
    ("POST", "/v1/stations/{id}/last", Operate),
    ("POST", "/v1/stations/{id}/release", Operate),
    ("POST", "/v1/stations/{id}/done", Operate),
    ("POST", "/v1/stations/{id}/short", Operate),
    ("POST", "/v1/stations/{id}/pause", Operate),
    ("POST", "/v1/stations/{id}/resume", Operate),
    ("GET", "/v1/robots", Read),
    ("POST", "/v1/robots", Administer),
    ("GET", "/v1/robots/{id}", ReadOwn),
    ("DELETE", "/v1/robots/{id}", Administer),
    ("GET", "/v1/robots/{id}/link", Read),
    ("GET", "/v1/robots/{id}/messages", Administer),
    ("POST", "/v1/robots/{id}/actions", Operate),
    ("GET", "/v1/robots/{id}/actions/{action}", Operate),
    ("PUT", "/v1/robots/{id}/consent", Administer),
    ("POST", "/v1/robots/{id}/settled", Operate),
    ("GET", "/v1/robots/{id}/history", ReadOwn),
    ("GET", "/v1/robots/{id}/why", ReadOwn),
    ("PUT", "/v1/robots/{id}/maintenance", Operate),
    ("DELETE", "/v1/robots/{id}/maintenance", Operate),
    ("POST", "/v1/robots/{id}/pause", Operate),
    ("POST", "/v1/robots/{id}/resume", Operate),
    ("GET", "/v1/fleet", Read),
    ("POST", "/v1/fleet/stop", Operate),
    ("POST", "/v1/fleet/resume", Operate),
    ("GET", "/v1/jobs", Read),
    ("POST", "/v1/jobs", Change),
    ("POST", "/v1/jobs:batch", Change),
    ("GET", "/v1/jobs/{id}", Read),
    ("PATCH", "/v1/jobs/{id}", Change),
    ("DELETE", "/v1/jobs/{id}", Change),
    ("POST", "/v1/jobs/{id}/reassign", Change),
    ("GET", "/v1/jobs/{id}/why", Read),
    ("GET", "/v1/timelines", Read),
    ("GET", "/v1/workers", Known),
    ("POST", "/v1/workers", Enrol),
    ("GET", "/v1/workers/{id}", ReadOwn),
    ("PATCH", "/v1/workers/{id}", Change),
    ("POST", "/v1/workers/{id}/clear", OperateOwn),
    ("POST", "/v1/workers/{id}/narrow", Operate),
    ("GET", "/v1/workers/{id}/feed", Own),
    ("POST", "/v1/workers/{id}/position", Report),
    ("POST", "/v1/positions", Order),
    ("GET", "/v1/massrobotics", Order),
    ("POST", "/v1/massrobotics", Order),
    ("GET", "/v1/workers/{id}/assignments", ReadOwn),
    ("POST", "/v1/workers/{id}/assignments", Change),
    ("GET", "/v1/assignments", Read),
    ("POST", "/v1/assignments", Change),
    ("GET", "/v1/assignments/{id}", Read),
    ("DELETE", "/v1/assignments/{id}", Change),
    ("POST", "/v1/assignments/{id}/done", Change),
    ("GET", "/v1/closures", Read),
    ("POST", "/v1/closures", Operate),
    ("POST", "/v1/closures/preview", Operate),
    ("GET", "/v1/closures/recurring", Read),
    ("GET", "/v1/closures/{id}", Read),
    ("DELETE", "/v1/closures/{id}", Operate),
    ("GET", "/v1/evacuation", Read),
    ("POST", "/v1/evacuation", Operate),
    ("DELETE", "/v1/evacuation", Operate),
    ("GET", "/v1/people", Operate),
    ("DELETE", "/v1/people/{id}", Administer),
    ("GET", "/v1/alarms", Read),
    ("POST", "/v1/alarms/{id}/acknowledge", Operate),
    ("POST", "/v1/alarms/{id}/shelve", Operate),
    ("DELETE", "/v1/alarms/{id}/shelve", Operate),
    ("POST", "/v1/alarms/{id}/notes", Operate),
    ("GET", "/v1/encounters", Read),
    ("GET", "/v1/past", Read),
    ("GET", "/v1/past/figures", Read),
    ("GET", "/v1/past/reel", Read),
    ("GET", "/v1/history", Read),
    ("GET", "/v1/report", Read),
    ("GET", "/v1/heat", Read),
    ("GET", "/v1/audit", Administer),
    ("GET", "/v1/session", Known),
    ("POST", "/v1/session", Open),
    ("DELETE", "/v1/session", Open),
    ("GET", "/v1/session/oidc", Open),
    ("POST", "/v1/session/oidc", Open),
    ("GET", OIDC_CALLBACK, Open),
    ("GET", "/v1/tokens", Administer),
    ("POST", "/v1/tokens", Administer),
    ("DELETE", "/v1/tokens/{id}", Administer),
    ("POST", "/v1/tokens/{id}/rotate", Administer),
];

/// The route to which an identity provider sends browsers back. They come from another site, and the handler checks
/// what they bring, so only this route accepts pages of other sites.
pub const OIDC_CALLBACK: &str = "/v1/session/oidc/callback";

/// Routes for reports of positions.
const REPORTS: [&str; 3] = ["/v1/positions", "/v1/workers/{id}/position", "/v1/massrobotics"];

/// Routes that compute an answer and change nothing.
const TRIALS: [&str; 4] = ["/v1/map:check", "/v1/maps:check", "/v1/maps:try", "/v1/closures/preview"];

impl Access {
    /// The roles that may use the route, besides a device for its own worker or robot; empty if every client may.
    pub fn roles(self) -> &'static [Role] {
        match self {
            Open => &[],
            Known => &Role::ALL,
            Read | ReadOwn => &[Role::Viewer, Role::Operator, Role::Integrator, Role::Admin],
            Operate | OperateOwn => &[Role::Operator, Role::Admin],
            Order | Report => &[Role::Integrator, Role::Admin],
            Change => &[Role::Operator, Role::Integrator, Role::Admin],
            Enrol => &[Role::Device, Role::Admin],
            Own | Administer => &[Role::Admin],
        }
    }

    /// Whether a device may use the route for its own worker or robot.
    pub fn is_for_own(self) -> bool {
        matches!(self, ReadOwn | OperateOwn | Report | Own)
    }

    /// The roles that may use the route, in words; nothing if every client may.
    pub fn words(self) -> Option<String> {
        let mut words: Vec<&str> = self.roles().iter().map(|role| role.word()).collect();
        words.extend(self.is_for_own().then_some("device (its own)"));
        let last = words.pop()?;
        Some(if words.is_empty() { last.into() } else { format!("{} or {last}", words.join(", ")) })
    }
}

/// The row of a route; `HEAD` counts as `GET`.
pub fn access_of(method: &str, route: &str) -> Option<Access> {
    let method = if method == "HEAD" { "GET" } else { method };
    RULES.iter().find(|(m, path, _)| *m == method && *path == route).map(|(_, _, access)| *access)
}

/// Routes of signing in and out, which write their own audit entries: only the handler knows who the caller was, and a
/// client without a token must not fill the audit.
const SIGN_IN: [&str; 2] = ["/v1/session", "/v1/session/oidc"];

/// Whether a request is to change something, and is therefore audited. Reports of positions are observations.
pub fn is_audited(method: &str, route: &str) -> bool {
    let reads = matches!(method, "GET" | "HEAD" | "OPTIONS");
    !reads && !REPORTS.contains(&route) && !TRIALS.contains(&route) && !SIGN_IN.contains(&route)
}

/// Checks that a caller may use a route at this path.
///
/// # Errors
/// 403 that names the required role.
pub fn check_role(caller: &Caller, method: &str, route: &str, path: &str) -> Result<(), Problem> {
    let access = access_of(method, route).unwrap_or(Administer);
    let owns = || caller.subject.is_some() && caller.subject.as_deref() == subject_of(route, path);
    if access == Open
        || access.roles().contains(&caller.role)
        || (access.is_for_own() && caller.role == Role::Device && owns())
    {
        return Ok(());
    }
    let (name, role, needed) = (&caller.name, caller.role.word(), access.words().unwrap_or_default());
    let detail = match &caller.subject {
        Some(subject) => requests::role_needed_for_subject(name, role, subject, needed),
        None => requests::role_needed(name, role, needed),
    };
    Err(Problem::new(StatusCode::FORBIDDEN, "role", "Another role is needed", detail))
}

/// The part of a path that matches the route's variable.
pub fn subject_of<'a>(route: &str, path: &'a str) -> Option<&'a str> {
    let pairs = route.split('/').zip(path.split('/'));
    pairs.into_iter().find(|(part, _)| part.starts_with('{')).map(|(_, text)| text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn may(role: Role, subject: Option<&str>, method: &str, route: &str, path: &str) -> bool {
        let (name, subject) = ("n".into(), subject.map(Into::into));
        let caller = Caller { name, role, subject, key: None, session: None };
        check_role(&caller, method, route, path).is_ok()
    }

    #[test]
    fn each_role_may_what_it_is_for() {
        use Role::{Admin, Integrator, Operator, Viewer};
        for (method, route, roles) in [
            ("GET", "/v1/robots", &[Viewer, Operator, Integrator, Admin][..]),
            ("HEAD", "/v1/robots", &[Viewer, Operator, Integrator, Admin]),
            ("POST", "/v1/fleet/stop", &[Operator, Admin]),
            ("POST", "/v1/jobs", &[Operator, Integrator, Admin]),
            ("GET", "/v1/webhooks", &[Integrator, Admin]),
            ("DELETE", "/v1/jobs/{id}", &[Operator, Integrator, Admin]),
            ("GET", "/v1/map", &Role::ALL),
            ("GET", "/v1/health", &Role::ALL),
            ("POST", "/v1/robots", &[Admin]),
            ("PUT", "/v1/map", &[Admin]),
            ("POST", "/v1/map:check", &[Admin]),
            ("GET", "/v1/tokens", &[Admin]),
            ("GET", "/v1/no/such/route", &[Admin]),
        ] {
            let allowed: Vec<Role> =
                Role::ALL.into_iter().filter(|role| may(*role, None, method, route, route)).collect();
            assert_eq!(allowed, roles, "{method} {route}");
        }
    }

    #[test]
    fn a_device_may_use_its_own_alone() {
        let feed = "/v1/workers/{id}/feed";
        assert!(may(Role::Device, Some("w1"), "GET", feed, "/v1/workers/w1/feed"));
        assert!(!may(Role::Device, Some("w1"), "GET", feed, "/v1/workers/w2/feed"));
        assert!(!may(Role::Device, None, "GET", feed, "/v1/workers/w1/feed"));
        assert!(!may(Role::Operator, Some("w1"), "GET", feed, "/v1/workers/w1/feed"));
        assert!(may(Role::Device, Some("robot-2"), "GET", "/v1/robots/{id}", "/v1/robots/robot-2"));
        assert!(!may(
            Role::Device,
            Some("robot-2"),
            "POST",
            "/v1/robots/{id}/pause",
            "/v1/robots/robot-2/pause"
        ));
    }

    #[test]
    fn a_refusal_names_the_role_that_is_needed() {
        let caller = Caller { name: "anna".into(), role: Role::Viewer, ..Caller::anonymous() };
        let problem = check_role(&caller, "POST", "/v1/fleet/stop", "/v1/fleet/stop").unwrap_err();
        let detail = "\"anna\" has the role viewer, and this needs the role operator or admin";
        assert_eq!((problem.status, &*problem.detail), (403, detail));
    }
}
