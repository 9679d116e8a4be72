//! What perfect sensors on tractor and trailer show of the nonlinear plant.

use crate::plant::{PlantSample, UnitSample};
use cg_logs::log::LogRow;
use cg_vehicle::Vehicle;

/// Level of a frame that does not roll, above the axles.
const NOMINAL_LEVEL_M: f64 = 0.25;
/// Suspension roll per difference of the levels where the vehicle file has no level sensors: they
/// are 1 m apart.
const USUAL_ROLL_PER_DIFFERENCE: f64 = 1.0;

/// The constants of the sensors of a vehicle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Signals {
    has_chassis: bool,
    has_tractor_yaw: bool,
    gravity_mps2: f64,
    trailer_mass_kg: f64,
    /// Suspension roll per difference of the levels: trailer, tractor.
    pub(super) roll_per_difference: [f64; 2],
    /// Mass of the drive axles themselves.
    drive_axles_kg: f64,
    /// Gauge pressure without load, and per load of the drive axles in kg.
    drive_pressure: Option<[f64; 2]>,
    /// Halves of the trailer on which two roll sensors are, if the log has them separately.
    roll_halves: Option<[usize; 2]>,
}

impl Signals {
    /// With `has_chassis`, the signals of suspension roll and specific force are there too.
    pub(super) fn new(vehicle: &Vehicle, trailer_mass_kg: f64, has_chassis: bool) -> Self {
        let places = &vehicle.sensors;
        let roll_per_difference = [&places.level, &places.tractor_level].map(|level| {
            level.map_or(USUAL_ROLL_PER_DIFFERENCE, |level| level.roll_per_difference())
        });
        let drive = vehicle.tractor.axle.iter().filter(|axle| !axle.steered);
        let drive_pressure = places.drive_pressure.map(|readings| {
            let [[p, q], [a, b]] = [readings.gauge_pa, readings.axle_load_kg];
            let per_kg = (q - p) / (b - a);
            [p - per_kg * a, per_kg]
        });
        Self {
            roll_halves: vehicle.roll_halves(),
            has_chassis,
            has_tractor_yaw: places.yaw_rate_on_tractor().unwrap_or(false),
            gravity_mps2: vehicle.gravity_mps2,
            trailer_mass_kg,
            roll_per_difference,
            drive_axles_kg: drive.map(|axle| axle.axle.unsprung_mass_kg).sum(),
            drive_pressure,
        }
    }

    /// The same without the signals of suspension roll and specific force.
    pub(super) fn without_chassis(self) -> Self {
        Self { has_chassis: false, ..self }
    }

    /// Whether the log has two roll sensors.
    pub(super) fn has_two_rolls(&self) -> bool {
        self.roll_halves.is_some()
    }

    /// The roll angles of the first and the second sensor, from that of the trailer and those of its halves.
    pub(super) fn rolls_rad(&self, roll_rad: f64, halves_roll_rad: [f64; 2]) -> [f64; 2] {
        match self.roll_halves {
            Some(halves) => halves.map(|half| halves_roll_rad[half]),
            None => [roll_rad, f64::NAN],
        }
    }

    /// Whether the vehicle has a gauge on the drive axles.
    pub(super) fn has_drive_pressure(&self) -> bool {
        self.drive_pressure.is_some()
    }

    /// The row of a sample.
    pub(super) fn row(&self, time_s: f64, sample: &PlantSample) -> LogRow {
        let (tractor, trailer) = (&sample.tractor, &sample.trailer);
        let yaw = if self.has_tractor_yaw { tractor } else { trailer };
        let [roll_rad, second_roll_rad] = self.rolls_rad(trailer.roll_rad, sample.halves_roll_rad);
        let row = LogRow {
            time_s,
            steer_rad: sample.steer_rad,
            roll_rad,
            second_roll_rad,
            speed_mps: sample.speed_mps,
            lateral_acceleration_mps2: trailer.lateral_acceleration_mps2,
            yaw_rate_radps: yaw.yaw_rate_radps,
            trailer_mass_kg: self.trailer_mass_kg,
            ..LogRow::ABSENT
        };
        if !self.has_chassis {
            return row;
        }
        let [level_left_m, level_right_m] = self.levels_m(trailer, 0);
        let [tractor_level_left_m, tractor_level_right_m] = self.levels_m(tractor, 1);
        let [drive_pressure_left_pa, drive_pressure_right_pa] = self.drive_pressures_pa(sample);
        let tilt = |unit: &UnitSample| unit.specific_force_mps2 / self.gravity_mps2;
        LogRow {
            roll_to_gravity_rad: trailer.roll_to_gravity_rad,
            tilt_rad: tilt(trailer),
            axle_tilt_rad: tilt(trailer) - trailer.suspension_roll_rad,
            suspension_roll_rad: trailer.suspension_roll_rad,
            level_left_m,
            level_right_m,
            lateral_specific_force_mps2: trailer.specific_force_mps2,
            tractor_lateral_specific_force_mps2: tractor.specific_force_mps2,
            tractor_suspension_roll_rad: tractor.suspension_roll_rad,
            tractor_tilt_rad: tilt(tractor),
            tractor_axle_tilt_rad: tilt(tractor) - tractor.suspension_roll_rad,
            tractor_level_left_m,
            tractor_level_right_m,
            drive_pressure_left_pa,
            drive_pressure_right_pa,
            ..row
        }
    }

    /// A roll to the right lifts the left side.
    fn levels_m(&self, unit: &UnitSample, place: usize) -> [f64; 2] {
        let half_m = 0.5 * unit.suspension_roll_rad / self.roll_per_difference[place];
        [NOMINAL_LEVEL_M + half_m, NOMINAL_LEVEL_M - half_m]
    }

    /// The bellows of a side carry the springs' force on that side; their pressure is that under
    /// twice this load, together with the axles' own weight.
    fn drive_pressures_pa(&self, sample: &PlantSample) -> [f64; 2] {
        let Some([unloaded_pa, per_kg]) = self.drive_pressure else { return [f64::NAN; 2] };
        let drive = sample.axles().iter().filter(|axle| !axle.is_on_trailer && !axle.is_steered);
        let mut sides_n = [0.0; 2];
        for axle in drive {
            sides_n[0] += axle.left_spring_n;
            sides_n[1] += axle.right_spring_n;
        }
        sides_n.map(|side_n| {
            let load_kg = 2.0 * side_n / self.gravity_mps2 + self.drive_axles_kg;
            unloaded_pa + per_kg * load_kg
        })
    }
}
