//! Calibration from logs with a known height.
//!
//! The runs are identified with the design, and the calibration changes the design. The calibration
//! is therefore done twice. From the last pass it also learns the shapes of the responses.

use std::path::Path;

use cg_core::{CHANNELS, Channel};
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::shape::{ShapeRun, shapes};
use cg_vehicle::calibration::{Calibration, Fitted, Judgment, Part, Procedure, Run, fit};
use cg_vehicle::lift::Positions;
use cg_vehicle::{Load, Vehicle, VehicleError};

use crate::estimate::{EMPTY_SHARE, Identified, LogEstimator, mass_contradiction};
use crate::same_drive::{are_of_one_drive, values};
use cg_output::Place;

mod run_truck;

use run_truck::{RunTruck, run_trucks};

pub use crate::known::{KnownLoad, KnownLog, KnownMass};
pub use run_truck::CalibrateOptions;

/// Number of passes. A further pass would change the result by less than 0.1 %.
const PASSES: usize = 2;

/// Calibrates a vehicle with logs. `feed` passes the rows of a log to the given estimator.
///
/// # Errors
/// As [`Calibrator`].
pub fn calibrate<E: From<VehicleError>>(
    vehicle: &Vehicle,
    options: CalibrateOptions,
    logs: &[KnownLog],
    feed: impl FnMut(&KnownLog, &mut LogEstimator) -> Result<(), E>,
) -> Result<Calibration, E> {
    Calibrator::new(vehicle, options, logs)?.calibrate(&[], feed)
}

/// The calibration of a vehicle file with logs of known loads. What does not depend on their rows is computed once, so that trucks
/// of one file with the same loads can share it.
#[derive(Debug)]
pub struct Calibrator<'a> {
    vehicle: &'a Vehicle,
    options: CalibrateOptions,
    logs: &'a [KnownLog],
    positions: Positions<'a>,
    /// Those of the first pass, one for each log.
    trucks: Vec<RunTruck>,
}

impl<'a> Calibrator<'a> {
    /// The calibration of a vehicle with these logs.
    ///
    /// # Errors
    /// [`VehicleError`] if a log is given twice, or if a load is impossible for the vehicle.
    pub fn new(
        vehicle: &'a Vehicle,
        options: CalibrateOptions,
        logs: &'a [KnownLog],
    ) -> Result<Self, VehicleError> {
        check(vehicle, logs)?;
        let trucks = run_trucks(vehicle, options, &Belief::prior(vehicle), logs)?;
        Ok(Self { vehicle, options, logs, positions: Positions::of(vehicle)?, trucks })
    }

    /// The calibration of a truck. `feed` passes the rows of one of its logs to the given estimator; `trips` are those of the empty
    /// trailer in service, as [`runs_of`](crate::state::runs_of) state files.
    ///
    /// # Errors
    /// The errors of `feed`, and [`VehicleError`] if a log has no turn or no trailer mass, or if the runs contradict the vehicle
    /// file beyond chance.
    pub fn calibrate<E: From<VehicleError>>(
        &self,
        trips: &[Run],
        mut feed: impl FnMut(&KnownLog, &mut LogEstimator) -> Result<(), E>,
    ) -> Result<Calibration, E> {
        let &Self { vehicle, options, logs, .. } = self;
        let CalibrateOptions { variant, part, force, .. } = options;
        let (of_states, mut trips) = (trips.len(), trips.to_vec());
        let mut pass = self.pass(&self.trucks, &mut trips, false, &mut feed)?;
        for number in 2..=PASSES {
            let trucks = run_trucks(vehicle, options, &pass.fitted.belief, logs)?;
            pass = self.pass(&trucks, &mut trips, number == PASSES, &mut feed)?;
        }
        let Pass { runs, fitted, shape_runs, mut doubts, assumed_flat } = pass;
        let mut calibration = Calibration::new(vehicle, variant, &runs, &fitted)?;
        calibration.statement.append(&mut doubts);
        calibration.statement.extend(flat_roads(&assumed_flat, logs.len()));
        calibration.statement.extend(same_drives(&runs));
        calibration.statement.extend(counted_once(of_states - trips.len()));
        if let (Judgment::Contradictory { .. }, false) = (calibration.judgment(), force) {
            return Err(VehicleError::Model(format!(
                "no calibration is made: {}; ⟨force⟩ makes it nevertheless, with intervals {:.1} times as \
                 wide",
                calibration.contradiction.join("; "),
                calibration.judgment().birge()
            ))
            .into());
        }
        if part == Part::Tractor {
            return Ok(calibration.of_tractor(vehicle)?);
        }
        calibration.add_shapes(&shapes(vehicle, variant, &fitted.belief, &shape_runs)?);
        Ok(calibration)
    }

