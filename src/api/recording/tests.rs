//! Recordings as readers see them: which times a folder covers, and what is left of a file that was cut off.

use super::*;
use crate::port::moment::Moment;
use crate::state::alarms::Alarms;
use giveway_fleet::alarm::AlarmKind;
use giveway_fleet::{EncounterFact, Fleet, Settings, View};
use giveway_floor::id::WorkerId;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::warehouse::lab;
use serde_json::Value;
use std::path::PathBuf;

const NO_LIMITS: Limits = Limits { age_s: f64::INFINITY, bytes: u64::MAX };

/// A folder that is deleted with the test.
pub(super) struct TestFolder(PathBuf);

impl TestFolder {
    pub(super) fn new(name: &str) -> TestFolder {
        TestFolder(std::env::temp_dir().join(format!("giveway-reel-{name}-{}", std::process::id())))
    }

    pub(super) fn folder(&self, start_s: i64) -> Arc<Folder> {
        let start = Some(Time(start_s * 1_000_000));
        Arc::new(Folder::open(self.0.clone(), Arc::new(lab()), "lab".into(), start).unwrap())
    }

    pub(super) fn recordings(&self) -> Vec<PathBuf> {
        let files = std::fs::read_dir(&self.0).unwrap().map(|f| f.unwrap().path());
        let mut recordings: Vec<_> = files.filter(|f| f.extension().is_some_and(|e| e == "reel")).collect();
        recordings.sort();
        recordings
    }
}

impl Drop for TestFolder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A frame in which only the clock and an alarm change.
fn frame(at_s: f64, alarms: &Alarms) -> Arc<Frame> {
    let map = Arc::new(lab());
    let view = Fleet::new(map.clone(), Settings::default()).view(Time::ZERO);
    let moment =
        Moment { view: View { now: Time::from_secs_f64(at_s), ..view }, time_s: at_s, ..Moment::default() };
    Arc::new(Frame::of(&map, &moment, &alarms.list(), 0.0))
}

/// Records a period; a worker leaves the path at the end of each ten seconds.
fn record(folder: &Arc<Folder>, from_s: u32, to_s: u32) -> Rotation {
    let mut rotation = Rotation::new(folder.clone(), NO_LIMITS);
    let start = folder.start.unwrap_or(Time::ZERO);
    for s in from_s..=to_s {
        if s % 10 == 9 {
            rotation.note(&Fact::Encounter(EncounterFact::Deviated {
                worker: WorkerId(0),
                at: start + Span::from_secs(i64::from(s)),
            }));
        }
        rotation.take(&frame(f64::from(s), &Alarms::default())).unwrap();
    }
    rotation
}

/// The parsed lines of a span.
pub(super) fn cut(folder: &Folder, from_s: f64, to_s: f64) -> Vec<Value> {
    let mut text = String::new();
    folder.cut(from_s, to_s, true).expect("something is kept").each(|lines| {
        text += lines;
        true
    });
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect()
}

#[test]
fn a_span_begins_with_the_last_key_frame_before_it_and_has_its_bookmarks() {
    let place = TestFolder::new("span");
    let folder = place.folder(1000);
    record(&folder, 0, 100).finish().unwrap();
    let lines = cut(&folder, 35.0, 52.0);
    assert_eq!(lines[0]["reel"], 1);
    assert_eq!(lines[0]["start"], 1000.0);
    assert_eq!(lines[0]["map"]["name"], lab().name);
    let marks: Vec<_> = lines.iter().filter(|l| l.get("mark").is_some()).map(|l| l["at"].clone()).collect();
    assert_eq!(marks, [39.0, 49.0]);
    let frames: Vec<_> = lines[1..].iter().filter(|l| l.get("mark").is_none()).collect();
    assert!(frames[0].get("key").is_some() && frames[0]["at"] == 30.0, "{}", frames[0]);
    assert_eq!(frames.last().unwrap()["at"], 52.0);
    let mut version = frames[0]["key"]["version"].clone();
    for patch in frames[1..].iter().filter_map(|l| l.get("patch")) {
        assert_eq!(patch["base"], version, "patches follow one another");
        version = patch["version"].clone();
    }
}

#[test]
fn files_follow_one_another_without_a_seam_and_old_ones_go() {
    let place = TestFolder::new("rotation");
    let folder = place.folder(0);
    record(&folder, 0, 1300).finish().unwrap();
    assert_eq!(place.recordings().len(), 3);
    assert_eq!(folder.past(0.0, 0.0).spans, [(0.0, 1300.0)]);
    assert_eq!(cut(&folder, 590.0, 610.0).iter().filter(|l| l.get("patch").is_some()).count(), 20);
    folder.prune(1300.0, Limits { age_s: 500.0, bytes: u64::MAX });
    assert_eq!(folder.past(0.0, 2000.0).spans, [(600.0, 1300.0)]);
    folder.prune(1300.0, Limits { age_s: f64::INFINITY, bytes: 1 });
    assert!(place.recordings().is_empty() && folder.cut(0.0, 2000.0, true).is_none());
    assert_eq!(std::fs::read_dir(&place.0).unwrap().count(), 0, "their indexes went, too");
}

