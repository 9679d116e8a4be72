//! Supports of the bodies in the roll plane: springs that axles may share, and tires that leave the
//! road one after the other.

use crate::balance::Give;
use crate::characteristics::Envelope;
use crate::vehicle::{PlacedAxle, Vehicle};

/// The nodes of a spring's curve are at `SPAN (k/INTERVALS)²`, close together where friction builds up: 0.14 mm
/// at one millimeter. Beyond the last one the curve is extrapolated linearly.
const SPAN_M: f64 = 0.2;
const INTERVALS: usize = 200;
/// A step of Newton's method (m) below this is due to rounding and ends the iteration.
const ROUNDING: f64 = 1e-12;

/// Moments of a body about the points that support it: per `α` and per roll angle.
pub(super) struct Held {
    pub(super) side_nm: f64,
    pub(super) weight_nm: f64,
}

impl Held {
    /// The slopes of the moment over `α` and over the roll angle, and the moment.
    pub(super) fn moment(&self, alpha: f64, roll_rad: f64) -> [f64; 3] {
        let (sin, cos) = libm::sincos(roll_rad);
        let side_nm = self.side_nm * alpha;
        [
            self.side_nm * cos,
            self.weight_nm * cos - side_nm * sin,
            side_nm * cos + self.weight_nm * sin,
        ]
    }
}

/// The pair of springs of an axle, or of the axles of a load group, which are compressed equally:
/// outer minus inner force as a function of half the difference of their compressions, at a
/// constant sum of both forces.
pub(super) enum Springs {
    Linear(f64),
    /// An odd function, linear between its nodes, and how far the body rises meanwhile, an even one.
    Measured {
        difference_n: Vec<f64>,
        rise_m: Vec<f64>,
    },
}

impl Springs {
    /// The springs of axles that carry `sprung_n` each. Friction builds up as the springs deflect.
    pub(super) fn of(vehicle: &Vehicle, axles: &[&PlacedAxle<'_>], sprung_n: f64) -> Self {
        #[allow(clippy::cast_precision_loss)] // a few axles
        let count = axles.len() as f64;
        let first = axles.first().and_then(|placed| vehicle.spring_of(placed.axle));
        let Some(spring) = first else {
            let sum: f64 = axles.iter().map(|placed| placed.axle.spring_stiffness_n_per_m).sum();
            return Self::Linear(2.0 * sum / count);
        };
        let envelope = Envelope::new(spring);
        let at_rest_m = envelope.deflection_at(0.5 * sprung_n);
        let mut middle_m = at_rest_m;
        let pressed = |apart_m: f64| {
            let friction = 1.0 - libm::exp(-apart_m / spring.friction_deflection_m);
            let forces = |middle_m: f64| {
                [friction, -friction].map(|share| {
                    let x = middle_m + apart_m.copysign(share);
                    let (force_n, slope) = envelope.middle(x);
                    (force_n + share * envelope.friction_n(x).max(0.0), slope)
                })
            };
            for _ in 0..20 {
                let [outer, inner] = forces(middle_m);
                let step_m = (sprung_n - outer.0 - inner.0) / (outer.1 + inner.1);
                middle_m += step_m;
                if step_m.abs() < ROUNDING {
                    break;
                }
            }
            let [outer, inner] = forces(middle_m);
            (outer.0 - inner.0, at_rest_m - middle_m)
        };
        let (difference_n, rise_m) = (0..=INTERVALS).map(node_m).map(pressed).unzip();
        Self::Measured { difference_n, rise_m }
    }

    /// Force (N) and slope (N/m).
    pub(super) fn at(&self, apart_m: f64) -> (f64, f64) {
        match self {
            Self::Linear(stiffness) => (stiffness * apart_m, *stiffness),
            Self::Measured { difference_n, .. } => {
                let (value, slope) = between(difference_n, apart_m.abs());
                (value.copysign(apart_m), slope)
            }
        }
    }

    /// How far the body rises, m: springs that get stiffer as they are pressed extend more on the inner side than they are
    /// pressed on the outer one.
    pub(super) fn rise_m(&self, apart_m: f64) -> f64 {
        match self {
            Self::Linear(_) => 0.0,
            Self::Measured { rise_m, .. } => between(rise_m, apart_m.abs()).0,
        }
    }
}

/// Value and slope of a function that is linear between its nodes.
fn between(nodes: &[f64], apart_m: f64) -> (f64, f64) {
    #[allow(clippy::cast_precision_loss)]
    let place = INTERVALS as f64 * (apart_m / SPAN_M).sqrt();
    // The index is in range, because the deflection is some tenths of a meter.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let k = (place as usize).min(INTERVALS - 1);
    let slope = (nodes[k + 1] - nodes[k]) / (node_m(k + 1) - node_m(k));
    (nodes[k] + slope * (apart_m - node_m(k)), slope)
}

fn node_m(k: usize) -> f64 {
    #[allow(clippy::cast_precision_loss)]
    let share = k as f64 / INTERVALS as f64;
    SPAN_M * share * share
}

/// The tires of an axle.
pub(super) struct Tyres {
    /// Distances from the middle to the outer side, the outermost tire first.
    levers_m: Vec<f64>,
    stiffness_n_per_m: f64,
    overturning_nm_per_rad: f64,
}

impl Tyres {
    pub(super) fn of(placed: &PlacedAxle<'_>) -> Self {
        let positions_m = &placed.axle.tyre_positions_m;
        let mut levers_m: Vec<f64> = positions_m.iter().flat_map(|&y| [y, -y]).collect();
        levers_m.sort_by(|a, b| b.total_cmp(a));
        Self {
            levers_m,
            stiffness_n_per_m: placed.tyre.vertical_stiffness_n_per_m,
            overturning_nm_per_rad: placed.tyres() * placed.tyre.overturning_stiffness_nm_per_rad,
        }
    }

