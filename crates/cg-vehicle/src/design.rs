//! Computes the constants of the estimator (its design) from a vehicle.

use cg_core::truck::design::{MASSES, SPEEDS, SPRING_MASSES, STEPS};
use cg_core::truck::rollover::HEIGHTS;
use cg_core::{
    Articulation, CHANNELS, Channel, ChannelDesign, Design, Friction, RatioLine, Spread,
    ThresholdLine,
};

use crate::articulation::articulations;
use crate::balance::greatest_mass_kg;
use crate::belief::Belief;
use crate::equations::{Equations, Variant};
use crate::error::VehicleError;
use crate::friction::roll_friction;
use crate::linear::{Laden, ratio_line, ratio_line_at};
use crate::load::Load;
use crate::reduction::{ReducedModels, Shapes, reduce};
use crate::steady_turn::{rollover, thresholds_g};
use crate::trailer_path::lead;
use crate::vehicle::Vehicle;

/// Speed axis of a design; one of the speeds is replaced by the nominal speed of the vehicle.
const GRID_MPS: [f64; SPEEDS] = [3.0, 4.0, 5.5, 8.0, 12.0, 17.0, 23.0, 30.0];

/// Computes the design of a vehicle from its file, without a calibration.
///
/// # Errors
/// [`VehicleError`] if the model is unstable, or not known at the nominal speed and load.
pub fn design(vehicle: &Vehicle, variant: Variant) -> Result<Design<f64>, VehicleError> {
    design_with(vehicle, variant, &Belief::prior(vehicle))
}

/// Computes the design of a vehicle with a distribution of its parameters: the prior, or the
/// posterior of a calibration.
///
/// # Errors
/// [`VehicleError`] if the model is unstable, or not known at the nominal speed and load. The error
/// names the least usual keys of the vehicle file.
pub fn design_with(
    file: &Vehicle,
    variant: Variant,
    belief: &Belief,
) -> Result<Design<f64>, VehicleError> {
    let vehicle = &belief.applied_to(file);
    let complete = || {
        let design = without_thresholds(file, vehicle, variant, belief)?;
        with_thresholds(design, (vehicle, variant), belief.roll_gain(), heights(vehicle))
    };
    complete().map_err(|error| error.of_vehicle(file))
}

/// What designs for runs of known height have in common. Only the ratio of a run is needed, so no height is rejected.
#[derive(Debug)]
pub struct RatioDesign {
    vehicle: Vehicle,
    variant: Variant,
    roll_gain: f64,
    design: Design<f64>,
}

impl RatioDesign {
    /// For a vehicle with a distribution of its parameters.
    ///
    /// # Errors
    /// As [`design_with`].
    pub fn new(file: &Vehicle, variant: Variant, belief: &Belief) -> Result<Self, VehicleError> {
        let vehicle = belief.applied_to(file);
        let design = without_thresholds(file, &vehicle, variant, belief)
            .map_err(|error| error.of_vehicle(file))?;
        Ok(Self { vehicle, variant, roll_gain: belief.roll_gain(), design })
    }

    /// The design for runs of this height, m: all of its rollover thresholds are those of a load at this height.
    ///
    /// # Errors
    /// [`VehicleError`] if the vehicle has no rollover threshold, or no usable design.
    pub fn at_height(&self, cg_height_m: f64) -> Result<Design<f64>, VehicleError> {
        let Self { vehicle, variant, roll_gain, design } = self;
        let design = with_thresholds(*design, (vehicle, *variant), *roll_gain, [cg_height_m])?;
        Ok(Design { least_height_m: -1e3, greatest_height_m: 1e3, ..design })
    }
}

