//! For any samples, the functions for C give the same answers as the estimator, bit for bit.
#![allow(unsafe_code, clippy::unwrap_used)] // calls of functions for C; small indices

use std::ptr::{from_ref, null_mut};

use crate::common;
use cg_core::truck::design::SPRING_MASSES;
use cg_core::{
    Articulation, Channel, ChannelDesign, Estimator, FilteredArx, Friction, PathLead, Prior,
    RatioLine, Reduced5, RolloverDesign, Sample, Settings, Spread, ThresholdLine,
};
use cg_ffi::{
    CG_ESTIMATOR_SIZE, CHANNELS, CgError, CgEstimator, CgHeight, CgMeasured, CgRollover, CgStep,
    Design, cg_estimator_finish, cg_estimator_height, cg_estimator_init, cg_estimator_init_on_road,
    cg_estimator_lighten, cg_estimator_push, cg_estimator_threshold,
};
use proptest::prelude::*;

/// A truck that rolls 0.025 rad per m/s² at every speed and mass.
static DESIGN: Design = Design {
    speed_mps: [2.0, 5.0, 8.0, 11.0, 14.0, 18.0, 24.0, 30.0],
    trailer_mass_kg: [8e3, 15e3, 20e3, 25e3, 31e3, 40e3],
    channels: [channel(0, 0.85), channel(1, 0.025)],
    spread: [[Spread { covariance: [[0.01, 0.0025], [0.0025, 0.0025]] }; 6]; 8],
    nominal_speed_mps: 13.9,
    nominal_trailer_mass_kg: 25e3,
    reference_height_m: 2.0,
    least_height_m: 1.0,
    greatest_height_m: 3.0,
    trailer_wheelbase_m: 7.6,
    path_lead: PathLead { ahead_m: 5.0, slip_s2_per_m: 0.01 },
    gravity_mps2: 9.81,
    rollover: RolloverDesign {
        half_track_m: 0.95,
        unsprung_mass_kg: 2e3,
        unsprung_height_m: 0.5,
        payload_beside_sd_m: 0.05,
        tightest_turn_g: 0.4,
    },
    thresholds: [ThresholdLine {
        threshold_g: [
            [0.6, 0.5, 0.45, 0.4, 0.36, 0.33, 0.3, 0.28],
            [0.65, 0.54, 0.48, 0.42, 0.38, 0.35, 0.32, 0.3],
        ],
    }; 6],
};

const fn channel(index: u32, gain: f32) -> ChannelDesign<f32> {
    ChannelDesign {
        index,
        models: [Reduced5 {
            numerator: [61.0 * gain, 28.0 * gain, 24.0 * gain, 0.0, 0.0, 0.0],
            denominator: [61.0, 83.0, 57.0, 22.0, 6.0],
            speed_slope: [0.0; 5],
        }; 6],
        friction: [Friction::NONE; SPRING_MASSES],
        of_lines: [1.0; SPRING_MASSES],
        articulation: Articulation::NONE,
        lines: [[RatioLine { a0: 0.0, a1: gain / 2.0, b0: 1.0, b1: 0.0 }; 6]; 8],
        compensation: 1.0,
    }
}

/// An estimator for the roads that it assumes, or for roads with this bank.
fn new(bank_sd_rad: Option<f32>) -> CgEstimator {
    let mut estimator = CgEstimator::EMPTY;
    let (memory, design) = (&raw mut estimator, &raw const DESIGN);
    // SAFETY: valid pointers; the design is static.
    let code = unsafe {
        match bank_sd_rad {
            None => cg_estimator_init(memory, CG_ESTIMATOR_SIZE, design, size_of::<Design>()),
            Some(bank) => {
                let size = size_of::<Design>();
                cg_estimator_init_on_road(memory, CG_ESTIMATOR_SIZE, design, size, bank)
            }
        }
    };
    assert_eq!(code, CgError::Ok as i32);
    estimator
}

/// The height of a channel, or the error.
fn height(estimator: &CgEstimator, channel: i32) -> Result<CgHeight, i32> {
    let zero = CgMeasured { value: 0.0, sd: 0.0 };
    let mut height = CgHeight { height_m: zero, random_sd_m: 0.0, maneuvers: 0 };
    // SAFETY: valid pointers.
    let code = unsafe { cg_estimator_height(estimator, channel, &raw mut height) };
    if code == CgError::Ok as i32 { Ok(height) } else { Err(code) }
}

fn words<T>(value: &T) -> Vec<u32> {
    assert_eq!(size_of::<T>() % 4, 0);
    // SAFETY: structures of words without padding (asserted by the header's order of fields).
    unsafe { std::slice::from_raw_parts(from_ref(value).cast::<u32>(), size_of::<T>() / 4) }.into()
}

const EMPTY_STEP: CgStep = {
    // SAFETY: all zero is a valid step.
    unsafe { std::mem::zeroed() }
};

