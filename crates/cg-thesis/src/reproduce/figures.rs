//! The figures and insets that belong to the tables: curves of ours, and the thesis's printed values as
//! points beside them. The steps are those of the tables.

use cg_core::truck::reduced::ORDER;
use cg_vehicle::error::VehicleError;
use cg_vehicle::system::Rational;

use super::baseline::{Baseline, Options};
use super::compensated::reductions_of;
use super::histories::{History, histories, step};
use super::identified::{STEER_RAD, printed_responses};
use super::list::table;
use super::monte_carlo::{INTERVAL_S, RATE_PER_S, steps};
use super::nonlinear::Known;
use super::row::Row;
use super::transfer::{as_printed, printed_roots};
use crate::study::{Abscissa, Panel, Quantity, Series, Study, Unit, legend_of_printed};

const TIME: Quantity = Quantity { name: "time", label: "Time", unit: Unit::Second };
const ROLL: Quantity =
    Quantity { name: "trailer_roll", label: "Roll angle of the semitrailer", unit: Unit::Radian };
const ERROR: Quantity =
    Quantity { name: "height_error", label: "Error of the height", unit: Unit::One };

/// The figures of a table, in the order of the thesis's pages.
const FIGURES: [(&str, Draw); 8] = [
    ("reproduce-4.1", roots),
    ("reproduce-4.2-C", responses),
    ("reproduce-5.1", compensations),
    ("reproduce-5.3", reductions),
    ("reproduce-5.4-5.8", identified),
    ("reproduce-5.8-log", log),
    ("reproduce-5.9", by_noise),
    ("reproduce-5.10-5.11", springs_and_heights),
];

type Draw = fn(&Baseline, &Options) -> Result<(String, Vec<Panel>), VehicleError>;

/// All figures of chapters 4 and 5 and of appendix C, each as a study without statements.
///
/// # Errors
/// [`VehicleError`] if a table cannot be computed.
pub fn figures(options: &Options) -> Result<Vec<Study>, VehicleError> {
    let base = Baseline::new()?;
    let draw = |(name, draw): (&'static str, Draw)| {
        let (finding, panels) = draw(&base, options)?;
        let scenario = vec![legend_of_printed(&panels).to_owned()];
        Ok(Study { name, finding, scenario, panels, statements: Vec::new() })
    };
    FIGURES.into_iter().map(draw).collect()
}

/// The names of the files of [`figures`].
pub fn figure_names() -> impl Iterator<Item = &'static str> {
    FIGURES.into_iter().map(|(name, _)| name)
}

fn panel(
    figure: &'static str,
    title: &'static str,
    (x, y): (Quantity, Quantity),
    series: Vec<Series>,
) -> Panel {
    Panel { figure, title, x: Abscissa::Over(x), y, series }
}

/// A curve over time.
fn curve(name: &str, kind: usize, values: &[f64]) -> Series {
    #[allow(clippy::cast_precision_loss)] // some hundreds
    let points = values.iter().enumerate().map(|(k, value)| [k as f64 * INTERVAL_S, *value]);
    Series::new(name, kind, points.collect())
}

/// Fig. 4.1.
fn roots(base: &Baseline, _: &Options) -> Result<(String, Vec<Panel>), VehicleError> {
    let axis = |name, label| Quantity { name, label, unit: Unit::PerSecond };
    let both = (axis("real_part", "Real part"), axis("imaginary_part", "Imaginary part"));
    let ours = as_printed(base)?;
    let printed = printed_roots()?;
    // Two zeros far out on the real axis would hide the others.
    let near = |roots: &[(f64, f64)]| -> Vec<[f64; 2]> {
        let upper = roots.iter().filter(|root| root.1 >= 0.0 && root.0.abs() < 100.0);
        upper.map(|root| [root.0, root.1]).collect()
    };
    let series = vec![
        Series::new("poles", 0, near(&ours.poles)).apart(),
        Series::new("zeros", 1, near(&ours.zeros)).apart(),
        Series::new("thesis, Table 4.2", 2, near(&printed)).printed(),
    ];
    let finding = "Poles and zeros of the as-printed model in the upper half plane; the real zeros at \
                   −532.8 and 493.9 1/s are outside";
    Ok((finding.to_owned(), vec![panel("4.1", "Poles and zeros", both, series)]))
}