/// The design of a vehicle as the mean of a belief has it.
fn without_thresholds(
    file: &Vehicle,
    vehicle: &Vehicle,
    variant: Variant,
    belief: &Belief,
) -> Result<Design<f64>, VehicleError> {
    let load = vehicle.reference_load();
    let trailer_mass_kg = masses(vehicle, variant);
    let speed_mps = speeds(vehicle, variant, &trailer_mass_kg)?;
    let flat = RatioLine { a0: 0.0, a1: 0.0, b0: 0.0, b1: 0.0 };
    let mut lines = [[[flat; MASSES]; SPEEDS]; CHANNELS];
    let mut spread = [[Spread { covariance: [[0.0; CHANNELS]; CHANNELS] }; MASSES]; SPEEDS];
    for (j, &mass_kg) in trailer_mass_kg.iter().enumerate() {
        let load = at_mass(vehicle, variant, mass_kg);
        let laden = Laden::new(vehicle, variant, load)?;
        let covariances = belief.ratio_covariances(file, variant, speed_mps, load)?;
        for (i, (&speed_mps, covariance)) in speed_mps.iter().zip(covariances).enumerate() {
            for (channel, line) in ratio_line_at(&laden, speed_mps)?.into_iter().enumerate() {
                lines[channel][i][j] = line;
            }
            spread[i][j] = Spread { covariance };
        }
    }
    let models = models(vehicle, variant, &belief.shapes, &trailer_mass_kg)?;
    let articulation = match variant {
        Variant::Complete => articulations(vehicle, load)?,
        Variant::AsPrinted => [Articulation::NONE; CHANNELS],
    };
    #[allow(clippy::cast_possible_truncation)] // below the number of channels
    let channel = |channel: Channel| ChannelDesign {
        index: channel.index() as u32,
        models: models.map(|reduced| reduced.of_channels[channel.index()]),
        friction: [Friction::NONE; SPRING_MASSES],
        of_lines: [1.0; SPRING_MASSES],
        articulation: articulation[channel.index()],
        lines: lines[channel.index()],
        compensation: belief.gain(channel),
    };
    let mut design = Design {
        speed_mps,
        trailer_mass_kg,
        channels: Channel::ALL.map(channel),
        spread,
        nominal_speed_mps: vehicle.nominal_speed_mps,
        nominal_trailer_mass_kg: load.trailer_mass_kg,
        reference_height_m: load.cg_height_m,
        least_height_m: vehicle.height.least_m,
        greatest_height_m: vehicle.height.greatest_m,
        trailer_wheelbase_m: vehicle.trailer_wheelbase_m(),
        path_lead: lead(&Laden::new(vehicle, variant, load)?, &speed_mps)?,
        gravity_mps2: vehicle.gravity_mps2,
        rollover: rollover(vehicle, load)?,
        thresholds: [ThresholdLine { threshold_g: [[0.0; HEIGHTS]; 2] }; MASSES],
    };
    if variant == Variant::Complete && vehicle.has_measured_springs() {
        set_springs(&mut design, vehicle)?;
        add_interpolation_error(&mut design, vehicle)?;
    }
    Ok(design)
}

/// The design with the thresholds at these heights, of which there is one for all or one for each. Every roll angle
/// is multiplied by `compliance`.
fn with_thresholds<const N: usize>(
    mut design: Design<f64>,
    (vehicle, variant): (&Vehicle, Variant),
    compliance: f64,
    height_m: [f64; N],
) -> Result<Design<f64>, VehicleError> {
    let masses_kg = design.trailer_mass_kg;
    for (line, mass_kg) in design.thresholds.iter_mut().zip(masses_kg) {
        let load = at_mass(vehicle, variant, mass_kg);
        let found = thresholds_g(vehicle, load, compliance, height_m)?;
        for (line, found) in line.threshold_g.iter_mut().zip(found) {
            *line = std::array::from_fn(|k| found[k.min(N - 1)]);
        }
    }
    design.validate().map_err(|error| {
        VehicleError::Model(format!("vehicle \"{}\" gives no usable design: {error}", vehicle.name))
    })?;
    Ok(design)
}

/// The share of an interval of the mass axis at each step and after the last one.
#[allow(clippy::cast_precision_loss)] // a few
fn shares(after: f64) -> [f64; STEPS] {
    std::array::from_fn(|step| (step as f64 + after) / STEPS as f64)
}

/// Sets what measured springs do at the masses between those of the axis: their friction, and the ratios over
/// those of the lines, which hardly depend on speed and height.
fn set_springs(design: &mut Design<f64>, vehicle: &Vehicle) -> Result<(), VehicleError> {
    let masses_kg = design.trailer_mass_kg;
    let mut at_kg = [masses_kg[MASSES - 1]; SPRING_MASSES];
    for (steps, pair) in at_kg.chunks_mut(STEPS).zip(masses_kg.windows(2)) {
        for (mass_kg, share) in steps.iter_mut().zip(shares(0.0)) {
            *mass_kg = pair[0] + share * (pair[1] - pair[0]);
        }
    }
    for (place, trailer_mass_kg) in at_kg.into_iter().enumerate() {
        let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
        let friction = roll_friction(vehicle, load)?;
        let error = interpolation_error(design, vehicle, load)?;
        for ((channel, friction), error) in design.channels.iter_mut().zip(friction).zip(error) {
            channel.friction[place] = friction;
            channel.of_lines[place] = 1.0 / (1.0 + error);
        }
    }
    Ok(())
}

