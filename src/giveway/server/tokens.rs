//! Named tokens and sessions between database and gate: a change is in force before it is answered, and tokens that
//! another program writes are in force within a second.
//!
//! Main type: [`TokenKeeper`]. Refuses: roles that this version of Giveway does not know; such a token is invalid.

use giveway_api::{
    Alarms, Gate, Later, NamedToken, Now, Role, SessionHolder, TokenHash, TokenPort, WebSession,
};
use giveway_fleet::alarm::AlarmKind;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_store::{SessionRow, Store, StoreError, TokenDraft, TokenRow};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::task::JoinHandle;

/// How often the table is read.
const LOOK: Duration = Duration::from_secs(1);

/// The most addresses that the alarm about wrong secrets names.
const MOST_NAMED: usize = 5;

/// The times of tokens' last use are stored once in this many reads of the table.
const USES: u32 = 10;

/// Keeps tokens of a running server.
#[derive(Clone)]
pub struct TokenKeeper {
    store: Arc<Store>,
    gate: Arc<Gate>,
    alarms: Arc<Alarms>,
    now: Now,
}

/// The tokens of a database that is not open yet; empty if there is no database.
pub async fn tokens_of(database: &Path) -> Vec<NamedToken> {
    if !std::fs::metadata(database).is_ok_and(|m| m.is_file() && m.len() > 0) {
        return Vec::new();
    }
    let Ok(store) = Store::inspect(database).await else { return Vec::new() };
    let rows = store.tokens().all().await.unwrap_or_default();
    store.close().await;
    rows.into_iter().filter_map(known).collect()
}

/// A row as the gate needs it; nothing if its role is of another version of Giveway.
fn known(row: TokenRow) -> Option<NamedToken> {
    let TokenRow { id, name, role, subject, hash, created, expires, revoked, last_used } = row;
    let (role, hash) = (Role::of_word(&role)?, hash.try_into().ok()?);
    Some(NamedToken { id, name, role, subject, hash, created, expires, revoked, last_used })
}

impl TokenKeeper {
    /// A keeper that keeps this gate in agreement with the database, and its task.
    pub async fn start(
        (store, alarms): (&Arc<Store>, &Arc<Alarms>),
        gate: &Arc<Gate>,
        now: Now,
    ) -> (TokenKeeper, JoinHandle<()>) {
        let keeper = TokenKeeper { store: store.clone(), gate: gate.clone(), alarms: alarms.clone(), now };
        if let Err(e) = keeper.learn_sessions().await {
            tracing::error!("sessions cannot be read, everybody has to sign in again: {e}");
        }
        let task = tokio::spawn(keeper.clone().run());
        (keeper, task)
    }

    /// Reads the table repeatedly, and stores when tokens were used.
    async fn run(self) {
        for look in 0u32.. {
            // If the database does not answer, the known tokens stay in force.
            if let Err(e) = self.learn().await {
                tracing::debug!("tokens cannot be read: {e}");
            }
            if look.is_multiple_of(USES)
                && let Err(e) = self.note_uses().await
            {
                tracing::debug!("it cannot be noted when tokens were used: {e}");
            }
            self.warn();
            tokio::time::sleep(LOOK).await;
        }
    }

    /// Raises or ends the alarm about addresses that show many wrong secrets.
    fn warn(&self) {
        let many = self.gate.wrong_secrets().alarming(Instant::now());
        let guesses = |(from, n): &(_, _)| sentence::address_guesses(format!("{from}"), *n);
        let mut said: Vec<Sentence> = many.iter().map(guesses).collect();
        let now = (self.now)();
        if said.is_empty() {
            self.alarms.clear(AlarmKind::SecretsGuessed, now);
        } else {
            let more = said.len().saturating_sub(MOST_NAMED);
            said.truncate(MOST_NAMED);
            let named = match more {
                0 => SentenceArg::from(said),
                more => sentence::and_more(said, more).into(),
            };
            self.alarms.raise(AlarmKind::SecretsGuessed, sentence::wrong_secrets(named), now);
        }
    }

