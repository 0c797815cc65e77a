//! Recorded people: files of three public data sets as walks.
//!
//! Main types: [`Format`], [`RecordedWalks`], [`RecordedWalk`], [`TrackError`]. A walk is one person without a gap; if
//! a file has gaps, a person has several walks. Refuses: to smooth, to fill gaps, and to read files itself.

use giveway_floor::geometry::Point;
use giveway_floor::time::Time;
use std::collections::BTreeMap;

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// ETH and UCY (Pellegrini 2009, Lerner 2007): frame, person, x, y; one step is 0.4 s.
    Eth,
    /// THÖR-MAGNI (Schreiter 2024): a table with a header; cut into tracklets of 20 rows.
    Magni,
    /// THÖR (Rudenko 2020) as prepared for CLiFF: seconds, person, x, y, speed, heading.
    Thor,
}

impl Format {
    /// The format of this name.
    pub fn named(name: &str) -> Option<Format> {
        match name {
            "eth" => Some(Format::Eth),
            "magni" => Some(Format::Magni),
            "thor" => Some(Format::Thor),
            _ => None,
        }
    }

    /// The format of a file, from its first line.
    pub fn guess(text: &str) -> Option<Format> {
        let first = text.lines().find(|l| !l.trim().is_empty())?;
        match first.split(',').count() {
            1 if first.split_whitespace().count() == 4 => Some(Format::Eth),
            6 if first.split(',').all(|f| f.trim().parse::<f64>().is_ok()) => Some(Format::Thor),
            n if n > 6 && first.contains("tracklet") => Some(Format::Magni),
            _ => None,
        }
    }
}

/// Time step of all three data sets, seconds.
pub const STEP_S: f64 = 0.4;
/// A longer gap ends a walk (THÖR), seconds.
const GAP_S: f64 = 0.45;
/// Tracklets that follow one another after a step form one walk; time stamps may be off by this, seconds.
const JOIN_S: f64 = 0.05;

/// A person's position at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Time since the start of the file or run.
    pub t: Time,
    /// Number of the step in the file; people with the same number were seen together.
    pub step: i64,
    /// Position, metres.
    pub at: Point,
}

/// One person's walk without a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedWalk {
    /// The person's name in the file; if there are several runs, with the run.
    pub person: String,
    /// Points in order of time.
    pub seen: Vec<TrackPoint>,
    /// Where tracklets begin, as indices into `seen`; empty if the file has none.
    pub tracklets: Vec<usize>,
}

/// All walks of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedWalks {
    /// The format of the file, which decides which windows count.
    pub format: Format,
    /// Walks in the order of people, then time.
    pub walks: Vec<RecordedWalk>,
}

/// Error of a file that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TrackError {
    /// A line does not match the format.
    #[error("line {line}: {what}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// The header lacks a column.
    #[error("the header has no column `{0}`")]
    Column(&'static str),
    /// The file contains nobody.
    #[error("the file holds no tracks")]
    Empty,
}

/// A row: person, tracklet if there is one, and the point.
type TrackRow = (String, Option<u64>, TrackPoint);

impl RecordedWalks {
    /// Reads a file's text.
    pub fn parse(text: &str, format: Format) -> Result<RecordedWalks, TrackError> {
        let rows = match format {
            Format::Eth => eth(text)?,
            Format::Magni => magni(text)?,
            Format::Thor => thor(text)?,
        };
        let mut people: BTreeMap<String, Vec<(Option<u64>, TrackPoint)>> = BTreeMap::new();
        for (person, tracklet, seen) in rows {
            people.entry(person).or_default().push((tracklet, seen));
        }
        let mut walks = Vec::new();
        for (person, mut rows) in people {
            rows.sort_by_key(|r| r.1.t);
            rows.dedup_by_key(|r| r.1.t);
            walks.extend(cut(&person, &rows, format));
        }
        if walks.is_empty() { Err(TrackError::Empty) } else { Ok(RecordedWalks { format, walks }) }
    }
}

