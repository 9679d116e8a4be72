//! An estimator whose identifiers return prescribed results, on a drive at 100 Hz.

use cg_core::Outcome;
use cg_core::identify::mean::Mean;
use cg_core::truck::lags::RollLags;
use cg_core::{
    Answer, Channel, Design, Estimator, Fit, Identify, Maneuver, Measured, Reduced5, Sample,
    Settings, Status, Unexcited,
};

/// The prescribed results besides the ratio, for the first `C` of all channels.
#[derive(Clone, Copy)]
pub(crate) struct Says<const C: usize = 2> {
    pub(crate) ratio_sd: [f64; C],
    pub(crate) misfit: [f64; C],
    pub(crate) bend: [Measured<f64>; C],
}

impl<const C: usize> Says<C> {
    pub(crate) const WELL: Self =
        Self { ratio_sd: [0.01; C], misfit: [0.0; C], bend: [Measured { value: 0.0, sd: 0.0 }; C] };
}

/// An identifier that returns prescribed results. The ratio is that of the newest row used; the
/// signal-to-noise ratio contains the weight of its rows.
#[derive(Clone, Copy)]
pub(crate) struct Told<const C: usize = 2> {
    says: Says<C>,
    place: usize,
    rows: u32,
    weight: f64,
    ratio: f64,
    input: f64,
    /// Whether the roll angle passes lags; the input then passes the same ones, so their ratio is that
    /// of the height.
    lags: bool,
    late: Option<RollLags<f64>>,
}

impl<const C: usize> Identify<f64> for Told<C> {
    const MOST_TOGETHER: u32 = 1;
    type Options = Says<C>;
    type Work = ();
    const NOT_BEGUN: () = ();

    const EMPTY: Self = Self {
        says: Says::WELL,
        place: 0,
        rows: 0,
        weight: 0.0,
        ratio: 0.0,
        input: 0.0,
        lags: false,
        late: None,
    };

    fn make_for(&mut self, model: &Reduced5<f64>, lags: bool, says: Says<C>) {
        let per_steer = super::EQ_5_12.dc_gain() / model.dc_gain();
        let its = |gain: &f64| (per_steer / gain - 1.0).abs() < 1e-9;
        let place = super::INPUT_PER_STEER.iter().position(its).unwrap();
        *self = Self { says, place, lags, ..Self::EMPTY };
    }

    fn push_mean(&mut self, mean: &Mean<f64>) {
        let Mean { input, roll_rad, interval_s, is_used, .. } = *mean;
        self.input = input;
        let late = self.late.get_or_insert(RollLags::at_rest(input)).push(input, interval_s);
        if is_used {
            self.rows += 1;
            self.weight += 1.0;
            let seen = if self.lags { late } else { input };
            if seen.abs() > 1e-3 {
                self.ratio = roll_rad / seen;
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
        self.late = None;
    }

    fn forget(&mut self, factor: f64) {
        self.weight *= factor;
    }

    fn fit_stage(&mut self, (): &mut ()) -> Option<Answer<f64>> {
        if self.rows == 0 {
            return Some(Answer::Unexcited(Unexcited::Input));
        }
        let k = self.place;
        Some(Answer::Ready(Fit {
            ratio: Measured { value: self.ratio, sd: self.says.ratio_sd[k] },
            drift_radps: Measured::exact(0.0),
            bend: self.says.bend[k],
            noise_sd_rad: 0.0,
            snr_db: self.weight,
            fit_percent: 100.0,
            misfit: self.says.misfit[k],
            rows: self.rows,
        }))
    }
}

/// Roll angle in the steady turns of [`Road`], rad: 1.6 m/s² at the reference height.
pub(crate) const ROLL_RAD: f64 = 0.04;

/// A truck whose trailer has a height for each channel. If it is NaN, the input of the channel is
/// absent.
pub(crate) struct Road<const C: usize = 2> {
    pub(crate) estimator: Estimator<f64, Told<C>, Design<f64, C>, C>,
    pub(crate) time_us: u64,
    pub(crate) heights_m: [f64; C],
    /// Whether the roll sensor shows the angle relative to gravity.
    pub(crate) to_gravity: bool,
    /// End of the range of the sensors of the trailer's suspension.
    pub(crate) suspension_end_rad: f64,
    pub(crate) speed_mps: f64,
    pub(crate) trailer_mass_kg: f64,
    pub(crate) closed: Vec<Maneuver<f64, C>>,
    pub(crate) last_turn_us: u64,
}

impl Road {
    pub(crate) fn new(says: Says) -> Self {
        Self::on(Estimator::new(super::design(), Settings::truck(), says))
    }
}

impl<const C: usize> Road<C> {
    #[allow(clippy::large_types_passed_by_value)] // called once per test
    pub(crate) fn on(estimator: Estimator<f64, Told<C>, Design<f64, C>, C>) -> Self {
        Self {
            estimator,
            time_us: 0,
            heights_m: [1.973; C],
            to_gravity: false,
            suspension_end_rad: f64::INFINITY,
            speed_mps: 10.0,
            trailer_mass_kg: f64::NAN,
            closed: Vec::new(),
            last_turn_us: 0,
        }
    }

    /// The input of a channel that gives this roll angle at the channel's height.
    fn input(&self, channel: Channel, roll_rad: f64) -> f64 {
        let design = self.estimator.design();
        let Some(place) = design.place(channel) else { return f64::NAN };
        let of = &design.channels[place];
        roll_rad / of.lines[0][0].ratio_at(self.heights_m[place]) / of.compensation
    }

    /// One row, 10 ms after the previous one. The sensor shows `shown_rad` while the roll angle is
    /// `roll_rad`.
    pub(crate) fn row(&mut self, shown_rad: f64, roll_rad: f64) -> Status {
        self.time_us += 10_000;
        let mut sample = Sample::absent(self.time_us);
        *(if self.to_gravity { &mut sample.roll_to_gravity_rad } else { &mut sample.roll_rad }) =
            shown_rad;
        sample.suspension_roll_rad = roll_rad.min(self.suspension_end_rad);
        sample.tractor_suspension_roll_rad = roll_rad;
        sample.lateral_specific_force_mps2 = self.input(Channel::Suspension, roll_rad);
        sample.tractor_lateral_specific_force_mps2 = self.input(Channel::Tractor, roll_rad);
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
    pub(crate) fn finish(&mut self) -> Maneuver<f64, C> {
        self.closed.extend(self.estimator.finish());
        assert_eq!(self.closed.len(), 1);
        self.closed.remove(0)
    }

    /// One maneuver after a second of straight driving; returns the results of all channels.
    pub(crate) fn maneuver(&mut self, heights_m: [f64; C]) -> [Outcome<f64>; C] {
        self.heights_m = heights_m;
        self.hold(100, 0.0);
        self.turn();
        self.finish().outcomes
    }
}
