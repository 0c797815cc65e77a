//! Recorded reaches: five tables as text, checked line by line.
//!
//! Main types: [`PickTexts`], [`PickRecording`], [`RecordedReach`], [`GazeTrial`]. Millimetres and degrees become
//! metres and radians. Refuses: a table with a missing column, an invalid or impossible figure, a sample of an unknown
//! movement, and times that go back; the error names the table and the line.

use giveway_people::reach::{ArmPoint, ArmSample, ReachTarget};
use std::collections::BTreeMap;

/// The tables as text, one for each file.
#[derive(Clone, Debug, Default)]
pub struct PickTexts {
    /// Text of `moves.csv`.
    pub moves: String,
    /// Text of `samples.csv`.
    pub samples: String,
    /// Text of `targets.csv`.
    pub targets: String,
    /// Text of `slots.csv`.
    pub slots: String,
    /// Text of `gaze.csv`.
    pub gaze: String,
}

/// An error in a table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}, line {line}: {what}")]
pub struct PickDataError {
    /// Name of the file.
    pub file: &'static str,
    /// Number of the line, from 1.
    pub line: usize,
    /// What is wrong.
    pub what: String,
}

/// A place of the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedPlace {
    /// Name of the place.
    pub name: String,
    /// Position where people look for the place.
    pub look: ArmPoint,
    /// Position where finger tips end, relative to the shoulder at onset.
    pub hand: ArmPoint,
}

/// One movement from rest to a place.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedReach {
    /// Name of the movement.
    pub name: String,
    /// The person: an index into [`PickRecording::people`].
    pub person: usize,
    /// The place: an index into [`PickRecording::places`].
    pub place: usize,
    /// Index of the sample at the onset.
    pub onset: usize,
    /// Index of the sample at the arrival.
    pub arrival: usize,
    /// All samples in order of time.
    pub samples: Vec<ArmSample>,
}

/// Eyes and head at one instant, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeSample {
    /// Time, seconds; 0 at the end of the trial.
    pub at_s: f64,
    /// Yaw and pitch of the eye ray.
    pub eye: (f64, f64),
    /// Yaw and pitch of the head ray.
    pub head: (f64, f64),
}

/// One trial of the wearer whose eyes were recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct GazeTrial {
    /// Samples in order of time.
    pub samples: Vec<GazeSample>,
}

/// The content of all tables.
#[derive(Clone, Debug, PartialEq)]
pub struct PickRecording {
    /// People in the order of their first movement.
    pub people: Vec<String>,
    /// Places in the order of `targets.csv`.
    pub places: Vec<RecordedPlace>,
    /// Recorded movements.
    pub reaches: Vec<RecordedReach>,
    /// Trials of eyes and head.
    pub gaze: Vec<GazeTrial>,
}

/// Choice of candidate places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotChoice {
    /// Places whose name ends in 1: the nearest of each direction.
    Near,
    /// All places.
    All,
}

/// A table during reading.
struct TableReader<'a> {
    file: &'static str,
    columns: &'static [&'static str],
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
}

/// One line of a table.
struct TableRow<'a> {
    file: &'static str,
    line: usize,
    columns: &'static [&'static str],
    cells: Vec<&'a str>,
}

impl<'a> TableReader<'a> {
    fn new(
        file: &'static str,
        text: &'a str,
        columns: &'static [&'static str],
    ) -> Result<TableReader<'a>, PickDataError> {
        let mut lines = text.lines().enumerate();
        let head = lines.next().map_or("", |l| l.1.trim_end());
        if head != columns.join(",") {
            let what = format!("the columns must be {}", columns.join(","));
            return Err(PickDataError { file, line: 1, what });
        }
        Ok(TableReader { file, columns, lines })
    }

    fn next(&mut self) -> Option<Result<TableRow<'a>, PickDataError>> {
        let (i, text) = self.lines.find(|l| !l.1.trim().is_empty())?;
        let (file, line, columns) = (self.file, i + 1, self.columns);
        let cells: Vec<&str> = text.trim_end().split(',').collect();
        if cells.len() != columns.len() {
            let what = format!("{} figures for {} columns", cells.len(), columns.len());
            return Some(Err(PickDataError { file, line, what }));
        }
        Some(Ok(TableRow { file, line, columns, cells }))
    }
}

