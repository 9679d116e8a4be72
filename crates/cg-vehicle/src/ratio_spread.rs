//! How far the DC ratios of a vehicle may be from those of its model: their derivatives with respect to the
//! uncertain parameters, and what differs from load to load.

use cg_core::{CHANNELS, Channel, Output};

use crate::balance::static_balance;
use crate::belief::{Belief, Deviations, Parameter, adjusted, log_gain};
use crate::cornering::{Softer, TURNS, TURNS_G};
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::linear::{Laden, ratio_line, ratio_line_at, usual_motion};
use crate::load::Load;
use crate::vehicle::{PlacedAxle, Vehicle};

impl Belief {
    /// Covariance of the logarithms of all channels' DC ratios at a speed and load, including the place
    /// of the payload and the residual. The order is that of [`Channel::ALL`].
    ///
    /// # Errors
    /// As [`ratio_line`].
    pub fn ratio_covariance(
        &self,
        vehicle: &Vehicle,
        variant: Variant,
        speed_mps: f64,
        load: Load,
    ) -> Result<[[f64; CHANNELS]; CHANNELS], VehicleError> {
        let [covariance] = self.ratio_covariances(vehicle, variant, [speed_mps], load)?;
        Ok(covariance)
    }

    /// The [covariances](Self::ratio_covariance) at several speeds.
    ///
    /// # Errors
    /// As [`ratio_line`].
    pub fn ratio_covariances<const N: usize>(
        &self,
        vehicle: &Vehicle,
        variant: Variant,
        speeds_mps: [f64; N],
        load: Load,
    ) -> Result<[[[f64; CHANNELS]; CHANNELS]; N], VehicleError> {
        let changes = Changes::new(vehicle, variant, speeds_mps, load, &self.mean)?;
        Ok(changes.covariances(self))
    }
}

/// How the logarithms of all channels' DC ratios change at a load, at several speeds. It depends on the mean of a belief
/// only.
pub(crate) struct Changes<const N: usize> {
    pub(crate) of_parameters: [LogRatios; N],
    /// See [`place_change`].
    pub(crate) by_place: [[f64; CHANNELS]; N],
    by_turn: [Deviations; TURNS],
    stiffness_variances: [f64; 2],
    /// See [`slow_sds`].
    by_slowness: [[f64; CHANNELS]; N],
}

/// Speeds between which what is not known of slow turns vanishes, m/s.
const SLOW_MPS: [f64; 2] = [5.5, 8.0];
/// What is not known of them, relative. Of two independent trucks, one rolls by 5 to 6 % less for each m/s² at 5.6 to 6.5 m/s than it
/// does from 9 m/s on (test `slow_turns` of `cg-logs`), and the other one as much. No equation here says why, and two trucks hardly
/// say what a third one does, so this is the whole of it. It is of the roll angle: the suspension rolls of the other truck show
/// none, and those of the first were not recorded.
const SLOW_SD: f64 = 0.055;

/// Relative standard deviations of the ratios of all channels at a speed, of one sign in all of them.
pub(crate) fn slow_sds(speed_mps: f64) -> [f64; CHANNELS] {
    let [slow_mps, usual_mps] = SLOW_MPS;
    let share = ((usual_mps - speed_mps) / (usual_mps - slow_mps)).clamp(0.0, 1.0);
    Channel::ALL.map(|channel| if channel.output() == Output::Roll { share * SLOW_SD } else { 0.0 })
}

impl<const N: usize> Changes<N> {
    pub(crate) fn new(
        vehicle: &Vehicle,
        variant: Variant,
        speeds_mps: [f64; N],
        load: Load,
        mean: &Deviations,
    ) -> Result<Self, VehicleError> {
        Ok(Self {
            of_parameters: log_ratios_at(vehicle, variant, (speeds_mps, None), load, mean)?,
            by_place: place_changes(vehicle, variant, speeds_mps, load, mean)?,
            by_turn: cornering_changes(&adjusted(vehicle, mean), variant, load)?,
            stiffness_variances: stiffness_variances(vehicle, load)?,
            by_slowness: speeds_mps.map(slow_sds),
        })
    }

