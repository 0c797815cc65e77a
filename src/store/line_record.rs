//! The written form of order lines, with the changes of lines and their progress.
//!
//! Main types: [`OrderRecord`], [`LineChangeRecord`], [`LinesRecord`]. Refuses: to know of jobs.

use giveway_cell::{LineChange, LineProgress, LineState, Lines, OrderLine, PickedBy};
use giveway_floor::warehouse::{SlotName, SlotNameError};
use serde::{Deserialize, Serialize};

#[derive(Clone, Serialize, Deserialize)]
pub(super) struct OrderRecord {
    slot: SlotRecord,
    quantity: u32,
    tote: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    item: Option<String>,
    by: PickedByRecord,
}

/// The written form of a slot's name.
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
struct SlotRecord(SlotName);

impl From<SlotRecord> for String {
    fn from(SlotRecord(slot): SlotRecord) -> String {
        slot.to_string()
    }
}

impl TryFrom<String> for SlotRecord {
    type Error = SlotNameError;

    fn try_from(text: String) -> Result<SlotRecord, SlotNameError> {
        text.parse().map(SlotRecord)
    }
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum PickedByRecord {
    Hand,
    Arm,
    Either,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum LineChangeRecord {
    Done(u32),
    Short,
    Undo,
    ToArm,
    ToHand,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LineStateRecord {
    Open,
    Lit,
    Done,
    Short,
    Undone,
    Arm,
}

/// A line, its state, and its pieces in the tote.
type ProgressRecord = (OrderRecord, LineStateRecord, u32);

/// The lines of one visit with their progress; a list of them is also a column of the `jobs` table. Lines that
/// contradict themselves are not read.
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "Vec<ProgressRecord>", into = "Vec<ProgressRecord>")]
pub(super) struct LinesRecord(pub Lines);

impl From<LinesRecord> for Vec<ProgressRecord> {
    fn from(LinesRecord(lines): LinesRecord) -> Vec<ProgressRecord> {
        lines.all().iter().map(|p| ((&p.line).into(), p.state.into(), p.pieces)).collect()
    }
}

impl TryFrom<Vec<ProgressRecord>> for LinesRecord {
    type Error = &'static str;

    fn try_from(rows: Vec<ProgressRecord>) -> Result<LinesRecord, &'static str> {
        let progress = |(line, state, pieces): ProgressRecord| LineProgress {
            line: line.into(),
            state: state.into(),
            pieces,
        };
        let lines = Lines::restore(rows.into_iter().map(progress).collect());
        lines.map(LinesRecord).ok_or("the lines of a visit contradict themselves")
    }
}

impl From<&OrderLine> for OrderRecord {
    fn from(line: &OrderLine) -> OrderRecord {
        let by = match line.by {
            PickedBy::Hand => PickedByRecord::Hand,
            PickedBy::Arm => PickedByRecord::Arm,
            PickedBy::Either => PickedByRecord::Either,
        };
        let slot = SlotRecord(line.slot);
        OrderRecord { slot, quantity: line.quantity, tote: line.tote.clone(), item: line.item.clone(), by }
    }
}

impl From<OrderRecord> for OrderLine {
    fn from(record: OrderRecord) -> OrderLine {
        let OrderRecord { slot: SlotRecord(slot), quantity, tote, item, by } = record;
        let by = match by {
            PickedByRecord::Hand => PickedBy::Hand,
            PickedByRecord::Arm => PickedBy::Arm,
            PickedByRecord::Either => PickedBy::Either,
        };
        OrderLine { slot, quantity, tote, item, by }
    }
}

impl From<LineChange> for LineChangeRecord {
    fn from(change: LineChange) -> LineChangeRecord {
        match change {
            LineChange::Done(pieces) => LineChangeRecord::Done(pieces),
            LineChange::Short => LineChangeRecord::Short,
            LineChange::Undo => LineChangeRecord::Undo,
            LineChange::ToArm => LineChangeRecord::ToArm,
            LineChange::ToHand => LineChangeRecord::ToHand,
        }
    }
}

impl From<LineChangeRecord> for LineChange {
    fn from(record: LineChangeRecord) -> LineChange {
        match record {
            LineChangeRecord::Done(pieces) => LineChange::Done(pieces),
            LineChangeRecord::Short => LineChange::Short,
            LineChangeRecord::Undo => LineChange::Undo,
            LineChangeRecord::ToArm => LineChange::ToArm,
            LineChangeRecord::ToHand => LineChange::ToHand,
        }
    }
}

impl From<LineState> for LineStateRecord {
    fn from(state: LineState) -> LineStateRecord {
        match state {
            LineState::Open => LineStateRecord::Open,
            LineState::Lit => LineStateRecord::Lit,
            LineState::Done => LineStateRecord::Done,
            LineState::Short => LineStateRecord::Short,
            LineState::Undone => LineStateRecord::Undone,
            LineState::Arm => LineStateRecord::Arm,
        }
    }
}

impl From<LineStateRecord> for LineState {
    fn from(record: LineStateRecord) -> LineState {
        match record {
            LineStateRecord::Open => LineState::Open,
            LineStateRecord::Lit => LineState::Lit,
            LineStateRecord::Done => LineState::Done,
            LineStateRecord::Short => LineState::Short,
            LineStateRecord::Undone => LineState::Undone,
            LineStateRecord::Arm => LineState::Arm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines() -> Lines {
        let line = |slot: &str, quantity| OrderLine {
            slot: slot.parse().unwrap(),
            quantity,
            tote: "B".into(),
            item: Some("screw".into()),
            by: PickedBy::Arm,
        };
        let mut lines = Lines::new([line("C3", 2), line("A1", 1), line("B2", 4)]);
        lines.change(0, LineChange::Short).unwrap();
        lines.change(1, LineChange::Done(1)).unwrap();
        lines.change(1, LineChange::Undo).unwrap();
        lines.change(2, LineChange::ToHand).unwrap();
        lines
    }

    #[test]
    fn lines_are_read_as_they_were_written() {
        let text = serde_json::to_string(&LinesRecord(lines())).unwrap();
        assert_eq!(serde_json::from_str::<LinesRecord>(&text).unwrap().0, lines());
    }

    #[test]
    fn lines_that_contradict_themselves_are_not_read() {
        let text = serde_json::to_string(&LinesRecord(lines())).unwrap();
        for (sound, broken) in
            [("\"lit\"", "\"open\""), ("\"open\"", "\"lit\""), ("\"open\",0", "\"open\",9")]
        {
            let broken = text.replacen(sound, broken, 1);
            assert!(broken != text && serde_json::from_str::<LinesRecord>(&broken).is_err(), "{broken}");
        }
    }
}