    /// Identifies all runs, records them for the shapes if this is the last pass, and fits the parameters to them and to the trips
    /// that are not among them.
    fn pass<E: From<VehicleError>>(
        &self,
        trucks: &[RunTruck],
        trips: &mut Vec<Run>,
        is_last: bool,
        feed: &mut impl FnMut(&KnownLog, &mut LogEstimator) -> Result<(), E>,
    ) -> Result<Pass, E> {
        let &Self { vehicle, options, logs, .. } = self;
        let (mut runs, mut turns_sd) = (Vec::new(), Vec::new());
        let (mut shape_runs, mut doubts, mut assumed_flat) = (Vec::new(), Vec::new(), Vec::new());
        for (known, truck) in logs.iter().zip(trucks) {
            let mut estimator = truck.estimator();
            if is_last {
                estimator.record();
            }
            feed(known, &mut estimator)?;
            let recorder = estimator.recorder();
            let identified = estimator.identified();
            let vehicle = self.positions.at(identified.lift_axle)?;
            doubts.extend(doubted(vehicle, known, &identified));
            assumed_flat.extend(by_road(&identified).then(|| known.log.clone()));
            let mut run = run_of(vehicle, known, &identified)?;
            // The factor makes up for all that the model lacks in this log, its turns included.
            if options.procedure == Procedure::Compensation {
                run.turn_g = None;
            }
            // The model of a shape is that at the run's own height.
            let recorder = recorder.filter(|_| run.height_is_known() && run.lift_axle.is_down());
            shape_runs.extend(recorder.map(|recorder| recorder.finish(run.load, run.speed_mps)));
            runs.push(run);
            turns_sd.push(identified.turns_sd);
        }
        count_together(&mut runs, &turns_sd, logs);
        forget_given(trips, &runs);
        runs.extend_from_slice(trips);
        let fitted = fit(vehicle, options.variant, options.procedure, &runs)?;
        Ok(Pass { runs, fitted, shape_runs, doubts, assumed_flat })
    }
}

/// What a pass finds.
struct Pass {
    /// Those of the logs, then the trips.
    runs: Vec<Run>,
    fitted: Fitted,
    shape_runs: Vec<ShapeRun>,
    doubts: Vec<String>,
    /// Names of the logs whose roads count as flat because nothing is said of them.
    assumed_flat: Vec<String>,
}

/// What is doubtful in a run: a log that contradicts the given mass, an unknown lift axle, turns that are strong or tight, and
/// what an estimate says of the whole log. The mass of an empty trailer is in its papers.
fn doubted(vehicle: &Vehicle, known: &KnownLog, identified: &Identified) -> Vec<String> {
    let given = known.load.trailer_mass(vehicle).filter(|_| known.load != KnownLoad::Empty);
    let masses = given.zip(identified.logged_mass_kg);
    let of_mass = masses.and_then(|(given, logged_kg)| mass_contradiction(given.kg, logged_kg));
    let of_lift = identified.lift_unknown.map(str::to_owned);
    let mut all: Vec<String> = of_mass.into_iter().chain(of_lift).collect();
    all.extend_from_slice(&identified.turns);
    let others = identified.notes.iter().filter(|note| !all.contains(note));
    // A calibration has no such option.
    let in_file = |note: &String| note.replace("give ⟨speed_mps⟩", "add the speed to the log");
    let others: Vec<_> = others.map(|note| in_file(note).replace(['⟨', '⟩'], "")).collect();
    all.into_iter().chain(others).map(|found| format!("{}: {found}", known.log)).collect()
}

