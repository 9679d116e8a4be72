//! How near to rolling over the turns of a load came, how much the truck braked in them, and what that does to its
//! height.

use cg_core::{CHANNELS, Channel, Design, Maneuver, Measured, Sample};
use serde::{Deserialize, Serialize};

use super::felt::{force_by_roll, path_by_steer_mps2};
use super::speed_change::{GAP_S, InTurns, SpeedChange};
use super::strength::{Strength, mean};

/// Time constant with which the lateral acceleration is smoothed, s.
const SMOOTH_S: f64 = 0.5;
/// Greatest lateral acceleration of turns, g. What seems to be more is another unit.
const STRONGEST_G: f64 = 0.5;

/// Relative standard deviation of a height for each m/s² of the standard deviation of the acceleration within a turn, also if its mean
/// is zero: the forces at the fifth wheel, and the springs that they load, then change with the lateral acceleration.
/// docs/limits.md has the errors.
const UNSTEADY_S2_PER_M: f64 = 0.05;
/// The same of springs with friction, as a share of what friction holds in a usual turn, from [`MOVES_MPS2`] on: braking and
/// accelerating, also before a turn, moves the springs along their loops, so that friction no longer holds the roll. Leaf springs, whose
/// friction holds 4 to 12 %, have heights that are 4 % too great then, and air springs with 2 % of it 1 % (docs/limits.md).
const OF_FRICTION: f64 = 0.6;
const MOVES_MPS2: f64 = 0.5;

/// Greatest share of the threshold that is told apart, so that a threshold of zero gives a number.
const MOST_SHARE: f64 = 100.0;
/// The most maneuvers of a load that count, the last ones.
const MOST_MANEUVERS: usize = 1000;

/// How strong the turns of a load are: those of a log, or those on the bus since the load changed.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct StrongTurns {
    /// That of the path, the specific force of the trailer or else of the tractor, and where neither is known, the lateral
    /// acceleration that follows from the steer angle.
    signals: [Smooth; 3],
    maneuvers: Vec<Peak>,
    /// What was known before a restart.
    kept: Strength,
    /// Sums over time of the square and the cube of that of the path, which is smoothed.
    path_squares: f64,
    path_cubes: f64,
    speed: SpeedChange,
}

/// A lateral acceleration or specific force, m/s², which may be missing in most samples.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Smooth {
    time_us: u64,
    /// Smoothed.
    now_mps2: f64,
    /// The greatest size since the last maneuver.
    greatest_mps2: f64,
}

impl Smooth {
    /// Takes a value, and returns the time since the one before, s; `None` if it is absent.
    fn push(&mut self, time_us: u64, value_mps2: f64) -> Option<f64> {
        if !value_mps2.is_finite() {
            return None;
        }
        #[allow(clippy::cast_precision_loss)] // 2^53 µs are 285 years
        let passed_s = time_us.saturating_sub(self.time_us) as f64 * 1e-6;
        self.time_us = time_us;
        let share = if passed_s > GAP_S { 1.0 } else { passed_s / (SMOOTH_S + passed_s) };
        self.now_mps2 += share * (value_mps2 - self.now_mps2);
        self.greatest_mps2 = self.greatest_mps2.max(self.now_mps2.abs());
        Some(passed_s)
    }
}

/// The greatest lateral accelerations of a maneuver.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Peak {
    path_mps2: f64,
    force_mps2: f64,
    braking_mps2: f64,
    /// Mean acceleration, also a negative one, if the lateral acceleration was yaw rate times speed.
    #[serde(default)]
    speeding_mps2: f64,
    /// Standard deviation of the acceleration, and the root mean square until then.
    #[serde(default)]
    unsteady_mps2: [f64; 2],
    speed_mps: f64,
    trailer_mass_kg: f64,
    /// The channels in which it gave a height.
    gave: [bool; CHANNELS],
}

impl StrongTurns {
    /// After a restart, those before which came to this.
    pub fn kept(strength: Strength) -> Self {
        Self { kept: strength, ..Self::default() }
    }

