//! Robot kinds that are added during operation, and removed again.
//!
//! Refuses: to change kinds of the site, and kinds that robots have, even robots that have left, since they may come
//! back. Whether the floor was drawn for a kind is checked before the request: that takes too long for a step.

use crate::requests::intake::Intake;
use crate::state::fact::FloorFact;
use crate::state::kind::RobotKind;
use crate::state::refusal::{Bounded, KindRefusal, Refusal};
use crate::state::request::{Answer, Answered, Made};
use giveway_floor::time::Time;
use giveway_floor::warehouse::MOST_BODIES;

impl Intake<'_> {
    /// Lets robots of a kind join. The same kind once more changes nothing.
    pub(super) fn put_kind(&mut self, kind: Box<RobotKind>, now: Time) -> Answered {
        let ledger = self.writer.ledger();
        let (kinds, name) = (ledger.kinds(), kind.name.clone());
        if kinds.is_of_site(&name) {
            return Err(Refusal::Kind(KindRefusal::OfSite));
        }
        let known = kinds.named(&name);
        if known.is_none() && kinds.len() >= MOST_BODIES {
            return Err(Refusal::TooMany(Bounded::Kinds, kinds.len()));
        }
        if kind.kinematics.clearance > ledger.timeline().clearance() {
            return Err(Refusal::Kind(KindRefusal::Clearance));
        }
        if ledger.warehouse().check_outlines(&kind.body()).is_err() {
            return Err(Refusal::Kind(KindRefusal::TooLarge));
        }
        let (new, same) = (known.is_none(), known == Some(&*kind));
        if !same {
            self.refuse_used(&name)?;
            self.writer.record(FloorFact::KindPut { kind, at: now });
        }
        Ok(Answer::Kind(Made { id: self.writer.warehouse().body_of(&name), new }))
    }

    /// Lets robots of an added kind no longer join.
    pub(super) fn remove_kind(&mut self, name: String, now: Time) -> Answered {
        let kinds = self.writer.ledger().kinds();
        if kinds.is_of_site(&name) {
            return Err(Refusal::Kind(KindRefusal::OfSite));
        }
        if kinds.named(&name).is_none() {
            return Err(Refusal::Kind(KindRefusal::Unknown));
        }
        self.refuse_used(&name)?;
        self.writer.record(FloorFact::KindRemoved { name, at: now });
        Ok(Answer::Done)
    }

    /// Refuses to change a kind that robots are of, or were when they left.
    fn refuse_used(&self, name: &str) -> Result<(), Refusal> {
        match self.writer.ledger().robots_of(name) {
            0 => Ok(()),
            robots => Err(Refusal::Kind(KindRefusal::InUse(robots))),
        }
    }
}