#[test]
fn what_a_killed_server_wrote_is_there_after_the_restart_before_the_new_beginning() {
    let place = TestFolder::new("killed");
    // Never finished: no index, and the file is cut off.
    std::mem::forget(record(&place.folder(1000), 0, 60));
    let later = place.folder(1100);
    let past = later.past(f64::NEG_INFINITY, f64::INFINITY);
    assert_eq!(past.spans, [(-100.0, -40.0)]);
    assert_eq!(past.marks.first().map(|m| m.at_s), Some(-91.0));
    record(&later, 5, 30).finish().unwrap();
    assert_eq!(later.past(0.0, 0.0).spans, [(-100.0, -40.0), (5.0, 30.0)]);
    let lines = cut(&later, -45.0, 10.0);
    let frames: Vec<f64> = lines[1..].iter().filter_map(|l| l["at"].as_f64()).collect();
    assert!(frames.contains(&-40.0) && frames.contains(&5.0), "{frames:?}");
    assert_eq!(lines[0]["start"], 1100.0);
}

#[test]
fn a_file_cut_anywhere_gives_whole_lines_up_to_there() {
    let place = TestFolder::new("cut");
    record(&place.folder(0), 0, 60).finish().unwrap();
    let path = place.recordings().remove(0);
    let whole: Vec<String> = lines(&path).unwrap().collect();
    let bytes = std::fs::read(&path).unwrap();
    let mut most = 0;
    for part in (0..bytes.len()).step_by(bytes.len() / 40) {
        std::fs::write(&path, &bytes[..part]).unwrap();
        let read: Vec<String> = lines(&path).unwrap().collect();
        assert!(whole.starts_with(&read));
        most = most.max(read.len());
    }
    assert!(most > whole.len() * 8 / 10, "{most} of {}", whole.len());
}

#[test]
fn an_alarm_is_a_bookmark_once_and_a_stop_by_hand_is_not_two() {
    let mut recording = Recording::new(Arc::new(lab()), "lab".into(), None);
    let alarms = Alarms::default();
    let mut take_frame =
        |at_s, alarms: &Alarms| recording.add(&frame(at_s, alarms)).expect("a new frame").marks;
    assert!(take_frame(0.0, &alarms).is_empty());
    alarms.raise(AlarmKind::Journal, sentence::journal_slow(1, "a file"), Time::ZERO);
    alarms.raise(AlarmKind::Stopped, sentence::all_stopped(), Time::ZERO);
    let marks = take_frame(1.0, &alarms);
    assert_eq!(marks.len(), 1);
    assert_eq!((marks[0].kind, &marks[0].words), (MarkKind::Alarm, &sentence::journal_slow(1, "a file")));
    alarms.raise(AlarmKind::Journal, sentence::journal_slow(2, "a file"), Time::ZERO);
    assert!(take_frame(2.0, &alarms).is_empty());
    assert!(recording.add(&frame(2.0, &alarms)).is_none(), "the same frame is none");
}

#[test]
fn where_the_disk_refuses_nothing_breaks_and_the_past_goes_on_later() {
    let place = TestFolder::new("refused");
    let folder = place.folder(0);
    std::fs::remove_dir(&place.0).unwrap();
    std::fs::write(&place.0, "in the way").unwrap();
    let mut rotation = Rotation::new(folder.clone(), NO_LIMITS);
    let alarms = Alarms::default();
    for s in 0..5 {
        assert!(rotation.take(&frame(f64::from(s), &alarms)).is_err());
    }
    assert_eq!(folder.past(0.0, 9.0), PastSpan::default());
    std::fs::remove_file(&place.0).unwrap();
    for s in 5..30 {
        rotation.take(&frame(f64::from(s), &alarms)).unwrap();
    }
    rotation.finish().unwrap();
    assert_eq!(folder.past(0.0, 0.0).spans, [(5.0, 29.0)]);
    assert!(cut(&folder, 0.0, 9.0)[2].get("key").is_some(), "it begins with a key frame");
}

#[test]
fn of_the_bookmarks_of_an_hour_the_first_are_kept_and_the_next_file_has_room_again() {
    let test = TestFolder::new("many-marks");
    let folder = test.folder(0);
    let frame = |at_s: f64, marks: usize| {
        let (words, who) = (Sentence::without_code("a robot stood"), Vec::new());
        let mark = Mark { at_s, kind: MarkKind::Alarm, words, who, place: None, encounter: None };
        RecordedFrame { at_s, marks: vec![mark; marks], ..RecordedFrame::default() }
    };
    folder.begin(0.0).unwrap();
    folder.grow(frame(1.0, 4_990));
    folder.grow(frame(2.0, 20));
    assert_eq!(folder.past(0.0, 4000.0).marks.len(), 5_000);
    folder.begin(3600.0).unwrap();
    folder.grow(frame(3601.0, 20));
    assert_eq!(folder.past(0.0, 4000.0).marks.len(), 5_020);
}
