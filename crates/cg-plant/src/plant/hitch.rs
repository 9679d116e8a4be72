//! The fifth wheel transmits every force, is free in yaw and pitch, and is a spring in roll.
//!
//! The angle of the plates is that of the trailer's vertical seen along the tractor,
//! `φ5 = atan2(−e_y1·k_2, e_z·k_2)` (eq. 3.22), minus the tractor's roll. That is a plate that tilts about an axis of
//! the tractor. One that tilts about an axis of the trailer is the same with both units exchanged. Beyond the
//! separation moment one side lifts: the moment is constant until the lash is used up and the kingpin locks.

use cg_vehicle::characteristics::FifthWheel;

use super::body::{Attitude, Motion};
use super::vector::Vector;

/// The fifth wheel in the equations of the rates: its angle, and its moment against it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Coupling {
    /// Restoring moment on the trailer.
    pub(super) moment_nm: f64,
    /// Derivatives of the angle with respect to the tractor's yaw, pitch, roll.
    pub(super) by_tractor: [f64; 3],
    /// The same of the trailer.
    pub(super) by_trailer: [f64; 3],
    /// Second derivative of the angle in time at constant rates.
    pub(super) drift_radps2: f64,
}

/// A unit at the fifth wheel.
#[derive(Clone, Copy)]
pub(super) struct Side<'a> {
    roll_rad: f64,
    attitude: &'a Attitude,
    rates: [f64; 3],
}

impl<'a> Side<'a> {
    pub(super) fn new(motion: &'a Motion, roll_rad: f64) -> Self {
        Self { roll_rad, attitude: &motion.attitude, rates: motion.rates }
    }
}

/// The angle of the fifth wheel and its moment; `turn` is the sine and cosine of the trailer's yaw minus
/// the tractor's.
#[inline]
pub(super) fn couple(
    wheel: &FifthWheel,
    tractor: &Side<'_>,
    trailer: &Side<'_>,
    (sin, cos): (f64, f64),
) -> Coupling {
    if wheel.tilts_on_tractor {
        return tilted(wheel, tractor, trailer, (sin, cos));
    }
    let exchanged = tilted(wheel, trailer, tractor, (-sin, cos));
    Coupling {
        moment_nm: -exchanged.moment_nm,
        by_tractor: exchanged.by_trailer.map(|by| -by),
        by_trailer: exchanged.by_tractor.map(|by| -by),
        drift_radps2: -exchanged.drift_radps2,
    }
}

/// The angle and moment of a plate that tilts about an axis of the first unit, which is called the tractor here.
#[inline]
fn tilted(
    wheel: &FifthWheel,
    tractor: &Side<'_>,
    trailer: &Side<'_>,
    (sin, cos): (f64, f64),
) -> Coupling {
    let (tractor_roll_rad, tractor_rates) = (tractor.roll_rad, tractor.rates);
    let (trailer, trailer_rates) = (trailer.attitude, trailer.rates);
    let k = vertical(trailer);
    // The tractor's axes in the trailer's yaw frame: e_x1 = (cos, −sin, 0), e_y1 = (sin, cos, 0).
    let across = |v: Vector| sin * v[0] + cos * v[1];
    let (n, c) = (-across(k), k[2]);
    let scale = 1.0 / (n * n + c * c);
    let angle_rad = libm::atan(n / c) - tractor_roll_rad;
    // Derivatives of the angle with respect to each rate: k rotates about e_z, e_y, b.
    let turned = [
        [-k[1], k[0], 0.0],
        [k[2], 0.0, -k[0]],
        [
            -trailer.sin_pitch * trailer.sin_roll,
            -trailer.cos_roll,
            -trailer.cos_pitch * trailer.sin_roll,
        ],
    ];
    let by_trailer = turned.map(|dk| (c * -across(dk) - n * dk[2]) * scale);
    let by_tractor = [c * (cos * k[0] - sin * k[1]) * scale, 0.0, -1.0];
    let mut moment_nm = wheel.moment_nm(angle_rad);
    if wheel.damping_nms_per_rad > 0.0 {
        let rate: f64 = (0..3)
            .map(|j| by_tractor[j] * tractor_rates[j] + by_trailer[j] * trailer_rates[j])
            .sum();
        moment_nm += wheel.damping_nms_per_rad * rate;
    }
    let turning = trailer_rates[0] - tractor_rates[0];
    let drift_radps2 = drift(trailer, [turning, trailer_rates[1], trailer_rates[2]], (sin, cos));
    Coupling { moment_nm, by_tractor, by_trailer, drift_radps2 }
}

/// Second derivative in time, at constant rates of relative yaw, pitch and roll, of the angle of the trailer's vertical seen along
/// the tractor.
#[inline]
fn drift(a: &Attitude, [turning, pitching, rolling]: [f64; 3], (sin, cos): (f64, f64)) -> f64 {
    let k = vertical(a);
    let [along_pitch, along_roll] =
        [[k[2], 0.0, -k[0]], [-a.sin_pitch * a.sin_roll, -a.cos_roll, -a.cos_pitch * a.sin_roll]];
    let along_both = [-a.cos_pitch * a.sin_roll, 0.0, a.sin_pitch * a.sin_roll];
    let along_pitch_twice = [-k[0], 0.0, -k[2]];
    let first = [0, 1, 2].map(|i| pitching * along_pitch[i] + rolling * along_roll[i]);
    let second = [0, 1, 2].map(|i| {
        pitching * pitching * along_pitch_twice[i] + 2.0 * pitching * rolling * along_both[i]
            - rolling * rolling * k[i]
    });
    let across = |v: Vector| sin * v[0] + cos * v[1];
    let along = |v: Vector| cos * v[0] - sin * v[1];
    let (n, c) = (-across(k), k[2]);
    let n_rate = -across(first) - turning * along(k);
    let n_drift = -across(second) - 2.0 * turning * along(first) + turning * turning * across(k);
    let (c_rate, c_drift) = (first[2], second[2]);
    let scale = 1.0 / (n * n + c * c);
    let rate = (c * n_rate - n * c_rate) * scale;
    (c * n_drift - n * c_drift) * scale - 2.0 * rate * (n * n_rate + c * c_rate) * scale
}

/// The trailer's own vertical in its yaw frame.
#[inline]
fn vertical(a: &Attitude) -> Vector {
    [a.sin_pitch * a.cos_roll, -a.sin_roll, a.cos_pitch * a.cos_roll]
}
