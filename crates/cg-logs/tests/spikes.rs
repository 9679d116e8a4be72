//! Single values that no truck has.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{known, vehicle};
use cg_logs::estimate::{EstimateOptions, LogEstimate, LogEstimator};
use cg_logs::log::LogRow;

/// The estimate of a log of the independent truck whose rows are changed.
fn estimate(change: impl Fn(usize, &mut LogRow)) -> LogEstimate {
    let (truck, all) = (vehicle("kraz.toml"), known());
    let log = all.iter().find(|one| one.log.starts_with("A_p20_h190")).unwrap();
    let mut estimator = LogEstimator::new(&truck, EstimateOptions::default()).unwrap();
    for (k, mut row) in log.rows().into_iter().enumerate() {
        change(k, &mut row);
        estimator.push(&row).unwrap();
    }
    estimator.finish()
}

/// What makes a row wrong.
type Set = fn(&mut LogRow);

/// One roll or steer angle in a log is wrong, in straight driving or in the turn, or ten in a row are. The height is as without them to a
/// tenth of its uncertainty, and a message says how many were left out.
#[test]
fn a_spike_is_left_out() {
    let whole = estimate(|_, _| ());
    let (height_m, sd_m) = (whole.height_m.unwrap(), whole.height_sd_m.unwrap());
    let is_of = |one: &String| one.contains("7 degrees from one row to the next");
    assert!(!whole.messages.iter().any(is_of), "{:?}", whole.messages);
    let wrong: [Set; 4] = [
        |row| row.roll_rad = 0.3,
        |row| row.roll_rad = -0.9,
        |row| row.steer_rad = 0.7,
        |row| row.steer_rad = -0.5,
    ];
    for (set, from, count) in
        wrong.into_iter().flat_map(|set| [(set, 50, 1), (set, 900, 1), (set, 1200, 10)])
    {
        let found = estimate(|k, row| {
            if (from..from + count).contains(&k) {
                set(row);
            }
        });
        let change = (found.height_m.unwrap() - height_m).abs() / sd_m;
        assert!(change < 0.1, "{from}: {change}");
        let told = found.messages.iter().find(|one| is_of(one)).unwrap();
        assert!(told.starts_with(&format!("{count} angle")), "{told}");
    }
}