/// Whether a bank of its roads, of which nothing is said, would change its ratios.
fn by_road(identified: &Identified) -> bool {
    let mut ratios = Channel::ALL.into_iter().zip(&identified.ratio);
    identified.is_assumed_flat
        && ratios.any(|(channel, ratio)| channel.feels_bank() && ratio.is_some())
}

/// What is said of runs whose roads count as flat: all of them, or those with these names.
fn flat_roads(names: &[String], runs: usize) -> Option<String> {
    let which = if names.len() < runs { names.join(", ") } else { "the runs".to_owned() };
    (!names.is_empty()).then(|| {
        format!(
            "nothing says on which roads {which} were, so they count as flat: curves that all lean to their inside by 1 % make later \
             heights about 6 % too low, which no interval contains. [road] in the vehicle file, or an option, says whether they \
             were flat or public"
        )
    })
}

/// What is said of runs that are one drive.
fn same_drives(runs: &[Run]) -> Vec<String> {
    let pairs = runs
        .iter()
        .enumerate()
        .flat_map(|(i, run)| runs[..i].iter().map(move |first| (first, run)));
    let are_one =
        |(first, run): &(&Run, &Run)| are_of_one_drive(&values(&first.ratio), &values(&run.ratio));
    let said = |(first, run): (&Run, &Run)| {
        format!(
            "{} and {} have the same ratios, as logs of one drive have, and count as two: leave one of them out",
            first.log, run.log
        )
    };
    pairs.filter(are_one).map(said).collect()
}

/// Checks what can be checked before a log is read.
fn check(vehicle: &Vehicle, logs: &[KnownLog]) -> Result<(), VehicleError> {
    let (least_m, greatest_m) = (vehicle.height.least_m, vehicle.height.greatest_m);
    for (i, known) in logs.iter().enumerate() {
        let height_m = known.load.height_m(vehicle).value;
        if !(least_m..=greatest_m).contains(&height_m) {
            return Err(VehicleError::Model(format!(
                "{}: height {height_m} m is outside the vehicle file's range {least_m} to {greatest_m} m",
                known.log
            )));
        }
        if let Some(again) = logs[..i].iter().find(|other| is_same_log(&other.log, &known.log)) {
            let names = if again.log == known.log {
                known.log.clone()
            } else {
                format!("{} (the same file as {})", known.log, again.log)
            };
            return Err(VehicleError::Model(format!("{names}: given twice")));
        }
        if let Some(KnownMass { kg: trailer_mass_kg, .. }) = known.load.trailer_mass(vehicle) {
            vehicle.trailer_sprung_mass(Load { trailer_mass_kg, cg_height_m: height_m })?;
            let greatest_kg =
                vehicle.align_settings().mass_range_kg.map_or(f64::MAX, |range| range[1]);
            if !(trailer_mass_kg <= greatest_kg) {
                return Err(VehicleError::Model(format!(
                    "{}: trailer mass {trailer_mass_kg:.0} kg is impossible (the vehicle file allows {:.0} to \
                     {greatest_kg:.0} kg)",
                    known.log,
                    vehicle.empty_trailer_mass_kg()
                )));
            }
        }
    }
    Ok(())
}

/// Whether both names are of one log; a file has several, by links and by other folders.
fn is_same_log(one: &str, other: &str) -> bool {
    let place = |log: &str| Place::of(Path::new(log));
    one == other || place(one).is_some_and(|place_of_one| Some(place_of_one) == place(other))
}