/// Fig. 4.2 and appendix C.
fn responses(base: &Baseline, _: &Options) -> Result<(String, Vec<Panel>), VehicleError> {
    const PLACES: [&str; 10] =
        ["C.1", "C.2", "C.3", "C.4", "4.2 and C.5", "C.6", "C.7", "C.8", "C.9", "C.10"];
    const TITLES: [&str; 10] = [
        "Tractor lateral velocity",
        "Tractor yaw angle",
        "Tractor roll angle",
        "Semitrailer yaw angle",
        "Semitrailer roll angle",
        "Roll angle of axle 1",
        "Roll angle of axle 2",
        "Roll angle of axle 3",
        "Roll angle of axle 4",
        "Roll angle of axle 5",
    ];
    let all = histories(base, &step(&Known::new(base)?)?);
    let drawn = |(history, (figure, title)): (&History, (&'static str, &'static str))| {
        let y = match history.unit {
            "m/s" => {
                Quantity { name: "velocity", label: "Lateral velocity", unit: Unit::MeterPerSecond }
            }
            _ => Quantity { name: "angle", label: "Angle", unit: Unit::Radian },
        };
        let series = vec![
            curve("nonlinear plant", 0, &history.plant),
            curve("linear, complete", 1, &history.complete),
            curve("linear, as printed", 2, &history.as_printed).aside(),
        ];
        panel(figure, title, (TIME, y), series)
    };
    let panels = all.iter().zip(PLACES.into_iter().zip(TITLES)).map(drawn).collect();
    let finding = "The ten responses to a rounded step of 0.19 g at 50 km/h: without the moment of the \
                   fifth wheel the roll angles are too small";
    Ok((finding.to_owned(), panels))
}

/// Insets of Table 5.1.
fn compensations(base: &Baseline, _: &Options) -> Result<(String, Vec<Panel>), VehicleError> {
    const TITLES: [&str; 6] = ["Order 1", "Order 2", "Order 3", "Order 4", "Order 5", "Order 6"];
    let known = Known::new(base)?;
    let log = known.calibration_log(&known.vehicle)?;
    let analytical = known.analytical(&log);
    let functions = known.functions()?;
    let panels = functions.iter().zip(TITLES).map(|(function, title)| {
        let compensated = function.function.system().response(&analytical, INTERVAL_S);
        let series = vec![
            curve("nonlinear plant", 0, &log.roll),
            curve("as printed, compensated", 1, &compensated).aside(),
            curve("as printed", 2, &analytical),
        ];
        panel("", title, (TIME, ROLL), series)
    });
    let finding = "Table 5.1: compensation functions of order 1 to 6 make the as-printed model roll like \
                   the nonlinear plant";
    Ok((finding.to_owned(), panels.collect()))
}

/// Insets of Table 5.3.
fn reductions(base: &Baseline, _: &Options) -> Result<(String, Vec<Panel>), VehicleError> {
    const TITLES: [&str; 6] = ["Order 0", "Order 1", "Order 2", "Order 3", "Order 4", "Order 5"];
    let steer: Vec<f64> = steps(1, INTERVAL_S).iter().map(|step| STEER_RAD * step).collect();
    let (whole, reduced) = reductions_of(base)?;
    let whole = whole.response(&steer, INTERVAL_S).iter().map(|y| -y).collect::<Vec<_>>();
    let panels = reduced.iter().zip(TITLES).map(|(reduced, title)| {
        let response = of_function(reduced, &steer);
        let series = vec![curve("order 21", 0, &whole), curve("reduced", 1, &response).aside()];
        panel("", title, (TIME, ROLL), series)
    });
    let panels = panels.collect();
    Ok(("Table 5.3: the reduced transfer functions in a rounded step of rate 1".to_owned(), panels))
}

