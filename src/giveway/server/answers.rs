//! Answers to requests with an `Idempotency-Key` between API and store.
//!
//! Main type: [`AnswerKeeper`]. Only the process knows which requests are being carried out: after a restart, none are.
//! Refuses: to fail a request whose answer could not be kept; a repeat is told that the outcome is unknown.

use giveway_api::{AnswerPort, KeptAnswer, KeyedRequest, KnownRequest, Later};
use giveway_floor::time::Time;
use giveway_store::{AnswerRow, Store, StoreError};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Keeps the answers to requests.
pub struct AnswerKeeper {
    store: Arc<Store>,
    running: Mutex<BTreeSet<KeyedRequest>>,
}

impl AnswerKeeper {
    /// A keeper with this store.
    pub fn new(store: Arc<Store>) -> AnswerKeeper {
        AnswerKeeper { store, running: Mutex::default() }
    }

    fn running(&self) -> MutexGuard<'_, BTreeSet<KeyedRequest>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    async fn look(
        &self,
        request: &KeyedRequest,
        digest: &str,
        now: Time,
    ) -> Result<KnownRequest, StoreError> {
        let known = self.store.begin_keyed(columns(request), digest, now).await?;
        Ok(match known {
            None => KnownRequest::New,
            Some(row) if row.digest != digest => KnownRequest::Other,
            Some(AnswerRow { answer: Some((status, location, body)), .. }) => {
                KnownRequest::Answered(KeptAnswer { status, location, body })
            }
            Some(_) => KnownRequest::Unknown,
        })
    }
}

impl AnswerPort for AnswerKeeper {
    fn begin(
        &self,
        request: KeyedRequest,
        digest: String,
        now: Time,
    ) -> Later<'_, Result<KnownRequest, String>> {
        Box::pin(async move {
            if !self.running().insert(request.clone()) {
                return Ok(KnownRequest::Running);
            }
            let known = self.look(&request, &digest, now).await.map_err(|e| e.to_string());
            if known != Ok(KnownRequest::New) {
                self.leave(&request);
            }
            known
        })
    }

    fn finish(&self, request: KeyedRequest, answer: KeptAnswer) -> Later<'_, ()> {
        Box::pin(async move {
            let KeptAnswer { status, location, body } = answer;
            if let Err(e) = self.store.finish_keyed(columns(&request), (status, location, body)).await {
                tracing::warn!("the answer to the key {} is not kept: {e}", request.key);
            }
            self.leave(&request);
        })
    }

    fn forget(&self, request: KeyedRequest) -> Later<'_, ()> {
        Box::pin(async move {
            if let Err(e) = self.store.forget_keyed(columns(&request)).await {
                tracing::warn!("the key {} is not free again: {e}", request.key);
            }
            self.leave(&request);
        })
    }

    fn leave(&self, request: &KeyedRequest) {
        self.running().remove(request);
    }
}

fn columns(request: &KeyedRequest) -> [&str; 3] {
    [&request.caller, &request.route, &request.key]
}
