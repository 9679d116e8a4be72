//! J1939 frames in, heights out: the work of an ECU on the bus, with any `embedded-can` driver.

use cg_core::signal::j1939::{self, Compensation, NOT_AVAILABLE, Signal};
use cg_core::{AlignSettings, Aligner, Prior, Sample, Settings};
use embedded_can::{ExtendedId, Frame, Id, StandardId};

use crate::Maneuver;
use crate::log;
use crate::replay::Onboard;
use crate::trace::Trace;
use crate::truck::DESIGN;

/// Takes a frame received at `time_us` and turns frames into samples and samples into heights, in
/// memory of fixed size. Calls `told` for each maneuver that ends.
pub fn listen(
    aligner: &mut Aligner<f32>,
    estimator: &mut Onboard,
    frame: &impl Frame,
    time_us: u64,
    mut told: impl FnMut(&Maneuver, &Onboard),
) {
    // J1939 uses extended identifiers only.
    let Id::Extended(identifier) = frame.id() else { return };
    let identifier = identifier.as_raw();
    let source = identifier & 0xFF;
    j1939::decode(identifier, frame.data(), Compensation::Bits, |quantity, rank, value| {
        aligner.push(quantity, (source, rank), time_us, value);
    });
    while let Some(sample) = aligner.next(time_us) {
        // A sample whose time does not increase is refused and has no effect.
        if let Ok(step) = estimator.push(&sample)
            && let Some(maneuver) = &step.closed
        {
            told(maneuver, estimator);
        }
    }
}

/// A frame as a driver returns it.
pub struct Received {
    identifier: u32,
    data: [u8; 8],
}

impl Frame for Received {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let Id::Extended(id) = id.into() else { return None };
        let mut bytes = NOT_AVAILABLE;
        bytes.get_mut(..data.len())?.iter_mut().zip(data).for_each(|(to, from)| *to = *from);
        Some(Self { identifier: id.as_raw(), data: bytes })
    }

    fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> {
        None // J1939 has none
    }

    fn is_extended(&self) -> bool {
        true
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        ExtendedId::new(self.identifier).map_or(Id::Standard(StandardId::ZERO), Id::Extended)
    }

    fn dlc(&self) -> usize {
        self.data.len()
    }

    fn data(&self) -> &[u8] {
        &self.data
    }
}

/// The frames that the truck's devices send for one row of the log: brakes, roll sensor, engine,
/// scale. The road is flat, so the roll angle to gravity is that to the road. The brakes measure the
/// specific force of the tractor, which is taken to roll like the trailer.
fn frames(sample: &Sample<f32>, steering_ratio: f32) -> [Received; 4] {
    let frame = |source: u8, signals: &[(Signal, f32)]| {
        let (mut data, mut identifier) = (NOT_AVAILABLE, 0);
        for (signal, value) in signals {
            identifier = signal.identifier(source);
            signal.encode(f64::from(*value), &mut data);
            signal.set_compensated(true, &mut data);
        }
        Received { identifier, data }
    };
    let tractor_force_mps2 =
        sample.lateral_acceleration_mps2 + DESIGN.gravity_mps2 * sample.roll_rad;
    [
        frame(
            0x0B,
            &[
                (j1939::STEERING_WHEEL_ANGLE, sample.steer_rad * steering_ratio),
                (j1939::YAW_RATE, sample.yaw_rate_radps),
                (j1939::LATERAL_ACCELERATION, tractor_force_mps2),
            ],
        ),
        frame(0xE4, &[(j1939::ROLL_FINE, sample.roll_rad)]),
        frame(0x00, &[(j1939::SPEED, sample.speed_mps)]),
        frame(0xC8, &[(j1939::TRAILER_MASS, sample.trailer_mass_kg)]),
    ]
}

/// Sends the log as the frames of a truck's bus and listens to them. Returns a hash of every
/// maneuver.
pub fn replay(mut told: impl FnMut(&Maneuver, &Onboard)) -> Trace {
    const STEERING_RATIO: f32 = 20.0;
    let mut aligner =
        Aligner::new(AlignSettings { steering_ratio: Some(STEERING_RATIO), ..AlignSettings::NONE });
    let mut estimator =
        Onboard::new(&DESIGN, Settings::truck().on_road(0.0).spread(), Prior::standard());
    let mut trace = Trace::default();
    for sample in log::samples() {
        for frame in frames(&sample, STEERING_RATIO) {
            listen(&mut aligner, &mut estimator, &frame, sample.time_us, |maneuver, estimator| {
                trace.maneuver(maneuver);
                told(maneuver, estimator);
            });
        }
    }
    if let Some(maneuver) = estimator.finish() {
        trace.maneuver(&maneuver);
        told(&maneuver, &estimator);
    }
    trace.height(estimator.combined_height());
    trace
}