/// One person's rows as walks without gaps.
fn cut(person: &str, rows: &[(Option<u64>, TrackPoint)], format: Format) -> Vec<RecordedWalk> {
    let mut walks: Vec<RecordedWalk> = Vec::new();
    let mut last: Option<(Option<u64>, TrackPoint)> = None;
    for (tracklet, seen) in rows {
        let follows = last.is_some_and(|(before, s)| {
            let gap = (seen.t - s.t).as_secs_f64();
            match format {
                Format::Eth => seen.step == s.step + 1,
                Format::Thor => gap < GAP_S,
                Format::Magni => before == *tracklet || (gap - STEP_S).abs() < JOIN_S,
            }
        });
        if !follows {
            walks.push(RecordedWalk { person: person.to_owned(), seen: Vec::new(), tracklets: Vec::new() });
        }
        let walk = walks.last_mut().expect("one was just begun");
        let is_first = last.is_none_or(|(before, _)| before != *tracklet) || !follows;
        if tracklet.is_some() && is_first {
            walk.tracklets.push(walk.seen.len());
        }
        walk.seen.push(*seen);
        last = Some((*tracklet, *seen));
    }
    walks
}

fn number(line: usize, field: Option<&str>, what: &str) -> Result<f64, TrackError> {
    let text = field.ok_or_else(|| TrackError::Line { line, what: format!("{what} is missing") })?.trim();
    let number: f64 = text
        .parse()
        .map_err(|_| TrackError::Line { line, what: format!("{what} is `{text}`, not a number") })?;
    if number.is_finite() && number.abs() < 1e9 {
        Ok(number)
    } else {
        Err(TrackError::Line { line, what: format!("{what} is out of range: {text}") })
    }
}

/// Names of people are numbers in all data sets, written as 1 or 1.0.
fn person_name(number: f64) -> String {
    format!("{:06}", number as i64)
}

fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(i, l)| (i + 1, l)).filter(|(_, l)| !l.trim().is_empty())
}

fn eth(text: &str) -> Result<Vec<TrackRow>, TrackError> {
    let mut raw = Vec::new();
    for (line, text) in lines(text) {
        let mut fields = text.split_whitespace();
        let frame = number(line, fields.next(), "the frame")?;
        let person = number(line, fields.next(), "the person")?;
        let x = number(line, fields.next(), "x")?;
        let y = number(line, fields.next(), "y")?;
        raw.push((frame as i64, person, Point::new(x, y)));
    }
    // Steps are counted over the frames that occur, as the usual benchmark does.
    let mut frames: Vec<i64> = raw.iter().map(|r| r.0).collect();
    frames.sort_unstable();
    frames.dedup();
    let row = |(frame, person, at): (i64, f64, Point)| {
        let step = frames.binary_search(&frame).expect("it is one of them") as i64;
        (person_name(person), None, TrackPoint { t: Time(step * 400_000), step, at })
    };
    Ok(raw.into_iter().map(row).collect())
}

fn magni(text: &str) -> Result<Vec<TrackRow>, TrackError> {
    let mut lines = lines(text);
    let (_, header) = lines.next().ok_or(TrackError::Empty)?;
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let column = |name: &'static str| names.iter().position(|n| *n == name).ok_or(TrackError::Column(name));
    let (time, agent, tracklet) = (column("time_s")?, column("agent")?, column("tracklet")?);
    let (x, y, run) = (column("x_m")?, column("y_m")?, column("run")?);
    let mut rows = Vec::new();
    for (line, text) in lines {
        let fields: Vec<&str> = text.split(',').collect();
        let field = |i: usize, what: &str| number(line, fields.get(i).copied(), what);
        let t = Time((field(time, "time_s")? * 1e6).round() as i64);
        let at = Point::new(field(x, "x_m")?, field(y, "y_m")?);
        let who = fields.get(agent).copied().unwrap_or_default().trim();
        let who = format!("{who} in run {}", field(run, "run")?);
        let step = (t.0 as f64 / 4e5).round() as i64;
        rows.push((who, Some(field(tracklet, "tracklet")? as u64), TrackPoint { t, step, at }));
    }
    Ok(rows)
}

fn thor(text: &str) -> Result<Vec<TrackRow>, TrackError> {
    let mut rows = Vec::new();
    for (line, text) in lines(text) {
        let mut fields = text.split(',');
        let t = Time((number(line, fields.next(), "the time")? * 1e6).round() as i64);
        let person = number(line, fields.next(), "the person")?;
        let x = number(line, fields.next(), "x")?;
        let y = number(line, fields.next(), "y")?;
        let step = (t.0 as f64 / 4e5).round() as i64;
        rows.push((person_name(person), None, TrackPoint { t, step, at: Point::new(x, y) }));
    }
    Ok(rows)
}