/// The response of a function that may have no dynamics.
fn of_function(function: &Rational, steer: &[f64]) -> Vec<f64> {
    if function.denominator.len() < 2 {
        return steer.iter().map(|u| function.dc_gain() * u).collect();
    }
    let leading = function.denominator[function.denominator.len() - 1];
    let scaled = |list: &[f64]| list.iter().map(|value| value / leading).collect();
    let monic = Rational {
        numerator: scaled(&function.numerator),
        denominator: scaled(&function.denominator),
    };
    monic.system().response(steer, INTERVAL_S)
}

/// Insets of Tables 5.4 and 5.8: the printed functions beside eq. 5.12.
fn identified(_: &Baseline, _: &Options) -> Result<(String, Vec<Panel>), VehicleError> {
    let mut panels = Vec::new();
    for (title, printed) in printed_responses()? {
        let steer: Vec<f64> =
            steps(printed.rate_per_s, INTERVAL_S).iter().map(|step| STEER_RAD * step).collect();
        let series = vec![
            curve("eq. 5.12", 0, &of_function(&printed.original, &steer)),
            curve("thesis, identified", 1, &of_function(&printed.function, &steer)).aside(),
        ];
        panels.push(panel("", title, (TIME, ROLL), series));
    }
    let finding = format!(
        "Tables 5.4 and 5.8: responses of the printed functions of order {ORDER} and of eq. 5.12, \
         rate {RATE_PER_S} with noise"
    );
    Ok((finding, panels))
}

/// Fig. 5.8.
fn log(base: &Baseline, _: &Options) -> Result<(String, Vec<Panel>), VehicleError> {
    let step = step(&Known::new(base)?)?;
    let of = |value: fn(&cg_plant::plant::PlantSample) -> f64| -> Vec<f64> {
        step.samples.iter().map(value).collect()
    };
    let steer = Quantity { name: "steer", label: "Road-wheel angle", unit: Unit::Radian };
    let lateral = Quantity {
        name: "lateral_acceleration",
        label: "Lateral acceleration",
        unit: Unit::MeterPerSecondSquared,
    };
    let both = vec![
        curve("semitrailer", 0, &of(|s| s.trailer.lateral_acceleration_mps2)),
        curve("tractor", 1, &of(|s| s.tractor.lateral_acceleration_mps2)).aside(),
    ];
    let panels = vec![
        panel("5.8", "Steer angle", (TIME, steer), vec![curve("steer", 0, &step.steer)]),
        panel(
            "5.8",
            "Roll angle",
            (TIME, ROLL),
            vec![curve("roll", 0, &of(|s| s.trailer.roll_rad))],
        ),
        panel("5.8", "Lateral accelerations", (TIME, lateral), both),
    ];
    Ok(("The log of section 5.7 from the nonlinear plant".to_owned(), panels))
}

/// The number that follows `before` in the items of rows, with the printed and the recomputed value, for
/// rows whose item ends with `after`; percentages become shares.
fn over(rows: &[Row], before: &str, after: &str) -> [Vec<[f64; 2]>; 2] {
    let mut sides = [Vec::new(), Vec::new()];
    for row in rows {
        let Some(rest) = row.item.strip_prefix(before).filter(|rest| rest.ends_with(after)) else {
            continue;
        };
        let number = rest.split(' ').next().and_then(|number| number.parse::<f64>().ok());
        let Some(x) = number else { continue };
        for (side, value) in sides.iter_mut().zip([row.thesis, row.ours]) {
            side.extend(value.map(|percent| [x, percent / 100.0]));
        }
    }
    sides
}

