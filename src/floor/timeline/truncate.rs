//! Truncation: holders lose visits that were promised but not granted.
//!
//! Main functions: [`Timeline::truncation`] computes what stays, [`Timeline::keep`] keeps only that;
//! [`Timeline::place`] is for a holder that stands somewhere else. Refuses: to take back granted visits.

use super::{Chain, Shift, Timeline, Visit};
use crate::id::RobotId;
use crate::time::Time;

/// What a holder keeps: one past the last visit that stays, and the visits that have new times.
pub type KeptVisits<'a> = (RobotId, u64, &'a [Shift]);

impl Timeline {
    /// What stays if these holders lose the visits that were not granted to them: they keep their last granted visit
    /// for ever, and holders with a true `stuck` flag keep every granted visit for ever. Nothing is changed.
    pub fn truncation(&self, holders: &[(RobotId, bool)]) -> Vec<(RobotId, u64, Vec<Shift>)> {
        let kept = |&(holder, stuck): &(RobotId, bool)| {
            let chain = &self.chains[&holder];
            let shifts = (chain.first..chain.granted).filter_map(|serial| {
                let visit = chain.get(serial).expect("what is granted is held");
                let old = Shift::of(serial, visit);
                let mut shift = old;
                if serial + 1 == chain.granted {
                    (shift.depart, shift.leave) = (Time::MAX, Time::MAX);
                }
                if stuck {
                    shift.leave = Time::MAX;
                }
                (shift != old).then_some(shift)
            });
            (holder, chain.granted, shifts.collect())
        };
        holders.iter().map(kept).collect()
    }

    /// Keeps exactly the given visits and drops the rest of these holders' visits.
    ///
    /// # Panics
    /// If granted visits would be lost, the last visit would end, or another holder holds any of that later: then the
    /// code that computed this, or the record of it, is broken (see [`Timeline::after`]).
    pub fn keep(&mut self, kept: &[KeptVisits<'_>]) {
        for &(holder, end, _) in kept {
            let chain = self.chains.get(&holder).expect("only holders lose what they hold");
            let fits = chain.granted <= end && end <= chain.end() && chain.first < end;
            assert!(fits, "{holder:?} keeps what it was granted");
            self.take_from(holder, end);
        }
        for &(holder, end, shifts) in kept {
            let first = self.chains[&holder].first;
            let mut visits = self.take_from(holder, first);
            for shift in shifts {
                assert!((first..end).contains(&shift.serial), "{holder:?} keeps no visit {}", shift.serial);
                shift.apply(&mut visits[(shift.serial - first) as usize]);
            }
            let last = visits.last().expect("at least one stays");
            assert!(last.leave.is_forever() && last.depart.is_forever(), "{holder:?} must stay somewhere");
            assert_eq!(self.check(holder, &visits), Ok(()), "{holder:?} cannot stay where others want to be");
            self.put(holder, visits);
            self.assert_in_order(holder);
        }
    }

    /// Places a holder that stands somewhere else: it holds that visit alone, with this serial number, and others keep
    /// what `kept` says.
    ///
    /// # Panics
    /// If the number is not later than all earlier numbers of the holder, or another holder holds the place after that.
    pub fn place(&mut self, holder: RobotId, serial: u64, visit: Visit, kept: &[KeptVisits<'_>]) {
        let end = self.chains.get(&holder).expect("only holders stand elsewhere").end();
        assert!(end <= serial, "{holder:?} had the visit {serial} before");
        self.remove(holder);
        self.keep(kept);
        assert_eq!(
            self.check(holder, std::slice::from_ref(&visit)),
            Ok(()),
            "{holder:?} stands where others are"
        );
        self.chains.insert(holder, Chain { first: serial, granted: serial + 1, ..Chain::default() });
        self.put(holder, [visit]);
    }
}