/// Reads goals: lines of a name and a place, or of a place only; a header is allowed. Places beyond a kilometre are
/// directions, not goals, and are left out.
pub fn goals(text: &str) -> Result<Vec<(String, Point)>, TrackError> {
    let mut found = Vec::new();
    for (line, text) in lines(text) {
        let fields: Vec<&str> =
            text.split(|c: char| c == ',' || c.is_whitespace()).filter(|f| !f.is_empty()).collect();
        let is_header = line == 1 && fields.last().is_some_and(|f| f.parse::<f64>().is_err());
        if is_header {
            continue;
        }
        let from = match fields.len() {
            2 => 0,
            3 => 1,
            n => {
                return Err(TrackError::Line {
                    line,
                    what: format!("a goal has a name, x and y, not {n} fields"),
                });
            }
        };
        let at = Point::new(
            number(line, fields.get(from).copied(), "x")?,
            number(line, fields.get(from + 1).copied(), "y")?,
        );
        if at.coords.norm() <= 1000.0 {
            let name = if from == 1 { fields[0].to_owned() } else { format!("{}", found.len() + 1) };
            found.push((name, at));
        }
    }
    if found.is_empty() { Err(TrackError::Empty) } else { Ok(found) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_who_is_missing_in_a_step_has_two_walks() {
        let text = "0\t1\t0\t0\n10\t1\t1\t0\n10\t2\t5\t5\n20\t2\t5\t6\n30\t1\t3\t0\n30\t2\t5\t7\n";
        let r = RecordedWalks::parse(text, Format::Eth).unwrap();
        let sizes: Vec<(&str, usize)> = r.walks.iter().map(|w| (w.person.as_str(), w.seen.len())).collect();
        assert_eq!(sizes, [("000001", 2), ("000001", 1), ("000002", 3)]);
        assert_eq!(r.walks[1].seen[0].t, Time(1_200_000));
    }

    #[test]
    fn tracklets_a_step_apart_are_one_walk() {
        let mut text = String::from("run,time_s,frame,agent,role,tracklet,x_m,y_m,z_m,speed_mps\n");
        for (i, t) in [0.01, 0.41, 0.81, 1.21, 9.01].iter().enumerate() {
            let tracklet = [0, 0, 1, 1, 2][i];
            text += &format!("1,{t},{i},Helmet_3,Visitors-Alone,{tracklet},{i},0.5,1.7,0.2\n");
        }
        let r = RecordedWalks::parse(&text, Format::Magni).unwrap();
        assert_eq!(r.walks.iter().map(|w| w.seen.len()).collect::<Vec<_>>(), [4, 1]);
        assert_eq!(r.walks[0].tracklets, [0, 2]);
    }

    #[test]
    fn formats_are_told_by_their_first_line() {
        assert_eq!(Format::guess("0.0\t1.0\t13.4\t3.9\n"), Some(Format::Eth));
        assert_eq!(
            Format::guess("\nrun,time_s,frame,agent,role,tracklet,x_m,y_m,z_m,speed_mps\n"),
            Some(Format::Magni)
        );
        assert_eq!(Format::guess("0.02,12001,-0.046,-3.443,0.141,2.356\n"), Some(Format::Thor));
        assert_eq!(Format::guess("hello\n"), None);
    }

    #[test]
    fn a_gap_ends_a_walk() {
        let text = "0.02,7,0,0,1,0\n0.43,7,0.4,0,1,0\n1.31,7,1,0,1,0\n";
        let r = RecordedWalks::parse(text, Format::Thor).unwrap();
        assert_eq!(r.walks.iter().map(|w| w.seen.len()).collect::<Vec<_>>(), [2, 1]);
    }

    #[test]
    fn errors_name_the_line_and_what_is_wrong() {
        let error = |text, format| RecordedWalks::parse(text, format).unwrap_err().to_string();
        assert_eq!(error("0 1 2 3\n10 1 x 3\n", Format::Eth), "line 2: x is `x`, not a number");
        assert_eq!(error("10 1 3\n", Format::Eth), "line 1: y is missing");
        assert_eq!(error("0.1,1,NaN,3\n", Format::Thor), "line 1: x is out of range: NaN");
        assert_eq!(error("time_s,agent,tracklet\n", Format::Magni), "the header has no column `x_m`");
        assert_eq!(error("\n\n", Format::Thor), "the file holds no tracks");
    }

    #[test]
    fn goals_at_infinity_are_no_goals() {
        let found = goals("goal,x_m,y_m\nA,1,2\nB,0,-271090.02\n").unwrap();
        assert_eq!(found, [("A".to_owned(), Point::new(1.0, 2.0))]);
        assert_eq!(goals("  1.0e0  2.0\n").unwrap()[0].1, Point::new(1.0, 2.0));
        assert!(goals("1 2 3 4\n").is_err());
    }
}
