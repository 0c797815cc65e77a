//! Requests about the floor: areas that robots and people keep out of, once or again and again, and evacuations.
//!
//! Refuses: to plan; what is asked for becomes a fact or a refusal.

use crate::requests::intake::Intake;
use crate::state::fact::{AreaFact, FloorFact};
use crate::state::recurring::RecurringClosure;
use crate::state::refusal::{AreaRefusal, Bounded, Refusal};
use crate::state::request::{Answer, Answered};
use crate::state::worker::Closure;
use giveway_floor::id::{ClosureId, SeriesId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;

impl Intake<'_> {
    /// Checks that an area can be closed.
    fn check_area(&self, area: &Closure) -> Result<(), Refusal> {
        if area.outline.len() < 3 || area.window.start() >= area.window.end() {
            return Err(Refusal::Area(AreaRefusal::Empty));
        }
        if area.outline.len() > self.writer.settings.limits.corners {
            return Err(Refusal::Area(AreaRefusal::TooManyCorners(self.writer.settings.limits.corners)));
        }
        if area.nodes.iter().any(|n| self.writer.warehouse().nodes.get(*n).is_none()) {
            return Err(Refusal::UnknownPlace);
        }
        Ok(())
    }

    pub(super) fn close(&mut self, area: Closure) -> Answered {
        self.check_area(&area)?;
        if self.writer.ledger().closures.len() >= self.writer.settings.limits.closures {
            return Err(Refusal::TooMany(Bounded::Closures, self.writer.ledger().closures.len()));
        }
        let closure = ClosureId(self.writer.ledger().next_closure);
        self.writer.record(AreaFact::Closed { closure, area });
        Ok(Answer::Closure(closure))
    }

    pub(super) fn reopen(&mut self, closure: ClosureId, now: Time) -> Answered {
        if !self.writer.ledger().closures.contains_key(&closure) {
            return Err(Refusal::Area(AreaRefusal::UnknownClosure(closure)));
        }
        self.writer.record(AreaFact::Reopened { closure, at: now });
        Ok(Answer::Done)
    }

    pub(super) fn recur(&mut self, closure: RecurringClosure) -> Answered {
        self.check_area(&closure.area)?;
        if !closure.can_be() {
            return Err(Refusal::Area(AreaRefusal::Recurrence));
        }
        let ledger = &self.writer.ledger();
        if ledger.recurring.len() >= self.writer.settings.limits.recurring_closures {
            return Err(Refusal::TooMany(Bounded::Series, ledger.recurring.len()));
        }
        let series = SeriesId(ledger.next_series);
        let area = Closure { series: Some(series), ..closure.area };
        self.writer.record(AreaFact::Recurs { series, closure: RecurringClosure { area, ..closure } });
        Ok(Answer::Series(series))
    }

    /// Ends a recurring closure, and its occurrences that are announced or in force.
    pub(super) fn end_series(&mut self, series: SeriesId, now: Time) -> Answered {
        if !self.writer.ledger().recurring.contains_key(&series) {
            return Err(Refusal::Area(AreaRefusal::UnknownSeries(series)));
        }
        let closures = self.writer.ledger().closures.iter();
        let open = closures.filter(|(_, c)| c.series == Some(series) && now < c.window.end());
        let open: Vec<ClosureId> = open.map(|(id, _)| *id).collect();
        self.writer.record(AreaFact::SeriesEnded { series, at: now });
        open.into_iter().for_each(|closure| self.writer.record(AreaFact::Reopened { closure, at: now }));
        Ok(Answer::Done)
    }

    /// Begins an evacuation; asked for again, it changes nothing.
    pub(super) fn evacuate(&mut self, now: Time) -> Answered {
        if self.writer.warehouse().nodes_where(|k| k == NodeKind::Exit).is_empty() {
            return Err(Refusal::Area(AreaRefusal::NoExits));
        }
        if self.writer.ledger().evacuation.is_none() {
            self.writer.record(FloorFact::Evacuated { at: now });
        }
        Ok(Answer::Done)
    }

    pub(super) fn end_evacuation(&mut self, now: Time) -> Answered {
        if self.writer.ledger().evacuation.is_some() {
            self.writer.record(FloorFact::EvacuationEnded { at: now });
        }
        Ok(Answer::Done)
    }
}
