//! The friction and the bends of measured springs in the roll angle of each channel.
//!
//! The ratio lines hold for linear springs, the describing function of a usual turn. How the ratio of a channel
//! changes if the springs of a unit are softer or stiffer says what friction and bends make of its roll angle:
//! both units share the moment, so that what friction holds in one of them is not all of it missing in its own
//! roll angle, and is missing in that of the other one.

use cg_core::{CHANNELS, Channel, Friction, Input, Output};

use crate::balance::static_balance;
use crate::equations::Variant;
use crate::error::VehicleError;
use crate::linear::{Laden, Motion, SteadyLines, ratio_line_at};
use crate::load::Load;
use crate::vehicle::Vehicle;

/// The friction of each channel at a load.
///
/// `δ` is the sum of the moments of a unit's springs over their roll stiffness, times the share of a moment that
/// the roll angle of the channel shows, and `β` their mean, weighted by these moments. The friction of the other
/// unit counts as if it changed sides at the same time, because both roll in the same turns.
///
/// # Errors
/// As [`SteadyLines::new`].
pub fn roll_friction(
    vehicle: &Vehicle,
    load: Load,
) -> Result<[Friction<f64>; CHANNELS], VehicleError> {
    if !vehicle.has_measured_springs() {
        return Ok([Friction::NONE; CHANNELS]);
    }
    let springs = Springs::new(vehicle, load)?;
    let held = [springs.held(0)?, springs.held(1)?];
    let shares = [springs.shares(0)?, springs.shares(1)?];
    let bent = springs.bent()?;
    Ok(Channel::ALL.map(|channel| {
        let unit = usize::from(channel.output() != Output::TractorSuspensionRoll);
        let Some([_, deflection_rad]) = held[unit] else { return Friction::NONE };
        let place = channel.index();
        // Of the units' moments that friction holds in a usual turn, what the roll angle shows.
        let shown = |unit: usize| {
            let [held_rad, _] = held[unit].unwrap_or_default();
            shares[unit][place] * held_rad / springs.usual.amplitude_rad[unit]
        };
        let (roll_rad, shown) = (springs.roll_rad(channel.output()), shown(0) + shown(1));
        if !(shown > 0.0) {
            return Friction::NONE;
        }
        let [slope, bend, knee] = bent[place];
        Friction {
            usual_share: 1.0 - slope,
            bend,
            knee_rad: knee * roll_rad,
            roll_rad: shown * roll_rad,
            deflection_rad: deflection_rad * roll_rad / springs.usual.amplitude_rad[unit],
        }
    }))
}

/// A vehicle with measured springs at a load, in usual turns.
struct Springs<'a> {
    vehicle: &'a Vehicle,
    load: Load,
    usual: Motion,
    lines: SteadyLines,
}

impl<'a> Springs<'a> {
    fn new(vehicle: &'a Vehicle, load: Load) -> Result<Self, VehicleError> {
        let springs = vehicle.with_springs_at(load)?;
        let usual = Motion::usual(&springs, load.trailer_mass_kg)?;
        let speed_mps = vehicle.nominal_speed_mps;
        let lines = SteadyLines::new(vehicle, Variant::Complete, speed_mps, load)?;
        Ok(Self { vehicle, load, usual, lines })
    }

    /// The roll angle of a channel in a usual turn. The trailer's roll angle to the road contains that of the
    /// tires.
    fn roll_rad(&self, output: Output) -> f64 {
        let [tractor_rad, trailer_rad] = self.usual.amplitude_rad;
        let at =
            |output| self.lines.line(output, Input::SpecificForce).ratio_at(self.load.cg_height_m);
        match output {
            Output::TractorSuspensionRoll => tractor_rad,
            Output::SuspensionRoll => trailer_rad,
            Output::Roll => trailer_rad * at(Output::Roll) / at(Output::SuspensionRoll),
        }
    }

    /// The roll angle by which the friction of a unit holds its suspension, and the angle within which it
    /// changes sides; `None` without friction.
    fn held(&self, unit: usize) -> Result<Option<[f64; 2]>, VehicleError> {
        let vehicle = &*self.vehicle.with_springs_at(self.load)?;
        let balance = static_balance(vehicle, self.load)?;
        let amplitude_rad = self.usual.amplitude_rad[unit];
        let [mut stiffness, mut moment_nm, mut turns] = [0.0; 3];
        for (placed, &load_n) in vehicle.axles().iter().zip(&balance.axle_load_n) {
            if usize::from(placed.on_trailer) == unit {
                stiffness += vehicle.roll_stiffness(placed, load_n, amplitude_rad, 1.0);
                let (own_nm, deflection_rad) = vehicle.roll_friction(placed, load_n, amplitude_rad);
                moment_nm += own_nm;
                turns += own_nm * deflection_rad;
            }
        }
        Ok((moment_nm > 0.0).then(|| [moment_nm / stiffness, turns / moment_nm]))
    }

