//! `/v1/closures/recurring`: areas that are closed again and again; and what recurs, as a request has it.
//!
//! Main type: [`NewRecurrence`]. Refuses: calendars beyond days of the week in a fixed offset from UTC.

use super::lists::{Paging, page};
use crate::api::called::Called;
use crate::api::dto::{Names, Page};
use crate::api::error::{FieldError, Problem};
use crate::api::extract::Params;
use crate::api::people::{RecurringClosureDto, WEEKDAYS};
use crate::api::text::{parse_offset, parse_time_of_day};
use crate::api::words::WeekdayDto;
use crate::fleet::{Recurrence, Weekdays};
use crate::time::{Span, Time, Window};
use axum::Json;
use serde::Deserialize;
use utoipa::ToSchema;

const DAY: Span = Span::from_secs(24 * 3600);

/// On which days and from when to when an area is closed.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewRecurrence {
    /// Days of the week, in English; every day if absent.
    #[schema(value_type = Option<Vec<WeekdayDto>>, example = json!(["monday", "thursday"]))]
    weekdays: Option<Vec<String>>,
    /// From this time of day on.
    #[schema(example = "22:00")]
    from: String,
    /// Until this time of day; the next day if it is not later than `from`.
    #[schema(example = "22:30")]
    to: String,
    /// How far the building's time is ahead of UTC; none if absent. It does not follow daylight saving time.
    #[schema(example = "+01:00")]
    utc_offset: Option<String>,
}

/// All areas that are closed again and again, each with its occurrences that are in force or announced.
#[utoipa::path(get, path = "/v1/closures/recurring", tag = "people",
    operation_id = "listRecurringClosures", params(Paging), responses(
    (status = 200, description = "In the order in which they were requested", body = Page<RecurringClosureDto>),
    (status = 422, body = Problem, content_type = "application/problem+json")))]
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
    /// The first occurrence, whatever the weekday, and when others follow. None begins before `from`; where that is not
    /// given, one that has begun before `now` is in force at once.
    pub(super) fn read(
        &self,
        (from, until): (Option<Time>, Time),
        now: Time,
        errors: &mut Vec<FieldError>,
    ) -> Option<(Window, Recurrence)> {
        let before = errors.len();
        let mut of_day = |field: &str, text: &str| {
            let time = parse_time_of_day(text);
            if time.is_none() {
                let detail = format!("\"{text}\" is not a time of day such as 22:30");
                errors.push(FieldError::new(format!("recurs.{field}"), detail));
            }
            time.unwrap_or(Span::ZERO)
        };
        let (begins, ends) = (of_day("from", &self.from), of_day("to", &self.to));
        let utc_offset = self.utc_offset.as_deref().map_or(Some(Span::ZERO), parse_offset);
        if utc_offset.is_none() {
            errors.push(FieldError::new("recurs.utc_offset", "must be an offset such as +01:00 or -05:30"));
        }
        let utc_offset = utc_offset.unwrap_or(Span::ZERO);
        let mut days = 0;
        for name in self.weekdays.iter().flatten() {
            match WEEKDAYS.iter().position(|day| day.word() == name) {
                Some(day) => days |= 1 << day,
                None => {
                    let detail =
                        format!("\"{name}\" is not one of {}", WEEKDAYS.map(WeekdayDto::word).join(", "));
                    errors.push(FieldError::new("recurs.weekdays", detail));
                }
            }
        }
        let weekdays = if self.weekdays.is_none() { Weekdays::ALL } else { Weekdays(days) };
        let lasts = if ends > begins { ends - begins } else { ends + DAY - begins };
        if lasts >= DAY || self.weekdays.is_some() && days == 0 {
            errors.push(FieldError::new("recurs", "must be on some day, and from one time to another"));
        }
        if errors.len() > before {
            return None;
        }
        let earliest = from.unwrap_or(now - DAY);
        let midnight = Time((earliest + utc_offset).0.div_euclid(DAY.0) * DAY.0) - utc_offset;
        let first = midnight + begins;
        let first = if first < earliest { first + DAY } else { first };
        Some((Window::new(first, first + lasts), Recurrence { every: DAY, weekdays, utc_offset, until }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::text::{parse_time, time_text};

    fn first(recurs: serde_json::Value, from: Option<&str>, now: &str) -> Result<String, String> {
        let new: NewRecurrence = serde_json::from_value(recurs).unwrap();
        let (from, now) = (from.map(|t| parse_time(t).unwrap()), parse_time(now).unwrap());
        let mut errors = Vec::new();
        let read = new.read((from, Time::MAX), now, &mut errors);
        read.map(|(w, _)| format!("{} {}", time_text(w.start()), time_text(w.end())))
            .ok_or_else(|| errors[0].field.clone())
    }

    #[test]
    fn the_first_occurrence_is_counted_in_the_time_of_the_building() {
        let evening = serde_json::json!({"from": "23:30", "to": "00:30", "utc_offset": "+02:00"});
        assert_eq!(
            first(evening, Some("2030-06-03T10:00:00Z"), "2030-06-01T00:00:00Z").unwrap(),
            "2030-06-03T21:30:00Z 2030-06-03T22:30:00Z"
        );
        // Without a beginning, the one of the day before counts, too: it may be in force.
        let night = serde_json::json!({"from": "22:00", "to": "02:00"});
        assert_eq!(
            first(night, None, "2030-06-03T01:00:00Z").unwrap(),
            "2030-06-02T22:00:00Z 2030-06-03T02:00:00Z"
        );
    }

    #[test]
    fn what_cannot_recur_is_named() {
        for (recurs, field) in [
            (serde_json::json!({"from": "8:00", "to": "09:00"}), "recurs.from"),
            (serde_json::json!({"from": "08:00", "to": "25:00"}), "recurs.to"),
            (serde_json::json!({"from": "08:00", "to": "08:00"}), "recurs"),
            (serde_json::json!({"from": "08:00", "to": "09:00", "weekdays": ["someday"]}), "recurs.weekdays"),
            (serde_json::json!({"from": "08:00", "to": "09:00", "weekdays": []}), "recurs"),
            (serde_json::json!({"from": "08:00", "to": "09:00", "utc_offset": "CET"}), "recurs.utc_offset"),
        ] {
            assert_eq!(first(recurs.clone(), None, "2030-06-03T01:00:00Z"), Err(field.into()), "{recurs}");
        }
    }
}