impl TableRow<'_> {
    fn error(&self, what: String) -> PickDataError {
        PickDataError { file: self.file, line: self.line, what }
    }

    /// A figure of at most this magnitude.
    fn figure(&self, column: usize, most: f64) -> Result<f64, PickDataError> {
        let cell = self.cells[column];
        let figure = cell.trim().parse::<f64>().ok().filter(|f| f.abs() <= most);
        figure.ok_or_else(|| {
            self.error(format!("{} is {cell:?}, not a figure from −{most} to {most}", self.columns[column]))
        })
    }

    /// Three figures as a position; `scale` converts them to metres.
    fn place(&self, first: usize, scale: f64) -> Result<ArmPoint, PickDataError> {
        let most = 20.0 / scale;
        let [x, y, z] = [0, 1, 2].map(|k| self.figure(first + k, most));
        Ok(ArmPoint::new(x? * scale, y? * scale, z? * scale))
    }
}

const MOVES: [&str; 5] = ["move", "person", "target", "onset_ms", "arrival_ms"];
const SAMPLES: [&str; 19] = [
    "move",
    "t_ms",
    "shoulder_x",
    "shoulder_y",
    "shoulder_z",
    "forearm_x",
    "forearm_y",
    "forearm_z",
    "hand_x",
    "hand_y",
    "hand_z",
    "finger_x",
    "finger_y",
    "finger_z",
    "head_x",
    "head_y",
    "head_z",
    "head_yaw",
    "head_pitch",
];
const PLACES: [&str; 4] = ["target", "x", "y", "z"];
const GAZE: [&str; 8] =
    ["trial", "t_ms", "eye_yaw", "eye_pitch", "head_yaw", "head_pitch", "target_yaw", "target_pitch"];
/// Longest recording, milliseconds.
const LONGEST_MS: f64 = 1e7;

impl PickRecording {
    /// Reads and checks all tables.
    pub fn parse(texts: &PickTexts) -> Result<PickRecording, PickDataError> {
        let places = places(texts)?;
        let (people, mut reaches, times) = moves(texts, &places)?;
        if reaches.is_empty() {
            let what = "there is no movement below the header".to_owned();
            return Err(PickDataError { file: "moves.csv", line: 1, what });
        }
        samples(texts, &mut reaches)?;
        for (reach, (line, onset_ms, arrival_ms)) in reaches.iter_mut().zip(times) {
            let error = |what: String| PickDataError { file: "moves.csv", line, what };
            let at = |ms: f64| reach.samples.iter().position(|s| (s.at_s * 1000.0 - ms).abs() < 1.0);
            let missing = |what: &str| error(format!("{} has no sample at its {what}", reach.name));
            let onset = at(onset_ms).ok_or_else(|| missing("onset"))?;
            let arrival = at(arrival_ms).ok_or_else(|| missing("arrival"))?;
            (reach.onset, reach.arrival) = (onset, arrival);
        }
        Ok(PickRecording { people, places, reaches, gaze: gaze(texts)? })
    }

    /// Indices of the candidate places.
    pub fn candidates(&self, slots: SlotChoice) -> Vec<usize> {
        let is_one = |i: &usize| slots == SlotChoice::All || self.places[*i].name.ends_with('1');
        (0..self.places.len()).filter(is_one).collect()
    }

    /// Candidates of one movement: their `hand` is relative to the shoulder at its onset.
    pub fn targets(&self, reach: &RecordedReach, places: &[usize]) -> Vec<ReachTarget> {
        let shoulder = reach.samples[reach.onset].shoulder;
        let target = |i: &usize| {
            let place = &self.places[*i];
            ReachTarget { hand: shoulder + place.hand.coords, look: place.look }
        };
        places.iter().map(target).collect()
    }
}

