//! The text of a state file, which keeps the estimator's memory over a restart, and its checks.
//!
//! ```text
//!     {"format":"cg-height state","version":1,"design_crc32":…,"memory":{…},…}
//!     crc32 89abcdef
//! ```

use cg_core::decide::height::Fusion;
use cg_core::{CHANNELS, Design, Measured, Memory};
use cg_vehicle::calibration::{Calibration, Run, vehicle_crc32};
use cg_vehicle::design::design;
use cg_vehicle::files::{self, Unsealed};
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::scales::Scale;
use cg_vehicle::{Variant, Vehicle, VehicleError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::estimate::{EstimateOptions, Gusts, Strength};
use crate::learned::Learned;

const FORMAT: &str = "cg-height state";
const VERSION: u32 = 2;
/// Beginning of the second line, which contains the checksum of the first line.
const CHECKSUM: &str = "crc32 ";

/// The content of a state file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct State {
    format: String,
    version: u32,
    /// Checksum of the design (vehicle file and calibration, without what was learned).
    design_crc32: u32,
    /// The same without the calibration, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    vehicle_crc32: Option<u32>,
    /// Name of the vehicle and [checksum](vehicle_crc32) of its file. Older files do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    truck: Option<(String, u32)>,
    /// Time of saving, s, in the time of the frames (usually Unix time).
    pub saved_s: f64,
    /// Time of the last detected change of the load, s; `None` if no change was detected.
    pub load_since_s: Option<f64>,
    /// The scale of the load's mass. Older files do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<Scale>,
    /// Standard deviation of the load's mass, kg, if it was given. Older files do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_sd_kg: Option<f64>,
    /// What is wrong with a signal, so that there is no height. Older files do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrong_signal: Option<String>,
    /// Whether the mass is that of the load before. Older files do not have it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mass_is_of_another_load: bool,
    /// Whether its turns said that another load was on the trailer, so that its height was not shown. Older files do not have it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub height_is_doubted: bool,
    /// Where the lift axles were. Older files do not have it.
    #[serde(default, skip_serializing_if = "LiftAxle::is_down")]
    pub lift_axle: LiftAxle,
    /// What the turns of the load came to, if they were strong. Older files do not have it.
    #[serde(default, skip_serializing_if = "Strength::is_none")]
    pub strength: Strength,
    /// What a wind makes of the ratios of the load. Older files do not have it.
    #[serde(default, skip_serializing_if = "Gusts::is_none")]
    pub gusts: Gusts,
    /// Standard deviations of the bank of the roads that its heights assume, rad, as [`EstimateOptions::bank_sds_rad`]. Older files do
    /// not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bank_sds_rad: Option<[f64; 2]>,
    /// Standard deviation of the height by what the estimator does not know and this file does not have otherwise, m: turns that were
    /// left out, and the sensors of the roll angle. Older files do not have it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub beside_sd_m: f64,
    /// The part of the load that came or went since its last turn, kg. Older files do not have it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub part_kg: f64,
    memory: Stored,
    /// Number of learned trips in the design that gave the heights. Older files do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trips_in_use: Option<usize>,
    /// The time of the newest of them, s: another number of trips is not the only sign of other trips. Older files do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub newest_in_use_s: Option<f64>,
    /// What the truck has learned from empty driving. Older files do not have it.
    #[serde(default, skip_serializing_if = "Learned::is_empty")]
    pub learned: Learned,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde passes a reference
fn is_zero(number: &f64) -> bool {
    *number <= 0.0
}

/// The truck, as its vehicle file and calibration describe it, to which a state belongs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Owner {
    design_crc32: u32,
    /// Of the design without the calibration, if there is one.
    vehicle_crc32: Option<u32>,
    /// The name, and the checksum of what the file says beside the design too, such as the places of sensors.
    truck: (String, u32),
}

impl Owner {
    /// A truck with a calibration or none, and the design of both.
    ///
    /// # Errors
    /// As those of [`design`].
    pub fn of(
        vehicle: &Vehicle,
        calibration: Option<&Calibration>,
        of_both: &Design<f64>,
    ) -> Result<Self, VehicleError> {
        let without = |calibration: &Calibration| design(vehicle, calibration.model);
        let without = calibration.map(without).transpose()?;
        Ok(Self {
            design_crc32: design_crc32(of_both),
            vehicle_crc32: without.as_ref().map(design_crc32),
            truck: (vehicle.name.clone(), vehicle_crc32(vehicle)?),
        })
    }
}

