//! Names of people and their pseudonyms, which replace the names everywhere else: in the fleet and its journal, in
//! feeds, events, webhooks and recordings.
//!
//! Main types: [`Pseudonyms`], [`NamedPerson`]. Refuses: to give a pseudonym to a second person, even after the first
//! was erased.

use super::caller::{Caller, Role};
use crate::port::Later;
use crate::wire::text::worker_name;
use giveway_floor::id::WorkerId;
use giveway_floor::time::Time;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use uuid::Uuid;

/// A person with name and pseudonym.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedPerson {
    /// The pseudonym, by which everything else knows this person.
    pub pseudonym: String,
    /// The person's name.
    pub name: String,
    /// When the person was registered.
    pub since: Time,
}

/// Keeps names durably. Errors are texts for people.
pub trait PersonPort: Send + Sync {
    /// Keeps a person.
    fn keep(&self, person: NamedPerson) -> Later<'_, Result<(), String>>;
    /// Forgets a person, and removes the identity from all lists of this worker.
    fn erase(&self, pseudonym: String, worker: Option<WorkerId>) -> Later<'_, Result<(), String>>;
}

/// The people behind pseudonyms, and the roles that may see names.
#[derive(Default)]
pub struct Pseudonyms {
    people: Mutex<BTreeMap<String, NamedPerson>>,
    /// Roles that may see names.
    names_for: Vec<Role>,
    /// Absent if a recording is shown.
    port: Option<Box<dyn PersonPort>>,
    /// Serialises registrations, so that a name gets only one pseudonym.
    turn: tokio::sync::Mutex<()>,
}

impl Pseudonyms {
    /// Known people, with names visible to these roles.
    pub fn new(people: Vec<NamedPerson>, names_for: Vec<Role>, port: Box<dyn PersonPort>) -> Pseudonyms {
        let people = people.into_iter().map(|p| (p.pseudonym.clone(), p)).collect();
        Pseudonyms { people: Mutex::new(people), names_for, port: Some(port), turn: Default::default() }
    }

    /// The person behind a pseudonym.
    pub fn person(&self, pseudonym: &str) -> Option<NamedPerson> {
        self.people().get(pseudonym).cloned()
    }

    /// The pseudonym of a name.
    pub fn pseudonym_of(&self, name: &str) -> Option<String> {
        self.people().values().find(|p| p.name == name).map(|p| p.pseudonym.clone())
    }

    /// The name of a worker as a caller sees it: the real name if the role may see it or if it is the device's own
    /// worker.
    pub fn shown(&self, caller: &Caller, worker: WorkerId, pseudonym: &str) -> String {
        let own = caller.subject.as_deref() == Some(&worker_name(worker));
        let person = if own || self.names_for.contains(&caller.role) { self.person(pseudonym) } else { None };
        person.map_or_else(|| pseudonym.to_owned(), |p| p.name)
    }

    /// The pseudonym under which a person of this name is registered with the fleet, durable before this returns. A
    /// name that the fleet already has is used as it is: it is a pseudonym, or older than pseudonyms.
    ///
    /// # Errors
    /// If the name cannot be kept.
    pub async fn register(
        &self,
        name: &str,
        now: Time,
        is_taken: impl Fn(&str) -> bool,
    ) -> Result<String, String> {
        let _turn = self.turn.lock().await;
        if let Some(known) = self.pseudonym_of(name) {
            return Ok(known);
        }
        let Some(port) = self.port.as_ref().filter(|_| !is_taken(name)) else { return Ok(name.to_owned()) };
        let mut pseudonym = fresh(4);
        while is_taken(&pseudonym) || self.person(&pseudonym).is_some() {
            pseudonym = fresh(8);
        }
        let person = NamedPerson { pseudonym: pseudonym.clone(), name: name.to_owned(), since: now };
        port.keep(person.clone()).await?;
        self.people().insert(pseudonym.clone(), person);
        Ok(pseudonym)
    }

    /// Forgets the person behind a pseudonym, and removes the identity from all lists of this worker.
    ///
    /// # Errors
    /// If the erasure is not durable; the caller may try again.
    pub async fn erase(&self, pseudonym: &str, worker: Option<WorkerId>) -> Result<(), String> {
        let _turn = self.turn.lock().await;
        if let Some(port) = &self.port {
            port.erase(pseudonym.to_owned(), worker).await?;
        }
        self.people().remove(pseudonym);
        Ok(())
    }

    fn people(&self) -> MutexGuard<'_, BTreeMap<String, NamedPerson>> {
        self.people.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn fresh(digits: usize) -> String {
    format!("worker-{}", &Uuid::new_v4().simple().to_string()[..digits])
}
