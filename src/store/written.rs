//! How values are written: identifiers and times as numbers, the rest as records.
//!
//! Main trait: [`Written`]. Refuses: to know which fields a fact has.

use super::body_record::RobotKindRecord;
use super::job_record::{ChoiceRecord, KindRecord, RequestRecord, StateRecord, TaskRecord};
use super::line_record::LineChangeRecord;
use super::note_record::NoteRecord;
use super::people_record::{
    AssignmentRecord, AssignmentStateRecord, ClosureRecord, EncounterRecord, LastPlaceRecord, MoverRecord,
    ReactionRecord, RecurringRecord,
};
use super::route_record::{BookingRecord, KeptRecord, MovedRecord};
use giveway_cell::LineChange;
use giveway_fleet::{
    AssignmentRequest, AssignmentState, Booking, Closure, Encounter, FloorNote, JobKind, JobRequest,
    JobState, KeptRoute, LastPlace, Moved, Reaction, RecurringClosure, RobotChoice, RobotKind, Task,
};
use giveway_floor::id::{
    AssignmentId, ClosureId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_floor::time::Time;
use giveway_people::human::Mover;

/// A value that has a form in the journal.
pub(super) trait Written: Sized {
    /// The type that serde writes and reads.
    type Form;
    /// The value in that form.
    fn write(&self) -> Self::Form;
    /// The value from that form.
    fn read(form: Self::Form) -> Self;
}

/// Implements the form of values that are a number.
macro_rules! as_numbers {
    ($($type:ident: $number:ty),*) => {
        $(impl Written for $type {
            type Form = $number;
            fn write(&self) -> $number {
                self.0
            }
            fn read(form: $number) -> $type {
                $type(form)
            }
        })*
    };
}

as_numbers!(RobotId: u32, NodeId: u32, RackId: u32, StationId: u32, WorkerId: u32, Time: i64);
as_numbers!(JobId: u64, AssignmentId: u64, ClosureId: u64, SeriesId: u64);

/// Implements the form of values that serde writes as they are.
macro_rules! as_they_are {
    ($($type:ty),*) => {
        $(impl Written for $type {
            type Form = $type;
            fn write(&self) -> $type {
                self.clone()
            }
            fn read(form: $type) -> $type {
                form
            }
        })*
    };
}

as_they_are!(u8, u64, usize, String);

/// Implements the form of values with a record, made from the value itself or from a reference to it.
macro_rules! as_records {
    ($($type:ty: $record:ty = $from:expr),* $(,)?) => {
        $(impl Written for $type {
            type Form = $record;
            fn write(&self) -> $record {
                let from: fn(&$type) -> $record = $from;
                from(self)
            }
            fn read(form: $record) -> $type {
                form.into()
            }
        })*
    };
}

as_records!(
    AssignmentRequest: AssignmentRecord = |it| it.into(),
    AssignmentState: AssignmentStateRecord = |it| (*it).into(),
    Booking: BookingRecord = |it| it.into(),
    Closure: ClosureRecord = |it| it.into(),
    Encounter: EncounterRecord = |it| it.into(),
    FloorNote: NoteRecord = |it| it.into(),
    JobKind: KindRecord = |it| (*it).into(),
    JobRequest: RequestRecord = |it| it.into(),
    JobState: StateRecord = |it| (*it).into(),
    KeptRoute: KeptRecord = |it| it.into(),
    LastPlace: LastPlaceRecord = |it| (*it).into(),
    LineChange: LineChangeRecord = |it| (*it).into(),
    Moved: MovedRecord = |it| it.into(),
    Mover: MoverRecord = |it| (*it).into(),
    Reaction: ReactionRecord = |it| (*it).into(),
    RecurringClosure: RecurringRecord = |it| it.into(),
    RobotChoice: ChoiceRecord = |it| (*it).into(),
    RobotKind: RobotKindRecord = |it| it.into(),
    Task: TaskRecord = |it| (*it).into(),
);

impl<T: Written> Written for Option<T> {
    type Form = Option<T::Form>;
    fn write(&self) -> Self::Form {
        self.as_ref().map(T::write)
    }
    fn read(form: Self::Form) -> Self {
        form.map(T::read)
    }
}

impl<T: Written> Written for Box<T> {
    type Form = T::Form;
    fn write(&self) -> Self::Form {
        T::write(self)
    }
    fn read(form: Self::Form) -> Self {
        Box::new(T::read(form))
    }
}

impl<T: Written> Written for Vec<T> {
    type Form = Vec<T::Form>;
    fn write(&self) -> Self::Form {
        self.iter().map(T::write).collect()
    }
    fn read(form: Self::Form) -> Self {
        form.into_iter().map(T::read).collect()
    }
}

impl<A: Written, B: Written> Written for (A, B) {
    type Form = (A::Form, B::Form);
    fn write(&self) -> Self::Form {
        (self.0.write(), self.1.write())
    }
    fn read(form: Self::Form) -> Self {
        (A::read(form.0), B::read(form.1))
    }
}