/// The memory of the estimator, channels in the order of the design.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    fused: [Fusion<f64>; CHANNELS],
    correlation: [[f64; CHANNELS]; CHANNELS],
    trailer_mass_kg: f64,
    load_mass_kg: Option<f64>,
    waiting: Option<[ChannelHeight; CHANNELS]>,
}

/// The height of a maneuver in one channel and its systematic standard deviation.
type ChannelHeight = Option<(Measured<f64>, f64)>;

/// The reason why a text is not a usable state.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum StateError {
    /// It is not UTF-8.
    #[error("it is not text")]
    NotText,
    /// It is damaged or cut off, or it is another kind of file.
    #[error(transparent)]
    Unsealed(#[from] Unsealed),
    /// It is another kind of file.
    #[error("it is not a state file of cg run")]
    Foreign,
    /// It was written by an older or newer version.
    #[error("it has version {0}, but this program reads version {VERSION}")]
    Version(u64),
    /// A key is missing, unknown or of the wrong type.
    #[error("{0}")]
    Content(String),
    /// It belongs to another truck, or to another calibration of the same truck.
    #[error("it was saved with another vehicle file or calibration")]
    OtherDesign,
    /// It contains numbers that are impossible for an estimator.
    #[error("it contains impossible numbers")]
    Unsound,
}

impl State {
    /// A state of this truck. `saved_s` and `load_since_s` are in seconds.
    pub fn new(
        owner: Owner,
        memory: &Memory<f64>,
        saved_s: f64,
        load_since_s: Option<f64>,
        learned: Learned,
    ) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            design_crc32: owner.design_crc32,
            vehicle_crc32: owner.vehicle_crc32,
            truck: Some(owner.truck),
            saved_s,
            load_since_s,
            scale: None,
            mass_sd_kg: None,
            wrong_signal: None,
            mass_is_of_another_load: false,
            height_is_doubted: false,
            lift_axle: LiftAxle::Down,
            strength: Strength::default(),
            gusts: Gusts::default(),
            bank_sds_rad: None,
            beside_sd_m: 0.0,
            part_kg: 0.0,
            trips_in_use: None,
            newest_in_use_s: None,
            learned,
            memory: Stored {
                fused: memory.fused,
                correlation: memory.correlation,
                trailer_mass_kg: memory.trailer_mass_kg,
                load_mass_kg: memory.load_mass_kg,
                waiting: memory.waiting,
            },
        }
    }

    /// The memory of an estimator whose design contains this many learned trips, of which the newest is of this time, s. If it was
    /// saved with others, the truck is known otherwise now, and the heights are
    /// [those of another design](Memory::of_another_design).
    pub fn memory(&self, (trips_in_use, newest_s): (usize, Option<f64>)) -> Memory<f64> {
        let memory = self.stored();
        let are_as_many = self.trips_in_use.is_none_or(|saved| saved == trips_in_use);
        let bits = |time_s: Option<f64>| time_s.map(f64::to_bits);
        let are_as_new =
            self.newest_in_use_s.is_none() || bits(self.newest_in_use_s) == bits(newest_s);
        if are_as_many && are_as_new { memory } else { memory.of_another_design() }
    }

    fn stored(&self) -> Memory<f64> {
        let Stored { fused, correlation, trailer_mass_kg, load_mass_kg, waiting } = self.memory;
        Memory { fused, correlation, trailer_mass_kg, load_mass_kg, waiting }
    }

    /// Whether its heights assume roads with less bank than a truck with these options drives on.
    pub fn is_of_flatter_roads(&self, options: &EstimateOptions) -> bool {
        let present_rad = options.bank_sds_rad();
        let saved = self.bank_sds_rad.iter().flatten();
        saved.zip(present_rad).any(|(saved_rad, present_rad)| present_rad > 1.001 * saved_rad)
    }

    /// The text of the state file.
    ///
    /// # Errors
    /// A number cannot be written. This would be a bug.
    pub fn to_text(&self) -> Result<String, serde_json::Error> {
        let json = serde_json::to_string(self)?;
        Ok(files::sealed(&json, CHECKSUM))
    }

    /// Reads a state and checks that it is complete and belongs to this truck.
    ///
    /// # Errors
    /// [`StateError`] with the reason.
    pub fn parse(bytes: &[u8], own: &Owner) -> Result<Self, StateError> {
        Self::of_any_truck(bytes)?.of_truck(own, |state| state.design_crc32)
    }

    /// The same for a truck with any calibration or none; `own` is without one.
    fn of_vehicle(bytes: &[u8], own: &Owner) -> Result<Self, StateError> {
        let without = |state: &Self| state.vehicle_crc32.unwrap_or(state.design_crc32);
        Self::of_any_truck(bytes)?.of_truck(own, without)
    }

    /// This state, if it is of the truck `own` and of its design.
    fn of_truck(self, own: &Owner, crc32: impl Fn(&Self) -> u32) -> Result<Self, StateError> {
        let is_truck = self.truck.as_ref().is_none_or(|truck| *truck == own.truck);
        let is_own = is_truck && crc32(&self) == own.design_crc32;
        if is_own { Ok(self) } else { Err(StateError::OtherDesign) }
    }

    /// Reads a state of any truck and checks that it is complete.
    fn of_any_truck(bytes: &[u8]) -> Result<Self, StateError> {
        let text = std::str::from_utf8(bytes).map_err(|_| StateError::NotText)?;
        let json = files::unsealed(text, CHECKSUM)?;
        let version = serde_json::from_str::<serde_json::Value>(json)
            .ok()
            .filter(|value| value["format"] == FORMAT)
            .and_then(|value| value["version"].as_u64())
            .ok_or(StateError::Foreign)?;
        if version != u64::from(VERSION) {
            return Err(StateError::Version(version));
        }
        let state: Self =
            serde_json::from_str(json).map_err(|error| StateError::Content(error.to_string()))?;
        let is_size = |number: f64| number.is_finite() && number >= 0.0;
        let parts = [
            state.stored().is_sound(),
            state.bank_sds_rad.iter().flatten().all(|sd_rad| is_size(*sd_rad)),
            is_size(state.beside_sd_m) && is_size(state.part_kg),
            state.learned.is_sound(),
            state.strength.is_sound(),
            state.gusts.is_sound(),
            state.mass_sd_kg.is_none_or(is_size),
        ];
        if parts.contains(&false) {
            return Err(StateError::Unsound);
        }
        Ok(state)
    }
}