    /// The ratios of all channels in another motion over those in a usual turn; `None` if the vehicle has
    /// no steady turn in it.
    fn ratios(&self, motion: Motion) -> Result<Option<[f64; CHANNELS]>, VehicleError> {
        let laden = Laden::new(self.vehicle, Variant::Complete, self.load)?.moving(motion);
        let lines = ratio_line_at(&laden, self.vehicle.nominal_speed_mps)?;
        let height_m = self.load.cg_height_m;
        let ratios = Channel::ALL.map(|channel| {
            lines[channel.index()].ratio_at(height_m)
                / self.lines.channel(channel).ratio_at(height_m)
        });
        Ok(ratios.iter().all(|ratio| *ratio > 0.0).then_some(ratios))
    }

    /// The relative decrease of the ratios over the relative increase of the roll stiffness of a unit.
    fn shares(&self, unit: usize) -> Result<[f64; CHANNELS], VehicleError> {
        const STEP: f64 = 1e-3;
        let stiffer = |factor: f64| {
            let mut motion = self.usual;
            motion.stiffness[unit] = factor;
            self.ratios(motion)
        };
        let (Some(soft), Some(hard)) = (stiffer(1.0 - STEP)?, stiffer(1.0 + STEP)?) else {
            return Ok([1.0; CHANNELS]);
        };
        Ok(std::array::from_fn(|place| (soft[place] - hard[place]) / (2.0 * STEP)))
    }

    /// The two straight lines, from zero to a knee and beyond it, that are nearest to `s` times the ratio in a
    /// usual turn over that in a turn of `s` times its amplitude without friction: the first slope, the
    /// increase of the slope, and the knee, of each channel. The turns are those up to twice the usual one.
    fn bent(&self) -> Result<[[f64; 3]; CHANNELS], VehicleError> {
        let mut turns = Vec::new();
        for share in usual_shares() {
            let mut motion = self.usual;
            motion.amplitude_rad = motion.amplitude_rad.map(|usual_rad| share * usual_rad);
            motion.friction = [0.0; 2];
            if let Some(ratios) = self.ratios(motion)? {
                turns.push((share, ratios));
            }
        }
        Ok(std::array::from_fn(|channel| {
            let points: Vec<_> =
                turns.iter().map(|(s, ratios)| (*s, s / ratios[channel])).collect();
            two_lines(&points).map_or([1.0, 0.0, 1.0], |(_, lines)| lines)
        }))
    }
}

/// Amplitudes of usual turns over that of the usual turn.
pub(crate) fn usual_shares() -> impl Iterator<Item = f64> {
    const PLACES: u32 = 12;
    const MOST: f64 = 2.0;
    (1..=PLACES).map(|place| MOST * f64::from(place) / f64::from(PLACES))
}

/// Least squares of `y = p x + c max(x − knee, 0)` to points with increasing `x`, with the best of their knees:
/// the mean square of what remains over `x`, and `p`, `c` and the knee. `None` for less than three points.
pub(crate) fn two_lines(points: &[(f64, f64)]) -> Option<(f64, [f64; 3])> {
    let knees = points.iter().map(|(x, _)| *x);
    let fits = knees.filter_map(|knee| with_knee(points, knee));
    fits.min_by(|(a, _), (b, _)| a.total_cmp(b))
}

fn with_knee(points: &[(f64, f64)], knee: f64) -> Option<(f64, [f64; 3])> {
    let beyond = |x: f64| (x - knee).max(0.0);
    let mut sums = [0.0; 5];
    for (x, y) in points {
        let (x, b) = (*x, beyond(*x));
        for (sum, term) in sums.iter_mut().zip([x * x, x * b, b * b, x * y, b * y]) {
            *sum += term;
        }
    }
    let [xx, xb, bb, xy, by] = sums;
    let determinant = xx * bb - xb * xb;
    if !(determinant > 1e-9 * xx * xx) {
        return None;
    }
    let [p, c] = [bb * xy - xb * by, xx * by - xb * xy].map(|of| of / determinant);
    let remains = |(x, y): &(f64, f64)| (y / x - p - c * beyond(*x) / x).powi(2);
    #[allow(clippy::cast_precision_loss)] // a few
    let square = points.iter().map(remains).sum::<f64>() / points.len() as f64;
    Some((square, [p, c, knee]))
}