    /// Takes a sample.
    pub fn push(&mut self, sample: &Sample<f64>, design: &Design<f64>) {
        let or = |first: f64, second: f64| if first.is_nan() { second } else { first };
        let turn_mps2 = sample.yaw_rate_radps * sample.speed_mps;
        let path_mps2 = or(sample.lateral_acceleration_mps2, turn_mps2);
        let gravity_mps2 = design.gravity_mps2;
        let forces_mps2 = [
            (sample.lateral_specific_force_mps2, sample.tilt_rad),
            (sample.tractor_lateral_specific_force_mps2, sample.tractor_tilt_rad),
        ];
        let [trailer_mps2, tractor_mps2] =
            forces_mps2.map(|(force_mps2, tilt_rad)| or(force_mps2, gravity_mps2 * tilt_rad));
        let force_mps2 = or(trailer_mps2, tractor_mps2);
        let is_alone = path_mps2.is_nan() && force_mps2.is_nan();
        let steer_mps2 = if is_alone { path_by_steer_mps2(sample, design) } else { f64::NAN };
        let [path, force, steer] = &mut self.signals;
        let passed_s = path.push(sample.time_us, path_mps2);
        force.push(sample.time_us, force_mps2);
        steer.push(sample.time_us, steer_mps2);
        if sample.speed_mps.is_finite() {
            let best = self.signals.iter().find(|signal| signal.greatest_mps2 > 0.0);
            let lateral_mps2 = best.map_or(0.0, |signal| signal.now_mps2);
            self.speed.push((sample.time_us, sample.speed_mps), lateral_mps2);
        }
        if let Some(passed_s) = passed_s {
            self.speed.by_yaw_rate = sample.lateral_acceleration_mps2.is_nan();
            if passed_s <= GAP_S {
                let path_mps2 = self.signals[0].now_mps2.abs();
                self.path_squares += passed_s * path_mps2 * path_mps2;
                self.path_cubes += passed_s * path_mps2 * path_mps2 * path_mps2;
            }
        }
    }

    /// The lateral acceleration of one turn in place of all, g: that at which a secant is the one that least squares
    /// find, if it decreases in proportion to the lateral acceleration.
    pub(super) fn usual_g(&self, gravity_mps2: f64) -> Option<f64> {
        let usual_g = self.path_cubes / self.path_squares / gravity_mps2;
        (self.path_squares > 0.0).then(|| usual_g.min(STRONGEST_G))
    }

    /// Relative standard deviation of the ratio of a channel by the articulation in the turns. It has one sign.
    pub(super) fn articulated_sd(&self, design: &Design<f64>, channel: Channel) -> f64 {
        let used = self.maneuvers.iter().filter(|one| one.gave[channel.index()]);
        let curvature = |one: &Peak| {
            let load = [one.trailer_mass_kg, design.reference_height_m];
            let by_roll = || 1.0 + force_by_roll(design, one.speed_mps, load);
            let is_known = one.path_mps2 > 0.0;
            let path_mps2 = if is_known { one.path_mps2 } else { one.force_mps2 / by_roll() };
            path_mps2 / (one.speed_mps * one.speed_mps)
        };
        let by_yaw_rate = self.speed.by_yaw_rate;
        let sd = |one| design.articulated_sd(channel, curvature(one), by_yaw_rate);
        mean(&used.map(sd).collect::<Vec<_>>())
    }