    /// Their covariance at each speed, if the parameters have that of a belief.
    pub(crate) fn covariances(&self, belief: &Belief) -> [[[f64; CHANNELS]; CHANNELS]; N] {
        let mut parameters = belief.covariance;
        for (parameter, variance) in STIFFNESSES.into_iter().zip(self.stiffness_variances) {
            parameters[(parameter as usize, parameter as usize)] += variance;
        }
        std::array::from_fn(|at| {
            let ((_, slopes), by_place) = (&self.of_parameters[at], &self.by_place[at]);
            let slow = &self.by_slowness[at];
            let mut covariance = [[0.0; CHANNELS]; CHANNELS];
            let by_turn = self.by_turn.map(|change| slopes.map(|slope| slope.dot(&change)));
            for i in 0..CHANNELS {
                let moved = parameters * slopes[i];
                for j in 0..=i {
                    let turning: f64 = by_turn.iter().map(|moved| moved[i] * moved[j]).sum();
                    let common = by_place[i] * by_place[j] + slow[i] * slow[j] + turning;
                    covariance[i][j] = slopes[j].dot(&moved) + common;
                    covariance[j][i] = covariance[i][j];
                }
                covariance[i][i] += belief.residual_sd * belief.residual_sd;
            }
            covariance
        })
    }
}

/// Amplitudes of usual drives (0.06 to 0.2 g), as factors of the one in the usual turn (0.12 g).
const AMPLITUDES: [f64; 2] = [0.5, 1.67];
/// Relative standard deviation by which the friction of a spring differs from drive to drive, because it is
/// wet or dry, warm or cold. What is the same in all drives is a parameter of the truck.
const FRICTION_CHANGE_SD: f64 = 0.1;

/// Relative variances of the roll stiffness of the suspensions of tractor and trailer due to measured
/// springs, which differ in every situation: the slope midway between their curves depends on the
/// amplitude of the motion; the friction, which is [calculated](crate::friction), changes; and what is not
/// known of it counts more in small motion than in the usual one. Within the usual amplitudes the slope is
/// taken as distributed evenly.
pub(crate) fn stiffness_variances(vehicle: &Vehicle, load: Load) -> Result<[f64; 2], VehicleError> {
    if !vehicle.has_measured_springs() {
        return Ok([0.0; 2]);
    }
    let vehicle = &*vehicle.with_springs_at(load)?;
    let balance = static_balance(vehicle, load)?;
    let usual_rad = usual_motion(vehicle, (load.trailer_mass_kg, &balance), None)?.amplitude_rad;
    let axles = vehicle.axles();
    Ok([false, true].map(|on_trailer| {
        let sum = |of: &dyn Fn(&PlacedAxle<'_>, f64) -> f64| {
            let of_unit = axles.iter().zip(&balance.axle_load_n);
            let of_unit = of_unit.filter(|(placed, _)| placed.on_trailer == on_trailer);
            libm::log(of_unit.map(|(placed, &load_n)| of(placed, load_n)).sum::<f64>())
        };
        let rad = |amplitude: f64| amplitude * usual_rad[usize::from(on_trailer)];
        let logarithm = |amplitude: f64, friction: f64| {
            sum(&|placed, load_n| vehicle.roll_stiffness(placed, load_n, rad(amplitude), friction))
        };
        // A bump stop that is passed within a maneuver changes what is identified by more than the slope of a body
        // that has risen.
        let [small, large] = AMPLITUDES.map(|amplitude| {
            sum(&|placed, load_n| vehicle.roll_stiffness_at_rest(placed, load_n, rad(amplitude)))
        });
        let by_amplitude = (small - large) / 12.0_f64.sqrt();
        // More friction changes more than less.
        let by_friction =
            |amplitude: f64, sd: f64| logarithm(amplitude, 1.0 + sd) - logarithm(amplitude, 1.0);
        let changed = by_friction(1.0, FRICTION_CHANGE_SD);
        let unknown_sd = vehicle.uncertainty.spring_friction_sd;
        let apart = by_friction(AMPLITUDES[0], unknown_sd) - by_friction(1.0, unknown_sd);
        by_amplitude * by_amplitude + changed * changed + 0.5 * apart * apart
    }))
}

/// Changes of the tires' parameters from one usual turn to another, which differ in every situation, each as one
/// standard deviation: in a turn they are [softer](crate::cornering) than in the linear model, which has the mean of
/// usual turns at the reference height, by one of them or another.
#[allow(clippy::cast_precision_loss)] // three
pub(crate) fn cornering_changes(
    vehicle: &Vehicle,
    variant: Variant,
    load: Load,
) -> Result<[Deviations; TURNS], VehicleError> {
    let softer = Laden::new(vehicle, variant, load)?.softer_in(TURNS_G)?;
    let one_of = 1.0 / libm::sqrt(TURNS as f64);
    Ok(softer.map(|softer| of_tires(softer, one_of)))
}

/// What is not known of the tires in a turn whose lateral acceleration is known, as a share of the difference from usual
/// turns: how much softer they become with slip, which most vehicle files do not say, and how strong the turn was as a
/// whole.
const TURN_SD: f64 = 0.3;

