//! The friction and the bends of measured springs in the roll angle of each channel.
//!
//! The ratio lines hold for linear springs, the describing function of a usual turn. How the ratio of a pair of
//! suspension roll and specific force changes if the springs of a unit are softer or stiffer says what friction
//! and bends make of its roll angle: both units share the moment, so that what friction holds in one of them is
//! not all of it missing in its own roll angle, and is missing in that of the other one. The roll angle to the
//! road is that of the other channels, where this also depends on the height, near a load that tips the truck
//! on little else. There friction and bends of the trailer's own springs count as if their moment were given, times the
//! share of it that the roll angle shows, and what the tractor's springs hold is added.

use std::borrow::Cow;

use cg_core::{CHANNELS, Channel, Friction, Input, Output};

use crate::balance::{StaticBalance, static_balance};
use crate::equations::{Motion, Variant};
use crate::error::VehicleError;
use crate::linear::{Laden, SteadyLines};
use crate::load::Load;
use crate::vehicle::Vehicle;

/// The friction of each channel at a load.
///
/// `δ` is the sum of the moments of a unit's springs over their roll stiffness, times the share of a moment that
/// the roll angle of a pair shows, and `β` their mean, weighted by these moments. The friction of the other unit
/// counts as if it changed sides at the same time, because both roll in the same turns.
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
    let own = [springs.own(0), springs.own(1)];
    let shares = [springs.shares(0)?, springs.shares(1)?];
    let bent = springs.bent()?;
    let pair = |unit: usize| {
        let (Some(own_friction), [slope, bend, knee]) = (own[unit], bent[unit]) else {
            return Friction::NONE;
        };
        // Of the units' moments that friction holds in a usual turn, what the roll angle shows.
        let amplitude_rad = springs.usual.amplitude_rad;
        let shown = |other: usize| {
            let held_rad = own[other].map_or(0.0, |own| own.roll_rad);
            shares[other][unit] * held_rad / amplitude_rad[other]
        };
        let shown = shown(0) + shown(1);
        if !(shown > 0.0) {
            return Friction::NONE;
        }
        Friction {
            usual_share: 1.0 - slope,
            bend,
            knee_rad: knee * amplitude_rad[unit],
            roll_rad: shown * amplitude_rad[unit],
            ..own_friction
        }
    };
    // The trailer's roll angle to the road contains that of the tires, which friction does not change.
    let on_springs = springs.on_springs();
    let [[_, _, by_tractor], [_, _, by_trailer]] = shares;
    // All of it, where the tractor carries no part of the moment.
    let shown = by_trailer / on_springs;
    let [usual_share, roll_rad] = own[0].map_or([0.0; 2], |tractor| {
        let [tractor_rad, trailer_rad] = springs.usual.amplitude_rad;
        let held = tractor.roll_rad / tractor_rad;
        [by_tractor * tractor.usual_share, by_tractor * held * trailer_rad / on_springs]
    });
    let roll = own[1].map_or(Friction::NONE, |own| {
        let [slope, bend, knee] = springs.bends(1).unwrap_or([1.0 - own.usual_share, 0.0, 0.0]);
        Friction {
            usual_share: (1.0 - slope) * by_trailer + usual_share,
            bend: bend * by_trailer,
            knee_rad: knee * springs.usual.amplitude_rad[1] / on_springs,
            roll_rad: own.roll_rad * shown + roll_rad,
            deflection_rad: own.deflection_rad / on_springs,
        }
    });
    Ok(Channel::ALL.map(|channel| match channel.output() {
        Output::TractorSuspensionRoll => pair(0),
        Output::SuspensionRoll => pair(1),
        Output::Roll => roll,
    }))
}

/// A vehicle with measured springs at a load, in usual turns.
struct Springs<'a> {
    /// The vehicle with its springs as they are under the load.
    vehicle: Cow<'a, Vehicle>,
    balance: StaticBalance,
    usual: Motion,
    laden: Laden<'a>,
    lines: SteadyLines,
}

impl<'a> Springs<'a> {
    fn new(vehicle: &'a Vehicle, load: Load) -> Result<Self, VehicleError> {
        let laden = Laden::new(vehicle, Variant::Complete, load)?;
        let lines = SteadyLines::at_speed(&laden, vehicle.nominal_speed_mps)?;
        let vehicle = vehicle.with_springs_at(load)?;
        let balance = static_balance(&vehicle, load)?;
        let usual = laden.motion().unwrap_or(Motion::SMALL);
        Ok(Self { vehicle, balance, usual, laden, lines })
    }

    /// The part of the trailer's roll angle that is that of its suspension.
    fn on_springs(&self) -> f64 {
        let [suspension, roll] = [Output::SuspensionRoll, Output::Roll].map(|output| {
            let line = self.lines.line(output, Input::LateralAcceleration);
            line.ratio_at(self.laden.load.cg_height_m)
        });
        suspension / roll
    }