    /// Takes the end of a maneuver; `true` if it is the first of another load.
    pub fn close(&mut self, maneuver: &Maneuver<f64>, is_of_another_load: bool) {
        if is_of_another_load {
            self.maneuvers.clear();
            self.kept = Strength::default();
        } else if self.maneuvers.len() == MOST_MANEUVERS {
            self.maneuvers.remove(0);
        }
        let greatest = |signal: &mut Smooth| std::mem::take(&mut signal.greatest_mps2);
        let [path_mps2, force_mps2, steer_mps2] = self.signals.each_mut().map(greatest);
        let is_by_steer = path_mps2 <= 0.0 && force_mps2 <= 0.0;
        let path_mps2 = if is_by_steer { steer_mps2 } else { path_mps2 };
        let InTurns { mean_mps2, sd_mps2, recent_mps2 } = self.speed.take();
        let braking_mps2 = (-mean_mps2).max(0.0);
        let speeding_mps2 = if self.speed.by_yaw_rate { mean_mps2 } else { 0.0 };
        let gave = maneuver.outcomes.map(|outcome| outcome.height_m.is_ok());
        let Maneuver { speed_mps, trailer_mass_kg, .. } = *maneuver;
        let motion = Peak { path_mps2, force_mps2, braking_mps2, speeding_mps2, ..Peak::default() };
        let unsteady_mps2 = [sd_mps2, recent_mps2];
        let motion = Peak { unsteady_mps2, speed_mps, ..motion };
        self.maneuvers.push(Peak { trailer_mass_kg, gave, ..motion });
    }

