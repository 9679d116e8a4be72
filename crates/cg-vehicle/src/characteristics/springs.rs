//! Measured springs: two force curves that enclose the friction.

use std::f64::consts::PI;

use crate::tables::Spring;

/// Nodes of the integral over half a cycle (midpoint rule): the stiffness is exact to 1e-4.
const CYCLE_NODES: u32 = 48;

/// Places at which a curve is averaged. Where the range passes a node of a table, the mean moves by a share of this.
const LOOP_NODES: u32 = 24;

/// The loop that a measured spring describes.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    /// Slope of the middle between the curves, N/m.
    pub slope: f64,
    /// Half the force between both directions, N.
    pub lost_n: f64,
    /// Deflection within which the force changes from one direction's to the other's.
    pub deflection_m: f64,
}

/// The mean of a function between −1 and 1.
fn mean(of: impl Fn(f64) -> f64) -> f64 {
    let side = |place| f64::from(2 * place + 1) / f64::from(LOOP_NODES) - 1.0;
    (0..LOOP_NODES).map(|place| of(side(place))).sum::<f64>() / f64::from(LOOP_NODES)
}

/// The greatest change of the [deflection](Envelope::deflection_within_m) over a distance.
const PER_DISTANCE: f64 = 0.25;

/// Half the distance between the curves at a place in a segment.
fn friction_n(dx: f64, s: &[f64; 4]) -> f64 {
    0.5 * (s[0] - s[2] + (s[1] - s[3]) * dx)
}

/// The greatest deflection at a place in a segment with which the friction takes energy out.
fn limit_m(dx: f64, s: &[f64; 4]) -> f64 {
    friction_n(dx, s).max(0.0) / s[1].max(s[3])
}

/// Two curves with common nodes; the end segments are extended.
#[derive(Clone, Debug)]
pub struct Envelope {
    deflection_m: Vec<f64>,
    /// For each segment: force at its start and slope, for compression and then for extension.
    segment: Vec<[f64; 4]>,
    /// At each node, the greatest [deflection](Self::deflection_within_m).
    greatest_m: Vec<f64>,
}