/// The trips with the empty trailer in some state files, or in texts of [`Learned::text_of`] (name and
/// content), as runs of a calibration. The truck is as at the time of the newest one. A trip that is
/// given twice counts once.
///
/// # Errors
/// [`VehicleError`] if one is not a state of this vehicle, or has no trip.
pub fn runs_of(
    files: &[(String, Vec<u8>)],
    vehicle: &Vehicle,
    variant: Variant,
) -> Result<Vec<Run>, VehicleError> {
    if files.is_empty() {
        return Ok(Vec::new());
    }
    let own = Owner::of(vehicle, None, &design(vehicle, variant)?)?;
    let mut all = Vec::new();
    for (name, bytes) in files {
        let refused = |reason: String| VehicleError::Model(format!("{name}: {reason}"));
        let text = std::str::from_utf8(bytes).ok();
        let learned = if let Some(learned) = text.and_then(|text| Learned::parse(text).ok()) {
            learned.belongs_to(vehicle).map_err(|error| refused(error.to_string()))?;
            learned
        } else {
            let state = State::of_vehicle(bytes, &own);
            state.map_err(|error| refused(error.to_string()))?.learned
        };
        if learned.trips() == 0 {
            return Err(refused("contains no trip with the empty trailer".to_owned()));
        }
        all.push((name, learned));
    }
    let now_s = all.iter().filter_map(|(_, learned)| learned.newest_s()).fold(f64::MIN, f64::max);
    let mut runs: Vec<Run> = Vec::new();
    for (name, learned) in &all {
        for (k, run) in learned.runs(vehicle, now_s).into_iter().enumerate() {
            let run = Run { log: format!("{name}, trip {}", k + 1), ..run };
            let is_again = |other: &Run| Run { log: run.log.clone(), ..other.clone() } == run;
            if !runs.iter().any(is_again) {
                runs.push(run);
            }
        }
    }
    Ok(runs)
}

