//! The channels that do not feel the bank of the road: the suspensions of trailer and tractor.

use cg_core::{ChannelDesign, Design, Sample};

use crate::{CHANNELS, log, truck};

/// The truck with these channels. Both have the model of the lateral acceleration, which costs as
/// much as their own.
pub static DESIGN: Design<f32, CHANNELS> = {
    let [_, lateral] = truck::DESIGN.channels;
    let suspension = ChannelDesign { index: 2, ..lateral };
    let tractor = ChannelDesign { index: 3, ..lateral };
    Design { channels: [suspension, tractor], ..truck::DESIGN }
};

/// The log as sensors of both suspensions would have measured it.
pub fn samples() -> impl Iterator<Item = Sample<f32>> {
    log::samples().map(|sample| Sample {
        suspension_roll_rad: sample.roll_rad,
        lateral_specific_force_mps2: sample.lateral_acceleration_mps2,
        tractor_suspension_roll_rad: sample.roll_rad,
        tractor_lateral_specific_force_mps2: sample.lateral_acceleration_mps2,
        speed_mps: sample.speed_mps,
        trailer_mass_kg: sample.trailer_mass_kg,
        ..Sample::absent(sample.time_us)
    })
}
