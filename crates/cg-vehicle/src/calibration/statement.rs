//! The statement of a calibration file: what the runs could and could not determine, and whether they
//! are possible.

use std::fmt;

use cg_core::{CHANNELS, Channel};

use super::advice::advice;
use super::entry::{ParameterEntry, ShapeEntry};
use super::fit::{Fitted, Procedure};
use super::judgment::Judgment;
use super::ratios::Run;
use super::shape::LEAST_RUNS;
use crate::belief::Belief;
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::lift::Positions;
use crate::ratio_spread::{height_change, mass_change};
use crate::vehicle::Vehicle;

/// Share of the prior variance that the runs must remove so that a parameter counts as determined.
const DETERMINED: f64 = 0.5;
/// Below this share a parameter counts as not determined.
const UNDETERMINED: f64 = 0.1;
/// Prior standard deviations beyond which a parameter or a ratio is named as a contradiction, and those beyond which the
/// statement says what to check of a ratio: one in twenty is by chance.
const FAR: f64 = 3.0;
const UNUSUAL: f64 = 1.96;
/// What a file without `[wind]` does not know of its runs; the figures are those of docs/limits.md.
const WINDLESS: &str = "a side wind in the runs is in no interval, because the vehicle file has no [wind]: after steps of a box body, \
                        3 m/s make later heights about 1.4 % wrong, after drives of five minutes 0.8 %. Calibrate in a calm, or give \
                        [wind]";

fn what_was_determined(parameter: &[ParameterEntry]) -> Vec<String> {
    let named = |title: &str, wanted: &dyn Fn(f64) -> bool| {
        let words: Vec<&str> = parameter
            .iter()
            .filter(|entry| entry.prior_sd > 0.0 && wanted(entry.determined))
            .map(|entry| entry.name.words())
            .collect();
        let list = if words.is_empty() { "none".to_owned() } else { words.join("; ") };
        format!("{title}: {list}")
    };
    vec![
        named("determined", &|share| share >= DETERMINED),
        named("partly determined", &|share| (UNDETERMINED..DETERMINED).contains(&share)),
        named("not determined by these runs", &|share| share < UNDETERMINED),
        "single parameters are less certain than the ratios that they determine together:"
            .to_owned(),
    ]
}

/// Text lines on the compensation functions.
pub(super) fn of_shapes(shapes: &[ShapeEntry]) -> Vec<String> {
    let mut lines: Vec<String> = shapes
        .iter()
        .filter(|shape| shape.order > 0)
        .map(|ShapeEntry { name, order, before_percent, after_percent, .. }| {
            format!(
                "{name}: F(s) of order {order}; of the roll angle in a run that it has not seen, it leaves \
                 {after_percent:.2} % instead of {before_percent:.2} %"
            )
        })
        .collect();
    for (reason, judged) in [
        ("no function makes every run better", true),
        ("only a third run with this channel can show whether a function holds", false),
    ] {
        let of_order_0 =
            |shape: &&ShapeEntry| shape.order == 0 && (shape.runs >= LEAST_RUNS) == judged;
        let names: Vec<&str> =
            shapes.iter().filter(of_order_0).map(|shape| shape.name.as_str()).collect();
        if !names.is_empty() {
            lines.push(format!("{}: F(s) of order 0; {reason}", names.join(", ")));
        }
    }
    lines
}

/// Text lines on what the runs could and could not determine, and on where they and the vehicle file
/// contradict each other.
pub(super) fn statements(
    vehicle: &Vehicle,
    variant: Variant,
    runs: &[Run],
    fitted: &Fitted,
    parameter: &[ParameterEntry],
) -> Result<[Vec<String>; 2], VehicleError> {
    let mut statement = match fitted.procedure {
        Procedure::Compensation => vec![
            "one factor for each channel and no parameter of the truck: the more speed and load differ \
             from the run's, the more of the vehicle file's uncertainty remains"
                .to_owned(),
        ],
        Procedure::MaximumAPosteriori => what_was_determined(parameter),
    };
    statement.extend(certain_ratios(vehicle, variant, runs, fitted)?);
    statement.extend(found_heights(runs, fitted));
    statement.extend(exact_heights(&Positions::of(vehicle)?, runs));
    statement.extend(vehicle.wind.is_none().then(|| WINDLESS.to_owned()));
    statement.extend(advice(vehicle, variant, runs, &fitted.belief)?);
    let distances = distances(vehicle, variant, runs, fitted)?;
    statement.extend(distances.iter().filter(|one| one.sds.abs() <= FAR).map(|one| {
        format!("{one}: check that no axle was lifted, and trailer, springs, mass and sensors of the run")
    }));
    let mut contradiction: Vec<String> =
        distances.iter().filter(|one| one.sds.abs() > FAR).map(ToString::to_string).collect();
    contradiction.extend(far_parameters(parameter));
    if fitted.judgment() != Judgment::Sound {
        contradiction.push(format!(
            "the runs contradict the vehicle file more than its [uncertainty] allows (chi-square \
             {:.1} for {} ratios{}): check heights, masses and units, or raise residual_sd",
            fitted.chi_square,
            fitted.residuals.len(),
            match fitted.heights.iter().flatten().count() {
                0 => String::new(),
                found => format!(" with {found} unknown heights"),
            }
        ));
    }
    Ok([statement, contradiction])
}