    /// The tires on the road at a roll angle of the axle. They leave it from the inner side on.
    fn on_road(&self, load_n: f64, angle_rad: f64) -> OnRoad<'_> {
        let mut levers_m = &self.levers_m[..];
        loop {
            #[allow(clippy::cast_precision_loss)] // a few tires
            let count = levers_m.len() as f64;
            let sum_m: f64 = levers_m.iter().sum();
            let pressed_m = (load_n / self.stiffness_n_per_m - angle_rad * sum_m) / count;
            match levers_m {
                [others @ .., inner_m]
                    if !others.is_empty() && !(pressed_m + angle_rad * inner_m >= 0.0) =>
                {
                    levers_m = others;
                }
                _ => return OnRoad { levers_m, count, sum_m, pressed_m },
            }
        }
    }

    /// The roll angle at which the next tire leaves the road; `None` if it is the last one.
    pub(super) fn next_lift_rad(&self, load_n: f64, angle_rad: f64) -> Option<f64> {
        let on = self.on_road(load_n, angle_rad);
        let spread_m = on.sum_m - on.count * on.levers_m.last()?;
        (spread_m > 0.0).then(|| load_n / self.stiffness_n_per_m / spread_m)
    }

    /// Whether the inner side has left the road.
    pub(super) fn inner_lifted(&self, load_n: f64, angle_rad: f64) -> bool {
        self.on_road(load_n, angle_rad).levers_m.len() <= self.levers_m.len() / 2
    }

    /// Whether no tire has left the road.
    pub(super) fn all_on_road(&self, load_n: f64, angle_rad: f64) -> bool {
        self.on_road(load_n, angle_rad).levers_m.len() == self.levers_m.len()
    }

    /// Load of each tire on the road.
    pub(super) fn loads_n(&self, load_n: f64, angle_rad: f64) -> impl Iterator<Item = f64> {
        let OnRoad { levers_m, pressed_m, .. } = self.on_road(load_n, angle_rad);
        let each_n = move |lever| self.stiffness_n_per_m * (pressed_m + angle_rad * lever);
        levers_m.iter().map(each_n)
    }

    /// Deflection of the tires at a roll angle of the axle.
    pub(super) fn give(&self, load_n: f64, angle_rad: f64) -> Give {
        let OnRoad { count, sum_m, .. } = self.on_road(load_n, angle_rad);
        Give {
            compliance_m_per_n: 1.0 / (count * self.stiffness_n_per_m),
            rise_m: angle_rad * sum_m / count,
        }
    }

    /// How far the axle rises at a roll angle, m: it turns about the tires that stay on the road, which are pressed more.
    pub(super) fn rise_m(&self, load_n: f64, angle_rad: f64) -> f64 {
        self.rise_of(&self.on_road(load_n, angle_rad), load_n)
    }

    #[allow(clippy::cast_precision_loss)] // a few tires
    fn rise_of(&self, on: &OnRoad<'_>, load_n: f64) -> f64 {
        load_n / (self.levers_m.len() as f64 * self.stiffness_n_per_m) - on.pressed_m
    }

    /// What the tires do to the axle at a roll angle.
    pub(super) fn right(&self, load_n: f64, angle_rad: f64) -> Righting {
        let on = self.on_road(load_n, angle_rad);
        let square: f64 = on.levers_m.iter().map(|y| y * y).sum();
        let slope = self.stiffness_n_per_m * (square - on.sum_m * on.sum_m / on.count);
        let moment = self.stiffness_n_per_m * (on.pressed_m * on.sum_m + angle_rad * square);
        let overturning = self.overturning_nm_per_rad;
        Righting {
            moment_nm: moment + overturning * angle_rad,
            slope: slope + overturning,
            rise_m: self.rise_of(&on, load_n),
            lever_m: on.sum_m / on.count,
        }
    }
}

/// The tires of an axle that carry load: their levers, number and the sum of the levers, and the deflection at the axle's middle.
struct OnRoad<'a> {
    levers_m: &'a [f64],
    count: f64,
    sum_m: f64,
    pressed_m: f64,
}

/// Righting moment of the tires and its slope over the roll angle of the axle; how far the axle rises, and the slope of that,
/// which is also the moment per load.
pub(super) struct Righting {
    pub(super) moment_nm: f64,
    pub(super) slope: f64,
    pub(super) rise_m: f64,
    pub(super) lever_m: f64,
}
