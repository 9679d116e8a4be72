//! What a vehicle file says, or leaves out, that no measurement contradicts: if it is wrong, so is the height, and
//! no log shows it.

use crate::finding::plain;
use crate::slip::USUAL_G;
use crate::vehicle::Vehicle;

/// The key of the stiffness of the trailer's frame.
const FRAME: &str = "trailer.frame_torsional_stiffness_nm_per_rad";
/// The key of the place of the roll sensor.
const PLACE: &str = "sensors.roll.behind_hitch_m";
/// The key of the place of the accelerometer.
const FORCE_PLACE: &str = "sensors.accelerometer.behind_hitch_m";
/// The key of a lift axle.
const LIFT: &str = "trailer.axle.lift_m";
/// The table of the side of the body.
const WIND: &str = "wind";
/// Number of axles of a trailer from which on one is usually a lift axle.
const LIFTING: usize = 3;

/// The key of the slope of a tire.
const SLOPE: &str = "tyre.cornering_stiffness_n_per_rad";
/// Relative difference of a slope from the secant of its slip table that is noted: a third of the usual
/// uncertainty of cornering stiffnesses (15 %), as great as slopes at zero slip are too great.
const SLOPE_APART: f64 = 0.05;

/// Whether the place of the roll sensor matters, because the frame twists, and is not in the file.
pub fn has_unplaced_roll_sensor(vehicle: &Vehicle) -> bool {
    vehicle.trailer.frame_nm_per_rad().is_some() && vehicle.sensors.roll.behind_hitch_m.is_none()
}

/// Something that is taken as true because the file says it, or does not say otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Assumption {
    /// The key.
    pub key: &'static str,
    /// What is assumed, and what to do.
    pub note: String,
}

impl Assumption {
    /// All of a vehicle file.
    pub fn of(vehicle: &Vehicle) -> Vec<Self> {
        let given = vehicle.trailer.frame_torsional_stiffness_nm_per_rad;
        let is_rigid = vehicle.trailer.frame_nm_per_rad().is_none();
        let frame = given.filter(|_| is_rigid).map(|stiffness| Self {
            key: FRAME,
            note: format!(
                "{} is a rigid frame. If the frame twists, a height from a roll sensor and the rollover threshold \
                 are wrong, and no message tells it. Unless you know the frame, leave the key out: the interval \
                 then allows for any",
                plain(stiffness)
            ),
        });
        let place = has_unplaced_roll_sensor(vehicle).then(|| Self {
            key: PLACE,
            note: format!(
                "it is absent, so a roll sensor counts as over the axles. On a frame that twists, one that is less \
                 than {} m behind the fifth wheel gives a wrong height, which the interval may miss. Give the place \
                 of the sensor",
                plain(vehicle.trailer.payload.behind_hitch_m)
            ),
        });
        let is_unplaced = vehicle.sensors.accelerometer.behind_hitch_m.is_none();
        let force = (!is_rigid && is_unplaced).then(|| Self {
            key: FORCE_PLACE,
            note: "it is absent, so an accelerometer or inclinometer on the frame counts as over the trailer's axles. \
                   On a frame that twists, one further forward rolls by another angle, and the height of its pair is \
                   wrong. Give the place of the sensor"
                .to_owned(),
        });
        let axles = vehicle.trailer.axle.len();
        let none_lifts = axles >= LIFTING && !vehicle.has_lift_axle();
        let lift = none_lifts.then(|| Self {
            key: LIFT,
            note: format!(
                "none of the {axles} axles has it, so none can be raised. With one raised, heights of loads are 12 to 41 % too \
                 great, and no message tells it. If an axle can be raised, give it lift_m"
            ),
        });
        let of_slopes = Self::of_slopes(vehicle);
        let wind = Self::of_wind(vehicle);
        frame
            .into_iter()
            .chain(place)
            .chain(force)
            .chain(lift)
            .chain(wind)
            .chain(of_slopes)
            .collect()
    }

    fn of_wind(vehicle: &Vehicle) -> Option<Self> {
        vehicle.wind.is_none().then(|| Self {
            key: WIND,
            note: "it is absent, so no interval contains a side wind. On a box body, 3 m/s make the height from a single turn about \
                   2 % wrong, and that of the empty trailer 9 %, and calibrations as well. Say how large the side is, also \
                   of a flatbed with a high load"
                .to_owned(),
        })
    }

    /// The tire whose slopes are farthest from the secants of its slip table.
    fn of_slopes(vehicle: &Vehicle) -> Option<Self> {
        let apart = vehicle.tyre.iter().flat_map(|tyre| {
            let slopes = tyre.load_n.iter().zip(&tyre.cornering_stiffness_n_per_rad);
            slopes.filter_map(|(&load_n, slope)| {
                let table = tyre.lateral_force.as_ref()?;
                let [_, secant] = table.slopes_n_per_rad(load_n, USUAL_G)?;
                (load_n > 0.0).then(|| (slope / secant - 1.0, tyre.name.as_str()))
            })
        });
        let (most, tyre) = apart.max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()))?;
        (most.abs() > SLOPE_APART).then(|| Self {
            key: SLOPE,
            note: format!(
                "those of tire \"{tyre}\" differ by up to {:+.0} % from the secants at {USUAL_G} g in its slip table; slopes at \
                 zero slip are some percent greater. The model of usual turns takes the table. If you leave the key \
                 out, it is computed from the table, too",
                100.0 * most
            ),
        })
    }
}
