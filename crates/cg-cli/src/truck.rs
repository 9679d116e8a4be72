//! Arguments that select the truck: vehicle file, calibration, equations.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow};
use cg_core::Design;
use cg_logs::estimate::{Basis, RoadChoice};
use cg_output::Files;
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::Calibration;
use cg_vehicle::design::design_with;
use cg_vehicle::finding::Finding;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::{Variant, Vehicle};
use clap::Args;

use crate::outcome::print_error;
use crate::words::word;

/// The truck and its calibration.
#[derive(Debug, Args)]
pub(crate) struct TruckArgs {
    /// Vehicle file
    #[arg(long, value_name = "V.toml")]
    pub(crate) vehicle: PathBuf,
    /// Calibration of this vehicle (from `cg calibrate`)
    #[arg(long, value_name = "C.toml")]
    pub(crate) calibration: Option<PathBuf>,
    /// Equations of the vehicle model
    #[arg(long, value_parser = word::<Variant>(), default_value_t = Variant::Complete)]
    pub(crate) model: Variant,
    #[command(flatten)]
    pub(crate) lift: LiftArgs,
}

/// The lift axles.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct LiftArgs {
    /// Position of the lift axles (`lift_m` of a trailer axle) [default: that in a log, or down]
    #[arg(long, value_name = "POSITION", value_parser = word::<LiftAxle>())]
    pub(crate) lift_axle: Option<LiftAxle>,
}

impl LiftArgs {
    /// The vehicle of a file with its lift axles in this position.
    pub(crate) fn of(self, vehicle: &Vehicle) -> anyhow::Result<Vehicle> {
        let position = self.lift_axle.unwrap_or_default();
        vehicle.clone().with_lift_axle(position).context("--lift-axle")
    }
}

/// Reads a vehicle file and prints warnings about unusual values to standard error.
pub(crate) fn load(path: &Path) -> anyhow::Result<Vehicle> {
    Ok(load_checked("--vehicle", path)?.0)
}

/// The same for a file that is given to the option `flag`; also returns the warnings.
pub(crate) fn load_checked(flag: &str, path: &Path) -> anyhow::Result<(Vehicle, Vec<Finding>)> {
    Files::new(false).reads(flag, path).prints()?;
    let (vehicle, warnings) = Vehicle::load_checked(path)?;
    let file = path.display().to_string();
    for warning in &warnings {
        // Standard error may be closed, and `eprintln!` would then panic.
        let _ = writeln!(std::io::stderr(), "cg: {}", warning.in_file(&file));
    }
    Ok((vehicle, warnings))
}

/// The roads of the logs.
#[derive(Debug, Args)]
pub(crate) struct RoadArgs {
    /// Roads: flat (test track), public, or the standard deviation of their bank in curves, rad.
    /// Default: that of the vehicle file; without it, roll angles relative to gravity and those
    /// beside sensors that do not feel the bank are taken as measured on public roads
    #[arg(long, value_name = "flat|public|SD")]
    road: Option<RoadChoice>,
}

impl RoadArgs {
    /// The given roads, or those of the vehicle file.
    pub(crate) fn of(&self, vehicle: &Vehicle) -> Option<RoadChoice> {
        self.road.or_else(|| RoadChoice::of_vehicle(vehicle))
    }
}

impl TruckArgs {
    /// Registers the files that are read.
    pub(crate) fn read(&self, files: Files) -> Files {
        files
            .reads("--vehicle", &self.vehicle)
            .reads_some("--calibration", self.calibration.as_deref())
    }

    pub(crate) fn load(&self) -> anyhow::Result<Vehicle> {
        load(&self.vehicle)
    }

    /// The design of the vehicle with its lift axles where they are, and with the calibration if there is one. What
    /// contradicts the calibration is told.
    pub(crate) fn design(&self, vehicle: &Vehicle) -> anyhow::Result<Design<f64>> {
        let (belief, _) = self.told_belief(vehicle)?;
        Ok(design_with(&self.lift.of(vehicle)?, self.model, &belief)?)
    }

    /// What is [known](Self::belief) of the truck. A calibration whose runs contradict the vehicle file is told on standard error.
    pub(crate) fn told_belief(&self, vehicle: &Vehicle) -> anyhow::Result<(Belief, Option<Basis>)> {
        let (belief, basis) = self.belief(vehicle)?;
        if let Some(message) = basis.and_then(|basis| basis.judgment.message()) {
            print_error(&anyhow!(message));
        }
        Ok((belief, basis))
    }

    /// The calibration, if there is one.
    pub(crate) fn calibration(&self, vehicle: &Vehicle) -> anyhow::Result<Option<Calibration>> {
        let Some(path) = &self.calibration else { return Ok(None) };
        Files::new(false).reads("--calibration", path).prints()?;
        let calibration = Calibration::load(path, vehicle)?;
        if calibration.model != self.model {
            return Err(anyhow!(
                "{}: the calibration is for the other model; give the same --model as to cg calibrate",
                path.display()
            ));
        }
        Ok(Some(calibration))
    }

    /// What is known of the truck, and whether the runs of the calibration are possible; `None` without one.
    pub(crate) fn belief(&self, vehicle: &Vehicle) -> anyhow::Result<(Belief, Option<Basis>)> {
        Ok(match self.calibration(vehicle)? {
            Some(calibration) => (calibration.belief(), Some(Basis::of(&calibration))),
            None => (Belief::prior(vehicle), None),
        })
    }
}