/// Mostly a drive with turns, sometimes arbitrary bits.
fn sample() -> impl Strategy<Value = (u64, [f32; 6], bool)> {
    let wild = prop::array::uniform6(any::<f32>());
    let tame = (-1.0_f32..1.0).prop_map(|x| [0.0, 1e-3 * x, 14.0 + x, 0.05 * x, 0.0, 25e3]);
    let values =
        prop_oneof![40 => tame.prop_map(|v| (v, true)), 1 => wild.prop_map(|v| (v, false))];
    (prop_oneof![30 => Just(20_000_u64), 1 => 0_u64..90_000_000], values)
        .prop_map(|(interval, (values, tame))| (interval, values, tame))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn c_and_rust_answer_alike(
        samples in prop::collection::vec(sample(), 50..900),
        bank in prop::option::of(0.0_f32..0.05),
        to_gravity in any::<bool>(),
        light in any::<bool>(),
    ) {
        let mut for_c = new(bank);
        let mut settings = bank.map_or(Settings::truck(), |bank| Settings::truck().on_road(bank));
        if light {
            // SAFETY: an initialized estimator.
            prop_assert_eq!(unsafe { cg_estimator_lighten(&raw mut for_c) }, CgError::Ok as i32);
            settings = settings.spread();
        }
        let mut ours = Estimator::<f32, FilteredArx<f32>, &Design, CHANNELS>::new(
            &DESIGN, settings, Prior::standard());
        let (mut time_us, mut phase) = (0_u64, 0.0_f32);
        for (interval_us, [steer, roll, speed, lateral, yaw, mass], tame) in samples {
            time_us += interval_us;
            phase += 0.02;
            let swing = if tame { 1.5 * (0.7 * phase).sin() } else { 0.0 };
            let roll_rad = roll + 0.025 * swing;
            let nan = f32::NAN;
            let sample = common::for_c(&Sample {
                steer_rad: steer + 0.03 * swing,
                roll_rad: if to_gravity { nan } else { roll_rad },
                roll_to_gravity_rad: if to_gravity { roll_rad } else { nan },
                speed_mps: speed,
                lateral_acceleration_mps2: lateral + swing,
                yaw_rate_radps: yaw,
                trailer_mass_kg: mass,
                ..Sample::absent(time_us)
            });
            let mut step = EMPTY_STEP;
            // SAFETY: valid pointers.
            let code = unsafe { cg_estimator_push(&raw mut for_c, &raw const sample, &raw mut step) };
            if let Ok(answer) = ours.push(&sample.sample()) {
                prop_assert_eq!(code, CgError::Ok as i32);
                let told = CgStep::new(&answer);
                prop_assert_eq!(&words(&step)[2..], &words(&told)[2..]);
                prop_assert_eq!((step.status, step.closed), (told.status, told.closed));
            } else {
                prop_assert_eq!(code, CgError::TimeOrder as i32);
                prop_assert_eq!(words(&step), words(&EMPTY_STEP));
            }
        }
        // SAFETY: valid pointers; a step may be null.
        unsafe { cg_estimator_finish(&raw mut for_c, null_mut()) };
        let _ = ours.finish();
        for channel in Channel::ALL {
            let error = match DESIGN.place(channel) {
                Some(_) => CgError::NoAnswer,
                None => CgError::BadChannel,
            };
            let known = ours.height(channel).as_ref().map(CgHeight::new).ok_or(error as i32);
            let found = height(&for_c, i32::try_from(channel.index()).unwrap());
            prop_assert_eq!(found.as_ref().map(words), known.as_ref().map(words));
        }
        let combined = ours.combined_height();
        let found = height(&for_c, -1);
        prop_assert_eq!(found.is_ok(), combined.is_some());
        if let (Some(combined), Ok(found)) = (combined, found) {
            prop_assert_eq!(words(&found), words(&CgHeight::new(&combined)));
            let zero = CgMeasured { value: 0.0, sd: 0.0 };
            let mut rollover =
                CgRollover { static_stability_factor_g: 0.0, static_rollover_threshold_g: zero };
            // SAFETY: valid pointers.
            let code =
                unsafe { cg_estimator_threshold(&raw const for_c, 25e3, 15.0, &raw mut rollover) };
            prop_assert_eq!(code, CgError::Ok as i32);
            let found = DESIGN.rollover(combined.height_m, 25e3, 15.0).unwrap();
            prop_assert_eq!(words(&rollover), words(&CgRollover::new(&found)));
        }
    }
}

#[test]
fn a_bank_that_is_not_a_number_from_zero_is_refused() {
    let mut estimator = CgEstimator::EMPTY;
    for bank_sd_rad in [-0.01, f32::NAN, f32::INFINITY] {
        // SAFETY: valid pointers; the design is static.
        let code = unsafe {
            cg_estimator_init_on_road(
                &raw mut estimator,
                CG_ESTIMATOR_SIZE,
                &raw const DESIGN,
                size_of::<Design>(),
                bank_sd_rad,
            )
        };
        assert_eq!(code, CgError::BadRoad as i32);
        assert_eq!(height(&estimator, -1).err(), Some(CgError::NotInitialised as i32));
        // SAFETY: a valid pointer.
        let code = unsafe { cg_estimator_lighten(&raw mut estimator) };
        assert_eq!(code, CgError::NotInitialised as i32);
    }
}