    /// Puts the tokens in the database in force.
    async fn learn(&self) -> Result<(), StoreError> {
        let rows = self.store.tokens().all().await?;
        self.gate.learn(rows.into_iter().filter_map(known).collect(), (self.now)());
        Ok(())
    }

    /// Puts the sessions in the database in force.
    async fn learn_sessions(&self) -> Result<(), StoreError> {
        let rows = self.store.sessions().await?;
        let known = |row: SessionRow| {
            let SessionRow { hash, token, person, created, expires } = row;
            let holder = match person {
                Some((name, role)) => SessionHolder::Person { name, role: Role::of_word(&role)? },
                None => SessionHolder::Token(token.try_into().ok()?),
            };
            Some(WebSession { hash: hash.try_into().ok()?, holder, created, expires })
        };
        self.gate.learn_sessions(rows.into_iter().filter_map(known).collect());
        Ok(())
    }

    async fn note_uses(&self) -> Result<(), StoreError> {
        for (id, at) in self.gate.take_used() {
            self.store.tokens().note_use(id, at).await?;
        }
        Ok(())
    }

    /// Writes while the files are still the database, then puts the result in force.
    async fn change<T>(&self, write: impl Future<Output = Result<T, StoreError>>) -> Result<T, String> {
        let written = async {
            self.store.check_place()?;
            let written = write.await?;
            self.store.check_place()?;
            self.learn().await?;
            Ok(written)
        };
        written.await.map_err(told)
    }

    async fn one(&self, id: i64) -> Result<Option<NamedToken>, String> {
        Ok(self.store.tokens().one(id).await.map_err(told)?.and_then(known))
    }
}

impl TokenPort for TokenKeeper {
    fn list(&self) -> Later<'_, Result<Vec<NamedToken>, String>> {
        Box::pin(async {
            let rows = self.store.tokens().all().await.map_err(told)?;
            Ok(rows.into_iter().filter_map(known).collect())
        })
    }

    fn add(&self, new: NamedToken) -> Later<'_, Result<Option<NamedToken>, String>> {
        Box::pin(async move {
            let NamedToken { name, role, subject, hash, created, expires, .. } = new;
            let draft = TokenDraft { name, role: role.word().into(), subject, hash, created, expires };
            match self.change(self.store.tokens().add(&draft)).await? {
                Some(id) => self.one(id).await,
                None => Ok(None),
            }
        })
    }

    fn revoke(&self, id: i64) -> Later<'_, Result<bool, String>> {
        Box::pin(async move { self.change(self.store.tokens().revoke(id, (self.now)())).await })
    }

    fn rotate(&self, id: i64, hash: TokenHash) -> Later<'_, Result<Option<NamedToken>, String>> {
        Box::pin(async move {
            let rotated = self.change(self.store.tokens().rotate(id, hash, (self.now)())).await?;
            if rotated { self.one(id).await } else { Ok(None) }
        })
    }

    fn sign_in(&self, session: WebSession) -> Later<'_, Result<(), String>> {
        Box::pin(async move {
            let WebSession { hash, holder, created, expires } = session;
            let (token, person) = match holder {
                SessionHolder::Token(token) => (token.into(), None),
                SessionHolder::Person { name, role } => (Vec::new(), Some((name, role.word().into()))),
            };
            let row = SessionRow { hash: hash.into(), token, person, created, expires };
            self.change(self.store.add_session(&row)).await?;
            self.learn_sessions().await.map_err(told)
        })
    }

    fn sign_out(&self, hash: TokenHash) -> Later<'_, Result<(), String>> {
        Box::pin(async move {
            self.change(self.store.end_session(&hash)).await?;
            self.learn_sessions().await.map_err(told)
        })
    }
}

/// Logs the failure, once; the client only learns that the database failed.
fn told(e: StoreError) -> String {
    tracing::error!("tokens: {e}");
    "the database does not answer, or takes nothing; the server's log says why".into()
}