/// The checksum that distinguishes designs: of the numbers that relate a ratio to a height, and of
/// their uncertainty, each to five digits. Every computer computes the same bits, but another version
/// may round differently, which changes a design by less than 1e-10; an update must find its state.
pub fn design_crc32(design: &Design<f64>) -> u32 {
    let heights_m = [design.least_height_m, design.greatest_height_m];
    let lines = design.channels.iter().flat_map(|channel| channel.lines.iter().flatten());
    let ratios = lines.flat_map(|line| heights_m.map(|height_m| line.ratio_at(height_m)));
    let spread = design.spread.iter().flatten();
    let sds = spread.flat_map(|spread| (0..CHANNELS).map(|place| spread.sd(place)));
    let axes = design.speed_mps.into_iter().chain(design.trailer_mass_kg).chain(heights_m);
    let numbers = axes.chain(ratios).chain(sds).map(|number| format!("{number:.4e}"));
    files::checksum(&numbers.collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cg_core::{Estimator, FilteredArx, Prior, Settings};
    use cg_vehicle::sensor_places::LevelSensors;

    /// Multiplies every number that the checksum depends on, other than the axes.
    fn scaled(design: &Design<f64>, factor: f64) -> Design<f64> {
        let mut design = *design;
        for line in
            design.channels.iter_mut().flat_map(|channel| channel.lines.iter_mut().flatten())
        {
            line.a0 *= factor;
            line.a1 *= factor;
        }
        for spread in design.spread.iter_mut().flatten() {
            spread.covariance.iter_mut().flatten().for_each(|entry| *entry *= factor);
        }
        design
    }

    /// The design is that of a calibration or none; the file says more than the design. A state of an older program says
    /// nothing of it.
    #[test]
    fn a_state_is_of_one_truck_with_its_sensors_and_its_calibration() {
        let kraz = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
        let vehicle = Vehicle::load(kraz).unwrap();
        let here = design(&vehicle, Variant::Complete).unwrap();
        let own = Owner::of(&vehicle, None, &here).unwrap();
        let estimator: Estimator<f64, FilteredArx<f64>> =
            Estimator::new(here, Settings::truck(), Prior::standard());
        let state = State::new(own.clone(), &estimator.memory(), 1.0, None, Learned::default());
        let bytes = state.to_text().unwrap().into_bytes();
        let with = |change: &dyn Fn(&mut Vehicle)| {
            let mut other = vehicle.clone();
            change(&mut other);
            // None of these changes the design.
            assert_eq!(design(&other, Variant::Complete).unwrap(), here);
            Owner::of(&other, None, &here).unwrap()
        };
        let read = |own: &Owner| (State::parse(&bytes, own), State::of_vehicle(&bytes, own));
        assert_eq!(read(&own), (Ok(state.clone()), Ok(state.clone())));
        let refused = || Err(StateError::OtherDesign);
        assert_eq!(read(&with(&|other| other.name.push('2'))), (refused(), refused()));
        let level = |spread_m| Some(LevelSensors { spread_m, gain: 1.0 });
        let levels = with(&|other| other.sensors.tractor_level = level(0.97));
        assert_eq!(read(&levels), (refused(), refused()));
        let ratio = with(&|other| other.steering_ratio = Some(23.0));
        assert_eq!(read(&ratio), (refused(), refused()));
        let older = State { truck: None, ..state };
        let bytes = older.to_text().unwrap().into_bytes();
        assert_eq!(State::parse(&bytes, &ratio), Ok(older));
    }

    #[test]
    fn a_design_of_another_version_is_the_same_and_that_of_another_truck_is_not() {
        let kraz = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/vehicles/kraz.toml");
        let mut vehicle = Vehicle::load(kraz).unwrap();
        let here = design(&vehicle, Variant::Complete).unwrap();
        let checksum = design_crc32(&here);
        // A number is rounded differently if it lies within 1e-10 of the limit between two roundings,
        // which are at least 1e-5 apart: for about 600 numbers, in 1 % of all trucks.
        for factor in [1.0 - 1e-10, 1.0 + 1e-10] {
            let there = scaled(&here, factor);
            assert!(there != here && design_crc32(&there) == checksum, "{factor}");
        }
        for factor in [1.0 - 1e-3, 1.0 + 1e-3] {
            assert_ne!(design_crc32(&scaled(&here, factor)), checksum, "{factor}");
        }
        vehicle.uncertainty.roll_stiffness_sd *= 1.01;
        assert_ne!(design_crc32(&design(&vehicle, Variant::Complete).unwrap()), checksum);
    }
}
