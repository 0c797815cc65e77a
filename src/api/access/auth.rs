//! Authorisation: bearer tokens; without tokens, only clients on the loopback and pages that this server served.
//!
//! Main type: [`Gate`]. Tokens are kept as SHA-256 and compared in constant time. Tokens of the settings are
//! administrators'; named tokens have a role and may change while the server runs. Without an administrator's token the
//! server listens on the loopback only; there, requests under a foreign host name or from a foreign page are refused,
//! since any web page can make a browser talk to the loopback. A session cookie stands for the token with which a
//! person signed in, or for the person whom an identity provider named, and changes something only for pages of this
//! server. Refuses: tokens in addresses, which end up in logs.

use super::caller::{Caller, NamedToken, Role, SessionHolder, TokenHash, WebSession};
use super::cookie::{is_loopback, session_secret};
use super::secrets::WrongSecrets;
use crate::port::Now;
use crate::wire::error::{Problem, SecretDoor};
use axum::http::{HeaderMap, Method, StatusCode, header};
use giveway_floor::text::sentence::requests;
use giveway_floor::time::{Span, Time};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use subtle::{ConditionallySelectable, ConstantTimeEq};
use tokio::sync::watch;
use tokio::time::timeout;
use uuid::Uuid;

/// The prefix of a token in `Sec-WebSocket-Protocol`.
const WS_BEARER: &str = "bearer.";

/// The reason with which a feed ends when its token is no longer valid.
pub const TOKEN_ENDED: &str = "the token of this connection no longer holds";

/// How often the server checks whether a token of an open connection has expired.
const LOOK: Duration = Duration::from_secs(1);

/// How long a session lasts, however much it is used.
pub const SESSION_LIFE: Span = Span::from_secs(7 * 24 * 3600);

/// The most ended sessions that are remembered.
const MOST_OVER: usize = 1000;

/// A new token of 244 random bits, as text.
pub fn fresh_token() -> String {
    format!("gw_{}{}", Uuid::new_v4().simple(), Uuid::new_v4().simple())
}

/// The digest under which a token is known.
pub fn hash_of(token: &str) -> TokenHash {
    Sha256::digest(token).into()
}

/// Decides which requests are admitted.
#[derive(Debug, Default)]
pub struct Gate {
    /// Digests of the tokens of the settings.
    fixed: Vec<TokenHash>,
    /// Origins of other sites whose pages may use the server with a token.
    origins: Vec<String>,
    /// Whether people sign in with an identity provider.
    has_provider: bool,
    named: Mutex<NamedTokens>,
    /// Wrong secrets that clients have shown.
    wrong: WrongSecrets,
    /// Signals that named tokens or sessions changed.
    changes: watch::Sender<()>,
}

/// Named tokens, when each was last used since the last [`Gate::take_used`], and sessions.
#[derive(Debug, Default)]
struct NamedTokens {
    all: Vec<NamedToken>,
    sessions: BTreeMap<TokenHash, WebSession>,
    /// The latest sessions that have ended: a browser that still shows such a cookie is not guessing.
    over: VecDeque<TokenHash>,
    /// Whether there ever was a valid administrator's token: from then on the server needs tokens until it stops.
    closed: bool,
    used: BTreeMap<i64, Time>,
}

