//! `/v1/closures/recurring`: areas that are closed repeatedly, and how a request describes the recurrence.
//!
//! Main type: [`NewRecurrence`]. The clock changes of a time zone are looked up here, in the tables built into this
//! program, and stored with the closure. Refuses: calendars beyond days of the week.

use crate::dto::names::{Names, Page};
use crate::dto::people::{RecurringClosureDto, WEEKDAYS};
use crate::http::shared::paging::{Paging, page};
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::Params;
use crate::wire::text::{parse_offset, parse_time_of_day};
use crate::wire::words::WeekdayDto;
use axum::Json;
use giveway_fleet::{LocalClock, Recurrence, Weekdays};
use giveway_floor::text::sentence::requests;
use giveway_floor::time::{Span, Time, Window};
use serde::Deserialize;
use utoipa::ToSchema;

const DAY: Span = Span::from_secs(24 * 3600);

/// How many years of a zone's clock changes are stored with a closure. After that, the last offset holds.
const YEARS: i64 = 30;

/// The days and times at which an area is closed.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewRecurrence {
    /// Days of the week, in English; every day if absent.
    #[schema(value_type = Option<Vec<WeekdayDto>>, example = json!(["monday", "thursday"]))]
    weekdays: Option<Vec<String>>,
    /// The time of day at which an occurrence begins.
    #[schema(example = "22:00")]
    from: String,
    /// The time of day at which an occurrence ends; on the next day if it is not later than `from`.
    #[schema(example = "22:30")]
    to: String,
    /// The building's time: the name of a time zone, whose clocks it follows, or a fixed offset from UTC such as
    /// +01:00; UTC if absent. Where clocks are put forward, a time of day that they skip is moved by the change: 02:30
    /// becomes 03:30. Where they are put back, the first of the two times counts.
    #[schema(example = "Europe/Berlin")]
    utc_offset: Option<String>,
}

/// List recurring closures, each with its occurrences that are in force or announced.
#[utoipa::path(get, path = "/v1/closures/recurring", tag = "people",
    operation_id = "listRecurringClosures", params(Paging), responses(
    (status = 200, description = "In the order in which they were requested", body = Page<RecurringClosureDto>)))]
pub async fn list(
    Called(api): Called,
    Params(p): Params<Paging>,
) -> Result<Json<Page<RecurringClosureDto>>, Problem> {
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let all = moment.view.recurring.iter();
    page(all.map(|(id, recurring)| names.recurring(*id, recurring, (api.now)())).collect(), &p)
}

impl NewRecurrence {
    /// A usual occurrence, the recurrence, and the time before which none begins: this is `from`; if that is not given,
    /// an occurrence that began before `now` is in force at once.
    pub(super) fn read(
        &self,
        (from, until): (Option<Time>, Time),
        now: Time,
        errors: &mut Vec<FieldError>,
    ) -> Option<(Window, Recurrence, Time)> {
        let before = errors.len();
        let mut of_day = |field: &str, text: &str| {
            let time = parse_time_of_day(text);
            if time.is_none() {
                let detail = requests::not_a_time_of_day(text);
                errors.push(FieldError::new(format!("recurs.{field}"), detail));
            }
            time.unwrap_or(Span::ZERO)
        };
        let (begins, ends) = (of_day("from", &self.from), of_day("to", &self.to));
        let earliest = from.unwrap_or(now - DAY);
        let said = self.utc_offset.as_deref();
        let clock = said.map_or(Some(LocalClock::default()), |text| clock_of(text, earliest));
        if clock.is_none() {
            errors.push(FieldError::new("recurs.utc_offset", requests::not_a_zone()));
        }
        let mut days = 0;
        for name in self.weekdays.iter().flatten() {
            match WEEKDAYS.iter().position(|day| day.word() == name) {
                Some(day) => days |= 1 << day,
                None => {
                    let detail = requests::not_one_of(name, WEEKDAYS.map(WeekdayDto::word).to_vec());
                    errors.push(FieldError::new("recurs.weekdays", detail));
                }
            }
        }
        let weekdays = if self.weekdays.is_none() { Weekdays::ALL } else { Weekdays(days) };
        let lasts = if ends > begins { ends - begins } else { ends + DAY - begins };
        if lasts >= DAY || self.weekdays.is_some() && days == 0 {
            errors.push(FieldError::new("recurs", requests::recurs_never()));
        }
        let clock = clock.filter(|_| errors.len() == before)?;
        let usual = usual_day(&clock, earliest, (begins, lasts));
        Some((usual, Recurrence { every: DAY, weekdays, clock, until }, earliest))
    }
}

/// A clock from the name of a time zone or a fixed offset. A zone's changes are known for [`YEARS`] ahead.
fn clock_of(text: &str, from: Time) -> Option<LocalClock> {
    if let Some(offset) = parse_offset(text) {
        return Some(LocalClock::fixed(offset));
    }
    let zone = jiff::tz::TimeZoneDatabase::bundled().get(text).ok()?;
    let name = zone.iana_name()?.to_owned();
    let start = jiff::Timestamp::from_microsecond(from.0).ok()?;
    let span = |offset: jiff::tz::Offset| Span::from_secs(i64::from(offset.seconds()));
    let last = from + DAY * (YEARS * 366);
    let changes = zone
        .following(start)
        .map(|change| (Time(change.timestamp().as_microsecond()), span(change.offset())));
    let offset = span(zone.to_offset(start));
    let mut changes: Vec<(Time, Span)> = changes.take_while(|(at, _)| *at < last).collect();
    // Some changes concern only the name.
    let mut ahead = offset;
    changes.retain(|(_, offset)| std::mem::replace(&mut ahead, *offset) != *offset);
    Some(LocalClock { zone: Some(name), offset, changes })
}