    /// How strong those maneuvers were that gave the height, m, in a channel.
    pub fn strength(&self, design: &Design<f64>, (channel, height_m): (Channel, f64)) -> Strength {
        let height = Measured { value: height_m, sd: 0.0 };
        let share = |one: &Peak| {
            let rollover = design.rollover(height, one.trailer_mass_kg, one.speed_mps)?;
            let threshold_mps2 = design.gravity_mps2 * rollover.static_rollover_threshold_g.value;
            let by_roll = force_by_roll(design, one.speed_mps, [one.trailer_mass_kg, height_m]);
            let felt_mps2 = one.path_mps2.max(one.force_mps2 / (1.0 + by_roll));
            Some((felt_mps2 / threshold_mps2).min(MOST_SHARE))
        };
        let used = || self.maneuvers.iter().filter(|one| one.gave[channel.index()]);
        let shares: Vec<_> = used().filter_map(share).collect();
        let braking: Vec<_> = used().map(|one| one.braking_mps2).collect();
        // The pairs of suspension roll and specific force do not use it.
        let uses_path = channel.feels_bank();
        let speeding: Vec<_> = used().filter(|_| uses_path).map(|one| one.speeding_mps2).collect();
        let unsteady = |one: &Peak| {
            let [within_mps2, recent_mps2] = one.unsteady_mps2;
            let of_forces = UNSTEADY_S2_PER_M * within_mps2;
            let held = design.friction(channel.index(), one.trailer_mass_kg);
            match held.map(|friction| friction.usual_share.abs()).filter(|held| *held > 0.0) {
                Some(held) => {
                    let of_friction = OF_FRICTION * held * (recent_mps2 / MOVES_MPS2).min(1.0);
                    [within_mps2.max(recent_mps2), of_forces.max(of_friction)]
                }
                None => [within_mps2, of_forces],
            }
        };
        let unsteady: Vec<_> = used().map(unsteady).collect();
        let (found, kept) = (Strength::of(&shares, &braking, &speeding, &unsteady), self.kept);
        Strength {
            greatest: found.greatest.max(kept.greatest),
            braking_mps2: found.braking_mps2.max(kept.braking_mps2),
            speeding_mps2: found.speeding_mps2.max(kept.speeding_mps2),
            unsteady_mps2: found.unsteady_mps2.max(kept.unsteady_mps2),
            unsteady_sd: found.unsteady_sd.max(kept.unsteady_sd),
            sd: found.sd.max(kept.sd),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::{MASS_KG, design, maneuver};

    /// Puts a lateral acceleration, m/s², into a sample.
    type Show<'a> = dyn Fn(&mut Sample<f64>, f64) + 'a;

    fn reached(rate_hz: u32, seconds: u32, lateral_mps2: impl Fn(f64) -> f64) -> StrongTurns {
        let mut turns = StrongTurns::default();
        for k in 0..rate_hz * seconds {
            let time_s = f64::from(k) / f64::from(rate_hz);
            let mut sample = Sample::absent(u64::from(k) * 1_000_000 / u64::from(rate_hz));
            sample.lateral_acceleration_mps2 = lateral_mps2(time_s);
            turns.push(&sample, &design());
        }
        turns
    }

    /// A step is as strong as it is, with straight driving before it or not; a sine is as strong as its describing
    /// function says, 8/(3π). The smoothing takes 2 % of this sine and a little of the step's beginning.
    #[test]
    fn one_turn_stands_for_all() {
        assert_eq!(reached(50, 6, |_| f64::NAN).usual_g(9.81), None);
        assert_eq!(reached(50, 6, |_| 0.0).usual_g(9.81), None);
        let step = reached(50, 40, |time_s| if time_s < 20.0 { 0.0 } else { -0.15 * 9.81 });
        let sine = reached(50, 60, |time_s| 0.2 * 9.81 * (0.4 * time_s).sin());
        let [step_g, sine_g] = [step, sine].map(|turns| turns.usual_g(9.81).unwrap());
        assert!((step_g / 0.15 - 1.0).abs() < 0.02, "{step_g}");
        let expected_g = 0.2 * 8.0 / (3.0 * std::f64::consts::PI);
        assert!((sine_g / expected_g - 1.0).abs() < 0.04, "{sine_g} {expected_g}");
        assert_eq!(reached(50, 6, |_| 17.0).usual_g(9.81), Some(STRONGEST_G));
    }

    /// A step of some seconds counts whole, one sample hardly, and each maneuver begins anew.
    #[test]
    fn a_turn_counts_and_a_spike_does_not() {
        let mut turns = reached(50, 6, |time_s| if time_s < 1.0 { 0.0 } else { -2.0 });
        turns.close(&maneuver(), false);
        let Peak { path_mps2, force_mps2, .. } = turns.maneuvers[0];
        assert!((path_mps2 - 2.0).abs() < 1e-3 && force_mps2 == 0.0, "{path_mps2}");
        let greatest = turns.signals.map(|signal| signal.greatest_mps2);
        assert_eq!((turns.maneuvers.len(), greatest), (1, [0.0; 3]));
        let spike = reached(50, 4, |time_s| if (time_s - 2.0).abs() < 0.01 { 5.0 } else { 1.0 });
        assert!((1.0..1.2).contains(&spike.signals[0].greatest_mps2), "{:?}", spike.signals);
    }

    /// Of a load only its own turns count, of those as many as memory has room for, and after a restart what was known.
    #[test]
    fn turns_belong_to_a_load() {
        let design = design();
        let threshold_g = design.rollover(Measured { value: 2.0, sd: 0.0 }, MASS_KG, 15.0);
        let threshold_g = threshold_g.unwrap().static_rollover_threshold_g.value;
        let of = |turns: &StrongTurns| turns.strength(&design, (Channel::LateralAcceleration, 2.0));
        let mut turns = StrongTurns::default();
        let turn = |turns: &mut StrongTurns, share: f64, is_of_another_load: bool| {
            turns.signals[0].greatest_mps2 = share * threshold_g * design.gravity_mps2;
            let mut maneuver = maneuver();
            maneuver.outcomes[Channel::LateralAcceleration.index()].height_m =
                Ok(Measured { value: 2.0, sd: 0.01 });
            turns.close(&maneuver, is_of_another_load);
        };
        turn(&mut turns, 0.7, false);
        turn(&mut turns, 0.3, false);
        let strength = of(&turns);
        assert!((strength.sd - 0.03).abs() < 1e-9 && (strength.greatest - 0.7).abs() < 1e-9);
        let mut unstable = design;
        unstable.thresholds.iter_mut().for_each(|line| line.threshold_g = [[0.0; 8]; 2]);
        let found = turns.strength(&unstable, (Channel::LateralAcceleration, 2.0));
        assert!(found.is_sound() && found.greatest > 1.0, "{found:?}");
        let mut restarted = StrongTurns::kept(strength);
        turn(&mut restarted, 0.3, false);
        assert_eq!(of(&restarted), strength);
        for turns in [&mut turns, &mut restarted] {
            turn(turns, 0.2, true);
            assert!(of(turns).sd == 0.0 && (of(turns).greatest - 0.2).abs() < 1e-9);
        }
        for _ in 0..MOST_MANEUVERS {
            turn(&mut turns, 0.1, false);
        }
        assert!(
            turns.maneuvers.len() == MOST_MANEUVERS && (of(&turns).greatest - 0.1).abs() < 1e-9
        );
    }

    /// Braking into a turn and accelerating out of it has a mean of zero. Springs with friction also keep what was before the turn.
    #[test]
    fn a_speed_that_changes_in_turns_widens_the_interval() {
        let strength = |design: &Design<f64>, acceleration_mps2: fn(f64) -> f64| {
            let mut turns = StrongTurns::default();
            let mut speed_mps = 15.0;
            for k in 0..1500_u32 {
                let time_s = f64::from(k) / 50.0;
                speed_mps += 0.02 * acceleration_mps2(time_s);
                let mut sample = Sample::absent(u64::from(k) * 20_000);
                sample.speed_mps = speed_mps;
                sample.lateral_acceleration_mps2 = if time_s < 15.0 { 0.0 } else { 1.0 };
                turns.push(&sample, design);
            }
            let mut maneuver = maneuver();
            maneuver.outcomes[Channel::LateralAcceleration.index()].height_m =
                Ok(Measured { value: 2.0, sd: 0.01 });
            turns.close(&maneuver, false);
            turns.strength(design, (Channel::LateralAcceleration, 2.0))
        };
        let within = |time_s: f64| match time_s {
            15.0..20.0 => -0.6,
            25.0.. => 0.6,
            _ => 0.0,
        };
        let before = |time_s: f64| if (9.0..15.0).contains(&time_s) { -0.6 } else { 0.0 };
        let free = design();
        let mut sticks = free;
        let springs = sticks.channels.iter_mut().flat_map(|channel| &mut channel.friction);
        springs.for_each(|friction| friction.usual_share = 0.08);
        let free_within = strength(&free, within);
        // As in the tests of `speed_change`.
        assert!((0.3..0.49).contains(&free_within.unsteady_mps2), "{free_within:?}");
        assert!((free_within.sd - 0.05 * free_within.unsteady_mps2).abs() < 1e-3);
        assert!(free_within.messages()[0].contains("braked and accelerated"), "{free_within:?}");
        assert!(strength(&free, |_| 0.0).is_none());
        let [free_before, sticks_before] = [&free, &sticks].map(|one| strength(one, before));
        assert!(free_before.unsteady_mps2 < 0.2 && free_before.messages().is_empty());
        // 0.6 of the 8 % that friction holds, by 0.28 of 0.5 m/s².
        assert!((0.25..0.35).contains(&sticks_before.unsteady_mps2), "{sticks_before:?}");
        let expected = 0.6 * 0.08 * sticks_before.unsteady_mps2 / 0.5;
        assert!((sticks_before.sd - expected).abs() < 1e-9, "{sticks_before:?}");
        assert!(sticks_before.messages()[0].contains("or before them"), "{sticks_before:?}");
        assert!(strength(&sticks, within).sd >= free_within.sd);
    }

    /// Going faster matters to the channel of the lateral acceleration, if that is yaw rate times speed: 10 % for each m/s².
    #[test]
    fn going_faster_in_turns_widens_the_interval() {
        let strength = |is_measured: bool, channel: Channel| {
            let mut turns = StrongTurns::default();
            for k in 0..1500_u32 {
                let time_s = f64::from(k) / 50.0;
                let mut sample = Sample::absent(u64::from(k) * 20_000);
                sample.speed_mps = 10.0 + 0.3 * (time_s - 15.0).max(0.0);
                let turn_mps2 = if time_s < 15.0 { 0.0 } else { 0.5 };
                sample.yaw_rate_radps = turn_mps2 / sample.speed_mps;
                if is_measured {
                    sample.lateral_acceleration_mps2 = turn_mps2;
                }
                turns.push(&sample, &design());
            }
            let mut maneuver = maneuver();
            for outcome in &mut maneuver.outcomes {
                outcome.height_m = Ok(Measured { value: 2.0, sd: 0.01 });
            }
            turns.close(&maneuver, false);
            turns.strength(&design(), (channel, 2.0))
        };
        let found = strength(false, Channel::LateralAcceleration);
        assert!((found.speeding_mps2 - 0.3).abs() < 0.01, "{found:?}");
        assert!((found.sd - 0.03).abs() < 0.001 && found.messages()[0].contains("went faster"));
        assert!(!found.is_none());
        // Going slower in other turns makes up for it.
        assert!((Strength::of(&[], &[], &[0.3, -0.1], &[]).sd - 0.01).abs() < 1e-12);
        assert!(Strength::of(&[], &[], &[0.1, -0.3], &[]).sd <= 0.0);
        for other in
            [strength(true, Channel::LateralAcceleration), strength(false, Channel::Suspension)]
        {
            assert!(other.speeding_mps2 <= 0.0 && other.messages().is_empty(), "{other:?}");
            assert!(other.sd < 0.005, "what the filters take for a change: {other:?}");
        }
    }

    /// Of the truck of round numbers: the roll angle is 0.04 rad for each m/s², so a force is 1 + 0.04·9.81 times the lateral
    /// acceleration, and that is ten times the steer angle. It brakes by 0.5 m/s² in a turn of 2.4 m/s².
    #[test]
    fn whatever_shows_a_turn_shows_how_strong_it_is() {
        let design = design();
        let by_roll = 1.0 + 0.04 * design.gravity_mps2;
        let strength = |every: u32, show: &Show| {
            let mut turns = StrongTurns::default();
            for k in 0..1000_u32 {
                let since_s = f64::from(k) / 50.0 - 8.0;
                let path_mps2 = if since_s > 0.0 { 2.4 * (1.0 - (-since_s).exp()) } else { 0.0 };
                let mut sample = Sample::absent(u64::from(k) * 20_000);
                sample.speed_mps = 18.0 - 0.5 * since_s.max(0.0);
                if k % every == 0 {
                    show(&mut sample, path_mps2);
                }
                turns.push(&sample, &design);
            }
            let mut maneuver = maneuver();
            for outcome in &mut maneuver.outcomes {
                outcome.height_m = Ok(Measured { value: 2.0, sd: 0.01 });
            }
            turns.close(&maneuver, false);
            turns.strength(&design, (Channel::Steer, 2.0))
        };
        let usual = strength(1, &|sample, mps2| sample.lateral_acceleration_mps2 = mps2);
        assert!(usual.greatest > 0.6 && (usual.braking_mps2 - 0.5).abs() < 0.01, "{usual:?}");
        let shows: [(u32, &Show); 7] = [
            (25, &|sample, mps2| sample.lateral_acceleration_mps2 = mps2),
            (1, &|sample, mps2| sample.yaw_rate_radps = mps2 / sample.speed_mps),
            (1, &|sample, mps2| sample.lateral_specific_force_mps2 = by_roll * mps2),
            (1, &|sample, mps2| sample.tilt_rad = by_roll * mps2 / 9.81),
            (1, &|sample, mps2| sample.tractor_lateral_specific_force_mps2 = by_roll * mps2),
            (1, &|sample, mps2| sample.tractor_tilt_rad = by_roll * mps2 / 9.81),
            (1, &|sample, mps2| sample.steer_rad = 0.1 * mps2),
        ];
        for (k, (every, show)) in shows.into_iter().enumerate() {
            let found = strength(every, show);
            assert!((found.greatest / usual.greatest - 1.0).abs() < 0.01, "{k} {found:?}");
            assert!((found.braking_mps2 - usual.braking_mps2).abs() < 0.02, "{k} {found:?}");
        }
        // A steer angle is not asked where anything else is known, if only now and then.
        let both = strength(1, &|sample, mps2| {
            sample.steer_rad = 0.2 * mps2;
            if sample.time_us.is_multiple_of(100_000) {
                sample.lateral_acceleration_mps2 = mps2;
            }
        });
        assert!((both.greatest / usual.greatest - 1.0).abs() < 0.01, "{both:?}");
    }
}
