//! Samples in, costs and heights out.

use cg_core::{
    Channel, Design, Estimator, FilteredArx, Height, Identify, Prior, Sample, Settings, Step,
};

use crate::log;
use crate::trace::Trace;
use crate::truck::DESIGN;
use crate::{CHANNELS, Maneuver};

/// The estimator on a microcontroller: the design stays in flash.
pub type Onboard = Estimator<f32, FilteredArx<f32>, &'static Design<f32, CHANNELS>, CHANNELS>;

/// The cost of one kind of call, in the clock's unit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost {
    /// Number of calls.
    pub calls: u32,
    /// Sum over all calls; 32 bits are enough for the log, and their division is small.
    pub total: u32,
    /// The worst case.
    pub worst: u32,
}

impl Cost {
    fn add(&mut self, cost: u32) {
        self.calls += 1;
        self.total = self.total.saturating_add(cost);
        self.worst = self.worst.max(cost);
    }

    /// The mean, rounded up.
    pub fn mean(&self) -> u32 {
        self.total.div_ceil(self.calls.max(1))
    }
}

/// The results of a replay.
#[derive(Clone, Copy, Debug, Default)]
pub struct Report {
    /// All samples. Every fourth mean reduces a block. A new interval, or a new start after a stop,
    /// rediscretizes the filters. After a maneuver, each sample does some stages of its solution.
    pub all: Cost,
    /// The end of the log, in a maneuver: all that is left of its solution at once.
    pub finish: u32,
    /// Hash of every answer.
    pub trace: Trace,
    /// Height from both channels combined.
    pub height: Option<Height<f32>>,
    /// Rollover threshold at that height, in g.
    pub threshold_g: f32,
}

/// Runs samples through the estimator. `clock` counts up in any unit; `told` is called with each
/// maneuver and the height after it.
pub fn replay(
    design: &'static Design<f32, CHANNELS>,
    samples: impl Iterator<Item = Sample<f32>>,
    clock: impl Fn() -> u32,
    mut told: impl FnMut(&Maneuver, Option<Height<f32>>),
) -> Report {
    let settings = Settings::truck().spread();
    let mut estimator = Onboard::new(design, settings, Prior::standard());
    let mut report = Report::default();
    let (mut mass_kg, mut speed_mps) = (design.nominal_trailer_mass_kg, f32::NAN);
    for sample in samples {
        let start = clock();
        let step = estimator.push(&sample);
        let cost = clock().wrapping_sub(start);
        report.all.add(cost);
        let closed = match &step {
            Ok(Step { closed, .. }) => closed.as_ref(),
            Err(_) => None,
        };
        report.trace.step(&step);
        report.trace.height(estimator.combined_height());
        if let Some(maneuver) = closed {
            (mass_kg, speed_mps) = (maneuver.trailer_mass_kg, maneuver.speed_mps);
            for channel in (0..CHANNELS).filter_map(|place| design.channel(place)) {
                report.trace.height(estimator.height(channel));
            }
            told(maneuver, estimator.combined_height());
        }
    }
    let start = clock();
    let last = estimator.finish();
    report.finish = clock().wrapping_sub(start);
    if let Some(maneuver) = &last {
        report.trace.maneuver(maneuver);
        told(maneuver, estimator.combined_height());
    }
    report.height = estimator.combined_height();
    report.trace.height(report.height);
    let rollover = report.height.and_then(|h| design.rollover(h.height_m, mass_kg, speed_mps));
    report.threshold_g = rollover.map_or(0.0, |r| r.static_rollover_threshold_g.value);
    report.trace.number(report.threshold_g);
    report
}

/// Costs of the identifier alone, for one row of one channel.
#[derive(Clone, Copy, Debug, Default)]
pub struct IdentifyCosts {
    /// At a constant interval; every fourth row reduces a block.
    pub even: Cost,
    /// At an interval that changes with every row, as with time stamps of arrival: the filters are
    /// discretized again each time.
    pub jitter: Cost,
}

/// Number of rows with jitter.
const JITTER_ROWS: usize = 400;

/// Measures the cost of the identifier alone on the log's lateral acceleration and roll.
pub fn identify(clock: impl Fn() -> u32) -> IdentifyCosts {
    let mut costs = IdentifyCosts::default();
    let place = DESIGN.place(Channel::LateralAcceleration);
    let model = place.and_then(|place| DESIGN.model(place, DESIGN.nominal_trailer_mass_kg));
    let Some(model) = model else { return costs };
    let mut run = |jitter: bool, rows: usize| {
        let mut identifier = <FilteredArx<_>>::for_model(&model, Prior::standard());
        for (k, sample) in log::samples().take(rows).enumerate() {
            let late = jitter && k % 2 == 1;
            let interval_s = if late { 0.060_1 } else { 0.060 };
            let start = clock();
            identifier.push(
                0.02 * sample.lateral_acceleration_mps2,
                sample.roll_rad,
                interval_s,
                true,
            );
            let cost = clock().wrapping_sub(start);
            match (k, jitter) {
                (0 | 1, _) => {} // the first interval
                (_, false) => costs.even.add(cost),
                (_, true) => costs.jitter.add(cost),
            }
        }
    };
    run(false, usize::MAX);
    run(true, JITTER_ROWS);
    costs
}
