//! Callers, their roles, and what is known of tokens.
//!
//! Main types: [`Caller`], [`Role`], [`NamedToken`], [`WebSession`]. Refuses: to decide what a role may do.

use giveway_fleet::ClientKey;
use giveway_floor::id::CustomerId;
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use utoipa::ToSchema;

/// The digest of a token.
pub type TokenHash = [u8; 32];

/// The role of a caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// May read.
    Viewer,
    /// May read and run the floor: halts, releases, closures, alarms, maintenance, lost people, jobs and tasks.
    Operator,
    /// May read and order: jobs and assignments.
    Integrator,
    /// Speaks for one worker or robot.
    Device,
    /// May do everything.
    Admin,
}

impl Role {
    /// All roles.
    pub const ALL: [Role; 5] = [Role::Viewer, Role::Operator, Role::Integrator, Role::Device, Role::Admin];

    /// The word for the role on the wire.
    pub fn word(self) -> &'static str {
        match self {
            Role::Viewer => "viewer",
            Role::Operator => "operator",
            Role::Integrator => "integrator",
            Role::Device => "device",
            Role::Admin => "admin",
        }
    }

    /// The role of this word.
    pub fn of_word(word: &str) -> Option<Role> {
        Role::ALL.into_iter().find(|role| role.word() == word)
    }
}

/// The sender of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caller {
    /// The name of the token; `configuration` for tokens of the settings, `this machine` if no token is needed.
    pub name: String,
    /// The caller's role.
    pub role: Role,
    /// The worker or robot for which a device speaks, as in paths: `w1`, `robot-2`.
    pub subject: Option<String>,
    /// The digest of the caller's token; nothing if none is needed.
    pub key: Option<TokenHash>,
    /// The digest of the caller's session; nothing if the caller shows the token itself, or needs none.
    pub session: Option<TokenHash>,
}

/// A browser that is signed in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WebSession {
    /// SHA-256 of the cookie's secret.
    pub hash: TokenHash,
    /// The holder for whom the cookie stands.
    pub holder: SessionHolder,
    /// When the person signed in.
    pub created: Time,
    /// When the session expires.
    pub expires: Time,
}

/// The holder of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SessionHolder {
    /// The holder of the token with this digest, as long as that token is valid.
    Token(TokenHash),
    /// A person whom the identity provider named.
    Person {
        /// The person's name.
        name: String,
        /// The role that the person's groups at the provider give.
        role: Role,
    },
}

impl Caller {
    /// Names that no token may have, since callers without a named token have them.
    pub const RESERVED: [&'static str; 4] = ["configuration", "this machine", "command line", "anonymous"];

    /// The caller on a server that needs no token.
    pub fn this_machine() -> Caller {
        Caller { name: "this machine".into(), role: Role::Admin, subject: None, key: None, session: None }
    }

    /// The caller with a token of the settings.
    pub fn of_configuration(key: TokenHash) -> Caller {
        let key = Some(key);
        Caller { name: "configuration".into(), role: Role::Admin, subject: None, key, session: None }
    }

    /// The person who signed in with an identity provider and got the cookie of this digest.
    pub fn of_person(name: String, role: Role, session: TokenHash) -> Caller {
        Caller { name, role, subject: None, key: None, session: Some(session) }
    }

    /// The owner of a caller's keys (`Idempotency-Key`): all callers with a token of this name share one, and so do all
    /// sessions of the person of this name who signed in with an identity provider. A person with the same name as a
    /// token is a different owner.
    pub fn account(&self) -> String {
        let is_person = self.key.is_none() && self.session.is_some();
        if is_person { format!("person:{}", self.name) } else { self.name.clone() }
    }

    /// An idempotency key of this caller. It contains a digest of the account, since keys are kept in the journal,
    /// which has no names of people.
    pub fn client_key(&self, text: String) -> ClientKey {
        let digest = Sha256::digest(self.account());
        let first = digest.first_chunk().expect("a digest has 32 bytes");
        ClientKey { owner: Some(CustomerId(u64::from_be_bytes(*first))), text }
    }

    /// A client without a token on a server that needs one: only routes that need no role are open to it.
    pub fn anonymous() -> Caller {
        Caller { name: "anonymous".into(), role: Role::Viewer, subject: None, key: None, session: None }
    }
}

/// A token with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedToken {
    /// The token's number.
    pub id: i64,
    /// The user of the token.
    pub name: String,
    /// The role of callers with this token.
    pub role: Role,
    /// The worker or robot for which the token speaks, as in paths: `w1`, `robot-2`.
    pub subject: Option<String>,
    /// SHA-256 of the token.
    pub hash: TokenHash,
    /// When the token was made, or rotated.
    pub created: Time,
    /// When the token expires.
    pub expires: Option<Time>,
    /// When the token was revoked.
    pub revoked: Option<Time>,
    /// When the token was last used, approximately.
    pub last_used: Option<Time>,
}

/// The most tokens that are valid at once.
pub const MOST_TOKENS: usize = 1_000;

impl NamedToken {
    /// Whether the token is valid now.
    pub fn holds(&self, now: Time) -> bool {
        self.revoked.is_none() && self.expires.is_none_or(|end| now < end)
    }

    /// The caller who shows this token.
    pub fn caller(&self) -> Caller {
        let (name, subject) = (self.name.clone(), self.subject.clone());
        Caller { name, role: self.role, subject, key: Some(self.hash), session: None }
    }
}