/// How well the ratios of each run are known before and after the calibration.
fn certain_ratios(
    vehicle: &Vehicle,
    variant: Variant,
    runs: &[Run],
    fitted: &Fitted,
) -> Result<Vec<String>, VehicleError> {
    let mut lines = Vec::new();
    let prior = Belief::prior(vehicle);
    let positions = Positions::of(vehicle)?;
    for run in runs {
        let vehicle = positions.at(run.lift_axle)?;
        let covariance =
            |belief: &Belief| belief.ratio_covariance(vehicle, variant, run.speed_mps, run.load);
        let (before, after) = (covariance(&prior)?, covariance(&fitted.belief)?);
        let ratios: Vec<String> = Channel::ALL
            .into_iter()
            .filter(|channel| run.ratio[channel.index()].is_some())
            .map(|channel| {
                let k = channel.index();
                let percent =
                    |covariance: &[[f64; CHANNELS]; CHANNELS]| 100.0 * covariance[k][k].sqrt();
                format!("{channel} ratio to {:.1} % (was {:.1})", percent(&after), percent(&before))
            })
            .collect();
        lines.push(format!(
            "{:.1} t at {:.1} m/s: {}",
            run.load.trailer_mass_kg / 1e3,
            run.speed_mps,
            ratios.join(", ")
        ));
    }
    Ok(lines)
}

/// The heights that were not known.
fn found_heights(runs: &[Run], fitted: &Fitted) -> impl Iterator<Item = String> {
    runs.iter().zip(&fitted.heights).filter_map(|(run, found)| {
        let height_m = (*found)?;
        Some(format!("{}: its height is {:.2} ± {:.2} m", run.log, height_m.value, height_m.sd))
    })
}

/// The runs with a load whose height was given without a standard deviation.
fn exact_heights(positions: &Positions<'_>, runs: &[Run]) -> Option<String> {
    let empty = |run: &Run| positions.at(run.lift_axle).map(Vehicle::empty_load).ok();
    let is_exact = |run: &&Run| run.height_sd_m <= 0.0 && empty(run) != Some(run.load);
    let logs: Vec<&str> = runs.iter().filter(is_exact).map(|run| run.log.as_str()).collect();
    (!logs.is_empty()).then(|| {
        format!(
            "height taken as exact, so that no interval contains its error: {}; give its standard deviation too if \
             it has one",
            logs.join(", ")
        )
    })
}

/// How far a ratio is from that of the vehicle file.
#[derive(Debug)]
struct Distance<'a> {
    log: &'a str,
    channel: Channel,
    /// In prior standard deviations.
    sds: f64,
}

impl fmt::Display for Distance<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { log, channel, sds } = self;
        write!(
            f,
            "{log}: the {channel} ratio is {sds:+.1} standard deviations from that of the vehicle file"
        )
    }
}

/// The ratios that are [unusually](UNUSUAL) far from those of the vehicle file.
fn distances<'a>(
    vehicle: &Vehicle,
    variant: Variant,
    runs: &'a [Run],
    fitted: &Fitted,
) -> Result<Vec<Distance<'a>>, VehicleError> {
    let prior = Belief::prior(vehicle);
    let mut all = Vec::new();
    let positions = Positions::of(vehicle)?;
    for residual in &fitted.residuals {
        let run = &runs[residual.run];
        let vehicle = positions.at(run.lift_axle)?;
        let k = residual.channel.index();
        let covariance = prior.ratio_covariance(vehicle, variant, run.speed_mps, run.load)?;
        let weighed = (run.load, run.trailer_mass_sd_kg);
        let by_mass = mass_change(vehicle, variant, run.speed_mps, weighed)?[k];
        let measured = (run.load, run.height_sd_m);
        let by_height = height_change(vehicle, variant, run.speed_mps, measured)?[k];
        let by_load = by_mass * by_mass + by_height * by_height;
        let noise = run.ratio[k].map_or(0.0, |ratio| ratio.relative_variance()) + by_load;
        let sds = residual.before / (covariance[k][k] + noise).sqrt();
        all.push(Distance { log: &run.log, channel: residual.channel, sds });
    }
    all.retain(|one| one.sds.abs() > UNUSUAL);
    Ok(all)
}

/// The parameters that are far from the vehicle file.
fn far_parameters(parameter: &[ParameterEntry]) -> Option<String> {
    let far: Vec<String> = parameter
        .iter()
        .filter_map(|entry| {
            let distance = entry.deviation() / entry.prior_sd;
            let name = entry.name.words();
            (distance.abs() > FAR).then(|| format!("{name} ({distance:+.1})"))
        })
        .collect();
    (!far.is_empty()).then(|| {
        format!(
            "more than {FAR} standard deviations from the vehicle file: {}; check its numbers",
            far.join(", ")
        )
    })
}