impl Gate {
    /// A gate that admits these tokens of the settings or, if there are none, every client on this machine.
    pub fn new<'a>(tokens: impl IntoIterator<Item = &'a str>) -> Gate {
        Gate { fixed: tokens.into_iter().map(hash_of).collect(), ..Gate::default() }
    }

    /// Also admits pages of these origins: with a token of their own, never with a session cookie.
    pub fn with_origins(self, origins: Vec<String>) -> Gate {
        Gate { origins, ..self }
    }

    /// Also admits people whom an identity provider named: every client then needs a token or a session.
    pub fn with_provider(self, has_provider: bool) -> Gate {
        Gate { has_provider, ..self }
    }

    /// Origins of other sites whose pages may use the server.
    pub fn origins(&self) -> &[String] {
        &self.origins
    }

    /// Replaces the named tokens.
    pub fn learn(&self, all: Vec<NamedToken>, now: Time) {
        let mut named = self.named();
        if named.all == all {
            return;
        }
        named.closed |= all.iter().any(|t| t.role == Role::Admin && t.holds(now));
        named.all = all;
        drop(named);
        self.changes.send_replace(());
    }

    /// Replaces the sessions.
    pub fn learn_sessions(&self, all: Vec<WebSession>) {
        let mut named = self.named();
        let all = all.into_iter().map(|session| (session.hash, session)).collect();
        let before = std::mem::replace(&mut named.sessions, all);
        let over: Vec<TokenHash> =
            before.into_keys().filter(|hash| !named.sessions.contains_key(hash)).collect();
        named.over.extend(over);
        let too_many = named.over.len().saturating_sub(MOST_OVER);
        named.over.drain(..too_many);
        drop(named);
        self.changes.send_replace(());
    }

    /// Whether clients need tokens.
    pub fn is_closed(&self) -> bool {
        self.has_provider || !self.fixed.is_empty() || self.named().closed
    }

    /// Admits or refuses a request; returns its caller.
    ///
    /// # Errors
    /// 401 without a valid token or session, 403 for foreign hosts and pages.
    pub fn check(&self, method: &Method, headers: &HeaderMap, now: Time) -> Result<Caller, Problem> {
        self.check_origin(headers)?;
        let by_cookie = token_of(headers).is_none() && !self.is_of_allowed_page(headers);
        let cookie = if by_cookie { session_secret(headers) } else { None };
        if let Some(caller) = cookie.and_then(|secret| self.signed_in(&hash_of(secret), now)) {
            let changes = !matches!(*method, Method::GET | Method::HEAD | Method::OPTIONS);
            if (changes || headers.contains_key(header::UPGRADE)) && !says_own_page(headers) {
                let detail = "with a session, pages of this server may change something and open feeds, and browsers \
                              say which page asks; other clients send a token";
                let detail = requests::malformed(detail);
                return Err(Problem::new(StatusCode::FORBIDDEN, "foreign", "Origin not allowed", detail));
            }
            return Ok(caller);
        }
        match token_of(headers).map(|token| self.holder(&hash_of(token), now)) {
            Some(Some(caller)) => return Ok(caller),
            None if !self.is_closed() => return Ok(Caller::this_machine()),
            // If there are named tokens, a wrong token is refused even where none is needed, so that its owner notices.
            Some(None) if !self.is_closed() && self.named().all.is_empty() => {
                return Ok(Caller::this_machine());
            }
            _ => {}
        }
        let detail = requests::token_needed();
        let problem = Problem::new(StatusCode::UNAUTHORIZED, "unauthorized", "A token is needed", detail);
        Err(Problem { wrong_secret: self.wrong_door(headers, cookie), ..problem })
    }

    /// The way in which a refused request showed a wrong secret, if it showed one.
    fn wrong_door(&self, headers: &HeaderMap, cookie: Option<&str>) -> Option<SecretDoor> {
        if headers.contains_key(header::AUTHORIZATION) || token_of(headers).is_some() {
            return Some(SecretDoor::Token);
        }
        let hash = hash_of(cookie?);
        let named = self.named();
        let was_right = named.sessions.contains_key(&hash) || named.over.contains(&hash);
        (!was_right).then_some(SecretDoor::Cookie)
    }

    /// Wrong secrets that clients have shown.
    pub fn wrong_secrets(&self) -> &WrongSecrets {
        &self.wrong
    }

    /// The caller who signed in and got the cookie of this digest, if both the session and its token are valid.
    fn signed_in(&self, hash: &TokenHash, now: Time) -> Option<Caller> {
        match self.session(hash, now)?.holder {
            SessionHolder::Token(token) => Some(Caller { session: Some(*hash), ..self.holder(&token, now)? }),
            SessionHolder::Person { name, role } => Some(Caller::of_person(name, role, *hash)),
        }
    }

    /// A valid session; sessions of people are valid only while the settings name an identity provider.
    fn session(&self, hash: &TokenHash, now: Time) -> Option<WebSession> {
        let is_known =
            |session: &&WebSession| self.has_provider || matches!(session.holder, SessionHolder::Token(_));
        self.named().sessions.get(hash).filter(|s| now < s.expires).filter(is_known).cloned()
    }

    /// When the caller's session or token expires; nothing if neither does.
    pub fn end_of(&self, caller: &Caller, now: Time) -> Option<Time> {
        let session = caller.session.and_then(|hash| self.session(&hash, now)).map(|s| s.expires);
        let named = self.named();
        let token = named.all.iter().find(|t| Some(t.hash) == caller.key).and_then(|t| t.expires);
        session.into_iter().chain(token).min()
    }

    /// The caller with this token, if the token is valid.
    pub fn holder(&self, digest: &TokenHash, now: Time) -> Option<Caller> {
        let mut named = self.named();
        let known = self.fixed.iter().chain(named.all.iter().map(|t| &t.hash));
        // All digests are compared, whichever matches, so that the time reveals nothing.
        let found = known
            .zip(1u32..)
            .fold(0, |found, (hash, number)| u32::conditional_select(&found, &number, hash.ct_eq(digest)));
        let index = (found as usize).checked_sub(1)?;
        let Some(index) = index.checked_sub(self.fixed.len()) else {
            return Some(Caller::of_configuration(*digest));
        };
        let token = named.all[index].clone();
        if !token.holds(now) {
            return None;
        }
        named.used.insert(token.id, now);
        Some(token.caller())
    }

    /// Whether this caller, which was admitted before, would be admitted again.
    fn admits(&self, caller: &Caller, now: Time) -> bool {
        let signed_in = caller.session.is_none_or(|hash| self.session(&hash, now).is_some());
        match &caller.key {
            None if caller.session.is_some() => signed_in,
            None => !self.is_closed(),
            Some(key) => {
                let named = || self.named().all.iter().any(|t| t.hash == *key && t.holds(now));
                signed_in && (self.fixed.contains(key) || named())
            }
        }
    }

    /// Waits until the token or session of an admitted caller is no longer valid: it was revoked, rotated, signed
    /// out, or has expired.
    pub async fn ended(&self, caller: &Caller, now: &Now) {
        let mut changes = self.changes.subscribe();
        while self.admits(caller, now()) {
            _ = timeout(LOOK, changes.changed()).await;
        }
    }

    /// When named tokens were last used, by number, since the last call.
    pub fn take_used(&self) -> BTreeMap<i64, Time> {
        std::mem::take(&mut self.named().used)
    }

    fn named(&self) -> MutexGuard<'_, NamedTokens> {
        self.named.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Refuses pages of other sites, which might use a visitor's browser to reach this server.
    fn check_origin(&self, headers: &HeaderMap) -> Result<(), Problem> {
        let text = |name| headers.get(name).map(|v| v.to_str().unwrap_or("?"));
        let host = text(header::HOST).unwrap_or("");
        let forbid = |detail: String| {
            Problem::new(StatusCode::FORBIDDEN, "foreign", "Origin not allowed", requests::malformed(detail))
        };
        if !self.is_closed() && !is_loopback(host) {
            let detail = format!("without tokens this server answers at localhost only, not at \"{host}\"");
            return Err(forbid(detail));
        }
        let origin = text(header::ORIGIN);
        let is_own = |origin: &str| origin.split_once("://").is_some_and(|(_, site)| site == host);
        // Browsers name the origin of a request; without an origin, as for an image, they still send `sec-fetch-site`.
        let site = headers.get("sec-fetch-site").map(|v| v.to_str().unwrap_or("?"));
        let is_same = site.is_none_or(|site| matches!(site, "same-origin" | "none"));
        if origin.is_none_or(is_own) && is_same || self.is_of_allowed_page(headers) {
            return Ok(());
        }
        let page = origin.unwrap_or("another site");
        Err(forbid(format!(
            "a page of {page} may not use the server at {host}: the setting `allowed_origins` names those that may"
        )))
    }

    /// Whether the request is from a page of another site whose origin the settings allow.
    fn is_of_allowed_page(&self, headers: &HeaderMap) -> bool {
        let origin = headers.get(header::ORIGIN).and_then(|v| v.to_str().ok());
        origin.is_some_and(|origin| self.origins.iter().any(|allowed| allowed == origin))
    }
}