/// The error of the ratios of the lines at the nominal speed and a load, relative.
fn interpolation_error(
    design: &Design<f64>,
    vehicle: &Vehicle,
    load: Load,
) -> Result<[f64; CHANNELS], VehicleError> {
    let speed_mps = design.nominal_speed_mps;
    let exact = ratio_line(vehicle, Variant::Complete, speed_mps, load)?;
    Ok(Channel::ALL.map(|channel| {
        let ratio = exact[channel.index()].ratio_at(load.cg_height_m);
        let line = design.line(channel, speed_mps, load.trailer_mass_kg);
        line.map_or(0.0, |line| line.ratio_at(load.cg_height_m) / ratio - 1.0)
    }))
}

/// Adds to the uncertainty at each mass what the lines between it and its neighbors miss at two places between
/// two masses at which the springs are known.
fn add_interpolation_error(
    design: &mut Design<f64>,
    vehicle: &Vehicle,
) -> Result<(), VehicleError> {
    let masses_kg = design.trailer_mass_kg;
    for (j, pair) in masses_kg.windows(2).enumerate() {
        for place in [0.25, 0.75].into_iter().flat_map(shares) {
            let trailer_mass_kg = pair[0] + place * (pair[1] - pair[0]);
            let load = Load { trailer_mass_kg, ..vehicle.reference_load() };
            let error = interpolation_error(design, vehicle, load)?;
            for at_speed in &mut design.spread {
                for Spread { covariance } in &mut at_speed[j..=j + 1] {
                    for (row, a) in covariance.iter_mut().zip(error) {
                        for (entry, b) in row.iter_mut().zip(error) {
                            #[allow(clippy::cast_precision_loss)] // a few
                            let share = 0.5 / STEPS as f64;
                            *entry += a * b * share;
                        }
                    }
                }
            }
        }
    }
    Ok(())
}

/// The paces `U0/U − 1` at which the reduced models are fitted beside the nominal speed: at 50 km/h these
/// are 22, 34, 68 and 86 km/h.
const PACES: [f64; 4] = [1.3, 0.45, -0.27, -0.42];

/// The reduced models of a load at the nominal speed, with their change with the speed.
///
/// # Errors
/// [`VehicleError`] if the vehicle is unstable with this load.
pub fn models_at(
    vehicle: &Vehicle,
    variant: Variant,
    load: Load,
) -> Result<ReducedModels, VehicleError> {
    let nominal_mps = vehicle.nominal_speed_mps;
    let model = |speed_mps: f64| Equations::new(vehicle, variant, speed_mps, load)?.state_space();
    let others: Vec<_> = PACES
        .into_iter()
        .filter_map(|pace| Some((pace, model(nominal_mps / (1.0 + pace)).ok()?)))
        .collect();
    reduce(&model(nominal_mps)?, &others)
}

/// The reduced models at each mass, compensated as the calibration says. If the vehicle is unstable at a
/// mass, the model at the reference load is used.
fn models(
    vehicle: &Vehicle,
    variant: Variant,
    shapes: &Shapes,
    masses_kg: &[f64; MASSES],
) -> Result<[ReducedModels; MASSES], VehicleError> {
    let load = vehicle.reference_load();
    let at = |load: Load| models_at(vehicle, variant, load)?.compensated(shapes);
    let reference = at(load)?;
    let mut models = [reference; MASSES];
    if variant == Variant::Complete {
        for (model, &trailer_mass_kg) in models.iter_mut().zip(masses_kg) {
            *model = at(vehicle.usual_load(trailer_mass_kg)).unwrap_or(reference);
        }
    }
    Ok(models)
}

/// The reference load with another mass. The printed model knows that of the reference only.
fn at_mass(vehicle: &Vehicle, variant: Variant, mass_kg: f64) -> Load {
    let load = vehicle.reference_load();
    match variant {
        Variant::Complete => Load { trailer_mass_kg: mass_kg, ..load },
        Variant::AsPrinted => load,
    }
}