/// An occurrence on the day of `at` or shortly before, in which no clock changes and whose times the clock shows once:
/// the pattern for all other occurrences.
fn usual_day(clock: &LocalClock, at: Time, (begins, lasts): (Span, Span)) -> Window {
    let midnight = Time(clock.shown(at).0.div_euclid(DAY.0) * DAY.0);
    let on = |day: i64| {
        let shown = midnight - DAY * day + begins;
        let window = (clock.instant(shown), clock.instant(shown + lasts));
        let is_usual = window.1 - window.0 == lasts && clock.shown(window.0) == shown;
        is_usual.then(|| Window::new(window.0, window.1))
    };
    // Before `at`, no change of the clock is known.
    (0..3).find_map(on).unwrap_or_else(|| Window::new(midnight + begins, midnight + begins + lasts))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::text::{parse_time, time_text};
    use giveway_fleet::{Binds, Closure, RecurringClosure};

    fn first(recurs: serde_json::Value, from: Option<&str>, now: &str) -> Result<String, String> {
        let new: NewRecurrence = serde_json::from_value(recurs).unwrap();
        let (from, now) = (from.map(|t| parse_time(t).unwrap()), parse_time(now).unwrap());
        let mut errors = Vec::new();
        let read = new.read((from, Time::MAX), now, &mut errors);
        let (window, recurrence, earliest) = read.ok_or_else(|| errors[0].field.clone())?;
        let area = Closure {
            outline: vec![],
            nodes: vec![],
            window,
            reason: "cleaning".into(),
            binds: Binds::Both,
            series: None,
        };
        let recurring = RecurringClosure::new(area, recurrence).not_before(earliest);
        let window = recurring.occurrence(recurring.next.unwrap()).window;
        Ok(format!("{} {}", time_text(window.start()), time_text(window.end())))
    }

    #[test]
    fn the_first_occurrence_is_counted_in_the_time_of_the_building() {
        let evening = serde_json::json!({"from": "23:30", "to": "00:30", "utc_offset": "+02:00"});
        assert_eq!(
            first(evening, Some("2030-06-03T10:00:00Z"), "2030-06-01T00:00:00Z").unwrap(),
            "2030-06-03T21:30:00Z 2030-06-03T22:30:00Z"
        );
        // If `from` is not given, the previous day's occurrence counts, too: it may be in force.
        let night = serde_json::json!({"from": "22:00", "to": "02:00"});
        assert_eq!(
            first(night, None, "2030-06-03T01:00:00Z").unwrap(),
            "2030-06-02T22:00:00Z 2030-06-03T02:00:00Z"
        );
    }

    #[test]
    fn a_zone_is_known_by_its_name_and_brings_its_changes() {
        let clock = clock_of("europe/berlin", parse_time("2031-01-01T00:00:00Z").unwrap()).unwrap();
        assert_eq!((clock.zone.as_deref(), clock.offset), (Some("Europe/Berlin"), Span::from_secs(3600)));
        let changes: Vec<String> = clock.changes[..2]
            .iter()
            .map(|(at, offset)| format!("{} {}", time_text(*at), offset.0))
            .collect();
        assert_eq!(changes, ["2031-03-30T01:00:00Z 7200000000", "2031-10-26T01:00:00Z 3600000000"]);
        assert_eq!(clock.changes.len(), 60, "two a year for thirty years");
        assert_eq!(clock_of("Asia/Kolkata", Time(0)).unwrap().offset, Span::from_secs(19_800));
        assert_eq!(clock_of("UTC", Time(0)).unwrap().changes, []);
    }

    #[test]
    fn a_first_day_on_which_clocks_change_counts_and_is_no_measure_for_the_others() {
        let night = |from, to| serde_json::json!({"from": from, "to": to, "utc_offset": "Europe/Berlin"});
        let eve = Some("2031-03-29T12:00:00Z");
        for (from, to, wanted) in [
            ("22:00", "22:30", "2031-03-29T21:00:00Z 2031-03-29T21:30:00Z"),
            ("22:00", "06:00", "2031-03-29T21:00:00Z 2031-03-30T04:00:00Z"),
            ("02:30", "03:30", "2031-03-30T01:30:00Z 2031-03-30T02:30:00Z"),
            ("11:00", "11:30", "2031-03-30T09:00:00Z 2031-03-30T09:30:00Z"),
        ] {
            assert_eq!(
                first(night(from, to), eve, "2031-03-01T00:00:00Z").unwrap(),
                wanted,
                "{from} to {to}"
            );
        }
    }

    #[test]
    fn what_cannot_recur_is_named() {
        for (recurs, field) in [
            (serde_json::json!({"from": "8:00", "to": "09:00"}), "recurs.from"),
            (serde_json::json!({"from": "08:00", "to": "25:00"}), "recurs.to"),
            (serde_json::json!({"from": "08:00", "to": "08:00"}), "recurs"),
            (serde_json::json!({"from": "08:00", "to": "09:00", "weekdays": ["someday"]}), "recurs.weekdays"),
            (serde_json::json!({"from": "08:00", "to": "09:00", "weekdays": []}), "recurs"),
            (
                serde_json::json!({"from": "08:00", "to": "09:00", "utc_offset": "Berlin"}),
                "recurs.utc_offset",
            ),
            (
                serde_json::json!({"from": "08:00", "to": "09:00", "utc_offset": "../UTC"}),
                "recurs.utc_offset",
            ),
            (serde_json::json!({"from": "08:00", "to": "09:00", "utc_offset": ""}), "recurs.utc_offset"),
        ] {
            assert_eq!(first(recurs.clone(), None, "2030-06-03T01:00:00Z"), Err(field.into()), "{recurs}");
        }
    }
}
