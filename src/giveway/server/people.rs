//! Names of people between database and API.
//!
//! Main function: [`pseudonyms`]. Refuses: to write a name into the log.

use giveway_api::{Later, NamedPerson, Now, PersonPort, Pseudonyms, Role};
use giveway_floor::id::WorkerId;
use giveway_store::{PersonRow, Store, StoreError};
use std::sync::Arc;

/// Keeps names in the database of a running server.
struct PersonKeeper {
    store: Arc<Store>,
    now: Now,
}

/// The people of a database; these roles may see their names.
///
/// # Errors
/// If the database does not answer.
pub async fn pseudonyms(
    store: &Arc<Store>,
    now: &Now,
    names_for: Vec<Role>,
) -> Result<Pseudonyms, StoreError> {
    let known = |PersonRow { pseudonym, name, since }| NamedPerson { pseudonym, name, since };
    let people = store.people().await?.into_iter().map(known).collect();
    let keeper = PersonKeeper { store: store.clone(), now: now.clone() };
    Ok(Pseudonyms::new(people, names_for, Box::new(keeper)))
}

impl PersonPort for PersonKeeper {
    fn keep(&self, person: NamedPerson) -> Later<'_, Result<(), String>> {
        Box::pin(async move {
            let NamedPerson { pseudonym, name, since } = person;
            self.store.check_place().map_err(told)?;
            self.store.keep_name(&PersonRow { pseudonym, name, since }).await.map_err(told)?;
            self.store.check_place().map_err(told)
        })
    }

    fn erase(&self, pseudonym: String, worker: Option<WorkerId>) -> Later<'_, Result<(), String>> {
        Box::pin(async move {
            self.store.check_place().map_err(told)?;
            self.store.erase(&pseudonym, worker, (self.now)()).await.map_err(told)?;
            self.store.check_place().map_err(told)
        })
    }
}

/// Logs the failure, once; the client only learns that the database failed.
fn told(e: StoreError) -> String {
    tracing::error!("people: {e}");
    "the database does not answer, or takes nothing; the server's log says why".into()
}