fn speeds(
    vehicle: &Vehicle,
    variant: Variant,
    masses_kg: &[f64; MASSES],
) -> Result<[f64; SPEEDS], VehicleError> {
    let (least_mps, usual_mps) = (GRID_MPS[0], GRID_MPS[SPEEDS - 1]);
    let nominal_mps = vehicle.nominal_speed_mps;
    let greatest_mps = greatest_speed(vehicle, variant, masses_kg, usual_mps)?;
    let mut speeds = GRID_MPS;
    if greatest_mps < usual_mps {
        let exponent = libm::log(greatest_mps / least_mps) / libm::log(usual_mps / least_mps);
        speeds = speeds.map(|speed_mps| least_mps * libm::pow(speed_mps / least_mps, exponent));
    }
    let nearest = (1..SPEEDS - 1)
        .min_by(|&i, &j| {
            (speeds[i] - nominal_mps).abs().total_cmp(&(speeds[j] - nominal_mps).abs())
        })
        .unwrap_or(1);
    if nominal_mps > speeds[nearest - 1] && nominal_mps < speeds[nearest + 1] {
        speeds[nearest] = nominal_mps;
    }
    Ok(speeds)
}

/// The greatest speed of the design. A truck that oversteers has a critical speed, above which it
/// cannot be driven and its steady turn has the wrong sign; near it the steer channel knows nothing.
fn greatest_speed(
    vehicle: &Vehicle,
    variant: Variant,
    masses_kg: &[f64; MASSES],
    usual_mps: f64,
) -> Result<f64, VehicleError> {
    const STEPS: usize = 20;
    let nominal_mps = vehicle.nominal_speed_mps;
    let mut critical_mps = usual_mps;
    for &mass_kg in masses_kg {
        let load = at_mass(vehicle, variant, mass_kg);
        let laden = Laden::new(vehicle, variant, load)?;
        let steers = |speed_mps: f64| -> Result<bool, VehicleError> {
            let lines = ratio_line_at(&laden, speed_mps)?;
            Ok(lines[Channel::Steer.index()].ratio_at(load.cg_height_m) > 0.0)
        };
        // Where it has no steady turn at the nominal speed either, the cause is another one.
        if steers(critical_mps)? || !steers(nominal_mps)? {
            continue;
        }
        let mut below_mps = nominal_mps;
        for _ in 0..STEPS {
            let middle_mps = f64::midpoint(below_mps, critical_mps);
            if steers(middle_mps)? {
                below_mps = middle_mps;
            } else {
                critical_mps = middle_mps;
            }
        }
    }
    Ok(if critical_mps < usual_mps {
        (0.9 * critical_mps).max(f64::midpoint(nominal_mps, critical_mps))
    } else {
        usual_mps
    })
}

#[allow(clippy::cast_precision_loss)] // indices
fn masses(vehicle: &Vehicle, variant: Variant) -> [f64; MASSES] {
    let reference_kg = vehicle.trailer.reference_mass_kg;
    if variant == Variant::AsPrinted {
        // An axis of 0.1 % around the only load for which the printed model is known.
        return std::array::from_fn(|j| reference_kg * (1.0 + 4e-4 * (j as f64 - 2.5)));
    }
    // The axis starts slightly below the empty mass, so that an empty trailer with a weighing error
    // is still within it.
    let empty_kg = vehicle.empty_trailer_mass_kg();
    let least_kg = empty_kg * 0.996;
    let greatest_kg = greatest_mass_kg(vehicle);
    // The spacing is smaller where the payload is small compared with the trailer.
    let mut masses: [f64; MASSES] = std::array::from_fn(|j| {
        least_kg + (greatest_kg - least_kg) * libm::pow(j as f64 / (MASSES - 1) as f64, 1.3)
    });
    let nearest = (1..MASSES - 1)
        .min_by(|&i, &j| {
            (masses[i] - reference_kg).abs().total_cmp(&(masses[j] - reference_kg).abs())
        })
        .unwrap_or(1);
    if reference_kg > masses[nearest - 1] && reference_kg < masses[nearest + 1] {
        masses[nearest] = reference_kg;
    }
    masses
}

/// Heights equally spaced over the vehicle's range.
#[allow(clippy::cast_precision_loss)] // indices
fn heights(vehicle: &Vehicle) -> [f64; HEIGHTS] {
    let range = &vehicle.height;
    let span_m = range.greatest_m - range.least_m;
    std::array::from_fn(|k| range.least_m + span_m * k as f64 / (HEIGHTS - 1) as f64)
}