/// Change of the tires' parameters, as one standard deviation, from a turn of a known lateral acceleration, g, to what
/// it is taken for.
pub(crate) fn cornering_change(
    vehicle: &Vehicle,
    variant: Variant,
    load: Load,
    lateral_g: f64,
) -> Result<Deviations, VehicleError> {
    let [softer] = Laden::new(vehicle, variant, load)?.softer_in([lateral_g])?;
    Ok(of_tires(softer, TURN_SD))
}

fn of_tires(softer: Softer, share: f64) -> Deviations {
    let mut change = Deviations::zeros();
    for (parameter, by) in TYRES.into_iter().zip(softer) {
        change[parameter as usize] = share * by;
    }
    change
}

/// The parameters of the tires that differ from turn to turn.
const TYRES: [Parameter; 3] = [
    Parameter::SteeredCorneringStiffness,
    Parameter::DriveCorneringStiffness,
    Parameter::TrailerCorneringStiffness,
];

/// The parameters whose variance in every situation [`stiffness_variances`] gives.
pub(crate) const STIFFNESSES: [Parameter; 2] =
    [Parameter::TractorRollStiffness, Parameter::TrailerRollStiffness];

/// Change of the logarithms of all channels' DC ratios if the payload is one standard deviation farther
/// to the rear, as the mean of both directions. The place is that of a load and not of the truck:
/// every load has its own, in a calibration as well as later, and in all channels at once.
///
/// # Errors
/// As [`ratio_line`](crate::linear::ratio_line); also if a ratio is not positive.
pub(crate) fn place_change(
    vehicle: &Vehicle,
    variant: Variant,
    speed_mps: f64,
    load: Load,
    mean: &Deviations,
) -> Result<[f64; CHANNELS], VehicleError> {
    let [change] = place_changes(vehicle, variant, [speed_mps], load, mean)?;
    Ok(change)
}

fn place_changes<const N: usize>(
    vehicle: &Vehicle,
    variant: Variant,
    speeds_mps: [f64; N],
    load: Load,
    mean: &Deviations,
) -> Result<[[f64; CHANNELS]; N], VehicleError> {
    const SMALL: f64 = 1e-3;
    let sd_m = vehicle.uncertainty.payload_place_sd_m;
    if sd_m <= 0.0 {
        return Ok([[0.0; CHANNELS]; N]);
    }
    let truck = adjusted(vehicle, mean);
    let usual_m = truck.trailer.payload.behind_hitch_m;
    let moved = |share: f64| {
        let at = |by_m: f64| truck.with_payload_at(load, usual_m + by_m);
        Ok::<_, VehicleError>([at(share * sd_m)?, at(-share * sd_m)?])
    };
    let change = |[rear, front]: &[Laden<'_>; 2], share: f64, speed_mps: f64| {
        let (rear, front) = (logarithms(rear, speed_mps)?, logarithms(front, speed_mps)?);
        Ok::<_, VehicleError>(std::array::from_fn(|i| (rear[i] - front[i]) / (2.0 * share)))
    };
    // The whole way, because measured springs have kinks; where the truck would tip, a small part of it.
    let far = moved(1.0).ok();
    let far = far.as_ref().and_then(|both| laden_both(both, variant, load).ok());
    let mut changes = [[0.0; CHANNELS]; N];
    for (found, speed_mps) in changes.iter_mut().zip(speeds_mps) {
        *found = match far.as_ref().and_then(|both| change(both, 1.0, speed_mps).ok()) {
            Some(found) => found,
            None => change(&laden_both(&moved(SMALL)?, variant, load)?, SMALL, speed_mps)?,
        };
    }
    Ok(changes)
}

fn laden_both(
    [rear, front]: &[Vehicle; 2],
    variant: Variant,
    load: Load,
) -> Result<[Laden<'_>; 2], VehicleError> {
    Ok([Laden::new(rear, variant, load)?, Laden::new(front, variant, load)?])
}