fn places(texts: &PickTexts) -> Result<Vec<RecordedPlace>, PickDataError> {
    let mut hands = BTreeMap::new();
    let mut reader = TableReader::new("slots.csv", &texts.slots, &PLACES)?;
    while let Some(row) = reader.next() {
        let row = row?;
        hands.insert(row.cells[0], row.place(1, 1.0)?);
    }
    let mut places: Vec<RecordedPlace> = Vec::new();
    let mut reader = TableReader::new("targets.csv", &texts.targets, &PLACES)?;
    while let Some(row) = reader.next() {
        let row = row?;
        let name = row.cells[0].to_owned();
        if places.iter().any(|p| p.name == name) {
            return Err(row.error(format!("{name} is there twice")));
        }
        let hand = hands.get(row.cells[0]).ok_or_else(|| row.error(format!("slots.csv has no {name}")))?;
        places.push(RecordedPlace { name, look: row.place(1, 1.0)?, hand: *hand });
    }
    Ok(places)
}

/// Line, onset and arrival of a movement.
type Times = Vec<(usize, f64, f64)>;

fn moves(
    texts: &PickTexts,
    places: &[RecordedPlace],
) -> Result<(Vec<String>, Vec<RecordedReach>, Times), PickDataError> {
    let (mut people, mut reaches, mut times): (Vec<String>, Vec<RecordedReach>, Times) = Default::default();
    let mut names = std::collections::BTreeSet::new();
    let mut reader = TableReader::new("moves.csv", &texts.moves, &MOVES)?;
    while let Some(row) = reader.next() {
        let row = row?;
        let (name, person) = (row.cells[0].to_owned(), row.cells[1]);
        if !names.insert(row.cells[0]) {
            return Err(row.error(format!("movement {name} is there twice")));
        }
        let known = people.iter().position(|p| p == person);
        let person = known.unwrap_or_else(|| {
            people.push(person.to_owned());
            people.len() - 1
        });
        let place = places.iter().position(|p| p.name == row.cells[2]);
        let place = place.ok_or_else(|| row.error(format!("targets.csv has no {}", row.cells[2])))?;
        let (onset, arrival) = (row.figure(3, LONGEST_MS)?, row.figure(4, LONGEST_MS)?);
        if arrival <= onset {
            return Err(row.error("the arrival is not after the onset".into()));
        }
        times.push((row.line, onset, arrival));
        reaches.push(RecordedReach { name, person, place, onset: 0, arrival: 0, samples: Vec::new() });
    }
    if reaches.is_empty() {
        return Err(PickDataError { file: "moves.csv", line: 1, what: "there is no movement".into() });
    }
    Ok((people, reaches, times))
}

fn samples(texts: &PickTexts, reaches: &mut [RecordedReach]) -> Result<(), PickDataError> {
    let index: BTreeMap<String, usize> =
        reaches.iter().enumerate().map(|(i, r)| (r.name.clone(), i)).collect();
    let mut reader = TableReader::new("samples.csv", &texts.samples, &SAMPLES)?;
    while let Some(row) = reader.next() {
        let row = row?;
        let reach = index.get(row.cells[0]);
        let reach = *reach.ok_or_else(|| row.error(format!("moves.csv has no {}", row.cells[0])))?;
        let sample = ArmSample {
            at_s: row.figure(1, LONGEST_MS)? * 0.001,
            shoulder: row.place(2, 0.001)?,
            forearm: row.place(5, 0.001)?,
            hand: row.place(8, 0.001)?,
            finger: row.place(11, 0.001)?,
            head: row.place(14, 0.001)?,
            yaw: row.figure(17, 360.0)?.to_radians(),
            pitch: row.figure(18, 360.0)?.to_radians(),
        };
        let samples = &mut reaches[reach].samples;
        if samples.last().is_some_and(|last| last.at_s >= sample.at_s) {
            return Err(row.error("t_ms does not grow".into()));
        }
        samples.push(sample);
    }
    Ok(())
}

