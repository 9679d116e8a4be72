//! Options of a calibration, and what identifies its runs.

use cg_core::Channel;
use cg_vehicle::belief::Belief;
use cg_vehicle::calibration::{Part, Procedure};
use cg_vehicle::design::RatioDesign;
use cg_vehicle::lift::LiftAxle;
use cg_vehicle::{Variant, Vehicle, VehicleError};

use crate::estimate::{EstimateOptions, LogEstimator, Method, Truck};
use crate::known::KnownLog;

/// Options of a calibration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CalibrateOptions {
    /// Equations of the vehicle model.
    pub variant: Variant,
    /// Method by which the DC ratios are identified.
    pub method: Method,
    /// The channel whose ratios are used; `None` uses all.
    pub channel: Option<Channel>,
    /// What the runs determine.
    pub procedure: Procedure,
    /// What the calibration is for.
    pub part: Part,
    /// Position of the lift axles in all logs; `None` is what each log says, or down.
    pub lift_axle: Option<LiftAxle>,
    /// Whether it is made even if its runs contradict the vehicle file with a probability of chance
    /// below 1e-4.
    pub force: bool,
}

/// What identifies a run: the truck with its lift axles in the given position, or down and raised.
#[derive(Clone, Debug)]
pub(super) struct RunTruck {
    present: Truck,
    raised: Option<Truck>,
}

impl RunTruck {
    pub(super) fn estimator(&self) -> LogEstimator {
        LogEstimator::of_positions(&self.present, self.raised.clone())
    }
}

/// What identifies each run, if the parameters have this distribution.
pub(super) fn run_trucks(
    vehicle: &Vehicle,
    options: CalibrateOptions,
    belief: &Belief,
    logs: &[KnownLog],
) -> Result<Vec<RunTruck>, VehicleError> {
    let design = |vehicle: Vehicle| -> Result<_, VehicleError> {
        let design = RatioDesign::new(&vehicle, options.variant, belief)?;
        Ok((vehicle, design))
    };
    let (present, raised) = vehicle.in_positions(options.lift_axle, options.variant)?;
    let raised = raised.map(design).transpose()?;
    let present = design(present)?;
    let mut trucks: Vec<RunTruck> = Vec::with_capacity(logs.len());
    for (i, known) in logs.iter().enumerate() {
        let truck = |(vehicle, design): &(Vehicle, RatioDesign)| -> Result<_, VehicleError> {
            let design = design.at_height(known.load.height_m(vehicle).value)?;
            Ok(Truck::new(vehicle, &design, of_run(vehicle, options, known)))
        };
        let same = logs[..i].iter().position(|other| other.load == known.load);
        trucks.push(match same {
            Some(place) => trucks[place].clone(),
            None => RunTruck {
                raised: raised.as_ref().map(truck).transpose()?,
                present: truck(&present)?,
            },
        });
    }
    Ok(trucks)
}

/// The options with which a run is identified.
fn of_run(vehicle: &Vehicle, how: CalibrateOptions, known: &KnownLog) -> EstimateOptions {
    let CalibrateOptions { variant, method, channel, .. } = how;
    let trailer_mass = known.load.trailer_mass(vehicle);
    EstimateOptions {
        variant,
        method,
        channel,
        trailer_mass_kg: trailer_mass.map(|mass| mass.kg),
        trailer_mass_sd_kg: trailer_mass.and_then(|mass| mass.sd_kg),
        lift_axle: how.lift_axle,
        ..EstimateOptions::default()
    }
}