/// Table 5.9.
fn by_noise(_: &Baseline, options: &Options) -> Result<(String, Vec<Panel>), VehicleError> {
    const TITLES: [&str; 5] = ["Order 1", "Order 2", "Order 3", "Order 4", "Order 5"];
    let rows = table("5.9", options)?;
    let snr = Quantity { name: "snr", label: "Signal-to-noise ratio", unit: Unit::Decibel };
    let panels = TITLES.into_iter().enumerate().map(|(i, title)| {
        let [thesis, ours] = over(&rows, &format!("order {}, ", i + 1), "dB: ARX bias, %");
        let [_, scatter] = over(&rows, &format!("order {}, ", i + 1), "dB: ARX RMSE, %");
        let mut mean = Series::new("ARX, mean and twice the RMSE", 0, ours);
        mean.intervals = mean
            .points
            .iter()
            .zip(&scatter)
            .map(|(p, s)| [p[1] - 2.0 * s[1], p[1] + 2.0 * s[1]])
            .collect();
        panel(
            "",
            title,
            (snr, ERROR),
            vec![mean, Series::new("thesis, one draw", 1, thesis).printed()],
        )
    });
    let finding = "Table 5.9: the thesis's single draws and the distribution from which they come";
    Ok((finding.to_owned(), panels.collect()))
}

/// Tables 5.10 and 5.11.
fn springs_and_heights(
    _: &Baseline,
    options: &Options,
) -> Result<(String, Vec<Panel>), VehicleError> {
    let (springs, heights) = (table("5.10", options)?, table("5.11", options)?);
    let stiffness =
        Quantity { name: "stiffness", label: "Stiffness of the springs", unit: Unit::One };
    let height = Quantity { name: "cg_height", label: "C.g. height", unit: Unit::Meter };
    let shares = |points: Vec<[f64; 2]>| points.into_iter().map(|[x, y]| [x / 100.0, y]).collect();
    let beside = |rows: &[Row], before: &str, after: [&str; 2], share: bool| {
        let [thesis, arx] = over(rows, before, after[0]);
        let [_, own] = over(rows, before, after[1]);
        let [thesis, arx, own] = [thesis, arx, own].map(|p| if share { shares(p) } else { p });
        vec![
            Series::new("thesis's procedure, our plant", 0, arx),
            Series::new("ours, our plant", 1, own),
            Series::new("thesis", 2, thesis).printed(),
        ]
    };
    let before =
        ["own plant, bias, baseline F(s), ARX, %", "own plant, bias, baseline R_c, filtered, %"];
    let after =
        ["own plant, bias, updated F(s), ARX, %", "own plant, bias, updated R_c, filtered, %"];
    let over_heights =
        ["own plant, bias, F(s) and ARX, %", "own plant, bias, complete and filtered, %"];
    let panels = vec![
        panel(
            "",
            "Table 5.10, not recalibrated",
            (stiffness, ERROR),
            beside(&springs, "", before, true),
        ),
        panel(
            "",
            "Table 5.10, recalibrated",
            (stiffness, ERROR),
            beside(&springs, "", after, true),
        ),
        panel("", "Table 5.11", (height, ERROR), beside(&heights, "true ", over_heights, false)),
    ];
    let finding =
        "Errors of the height with other springs and at other heights; calibrated on another log";
    Ok((finding.to_owned(), panels))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_points_and_the_thesis_s_values_are_marked() {
        let all = figures(&Options { runs: 5, ..Options::default() }).unwrap();
        assert_eq!(all.len(), figure_names().count());
        for study in &all {
            for panel in &study.panels {
                for series in &panel.series {
                    let finite = series.points.iter().flatten().all(|value| value.is_finite());
                    assert!(finite && !series.points.is_empty(), "{} {}", panel.title, series.name);
                }
            }
        }
        let printed = |name: &str| {
            let study = all.iter().find(|study| study.name == name).unwrap();
            let series = study.panels.iter().flat_map(|panel| &panel.series);
            series.filter(|series| series.printed).map(|series| series.points.len()).sum::<usize>()
        };
        // Five orders of six noises; seven springs before and after, eight heights.
        assert_eq!((printed("reproduce-5.9"), printed("reproduce-5.10-5.11")), (30, 22));
    }
}
