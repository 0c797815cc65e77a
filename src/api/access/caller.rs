//! Who sends a request, what roles there are, and what is known of tokens.
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

/// What a caller may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Reads.
    Viewer,
    /// Reads, and runs the floor: halts, releases, closures, alarms, maintenance, people who were lost, jobs and tasks.
    Operator,
    /// Reads, and orders: jobs and assignments.
    Integrator,
    /// Speaks for one worker or robot.
    Device,
    /// Everything.
    Admin,
}

impl Role {
    /// All roles.
    pub const ALL: [Role; 5] = [Role::Viewer, Role::Operator, Role::Integrator, Role::Device, Role::Admin];

    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Role::Viewer => "viewer",
            Role::Operator => "operator",
            Role::Integrator => "integrator",
            Role::Device => "device",
            Role::Admin => "admin",
        }
    }

    /// The role of a word.
    pub fn of_word(word: &str) -> Option<Role> {
        Role::ALL.into_iter().find(|role| role.word() == word)
    }
}

/// Who sends a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caller {
    /// The name of the token; `configuration` for tokens of the settings, `this machine` where none is needed.
    pub name: String,
    /// What it may do.
    pub role: Role,
    /// The worker or robot that a device speaks for, as in paths: `w1`, `robot-2`.
    pub subject: Option<String>,
    /// The digest of its token; nothing where none is needed.
    pub key: Option<TokenHash>,
    /// The digest of the session through which it asks; nothing where it shows the token itself, or needs none.
    pub session: Option<TokenHash>,
}

/// A browser that is signed in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WebSession {
    /// SHA-256 of what the cookie says.
    pub hash: TokenHash,
    /// For whom the cookie stands.
    pub holder: SessionHolder,
    /// When somebody signed in.
    pub created: Time,
    /// When it ends.
    pub expires: Time,
}

/// For whom a session stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SessionHolder {
    /// Whoever has the token of this digest, as long as that holds.
    Token(TokenHash),
    /// Somebody whom the identity provider named.
    Person {
        /// The name.
        name: String,
        /// What the groups at the provider allow.
        role: Role,
    },
}

impl Caller {
    /// Names that no token may have, since they are those of callers without a named token.
    pub const RESERVED: [&'static str; 4] = ["configuration", "this machine", "command line", "anonymous"];

    /// Who talks to a server that needs no token.
    pub fn this_machine() -> Caller {
        Caller { name: "this machine".into(), role: Role::Admin, subject: None, key: None, session: None }
    }

    /// Who has a token of the settings.
    pub fn of_configuration(key: TokenHash) -> Caller {
        let key = Some(key);
        Caller { name: "configuration".into(), role: Role::Admin, subject: None, key, session: None }
    }

    /// Who signed in with an identity provider, and got the cookie of this digest.
    pub fn of_person(name: String, role: Role, session: TokenHash) -> Caller {
        Caller { name, role, subject: None, key: None, session: Some(session) }
    }

    /// Whose keys this caller's are (`Idempotency-Key`): those of everybody who shows a token of this name, or of the
    /// person of this name who signed in with an identity provider. A person who has the name of a token is another.
    pub fn account(&self) -> String {
        let is_person = self.key.is_none() && self.session.is_some();
        if is_person { format!("person:{}", self.name) } else { self.name.clone() }
    }

    /// A key of this caller. The account is a digest there, since keys are kept in the journal, which has no names of
    /// people.
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
    /// Its number.
    pub id: i64,
    /// Who uses it.
    pub name: String,
    /// What it may do.
    pub role: Role,
    /// The worker or robot that it speaks for, as in paths: `w1`, `robot-2`.
    pub subject: Option<String>,
    /// SHA-256 of it.
    pub hash: TokenHash,
    /// When it was made, or made anew.
    pub created: Time,
    /// From when on it no longer holds.
    pub expires: Option<Time>,
    /// When it was revoked.
    pub revoked: Option<Time>,
    /// About when it was used last.
    pub last_used: Option<Time>,
}

/// So many tokens hold at once.
pub const MOST_TOKENS: usize = 1_000;

impl NamedToken {
    /// Whether it lets anybody in now.
    pub fn holds(&self, now: Time) -> bool {
        self.revoked.is_none() && self.expires.is_none_or(|end| now < end)
    }

    /// Who shows it.
    pub fn caller(&self) -> Caller {
        let (name, subject) = (self.name.clone(), self.subject.clone());
        Caller { name, role: self.role, subject, key: Some(self.hash), session: None }
    }
}
