//! Turns bytes into samples for an estimator, and checks what must always hold.
//!
//! | first byte modulo 8 | then | meaning |
//! |---|---|---|
//! | 0 to 2 | 8 bytes | some driving: samples that move toward an input and its roll angle |
//! | 3 | 7 bytes | one sample of plausible values |
//! | 4 | 56 bytes | one sample of arbitrary bits |
//! | 5 | 8 bytes | an arbitrary time |
//! | 6 | 1 byte | a pause of tenths of a second |
//! | 7 | – | the end of a log, and a restart |

use std::fmt::Debug;

use cg_core::{
    Channel, Combined, Design, Estimator, FilteredArx, Height, Measured, Prior, Real, Sample,
    Settings, Step,
};

/// The greatest number of samples.
const MOST_SAMPLES: usize = 4000;

type Subject<T> = Estimator<T, FilteredArx<T>>;

/// Whether a height came out.
pub(crate) fn drive<T: Real + Debug>(data: &[u8], design: &Design<T>) -> bool {
    let mut truck = Truck::new(design);
    let mut code = data.iter().copied();
    while let Some(what) = code.next() {
        if truck.samples > MOST_SAMPLES || truck.obey(what, &mut code).is_none() {
            break;
        }
    }
    truck.finish();
    truck.answered
}

/// A hundred samples of a turn.
pub(crate) fn hundred_samples(mut estimator: Subject<f64>) {
    check(&estimator);
    for k in 0..100_u32 {
        let sample = Sample {
            steer_rad: 0.001 * f64::from(k.min(50)),
            roll_rad: 0.0008 * f64::from(k.min(60)),
            speed_mps: 14.0,
            lateral_acceleration_mps2: 0.04 * f64::from(k.min(55)),
            ..Sample::absent(1_000_000 + 50_000 * u64::from(k))
        };
        let step = estimator.push(&sample).expect("time goes on");
        check_step(&step);
    }
    estimator.finish();
    check(&estimator);
}

struct Truck<T: Real> {
    estimator: Subject<T>,
    design: Design<T>,
    time_us: u64,
    samples: usize,
    answered: bool,
    steer_rad: f64,
    roll_rad: f64,
    lateral_mps2: f64,
    noise: u32,
}

fn signed(byte: u8) -> f64 {
    f64::from(byte.cast_signed()) / 127.0
}

impl<T: Real + Debug> Truck<T> {
    fn new(design: &Design<T>) -> Self {
        Self {
            estimator: Estimator::new(*design, Settings::truck(), Prior::standard()),
            design: *design,
            time_us: 0,
            samples: 0,
            answered: false,
            steer_rad: 0.0,
            roll_rad: 0.0,
            lateral_mps2: 0.0,
            noise: 1,
        }
    }

    /// Executes one code; `None` at the end of the bytes.
    fn obey(&mut self, what: u8, code: &mut impl Iterator<Item = u8>) -> Option<()> {
        match what % 8 {
            0..=2 => self.stretch(take(code)?),
            3 => self.plausible(take(code)?),
            4 => self.any(code)?,
            5 => self.time_us = u64::from_le_bytes(take(code)?),
            6 => self.pass(u64::from(code.next()?) * 100_000),
            _ => self.restart(),
        }
        Some(())
    }

    fn pass(&mut self, us: u64) {
        self.time_us = self.time_us.saturating_add(us);
    }

    fn stretch(&mut self, bytes: [u8; 8]) {
        let [count, interval_ms, steer, roll, lateral, speed, mass, flags] = bytes;
        let to = (0.15 * signed(steer), 0.15 * signed(roll), 6.0 * signed(lateral));
        let interval_ms = 1 + interval_ms % 64;
        let share = 0.001 * f64::from(interval_ms) / (0.1 + 0.1 * f64::from(flags >> 5));
        for _ in 0..=count {
            self.pass(1000 * u64::from(interval_ms));
            self.steer_rad += (to.0 - self.steer_rad) * share.min(1.0);
            self.lateral_mps2 += (to.2 - self.lateral_mps2) * share.min(1.0);
            self.roll_rad += (to.1 - self.roll_rad) * share.min(1.0);
            let is = |bit: u8, value: f64| if flags >> bit & 1 == 1 { f64::NAN } else { value };
            let noise = [(); 3].map(|()| f64::from(mass % 4) * self.noise());
            self.push([
                is(0, self.steer_rad + 1e-4 * noise[0]),
                is(1, self.roll_rad + 1e-4 * noise[1]),
                is(2, self.roll_rad + 0.1 * self.lateral_mps2),
                is(3, f64::from(speed) / 8.0),
                is(4, self.lateral_mps2 + 1e-2 * noise[2]),
                f64::NAN,
                if mass < 4 { f64::NAN } else { 300.0 * f64::from(mass) },
            ]);
        }
    }