fn token_of(headers: &HeaderMap) -> Option<&str> {
    if let Some(value) = headers.get(header::AUTHORIZATION) {
        let (scheme, token) = value.to_str().ok()?.split_once(' ')?;
        return scheme.eq_ignore_ascii_case("bearer").then(|| token.trim());
    }
    let offered = headers.get(header::SEC_WEBSOCKET_PROTOCOL)?.to_str().ok()?;
    offered.split(',').find_map(|p| p.trim().strip_prefix(WS_BEARER))
}

/// Whether the browser says that the request is from a page of this server; contrary claims were refused before.
fn says_own_page(headers: &HeaderMap) -> bool {
    let site = headers.get("sec-fetch-site").and_then(|v| v.to_str().ok());
    headers.contains_key(header::ORIGIN) || site == Some("same-origin")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn check(gate: &Gate, pairs: &[(&'static str, &str)]) -> u16 {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.insert(*name, value.parse().unwrap());
        }
        gate.check(&Method::GET, &headers, Time(10)).map_or_else(|p| p.status, |_| 200)
    }

    #[test]
    fn an_open_gate_lets_this_machine_in_and_no_foreign_page() {
        let open = Gate::default();
        assert_eq!(check(&open, &[("host", "127.0.0.1:8080")]), 200);
        assert_eq!(check(&open, &[("host", "[::1]:8080")]), 200);
        assert_eq!(check(&open, &[("host", "localhost:8080"), ("origin", "http://localhost:8080")]), 200);
        assert_eq!(check(&open, &[("host", "localhost:8080"), ("origin", "http://evil.example")]), 403);
        let local = ("host", "localhost:8080");
        assert_eq!(
            check(&open, &[local, ("origin", "http://localhost:5173")]),
            403,
            "another page of this machine"
        );
        for (site, status) in [("same-origin", 200), ("none", 200), ("same-site", 403), ("cross-site", 403)] {
            assert_eq!(check(&open, &[local, ("sec-fetch-site", site)]), status, "{site}");
        }
        assert_eq!(check(&open, &[("host", "localhost:8080"), ("origin", "null")]), 403);
        assert_eq!(check(&open, &[("host", "evil.example")]), 403, "a name that was made to point here");
    }

    #[test]
    fn a_closed_gate_wants_one_of_its_tokens() {
        let gate = Gate::new(["alpha", "beta"]);
        assert_eq!(check(&gate, &[("host", "site:80")]), 401);
        assert_eq!(check(&gate, &[("host", "site:80"), ("authorization", "Bearer beta")]), 200);
        assert_eq!(check(&gate, &[("host", "site:80"), ("authorization", "Bearer gamma")]), 401);
        assert_eq!(check(&gate, &[("host", "site:80"), ("authorization", "Basic beta")]), 401);
        assert_eq!(check(&gate, &[("sec-websocket-protocol", "giveway, bearer.alpha")]), 200);
    }

    fn named(id: i64, token: &str, role: Role) -> NamedToken {
        NamedToken {
            id,
            name: format!("name-{id}"),
            role,
            subject: None,
            hash: hash_of(token),
            created: Time(1),
            expires: None,
            revoked: None,
            last_used: None,
        }
    }

    #[test]
    fn named_tokens_hold_until_they_expire_or_are_revoked() {
        let gate = Gate::new(["of-the-settings"]);
        let expired = NamedToken { expires: Some(Time(10)), ..named(2, "beta", Role::Viewer) };
        let revoked = NamedToken { revoked: Some(Time(2)), ..named(3, "gamma", Role::Viewer) };
        gate.learn(vec![named(1, "alpha", Role::Operator), expired, revoked], Time(10));
        for (token, status) in
            [("alpha", 200), ("beta", 401), ("gamma", 401), ("delta", 401), ("of-the-settings", 200)]
        {
            let header = format!("Bearer {token}");
            assert_eq!(check(&gate, &[("host", "site"), ("authorization", &header)]), status, "{token}");
        }
        let mut headers = HeaderMap::new();
        headers.insert("authorization", "Bearer alpha".parse().unwrap());
        let caller = gate.check(&Method::GET, &headers, Time(10)).unwrap();
        assert_eq!((caller.name.as_str(), caller.role), ("name-1", Role::Operator));
        assert_eq!(
            gate.take_used(),
            BTreeMap::from([(1, Time(10))]),
            "those that did not hold were not used"
        );
    }

    #[test]
    fn a_session_stands_for_its_token_and_changes_things_for_own_pages_alone() {
        let gate = Gate::new(["of-the-settings"]);
        let of = |secret: &str, token: &str, expires| WebSession {
            hash: hash_of(secret),
            holder: SessionHolder::Token(hash_of(token)),
            created: Time(1),
            expires: Time(expires),
        };
        gate.learn(vec![named(1, "alpha", Role::Operator)], Time(10));
        gate.learn_sessions(vec![of("one", "alpha", 99), of("two", "alpha", 10), of("three", "gone", 99)]);
        let ask = |method: Method, secret: &str, more: &[(&'static str, &str)]| {
            let mut headers = HeaderMap::new();
            headers.insert("host", "site".parse().unwrap());
            headers.insert("cookie", format!("giveway_session={secret}").parse().unwrap());
            more.iter().for_each(|(name, value)| _ = headers.insert(*name, value.parse().unwrap()));
            gate.check(&method, &headers, Time(10))
                .map_or_else(|p| p.status, |c| if c.session.is_some() { 200 } else { 0 })
        };
        for (secret, status) in [("one", 200), ("two", 401), ("three", 401), ("", 401)] {
            assert_eq!(ask(Method::GET, secret, &[]), status, "{secret}");
        }
        let (own, foreign) = (("origin", "https://site"), ("origin", "https://evil.example"));
        let (same, cross) = (("sec-fetch-site", "same-origin"), ("sec-fetch-site", "cross-site"));
        let upgrade = ("upgrade", "websocket");
        for (method, more, status) in [
            (Method::POST, &[][..], 403),
            (Method::POST, &[own], 200),
            (Method::POST, &[same], 200),
            (Method::POST, &[foreign], 403),
            (Method::DELETE, &[("sec-fetch-site", "none")], 403),
            (Method::GET, &[upgrade], 403),
            (Method::GET, &[upgrade, own], 200),
            (Method::GET, &[upgrade, foreign], 403),
            (Method::GET, &[cross], 403),
            (Method::POST, &[("authorization", "Bearer alpha")], 0),
        ] {
            assert_eq!(ask(method.clone(), "one", more), status, "{method} {more:?}");
        }
        gate.learn(vec![named(1, "rotated", Role::Operator)], Time(10));
        assert_eq!(ask(Method::GET, "one", &[]), 401, "with its token it is over");
    }

    #[test]
    fn a_session_of_a_person_holds_as_long_as_the_settings_name_a_provider() {
        let holder = SessionHolder::Person { name: "anna".into(), role: Role::Operator };
        let (hash, host) = (hash_of("one"), ("host", "site"));
        let session = WebSession { hash, holder, created: Time(1), expires: Time(99) };
        let cookie = ("cookie", "giveway_session=one");
        let with_provider = Gate::default().with_provider(true);
        assert!(with_provider.is_closed(), "who is not signed in is not let in");
        with_provider.learn_sessions(vec![session.clone()]);
        assert_eq!(check(&with_provider, &[host, cookie]), 200);
        assert_eq!(check(&with_provider, &[host]), 401);
        let anna = Caller::of_person("anna".into(), Role::Operator, hash);
        assert!(with_provider.admits(&anna, Time(98)) && !with_provider.admits(&anna, Time(99)));
        with_provider.learn_sessions(Vec::new());
        assert!(!with_provider.admits(&anna, Time(10)), "signed out");
        let without = Gate::new(["of-the-settings"]);
        without.learn_sessions(vec![session]);
        assert_eq!(check(&without, &[host, cookie]), 401);
    }

    #[test]
    fn pages_of_origins_that_the_settings_name_need_a_token_and_have_no_session() {
        let gate = Gate::new(["of-the-settings"]).with_origins(vec!["https://wms.example".into()]);
        let session = WebSession {
            hash: hash_of("one"),
            holder: SessionHolder::Token(hash_of("of-the-settings")),
            created: Time(1),
            expires: Time(99),
        };
        gate.learn_sessions(vec![session]);
        let (host, cross) = (("host", "site"), ("sec-fetch-site", "cross-site"));
        let allowed = ("origin", "https://wms.example");
        let token = ("authorization", "Bearer of-the-settings");
        let cookie = ("cookie", "giveway_session=one");
        assert_eq!(check(&gate, &[host, cross, allowed, token]), 200);
        assert_eq!(check(&gate, &[host, cross, allowed]), 401);
        assert_eq!(check(&gate, &[host, cross, allowed, cookie]), 401, "a session is for own pages alone");
        assert_eq!(check(&gate, &[host, cookie]), 200);
        for other in ["https://wms.example:8443", "http://wms.example", "https://wms.example.evil", "null"] {
            assert_eq!(check(&gate, &[host, cross, ("origin", other), token]), 403, "{other}");
        }
    }

    #[test]
    fn the_first_token_of_an_administrator_closes_an_open_gate_for_good() {
        let (gate, local) = (Gate::default(), ("host", "localhost:8080"));
        gate.learn(vec![named(1, "alpha", Role::Viewer)], Time(10));
        assert_eq!(check(&gate, &[local]), 200, "with a viewer alone nobody could make another token");
        gate.learn(vec![named(2, "beta", Role::Admin)], Time(10));
        assert_eq!(check(&gate, &[local]), 401);
        let revoked = NamedToken { revoked: Some(Time(9)), ..named(2, "beta", Role::Admin) };
        gate.learn(vec![revoked], Time(10));
        assert_eq!(check(&gate, &[local]), 401, "it does not open by itself");
    }

    #[tokio::test]
    async fn who_was_let_in_is_told_at_once_when_the_token_no_longer_holds() {
        let gate = Gate::default();
        gate.learn(vec![named(1, "alpha", Role::Admin)], Time(10));
        let caller = named(1, "alpha", Role::Admin).caller();
        let now: Now = Arc::new(|| Time(10));
        let ended = gate.ended(&caller, &now);
        tokio::pin!(ended);
        assert!(timeout(Duration::from_millis(20), &mut ended).await.is_err(), "it holds");
        gate.learn(Vec::new(), Time(10));
        timeout(Duration::from_millis(500), &mut ended).await.expect("at once");
    }
}