/// Change of the logarithms of all channels' DC ratios if the trailer is one standard deviation heavier, as
/// the mean of both directions. The mass belongs to a load, as its place does.
///
/// # Errors
/// As [`ratio_line`](crate::linear::ratio_line); also if a ratio is not positive.
pub(crate) fn mass_change(
    vehicle: &Vehicle,
    variant: Variant,
    speed_mps: f64,
    (load, sd_kg): (Load, f64),
) -> Result<[f64; CHANNELS], VehicleError> {
    if sd_kg <= 0.0 {
        return Ok([0.0; CHANNELS]);
    }
    let change = |[from, to]: [f64; 2]| {
        let at = |sds: f64| {
            let trailer_mass_kg = load.trailer_mass_kg + sds * sd_kg;
            let load = Load { trailer_mass_kg, ..load };
            logarithms(&Laden::new(vehicle, variant, load)?, speed_mps)
        };
        let (lighter, heavier) = (at(from)?, at(to)?);
        Ok(std::array::from_fn(|i| (heavier[i] - lighter[i]) / (to - from)))
    };
    // An empty trailer cannot be lighter, and a full one cannot be heavier.
    change([-1.0, 1.0])
        .or_else(|_: VehicleError| change([0.0, 1.0]))
        .or_else(|_: VehicleError| change([-1.0, 0.0]))
}

/// Change of the logarithms of all channels' DC ratios if the c.g. is one standard deviation higher. A height that is not
/// known (an infinite standard deviation) is a parameter of the fit instead, and changes nothing here.
///
/// # Errors
/// As [`ratio_line`].
pub(crate) fn height_change(
    vehicle: &Vehicle,
    variant: Variant,
    speed_mps: f64,
    (load, sd_m): (Load, f64),
) -> Result<[f64; CHANNELS], VehicleError> {
    if !(sd_m > 0.0 && sd_m.is_finite()) {
        return Ok([0.0; CHANNELS]);
    }
    let lines = ratio_line(vehicle, variant, speed_mps, load)?;
    Ok(lines.map(|line| sd_m * line.relative_slope_at(load.cg_height_m)))
}

/// Logarithms of all channels' DC ratios at the height of a load.
fn logarithms(laden: &Laden<'_>, speed_mps: f64) -> Result<[f64; CHANNELS], VehicleError> {
    let (load, lines) = (laden.load, ratio_line_at(laden, speed_mps)?);
    let mut logarithms = [0.0; CHANNELS];
    for (logarithm, line) in logarithms.iter_mut().zip(lines) {
        let ratio = line.ratio_at(load.cg_height_m);
        if !(ratio > 0.0) {
            return Err(VehicleError::Model(format!(
                "at {:.2} m and {:.0} kg the model has no positive steady-state roll angle",
                load.cg_height_m, load.trailer_mass_kg
            )));
        }
        *logarithm = libm::log(ratio);
    }
    Ok(logarithms)
}

/// Logarithms of all channels' DC ratios, and their derivatives with respect to the parameters.
type LogRatios = ([f64; CHANNELS], [Deviations; CHANNELS]);

/// The logarithms at a height, in turns of one lateral acceleration, g, or in usual turns, for the vehicle file.
///
/// # Errors
/// As [`ratio_line`](crate::linear::ratio_line); also if a ratio is not positive.
pub(crate) fn log_ratios_of_file(
    vehicle: &Vehicle,
    variant: Variant,
    (speed_mps, turn_g): (f64, Option<f64>),
    load: Load,
) -> Result<[f64; CHANNELS], VehicleError> {
    logarithms(
        &turning(&adjusted(vehicle, &Deviations::zeros()), variant, load, turn_g)?,
        speed_mps,
    )
}

/// The [logarithms and their derivatives](LogRatios) at a height, in turns of one lateral acceleration, g, or in usual
/// turns.
///
/// # Errors
/// As [`ratio_line`](crate::linear::ratio_line); also if a ratio is not positive.
pub(crate) fn log_ratios(
    vehicle: &Vehicle,
    variant: Variant,
    (speed_mps, turn_g): (f64, Option<f64>),
    load: Load,
    mean: &Deviations,
) -> Result<LogRatios, VehicleError> {
    let [both] = log_ratios_at(vehicle, variant, ([speed_mps], turn_g), load, mean)?;
    Ok(both)
}