    /// The [two lines](two_lines) of the moment of a unit's springs without friction, over their roll stiffness in a
    /// usual turn; the roll angle is in amplitudes of that turn.
    fn bends(&self, unit: usize) -> Option<[f64; 3]> {
        let vehicle = &*self.vehicle;
        let stiffness = |share: f64, friction: f64| -> f64 {
            let amplitude_rad = share * self.usual.amplitude_rad[unit];
            let axles = vehicle.axles().into_iter().zip(&self.balance.axle_load_n);
            let of_unit = axles.filter(|(placed, _)| usize::from(placed.on_trailer) == unit);
            of_unit
                .map(|(placed, n)| vehicle.roll_stiffness(&placed, *n, amplitude_rad, friction))
                .sum()
        };
        let usual = stiffness(1.0, 1.0);
        let points = turns().map(|share| (share, share * stiffness(share, 0.0) / usual));
        two_lines(&points.collect::<Vec<_>>())
    }

    /// The friction in the suspension roll of a unit if its moment is given; `None` without friction.
    fn own(&self, unit: usize) -> Option<Friction<f64>> {
        let vehicle = &*self.vehicle;
        let amplitude_rad = self.usual.amplitude_rad[unit];
        let [mut stiffness, mut free, mut moment_nm, mut turns] = [0.0; 4];
        for (placed, &load_n) in vehicle.axles().iter().zip(&self.balance.axle_load_n) {
            if usize::from(placed.on_trailer) == unit {
                stiffness += vehicle.roll_stiffness(placed, load_n, amplitude_rad, 1.0);
                free += vehicle.roll_stiffness(placed, load_n, amplitude_rad, 0.0);
                let (own_nm, deflection_rad) = vehicle.roll_friction(placed, load_n, amplitude_rad);
                moment_nm += own_nm;
                turns += own_nm * deflection_rad;
            }
        }
        (moment_nm > 0.0 && stiffness > free).then(|| Friction {
            usual_share: 1.0 - free / stiffness,
            roll_rad: moment_nm / stiffness,
            deflection_rad: turns / moment_nm,
            ..Friction::NONE
        })
    }

    /// The suspension roll of tractor and trailer, and the trailer's roll to the road, in another motion over those
    /// in a usual turn, for the same specific force or lateral acceleration; `None` if the vehicle has no steady turn
    /// in it.
    fn ratios(&self, motion: Motion) -> Result<Option<[f64; 3]>, VehicleError> {
        let laden = self.laden.clone().moving(motion);
        let lines = SteadyLines::at_speed(&laden, self.vehicle.nominal_speed_mps)?;
        let channels = [Channel::Tractor, Channel::Suspension, Channel::LateralAcceleration];
        let ratios = channels.map(|pair| {
            let [there, usual] = [&lines, &self.lines]
                .map(|lines| lines.channel(pair).ratio_at(laden.load.cg_height_m));
            there / usual
        });
        Ok(ratios.iter().all(|ratio| *ratio > 0.0).then_some(ratios))
    }

    /// The relative decrease of these over the relative increase of the roll stiffness of a unit.
    fn shares(&self, unit: usize) -> Result<[f64; 3], VehicleError> {
        const STEP: f64 = 1e-3;
        let stiffer = |factor: f64| {
            let mut motion = self.usual;
            motion.stiffness[unit] = factor;
            self.ratios(motion)
        };
        let (Some(soft), Some(hard)) = (stiffer(1.0 - STEP)?, stiffer(1.0 + STEP)?) else {
            return Ok([1.0; 3]);
        };
        Ok(std::array::from_fn(|of| (soft[of] - hard[of]) / (2.0 * STEP)))
    }

    /// The two straight lines, from zero to a knee and beyond it, that are nearest to `s` times the ratio in a
    /// usual turn over that in a turn of `s` times its amplitude without friction: the first slope, the
    /// increase of the slope, and the knee, of both units. The turns are those up to twice the usual one.
    fn bent(&self) -> Result<[[f64; 3]; 2], VehicleError> {
        let mut points = Vec::new();
        for share in turns() {
            let mut motion = self.usual;
            motion.amplitude_rad = motion.amplitude_rad.map(|usual_rad| share * usual_rad);
            motion.friction = [0.0; 2];
            if let Some(ratios) = self.ratios(motion)? {
                points.push((share, ratios));
            }
        }
        Ok(std::array::from_fn(|unit| {
            let point = |(s, ratios): &(f64, [f64; 3])| (*s, s / ratios[unit]);
            let points: Vec<_> = points.iter().map(point).collect();
            two_lines(&points).unwrap_or([1.0, 0.0, 1.0])
        }))
    }
}

/// Amplitudes up to twice that of the usual turn, as shares of it.
fn turns() -> impl Iterator<Item = f64> {
    const PLACES: u32 = 12;
    (1..=PLACES).map(|place| 2.0 * f64::from(place) / f64::from(PLACES))
}

/// Least squares of `y = p x + c max(x − knee, 0)` to points with increasing `x`, with the best of their knees: `p`,
/// `c` and the knee. `None` for less than three points.
fn two_lines(points: &[(f64, f64)]) -> Option<[f64; 3]> {
    let fits = points.iter().filter_map(|(knee, _)| with_knee(points, *knee));
    let (_, lines) = fits.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    Some(lines)
}

/// The same with a given knee, and the sum of squares of what remains over `x`.
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
    let remains = |(x, y): &(f64, f64)| y / x - p - c * beyond(*x) / x;
    Some((points.iter().map(|point| remains(point) * remains(point)).sum(), [p, c, knee]))
}