impl Envelope {
    /// The curves of a measured spring.
    pub fn new(spring: &Spring) -> Self {
        let x = &spring.deflection_m;
        let segment: Vec<[f64; 4]> = (0..x.len().saturating_sub(1))
            .map(|i| {
                let slope = |y: &[f64]| (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
                let (up, down) = (&spring.compression_n, &spring.extension_n);
                [up[i], slope(up), down[i], slope(down)]
            })
            .collect();
        // The limit of a segment is linear, so the least of it is at an end.
        let of_ends = segment.iter().zip(x.windows(2)).flat_map(|(s, ends)| {
            [(ends[0], limit_m(0.0, s)), (ends[1], limit_m(ends[1] - ends[0], s))]
        });
        let of_ends: Vec<(f64, f64)> = of_ends.collect();
        let least = |at: &f64| {
            let from_end =
                |(end, greatest_m): &(f64, f64)| greatest_m + PER_DISTANCE * (at - end).abs();
            of_ends.iter().map(from_end).fold(f64::INFINITY, f64::min)
        };
        Self { deflection_m: x.clone(), segment, greatest_m: x.iter().map(least).collect() }
    }

    #[inline]
    fn index(&self, x: f64) -> usize {
        let mut i = 0;
        while i + 1 < self.segment.len() && x >= self.deflection_m[i + 1] {
            i += 1;
        }
        i
    }

    #[inline]
    fn segment(&self, x: f64) -> (f64, &[f64; 4]) {
        let i = self.index(x);
        (x - self.deflection_m[i], &self.segment[i])
    }

    /// The law of the force, `dF/dt = |ẋ| (F_env − F)/β`, with the curve towards which the spring moves. `β`, the deflection
    /// within which it gets there, is `deflection_m`, or if that would feed energy in at this place, the greatest that does not.
    #[inline]
    pub fn force_rate(&self, x: f64, rate: f64, force_n: f64, deflection_m: f64) -> f64 {
        let i = self.index(x);
        let (dx, s) = (x - self.deflection_m[i], &self.segment[i]);
        let towards_n = if rate > 0.0 { s[0] + s[1] * dx } else { s[2] + s[3] * dx };
        rate.abs() * (towards_n - force_n) / self.within_m(i, x, deflection_m)
    }

    /// Force midway between the curves, and its slope.
    pub fn middle(&self, x: f64) -> (f64, f64) {
        let (dx, s) = self.segment(x);
        (0.5 * (s[0] + s[2] + (s[1] + s[3]) * dx), 0.5 * (s[1] + s[3]))
    }

    /// The greater of the slopes of both curves.
    pub fn steepest(&self, x: f64) -> f64 {
        let (_, s) = self.segment(x);
        s[1].max(s[3])
    }

    /// Half the distance between the curves.
    pub fn friction_n(&self, x: f64) -> f64 {
        let (dx, s) = self.segment(x);
        friction_n(dx, s)
    }

    /// Stiffness of the linear spring that takes the place of this one in motion of an amplitude
    /// about its static load: the describing function, `∮ F sin θ dθ/(π A)` over a full cycle.
    ///
    /// With straight curves of slope `k` at a distance of `±C` from their middle, a cycle of the law
    /// of [`Spring`] is
    ///
    /// ```text
    ///     F = k x + (C − k β) (1 − 2 e^(−(x + A)/β)/(1 + e^(−2A/β)))      while x rises from −A to A
    /// ```
    ///
    /// and the slope of the middle between the curves is its secant over the amplitude. With `β = C/k`,
    /// the greatest that is used, the force follows the middle without loss.
    ///
    /// `deflection_m` is `β`.
    pub fn stiffness_n_per_m(&self, load_n: f64, amplitude_m: f64, deflection_m: f64) -> f64 {
        let Loop { slope, lost_n, deflection_m } =
            self.hysteresis(load_n, amplitude_m, deflection_m);
        if !(lost_n > 0.0 && deflection_m > 0.0) {
            return slope;
        }
        let reach = amplitude_m / deflection_m;
        let begin = 2.0 / (1.0 + libm::exp(-2.0 * reach));
        // x = −A cos θ rises for θ in (0, π); the falling half contributes the same.
        let sum: f64 = (0..CYCLE_NODES)
            .map(|i| {
                let x = -libm::cos((f64::from(i) + 0.5) / f64::from(CYCLE_NODES) * PI);
                x * (1.0 - begin * libm::exp(-reach * (x + 1.0)))
            })
            .sum();
        slope + 2.0 * lost_n / amplitude_m * sum / f64::from(CYCLE_NODES)
    }

    /// The slope midway between the curves over an amplitude about its static load, if the body neither rises nor
    /// sinks.
    pub fn slope_at_rest(&self, load_n: f64, amplitude_m: f64) -> f64 {
        self.slope(self.deflection_at(load_n), amplitude_m)
    }

    fn slope(&self, start_m: f64, amplitude_m: f64) -> f64 {
        let ends = [1.0, -1.0].map(|side| self.middle(start_m + side * amplitude_m).0);
        (ends[0] - ends[1]) / (2.0 * amplitude_m)
    }

    /// The loop that the spring describes in rolling of an amplitude about its static load; the friction
    /// in it is the mean of `C − k β`, without places where that is negative. `deflection_m` is `β`.
    pub fn hysteresis(&self, load_n: f64, amplitude_m: f64, deflection_m: f64) -> Loop {
        let rest_m = self.deflection_at(load_n);
        let start_m = self.midway_m(rest_m, load_n, amplitude_m);
        let slope = self.slope(start_m, amplitude_m);
        let at_m = |side: f64| start_m + side * amplitude_m;
        let within_m = |side: f64| self.deflection_within_m(at_m(side), deflection_m);
        // With the slope of each place, which jumps at the nodes of a table, the sum would jump with the load.
        let lost_n = mean(|side| (self.friction_n(at_m(side)) - slope * within_m(side)).max(0.0));
        let deflection_m = mean(within_m);
        Loop { slope, lost_n, deflection_m }
    }

    /// The deflection about which both springs of an axle move by an amplitude, one up and one down, and still carry
    /// their load together: where a curve is steeper on one side, the body rises or sinks in a turn.
    fn midway_m(&self, rest_m: f64, load_n: f64, amplitude_m: f64) -> f64 {
        // The curves are straight between nodes, so Newton's method ends after a few of these steps, within rounding of the
        // amplitude. Where it would leave the range, which a change of the slope can make it do, the range is halved.
        const STEPS: u32 = 60;
        let [mut low_m, mut high_m] = [rest_m - amplitude_m, rest_m + amplitude_m];
        let mut middle_m = rest_m;
        for _ in 0..STEPS {
            let [up, down] = [1.0, -1.0].map(|side| self.middle(middle_m + side * amplitude_m));
            let missing_n = load_n - f64::midpoint(up.0, down.0);
            if missing_n > 0.0 {
                low_m = middle_m;
            } else {
                high_m = middle_m;
            }
            let newton_m = middle_m + missing_n / f64::midpoint(up.1, down.1);
            let is_within = newton_m > low_m && newton_m < high_m;
            let next_m = if is_within { newton_m } else { f64::midpoint(low_m, high_m) };
            let step_m = (next_m - middle_m).abs();
            middle_m = next_m;
            if step_m <= f64::EPSILON * amplitude_m {
                break;
            }
        }
        middle_m
    }

    /// The deflection within which the force changes from one curve to the other at a place: `deflection_m`, or if that
    /// would feed energy in, the greatest that does not.
    ///
    /// At a place of the curves this is half the distance between them over the greater slope: with a greater one the force
    /// would stay behind a rising curve by more than the friction. What another place allows counts as well, plus a quarter of
    /// the distance to it. So it does not jump where the slope of a table does: it is the greatest function that nowhere exceeds
    /// what the place itself allows and nowhere changes faster than a quarter of a meter per meter.
    fn deflection_within_m(&self, x: f64, deflection_m: f64) -> f64 {
        self.within_m(self.index(x), x, deflection_m)
    }

    /// The same in a segment.
    #[inline]
    fn within_m(&self, i: usize, x: f64, deflection_m: f64) -> f64 {
        /// Where the curves touch; the force then stays behind them by some hundred newtons.
        const LEAST_M: f64 = 2e-4;
        let at_end =
            |end: usize| self.greatest_m[end] + PER_DISTANCE * (x - self.deflection_m[end]).abs();
        let own_m = limit_m(x - self.deflection_m[i], &self.segment[i]);
        let greatest_m = own_m.min(at_end(i)).min(at_end(i + 1)).max(LEAST_M);
        deflection_m.min(greatest_m)
    }

    /// Deflection at which the force midway between the curves is `force_n`. The curves must be
    /// increasing.
    pub fn deflection_at(&self, force_n: f64) -> f64 {
        let last = self.segment.len() - 1;
        let segment = |i: usize| self.middle(self.deflection_m[i]);
        let i = (0..last).find(|&i| segment(i + 1).0 >= force_n).unwrap_or(last);
        let (start, slope) = segment(i);
        self.deflection_m[i] + (force_n - start) / slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slope of both curves, N/m, and half their distance, N.
    const SLOPE: f64 = 1e6;
    const FRICTION_N: f64 = 2000.0;

    fn straight() -> Envelope {
        let x = [-0.1, 0.1];
        let side = |shift_n: f64| x.map(|x| 50_000.0 + SLOPE * x + shift_n).to_vec();
        Envelope::new(&Spring {
            name: "leaf".to_owned(),
            deflection_m: x.to_vec(),
            compression_n: side(FRICTION_N),
            extension_n: side(-FRICTION_N),
            friction_deflection_m: 0.001,
        })
    }

    /// `∮ F sin θ dθ/(π A)` of the law `dF/dx = (F_env − F)/β`, integrated by Heun's method over ten
    /// cycles, of which the last one counts: a cycle reduces what is left of the start by `e^(−4A/β)`.
    fn integrated(envelope: &Envelope, amplitude_m: f64, deflection_m: f64) -> f64 {
        const STEPS: u32 = 50_000;
        const CYCLES: u32 = 10;
        let angle = |k: u32| f64::from(k) / f64::from(STEPS) * 2.0 * PI;
        let (mut force_n, mut sum) = (50_000.0, 0.0);
        for k in 0..CYCLES * STEPS {
            let [x, next] = [k, k + 1].map(|k| amplitude_m * angle(k).sin());
            let rate =
                |x: f64, force_n: f64, dx: f64| envelope.force_rate(x, dx, force_n, deflection_m);
            let first = rate(x, force_n, next - x);
            let change = 0.5 * (first + rate(next, force_n + first, next - x));
            if k >= (CYCLES - 1) * STEPS {
                let middle = f64::midpoint(angle(k), angle(k + 1)).sin();
                sum += (force_n + 0.5 * change) * middle * 2.0 * PI / f64::from(STEPS);
            }
            force_n += change;
        }
        sum / (PI * amplitude_m)
    }

    /// The closed cycle is the one to which the law settles. The integral over 48 nodes is exact to
    /// 1e-4, the integration to 1e-5.
    #[test]
    fn the_stiffness_is_that_of_a_cycle() {
        let envelope = straight();
        for deflection_m in [1e-4, 5e-4, 1.5e-3] {
            for reach in [0.3, 1.0, 3.0, 10.0, 20.0] {
                let amplitude_m = reach * deflection_m;
                let found = envelope.stiffness_n_per_m(50_000.0, amplitude_m, deflection_m);
                let expected = integrated(&envelope, amplitude_m, deflection_m);
                assert!((found / expected - 1.0).abs() < 2e-4, "{reach}: {found} {expected}");
            }
        }
    }

    /// Small motion meets the stiffness `C/β` with which the force leaves a curve, great motion the
    /// slope alone; with `β ≥ C/k` nothing is lost.
    #[test]
    fn friction_stiffens_small_motion() {
        let envelope = straight();
        let stiffness = |amplitude_m, deflection_m| {
            envelope.stiffness_n_per_m(50_000.0, amplitude_m, deflection_m)
        };
        let (small, great) = (stiffness(1e-7, 1e-4), stiffness(0.09, 1e-4));
        assert!((small / (FRICTION_N / 1e-4) - 1.0).abs() < 1e-3, "{small}");
        // The bends at both ends are what is in phase: 4 (C − kβ)/(πA) √(πβ/(2A)) for A ≫ β.
        let bends = 4.0 * 1900.0 / (PI * 0.09) * (PI * 1e-4 / 0.18).sqrt();
        assert!((great / (SLOPE + bends) - 1.0).abs() < 1e-4, "{great}");
        assert!((stiffness(0.002, 0.005) / SLOPE - 1.0).abs() < 1e-12);
    }

    proptest::proptest! {
        /// Whatever the slopes of a spring's segments are, both springs of an axle carry its load together. The place is right to
        /// the rounding of its own size (0.5 m at most) and to the step with which the search ends, and the force to what the
        /// steepest slope makes of it.
        #[test]
        fn the_body_rises_until_both_springs_carry_the_load(
            slopes in proptest::collection::vec(1e3..1e7_f64, 5),
            load_n in 0.0..1e5_f64,
            amplitude_m in 1e-4..0.1_f64,
        ) {
            let mut force_n = vec![0.0];
            for slope in &slopes {
                force_n.push(force_n[force_n.len() - 1] + 0.02 * slope);
            }
            let envelope = Envelope::new(&Spring {
                name: "any".to_owned(),
                deflection_m: (0_u8..6).map(|node| 0.02 * f64::from(node)).collect(),
                compression_n: force_n.clone(),
                extension_n: force_n,
                friction_deflection_m: 0.001,
            });
            let rest_m = envelope.deflection_at(load_n);
            let found_m = envelope.midway_m(rest_m, load_n, amplitude_m);
            let [up_n, down_n] = [1.0, -1.0].map(|side| envelope.middle(found_m + side * amplitude_m).0);
            let size_m = rest_m.abs() + 2.0 * amplitude_m + 0.1;
            let rounding_n = 8.0 * f64::EPSILON * 1e7 * size_m;
            proptest::prop_assert!((f64::midpoint(up_n, down_n) - load_n).abs() < rounding_n);
            proptest::prop_assert!((found_m - rest_m).abs() <= amplitude_m);
        }
    }

    /// The loop changes with the load as its curves do, and does not jump where their slope does, because the derivatives of a
    /// calibration are differences. The friction grows by less than the force, so that steps of 10 N change it by less than
    /// that; with the slope of each place in place of the secant it jumps by 35 N here.
    #[test]
    fn the_loop_does_not_jump_with_the_load() {
        let envelope = Envelope::new(&Spring {
            name: "trailer leaf".to_owned(),
            deflection_m: vec![0.0, 0.00635, 0.0127, 0.01905, 0.1143],
            compression_n: vec![0.0, 7120.0, 17790.0, 30030.0, 213_510.0],
            extension_n: vec![-445.0, 3114.0, 8896.0, 17793.0, 138_276.0],
            friction_deflection_m: 0.005,
        });
        let lost_n = |step: u32| envelope.hysteresis(10.0 * f64::from(step), 0.008, 0.005).lost_n;
        let change_n = (500..6000).map(|step| (lost_n(step + 1) - lost_n(step)).abs());
        let most_n = change_n.fold(0.0, f64::max);
        println!("{most_n} N");
        assert!((1.0..10.0).contains(&most_n), "{most_n}");
    }

    /// Twice as steep above its load, a pair of springs carries the load together at the slope of both in series,
    /// and the body rises: `3 z = A` and `2 k₁ k₂/(k₁ + k₂)`. Without rising the slope is the mean of both.
    #[test]
    fn both_springs_of_an_axle_carry_its_load() {
        let force_n = vec![-SLOPE * 0.1, 0.0, 2.0 * SLOPE * 0.1];
        let envelope = Envelope::new(&Spring {
            name: "stop".to_owned(),
            deflection_m: vec![-0.1, 0.0, 0.1],
            compression_n: force_n.clone(),
            extension_n: force_n,
            friction_deflection_m: 0.001,
        });
        let amplitude_m = 0.03;
        let rise_m = envelope.midway_m(0.0, 0.0, amplitude_m);
        assert!((rise_m + amplitude_m / 3.0).abs() < 1e-12, "{rise_m}");
        let slope = envelope.hysteresis(0.0, amplitude_m, 0.001).slope;
        assert!((slope / (4.0 / 3.0 * SLOPE) - 1.0).abs() < 1e-12, "{slope}");
        assert!((envelope.slope_at_rest(0.0, amplitude_m) / (1.5 * SLOPE) - 1.0).abs() < 1e-12);
    }
}