    /// Between -1 and 1 (linear congruence of Numerical Recipes).
    fn noise(&mut self) -> f64 {
        self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.noise) / f64::from(u32::MAX) * 2.0 - 1.0
    }

    fn plausible(&mut self, bytes: [u8; 7]) {
        self.pass(10_000);
        let scales = [0.2, 0.2, 0.5, 30.0, 10.0, 1.0, 60e3];
        let mut values = [0.0; 7];
        for ((value, byte), scale) in values.iter_mut().zip(bytes).zip(scales) {
            *value = if byte == 0x80 { f64::NAN } else { scale * signed(byte) };
        }
        self.push(values);
    }

    fn any(&mut self, code: &mut impl Iterator<Item = u8>) -> Option<()> {
        self.pass(10_000);
        let mut values = [0.0; 7];
        for value in &mut values {
            *value = f64::from_le_bytes(take(code)?);
        }
        self.push(values);
        Some(())
    }

    fn push(&mut self, values: [f64; 7]) {
        let [steer, roll, tilt, speed, lateral, yaw, mass] = values.map(T::of);
        let sample = Sample {
            time_us: self.time_us,
            steer_rad: steer,
            roll_rad: roll,
            tilt_rad: tilt,
            speed_mps: speed,
            lateral_acceleration_mps2: lateral,
            yaw_rate_radps: yaw,
            trailer_mass_kg: mass,
            // The same numbers as the signals of the other channels.
            roll_to_gravity_rad: tilt,
            suspension_roll_rad: roll,
            lateral_specific_force_mps2: lateral,
            tractor_suspension_roll_rad: steer,
            tractor_lateral_specific_force_mps2: yaw,
            tractor_tilt_rad: tilt,
        };
        self.samples += 1;
        // A refusal (a time that goes back) is also a valid answer.
        if let Ok(step) = self.estimator.push(&sample) {
            check_step(&step);
            if step.closed.is_some() {
                self.look();
            }
        }
    }

    fn look(&mut self) {
        self.answered |= check(&self.estimator);
    }

    fn finish(&mut self) {
        self.estimator.finish();
        self.look();
    }

    fn restart(&mut self) {
        self.finish();
        let (settings, prior) = (Settings::truck(), Prior::standard());
        let memory = self.estimator.memory();
        let restored = Estimator::restored(self.design, settings, prior, &memory);
        self.estimator =
            restored.unwrap_or_else(|| panic!("its own memory is unsound: {memory:?}"));
        self.look();
    }
}

fn take<const N: usize>(code: &mut impl Iterator<Item = u8>) -> Option<[u8; N]> {
    let mut bytes = [0; N];
    for byte in &mut bytes {
        *byte = code.next()?;
    }
    Some(bytes)
}

fn good<T: Real>(measured: Measured<T>) -> bool {
    let (value, sd) = (measured.value.as_f64(), measured.sd.as_f64());
    value.is_finite() && value > 0.0 && sd.is_finite() && sd > 0.0
}

fn check_height<T: Real + Debug>(height: &Height<T>) {
    let random_sd_m = height.random_sd_m.as_f64();
    assert!(good(height.height_m) && random_sd_m.is_finite(), "{height:?}");
}

fn check_step<T: Real + Debug>(step: &Step<T>) {
    let Some(maneuver) = &step.closed else { return };
    for outcome in &maneuver.outcomes {
        if let Ok(height_m) = outcome.height_m {
            assert!(good(height_m) && outcome.systematic_sd_m.as_f64().is_finite(), "{maneuver:?}");
        }
    }
}

/// Checks what must hold for every estimator; returns whether it has a height.
fn check<T: Real + Debug>(estimator: &Subject<T>) -> bool {
    for channel in Channel::ALL {
        if let Some(height) = estimator.height(channel) {
            check_height(&height);
        }
    }
    let memory = estimator.memory();
    assert!(memory.is_sound(), "{memory:?}");
    match estimator.combined() {
        Some(Combined::Agreed(height)) => check_height(&height),
        Some(Combined::Doubtful { height, chi_square, .. }) => {
            check_height(&height);
            assert!(chi_square.as_f64().is_finite(), "{chi_square:?}");
        }
        Some(Combined::Contradictory { chi_square, .. }) => {
            assert!(chi_square.as_f64().is_finite(), "{chi_square:?}");
        }
        _ => {}
    }
    estimator.combined_height().is_some()
}