/// What strong, tight and unsteady turns make of ratios has one sign in all runs, and does not average out: of as many runs as
/// have it, each counts for that much less, so that all together have it once.
fn count_together(runs: &mut [Run], turns_sd: &[[f64; CHANNELS]], logs: &[KnownLog]) {
    count_once(runs, logs);
    for channel in 0..CHANNELS {
        let have = |(run, sd): (&Run, &[f64; CHANNELS])| run.ratio[channel].map(|_| sd[channel]);
        let sds: Vec<_> = runs.iter().zip(turns_sd).filter_map(have).collect();
        for (run, own) in runs.iter_mut().zip(turns_sd) {
            let own = own[channel];
            let others: f64 = sds.iter().map(|sd| (sd / own).min(1.0)).sum::<f64>() - 1.0;
            if let Some(ratio) = run.ratio[channel].as_mut().filter(|_| own > 0.0) {
                ratio.sd = libm::hypot(ratio.sd, others.max(0.0).sqrt() * own * ratio.value);
            }
        }
    }
}

/// A height or a mass that is given for several runs was measured once: of as many runs as have it, each counts for that much less,
/// so that all together have it once.
fn count_once(runs: &mut [Run], logs: &[KnownLog]) {
    for (run, known) in runs.iter_mut().zip(logs) {
        let KnownLoad::Laden { trailer_mass, .. } = known.load else { continue };
        #[allow(clippy::cast_precision_loss)] // a handful
        let have = logs.iter().filter(|other| other.load == known.load).count() as f64;
        run.height_sd_m *= have.sqrt();
        if trailer_mass.is_some() {
            run.trailer_mass_sd_kg *= have.sqrt();
        }
    }
}

/// Removes trips from which a truck has learned and whose log is given, too.
fn forget_given(trips: &mut Vec<Run>, runs: &[Run]) {
    trips.retain(|trip| {
        let same = |run: &Run| are_of_one_drive(&values(&run.ratio), &values(&trip.ratio));
        !runs.iter().any(same)
    });
}

/// What is said of trips that were removed.
fn counted_once(trips: usize) -> Option<String> {
    (trips > 0).then(|| {
        format!("{trips} of the trips in state files are logs of this calibration and count once")
    })
}

/// The run of a log that an estimator with a [design for ratios](cg_vehicle::design::RatioDesign) has read.
///
/// # Errors
/// [`VehicleError`] if no ratio was identified, or if the mass is not known or is not that of the load.
pub fn run(
    vehicle: &Vehicle,
    known: &KnownLog,
    estimator: LogEstimator,
) -> Result<Run, VehicleError> {
    let identified = estimator.identified();
    run_of(Positions::of(vehicle)?.at(identified.lift_axle)?, known, &identified)
}

/// Checks that a log can be a run: signals, one load, one position of the lift axles, and a mass.
fn check_log(known: &KnownLog, identified: &Identified) -> Result<(), VehicleError> {
    if let Some(wrong) = &identified.wrong_signal {
        return Err(VehicleError::Model(format!(
            "{}: {wrong}; an estimate of this log has no height, and later ones would rest on it: correct the signal and record the \
             run again, or leave it out",
            known.log
        )));
    }
    if let Some(since_s) = identified.load_since_s {
        return Err(VehicleError::Model(format!(
            "{}: the load, or a sensor, changed before {since_s:.0} s, but a run has one load: give a log of one of them",
            known.log
        )));
    }
    if let Some(contradiction) = identified.lift_contradiction {
        return Err(VehicleError::Model(format!("{}: {contradiction}", known.log)));
    }
    if let Some(moved_s) = identified.lift_moved_s {
        return Err(VehicleError::Model(format!(
            "{}: the lift axle moved at {moved_s:.0} s, but a run has it in one position: give a log of one of them",
            known.log
        )));
    }
    if !identified.trailer_mass_is_known {
        return Err(VehicleError::Model(format!(
            "{}: the log has no trailer mass in its turns; give it with the run's height (on the command line \
             LOG=HEIGHT_M,TRAILER_MASS_KG)",
            known.log
        )));
    }
    Ok(())
}

