//! An estimator whose identifiers return prescribed results, on a drive at 100 Hz.

use cg_core::Outcome;
use cg_core::{
    Answer, Channel, Design, Estimator, Fit, Identify, Maneuver, Measured, Reduced5, Sample,
    Settings, Status, Unexcited,
};

/// The prescribed results besides the ratio, in the order of [`PAIR`](super::PAIR).
#[derive(Clone, Copy)]
pub(crate) struct Says {
    pub(crate) ratio_sd: [f64; 2],
    pub(crate) misfit: [f64; 2],
    pub(crate) bend: [Measured<f64>; 2],
}

impl Says {
    pub(crate) const WELL: Self =
        Self { ratio_sd: [0.01; 2], misfit: [0.0; 2], bend: [Measured { value: 0.0, sd: 0.0 }; 2] };
}

/// An identifier that returns prescribed results. The ratio is that of the newest row used; the
/// signal-to-noise ratio contains the weight of its rows.
#[derive(Clone, Copy)]
pub(crate) struct Told {
    says: Says,
    channel: Channel,
    rows: u32,
    weight: f64,
    ratio: f64,
    input: f64,
}

impl Identify<f64> for Told {
    type Options = Says;

    const EMPTY: Self = Self {
        says: Says::WELL,
        channel: Channel::Steer,
        rows: 0,
        weight: 0.0,
        ratio: 0.0,
        input: 0.0,
    };

    fn make_for(&mut self, model: &Reduced5<f64>, says: Says) {
        // One radian of steer gives more roll than one meter per second squared.
        let steer = model.dc_gain() > 0.1;
        let channel = if steer { Channel::Steer } else { Channel::LateralAcceleration };
        *self = Self { says, channel, ..Self::EMPTY };
    }

    fn push(&mut self, input: f64, roll_rad: f64, _: f64, use_row: bool) {
        self.input = input;
        if use_row {
            self.rows += 1;
            self.weight += 1.0;
            if input.abs() > 1e-3 {
                self.ratio = roll_rad / input;
            }
        }
    }

    fn expected_roll_rad(&self) -> f64 {
        self.input
    }

    fn clear(&mut self) {
        (self.rows, self.weight) = (0, 0.0);
    }

    fn restart(&mut self) {
        self.clear();
    }

    fn forget(&mut self, factor: f64) {
        self.weight *= factor;
    }

    fn fit(&mut self) -> Answer<f64> {
        if self.rows == 0 {
            return Answer::Unexcited(Unexcited::Input);
        }
        let k = self.channel.index();
        Answer::Ready(Fit {
            ratio: Measured { value: self.ratio, sd: self.says.ratio_sd[k] },
            drift_radps: Measured::exact(0.0),
            bend: self.says.bend[k],
            noise_sd_rad: 0.0,
            snr_db: self.weight,
            fit_percent: 100.0,
            misfit: self.says.misfit[k],
            rows: self.rows,
        })
    }
}

/// Roll angle in the steady turns of [`Road`], rad: 1.6 m/s² at the reference height.
pub(crate) const ROLL_RAD: f64 = 0.04;

/// A truck whose trailer has one height according to the steer channel and one according to the
/// lateral-acceleration channel.
pub(crate) struct Road {
    pub(crate) estimator: super::Pair<f64, Told>,
    pub(crate) time_us: u64,
    pub(crate) heights_m: [f64; 2],
    pub(crate) speed_mps: f64,
    pub(crate) trailer_mass_kg: f64,
    pub(crate) closed: Vec<Maneuver<f64, 2>>,
    pub(crate) last_turn_us: u64,
}

impl Road {
    pub(crate) fn new(says: Says) -> Self {
        Self::on(Estimator::new(super::design(), Settings::truck(), says))
    }

    #[allow(clippy::large_types_passed_by_value)] // called once per test
    pub(crate) fn on(estimator: super::Pair<f64, Told>) -> Self {
        Self {
            estimator,
            time_us: 0,
            heights_m: [1.973; 2],
            speed_mps: 10.0,
            trailer_mass_kg: f64::NAN,
            closed: Vec::new(),
            last_turn_us: 0,
        }
    }

    /// The input of a channel that gives this roll angle at the channel's height.
    fn input(&self, channel: Channel, roll_rad: f64) -> f64 {
        let design: &Design<f64, 2> = self.estimator.design();
        let of = &design.channels[channel.index()];
        roll_rad / of.lines[0][0].ratio_at(self.heights_m[channel.index()]) / of.compensation
    }

    /// One row, 10 ms after the previous one. The sensor shows `shown_rad` while the roll angle is
    /// `roll_rad`.
    pub(crate) fn row(&mut self, shown_rad: f64, roll_rad: f64) -> Status {
        self.time_us += 10_000;
        let mut sample = Sample::absent(self.time_us);
        sample.roll_rad = shown_rad;
        sample.steer_rad = self.input(Channel::Steer, roll_rad);
        sample.lateral_acceleration_mps2 = self.input(Channel::LateralAcceleration, roll_rad);
        sample.speed_mps = self.speed_mps;
        sample.trailer_mass_kg = self.trailer_mass_kg;
        let step = self.estimator.push(&sample).unwrap();
        if step.status == Status::Turning {
            self.last_turn_us = self.time_us;
        }
        self.closed.extend(step.closed);
        step.status
    }

    /// Rows with a constant roll angle.
    pub(crate) fn hold(&mut self, rows: u32, roll_rad: f64) {
        for _ in 0..rows {
            self.row(roll_rad, roll_rad);
        }
    }

    /// Into a turn and out of it, in 8 s.
    pub(crate) fn turn(&mut self) {
        for k in 0..=800 {
            let roll_rad = ROLL_RAD * (f64::from(k) * core::f64::consts::PI / 800.0).sin();
            self.row(roll_rad, roll_rad);
        }
    }

    /// Ends the maneuver, which must be the only one since the last call.
    pub(crate) fn finish(&mut self) -> Maneuver<f64, 2> {
        self.closed.extend(self.estimator.finish());
        assert_eq!(self.closed.len(), 1);
        self.closed.remove(0)
    }

    /// One maneuver after a second of straight driving; returns the results of both channels.
    pub(crate) fn maneuver(&mut self, heights_m: [f64; 2]) -> [Outcome<f64>; 2] {
        self.heights_m = heights_m;
        self.hold(100, 0.0);
        self.turn();
        self.finish().outcomes
    }
}