/// The [logarithms and their derivatives](log_ratios) at several speeds.
fn log_ratios_at<const N: usize>(
    vehicle: &Vehicle,
    variant: Variant,
    (speeds_mps, turn_g): ([f64; N], Option<f64>),
    load: Load,
    mean: &Deviations,
) -> Result<[LogRatios; N], VehicleError> {
    let truck = adjusted(vehicle, mean);
    let laden = turning(&truck, variant, load, turn_g)?;
    let mut all = [([0.0; CHANNELS], [Deviations::zeros(); CHANNELS]); N];
    for ((logs, slopes), here) in all.iter_mut().zip(at_speeds(&laden, speeds_mps)?) {
        for channel in Channel::ALL {
            let i = channel.index();
            logs[i] = here[i] + log_gain(mean, channel);
            slopes[i] = gain_slopes(channel);
        }
    }
    // How much softer tires are in turns hardly depends on the parameters, but bends where a tire's load passes a node of its
    // table. The derivatives leave it as it is, so that they do not jump from one step of an iteration to the next.
    let tires = laden.motion().map(|motion| motion.cornering);
    let near = |deviations: &Deviations| {
        let truck = adjusted(vehicle, deviations);
        at_speeds(&Laden::with_tires(&truck, variant, load, tires)?, speeds_mps)
    };
    // Central differences with a step of 1e-4: the error is 1e-8 of the third derivative, the
    // rounding error 1e-12/1e-4.
    let step = 1e-4;
    for parameter in
        Parameter::ALL.into_iter().filter(|parameter| parameter.is_in_model_of(vehicle))
    {
        let k = parameter as usize;
        let (mut above, mut below) = (*mean, *mean);
        above[k] += step;
        below[k] -= step;
        let differences = near(&above)?.into_iter().zip(near(&below)?);
        for ((_, slopes), (above, below)) in all.iter_mut().zip(differences) {
            for (i, slope) in slopes.iter_mut().enumerate() {
                slope[k] = (above[i] - below[i]) / (2.0 * step);
            }
        }
    }
    Ok(all)
}

/// A vehicle under a load, in turns of one lateral acceleration, g, or in usual turns.
fn turning(
    truck: &Vehicle,
    variant: Variant,
    load: Load,
    turn_g: Option<f64>,
) -> Result<Laden<'_>, VehicleError> {
    let laden = Laden::new(truck, variant, load)?;
    match turn_g {
        Some(lateral_g) => laden.in_turn(lateral_g),
        None => Ok(laden),
    }
}

fn at_speeds<const N: usize>(
    laden: &Laden<'_>,
    speeds_mps: [f64; N],
) -> Result<[[f64; CHANNELS]; N], VehicleError> {
    let mut logs = [[0.0; CHANNELS]; N];
    for (logs, speed_mps) in logs.iter_mut().zip(speeds_mps) {
        *logs = logarithms(laden, speed_mps)?;
    }
    Ok(logs)
}

/// The derivatives of [`log_gain`], which is linear.
fn gain_slopes(channel: Channel) -> Deviations {
    Deviations::from_fn(|k, _| log_gain(&Deviations::ith(k, 1.0), channel))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every parameter that is in the equations of a truck changes one of its ratios. What is not in them changes none, so that
    /// its derivatives are those of the gains.
    #[test]
    fn what_is_not_in_the_equations_changes_no_ratio() {
        // Seven gains; a rigid frame; the friction of tractor and trailer.
        let cases =
            [("baseline", 1e10, 7 + 1 + 2), ("baseline-tables", 1e10, 7 + 1), ("euro", 6e5, 7 + 2)];
        for (file, frame_nm_per_rad, others) in cases {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles");
            let mut vehicle = Vehicle::load(format!("{folder}/{file}.toml")).unwrap();
            vehicle.trailer.frame_torsional_stiffness_nm_per_rad = Some(frame_nm_per_rad);
            let (load, speed_mps) = (vehicle.reference_load(), vehicle.nominal_speed_mps);
            let at = |deviations: &Deviations| {
                let truck = adjusted(&vehicle, deviations);
                logarithms(&Laden::new(&truck, Variant::Complete, load).unwrap(), speed_mps)
                    .unwrap()
            };
            let usual = at(&Deviations::zeros()).map(f64::to_bits);
            let changes = |parameter: &Parameter| {
                at(&Deviations::ith(*parameter as usize, 0.1)).map(f64::to_bits) != usual
            };
            let (within, without): (Vec<_>, Vec<_>) = Parameter::ALL
                .into_iter()
                .partition(|parameter| parameter.is_in_model_of(&vehicle));
            assert!(!without.iter().any(changes), "{file}: {without:?}");
            assert!(within.iter().all(changes), "{file}: {within:?}");
            assert_eq!(without.len(), others, "{file}: {without:?}");
        }
    }

    /// A gain changes the ratios of its own channels alone, as much as itself.
    #[test]
    fn a_gain_changes_the_ratios_of_its_sensor() {
        for channel in Channel::ALL {
            let slopes = gain_slopes(channel);
            for parameter in Parameter::ALL {
                let is_own = parameter == Parameter::of_input(channel.input())
                    || parameter == Parameter::of_output(channel.output());
                assert!((slopes[parameter as usize] - f64::from(u8::from(is_own))).abs() < 1e-15);
            }
        }
    }
}
