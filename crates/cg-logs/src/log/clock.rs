//! Reads points in time in cells of text.

use chrono::{DateTime, NaiveDateTime, NaiveTime, TimeDelta};

/// Date and time of day without a time zone, which is taken to be UTC.
const DATES: [&str; 4] = [
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y-%m-%dT%H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%d.%m.%Y %H:%M:%S%.f",
];
/// The longest text of these forms, with a time zone.
const LONGEST: usize = 40;

/// Unix time, s, of `2024-05-01 12:00:00.02`, `2024-05-01T12:00:00Z` or `01.05.2024 12:00:00,02`, or the
/// seconds since midnight of `12:00:00.02`. Dates with slashes must begin with the year, because
/// 05/01 has two meanings.
pub(super) fn seconds(cell: &[u8]) -> Option<f64> {
    if cell.len() > LONGEST || !cell.contains(&b':') {
        return None;
    }
    let text = str::from_utf8(cell).ok()?.trim().replace(',', ".");
    let since_1970 =
        |time: NaiveDateTime| time.and_utc().signed_duration_since(DateTime::UNIX_EPOCH);
    let since = DATES
        .iter()
        .find_map(|form| NaiveDateTime::parse_from_str(&text, form).ok())
        .map(since_1970)
        .or_else(|| {
            let zoned = DateTime::parse_from_str(&text, "%Y-%m-%d %H:%M:%S%.f%#z");
            zoned
                .or_else(|_| DateTime::parse_from_rfc3339(&text))
                .ok()
                .map(|t| since_1970(t.naive_utc()))
        })
        .or_else(|| {
            let time = NaiveTime::parse_from_str(&text, "%H:%M:%S%.f").ok()?;
            Some(time.signed_duration_since(NaiveTime::MIN))
        })?;
    Some(in_seconds(since))
}

fn in_seconds(since: TimeDelta) -> f64 {
    #[allow(clippy::cast_precision_loss)] // 2^53 s are longer than any calendar
    let whole = since.num_seconds() as f64;
    whole + f64::from(since.subsec_nanos()) * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::float_cmp, reason = "an eighth of a second is exact")]
    fn dates_are_unix_time_and_times_of_day_count_from_midnight() {
        // date -u -d "2024-05-01 12:00:00" +%s
        let noon_s = 1_714_564_800.0;
        for (text, expected) in [
            ("2024-05-01 12:00:00.125", Some(noon_s + 0.125)),
            ("2024-05-01T12:00:00", Some(noon_s)),
            ("2024-05-01T12:00:00.125Z", Some(noon_s + 0.125)),
            ("2024-05-01 14:00:00.125+02:00", Some(noon_s + 0.125)),
            ("2024-05-01T14:00:00+02:00", Some(noon_s)),
            ("2024/05/01 12:00:00", Some(noon_s)),
            ("01.05.2024 12:00:00,125", Some(noon_s + 0.125)),
            ("12:00:00.125", Some(43_200.125)),
            (" 12:00:00 ", Some(43_200.0)),
            ("05/01/2024 12:00:00", None),
            ("2024-05-01", None),
            ("25:00:00", None),
            ("12.5", None),
            ("a:b", None),
        ] {
            assert_eq!(seconds(text.as_bytes()), expected, "{text}");
        }
    }
}