fn run_of(
    vehicle: &Vehicle,
    known: &KnownLog,
    identified: &Identified,
) -> Result<Run, VehicleError> {
    if known.load == KnownLoad::Empty
        && let Some(mass_kg) = identified.logged_mass_kg
    {
        let empty_kg = vehicle.empty_trailer_mass_kg();
        if !((mass_kg / empty_kg - 1.0).abs() <= EMPTY_SHARE) {
            return Err(VehicleError::Model(format!(
                "{}: the mass in the log is {mass_kg:.0} kg, but an empty trailer has {empty_kg:.0} kg; \
                 give the height and the mass of its load instead of \"empty\"",
                known.log
            )));
        }
    }
    check_log(known, identified)?;
    if identified.ratio.iter().all(Option::is_none) {
        return Err(VehicleError::Model(format!(
            "{}: no ratio can be identified: {}",
            known.log,
            identified.messages.join("; ")
        )));
    }
    let height_m = known.load.height_m(vehicle);
    // That of the empty trailer is in its papers.
    let weighed = known.load != KnownLoad::Empty;
    let trailer_mass_sd_kg = if weighed { identified.trailer_mass_sd_kg } else { 0.0 };
    let load = Load { trailer_mass_kg: identified.trailer_mass_kg, cg_height_m: height_m.value };
    vehicle.trailer_sprung_mass(load)?;
    Ok(Run {
        log: known.log.clone(),
        load,
        height_sd_m: height_m.sd,
        trailer_mass_sd_kg,
        lift_axle: identified.lift_axle,
        speed_mps: identified.speed_mps,
        turn_g: identified.turn_g,
        ratio: identified.ratio,
        age_s: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cg_core::Measured;
    use cg_vehicle::lift::LiftAxle;

    fn run(ratio_sd: Option<f64>) -> Run {
        let ratio = ratio_sd.map(|sd| Measured { value: 2.0, sd: 2.0 * sd });
        Run {
            log: String::new(),
            load: Load { trailer_mass_kg: 20e3, cg_height_m: 1.8 },
            height_sd_m: 0.0,
            trailer_mass_sd_kg: 0.0,
            lift_axle: LiftAxle::Down,
            speed_mps: 15.0,
            turn_g: None,
            ratio: [ratio, None, None, None],
            age_s: None,
        }
    }

    /// The relative standard deviation of the mean of all runs by their weights.
    fn of_mean(runs: &[Run]) -> f64 {
        let precision = |run: &Run| run.ratio[0].map(|ratio| (ratio.value / ratio.sd).powi(2));
        runs.iter().filter_map(precision).sum::<f64>().sqrt().recip()
    }

    /// Noise of 3 % averages out over four runs, the 4 % of their turns do not: √(0.015² + 0.04²). A run without such turns
    /// counts for as much as before, and one with smaller ones takes part in proportion.
    #[test]
    fn what_turns_make_of_ratios_does_not_average_out() {
        let both = f64::hypot(0.03, 0.04);
        let turns = |share: f64| [share * 0.04, 0.0, 0.0, 0.0];
        let mut runs = vec![run(Some(both)), run(Some(both)), run(Some(both)), run(Some(both))];
        count_together(&mut runs, &[turns(1.0); 4], &[]);
        assert!((of_mean(&runs) / f64::hypot(0.015, 0.04) - 1.0).abs() < 1e-12);

        let mut runs = vec![run(Some(both)), run(Some(0.03)), run(Some(0.05)), run(None)];
        let turns = [turns(1.0), turns(0.0), turns(0.25), turns(1.0)];
        count_together(&mut runs, &turns, &[]);
        let found: Vec<_> = runs.iter().map(|run| run.ratio[0].map(|one| one.sd / 2.0)).collect();
        let [Some(one), Some(none), Some(less), None] = found[..] else { panic!("{found:?}") };
        assert!((one - (0.03_f64.powi(2) + 1.25 * 0.04_f64.powi(2)).sqrt()).abs() < 1e-15);
        assert!((none - 0.03).abs() < 1e-15);
        // As many of its own size as there are runs with such turns.
        assert!((less - (0.05_f64.powi(2) + 0.01_f64.powi(2)).sqrt()).abs() < 1e-15);
    }
}
