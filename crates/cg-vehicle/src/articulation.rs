//! What the articulation of a tight turn does to the ratios.
//!
//! In a turn with the articulation angle `ψ` the fifth wheel connects the roll angles of two units that look in
//! different directions. A plate that tilts about an axis of the tractor transmits `φ2 cos ψ − φ1`, and its moment
//! acts on the trailer multiplied by `cos ψ`; with an axis of the trailer it is `φ2 − φ1 cos ψ`. The trailer moves on a
//! circle that is smaller by `cos ψ`, so that it leaves less moment on the fifth wheel than the tractor's
//! acceleration says. Changes of the ratios of both pairs of suspension roll and specific force divided by `ψ²`, in the
//! nonlinear plant (steady turns of 15 to 40 m at 5 m/s, 10 and 20 t, mean) and in this model (reference load; test
//! `articulation` of `cg-plant`):
//!
//! | vehicle | axis of the | trailer, plant | model | tractor, plant | model |
//! |---|---|---|---|---|---|
//! | `kraz` | tractor | 0.09 | 0.24 | −0.79 | −0.73 |
//! | `euro` | tractor | 0.16 | 0.19 | −0.80 | −0.75 |
//! | `air` | tractor | 0.18 | 0.19 | −0.29 | −0.50 |
//! | `baseline` | tractor | 0.38 | 0.32 | −0.61 | −0.54 |
//! | `kraz` | trailer | −0.03 | 0.05 | 0.22 | 0.08 |
//! | `euro` | trailer | 0.02 | −0.07 | 0.07 | −0.03 |
//! | `air` | trailer | −0.06 | −0.06 | −0.11 | −0.42 |
//! | `baseline` | trailer | −0.08 | −0.24 | −0.10 | −0.25 |
//!
//! An independent truck, whose joint tilts about an axis of the trailer, shows 0 and 0.1.

use cg_core::{Articulation, CHANNELS, Channel, Input, Output};

use crate::equations::{Articulated, Motion, Variant};
use crate::error::VehicleError;
use crate::linear::{Laden, ratio_line_at};
use crate::load::Load;
use crate::vehicle::Vehicle;

/// Root mean square of the differences in the table above, for the trailer's roll angles and for the tractor's.
const RESIDUAL_SD: [f64; 2] = [0.1, 0.16];
/// The change of the tractor's ratio in turns that are not steady, over that in steady ones, and its standard
/// deviation. The angle builds up slowly, and a roll angle that falls meanwhile looks like slow dynamics, so that
/// the identified ratio falls by more: by up to 1.7 times as much in turns of 20 to 36 m that last 18 s (test
/// `tight_turns`).
const SHORT: [f64; 2] = [1.35, 0.35];
/// The change for the steer angle, with the slip of the tires in tight turns: the nonlinear plant (`kraz`, `euro`)
/// shows −0.6 to 0, an independent truck −0.5.
const STEER: Articulation<f64> = Articulation { mean: -0.3, sd: 0.3 };
/// `cos ψ` at which the changes are computed.
const COS: f64 = 0.95;

/// The change of the ratios of all channels at a load.
///
/// # Errors
/// As [`ratio_line`](crate::linear::ratio_line).
pub(crate) fn articulations(
    vehicle: &Vehicle,
    load: Load,
) -> Result<[Articulation<f64>; CHANNELS], VehicleError> {
    let [on_tractor, on_trailer] = changes(vehicle, load)?;
    Ok(Channel::ALL.map(|channel| {
        if channel.input() == Input::Steer {
            return STEER;
        }
        let (a, b) = (on_tractor[channel.index()], on_trailer[channel.index()]);
        let (mean, half, most) = match vehicle.hitch.tilts_on_tractor {
            Some(true) => (a, 0.0, a.abs()),
            Some(false) => (b, 0.0, b.abs()),
            None => (f64::midpoint(a, b), 0.5 * (a - b), a.abs().max(b.abs())),
        };
        let on_tractor = channel.output() == Output::TractorSuspensionRoll;
        let residual_sd = RESIDUAL_SD[usize::from(on_tractor)];
        let [longer, longer_sd] = if on_tractor { SHORT } else { [1.0, SHORT[1]] };
        let sd = libm::hypot(libm::hypot(longer * half, residual_sd), longer_sd * most);
        Articulation { mean: longer * mean, sd }
    }))
}

/// The changes of the ratios with an axis of the tractor and with one of the trailer.
fn changes(vehicle: &Vehicle, load: Load) -> Result<[[f64; CHANNELS]; 2], VehicleError> {
    let laden = Laden::new(vehicle, Variant::Complete, load)?;
    let usual = laden.motion().unwrap_or(Motion::SMALL);
    let ratios = |articulated: Articulated| {
        let laden = laden.clone().moving(Motion { articulated, ..usual });
        let lines = ratio_line_at(&laden, vehicle.nominal_speed_mps)?;
        Ok::<_, VehicleError>(lines.map(|line| line.ratio_at(load.cg_height_m)))
    };
    let straight = ratios(Articulated::STRAIGHT)?;
    let angle_rad = libm::acos(COS);
    let changes = |hitch_shares: [f64; 2]| {
        let turned = ratios(Articulated { hitch_shares, circle: COS })?;
        Ok(std::array::from_fn(|place| {
            (turned[place] / straight[place] - 1.0) / (angle_rad * angle_rad)
        }))
    };
    Ok([changes([1.0, COS])?, changes([COS, 1.0])?])
}