fn gaze(texts: &PickTexts) -> Result<Vec<GazeTrial>, PickDataError> {
    let mut trials: Vec<(String, GazeTrial)> = Vec::new();
    let mut reader = TableReader::new("gaze.csv", &texts.gaze, &GAZE)?;
    while let Some(row) = reader.next() {
        let row = row?;
        let angle = |column: usize| Ok(row.figure(column, 360.0)?.to_radians());
        let sample = GazeSample {
            at_s: row.figure(1, LONGEST_MS)? * 0.001,
            eye: (angle(2)?, angle(3)?),
            head: (angle(4)?, angle(5)?),
        };
        if trials.last().is_none_or(|t| t.0 != row.cells[0]) {
            trials.push((row.cells[0].to_owned(), GazeTrial { samples: Vec::new() }));
        }
        let trial = trials.last_mut().map(|t| &mut t.1.samples).expect("one was pushed");
        if trial.last().is_some_and(|last| last.at_s >= sample.at_s) {
            return Err(row.error("t_ms does not grow".into()));
        }
        trial.push(sample);
    }
    Ok(trials.into_iter().map(|t| t.1).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts() -> PickTexts {
        let sample = |t: usize| format!("m,{t},{}\n", ["1"; 17].join(","));
        PickTexts {
            moves: format!("{}\nm,p,A1,40,80\n", MOVES.join(",")),
            samples: format!("{}\n{}{}{}", SAMPLES.join(","), sample(0), sample(40), sample(80)),
            targets: format!("{}\nA1,1,0,1\nB1,1,1,1\n", PLACES.join(",")),
            slots: format!("{}\nA1,0.5,0,0\nB1,0.5,0.3,0\n", PLACES.join(",")),
            gaze: format!("{}\n0,-40,1,2,3,4,5,6\n", GAZE.join(",")),
        }
    }

    #[test]
    fn good_tables_are_read_in_metres_and_radians() {
        let read = PickRecording::parse(&texts()).unwrap();
        let reach = &read.reaches[0];
        assert_eq!((reach.onset, reach.arrival, reach.samples.len()), (1, 2, 3));
        assert_eq!(reach.samples[0].finger, ArmPoint::new(0.001, 0.001, 0.001));
        assert!((reach.samples[0].yaw - 1f64.to_radians()).abs() < 1e-12);
        let targets = read.targets(reach, &read.candidates(SlotChoice::Near));
        assert_eq!(targets[1].hand, ArmPoint::new(0.501, 0.301, 0.001));
    }

    #[test]
    fn bad_tables_are_refused_by_file_and_line() {
        type Change = fn(&mut PickTexts);
        let changes: [(&str, Change); 9] = [
            ("moves.csv, line 1: there is no movement", |t| t.moves.truncate(t.moves.find('\n').unwrap())),
            ("moves.csv, line 1", |t| t.moves = t.moves.replace("onset_ms", "onset")),
            ("moves.csv, line 2: targets.csv has no C1", |t| t.moves = t.moves.replace("A1", "C1")),
            ("moves.csv, line 2: the arrival", |t| t.moves = t.moves.replace("40,80", "80,40")),
            ("moves.csv, line 2: m has no sample at its onset", |t| {
                t.moves = t.moves.replace("40,80", "20,80")
            }),
            ("samples.csv, line 3: t_ms does not grow", |t| t.samples = t.samples.replace("m,40", "m,0")),
            ("samples.csv, line 2: shoulder_x is \"NaN\"", |t| {
                t.samples = t.samples.replace("m,0,1", "m,0,NaN")
            }),
            ("targets.csv, line 3: slots.csv has no B1", |t| t.slots = t.slots.replace("B1", "D1")),
            ("gaze.csv, line 2: 7 figures for 8 columns", |t| t.gaze = t.gaze.replace(",6\n", "\n")),
        ];
        for (what, change) in changes {
            let mut bad = texts();
            change(&mut bad);
            let error = PickRecording::parse(&bad).unwrap_err().to_string();
            assert!(error.starts_with(what), "{what}: {error}");
        }
    }
}
