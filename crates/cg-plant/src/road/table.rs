//! A road as a table over the distance, and its values at a distance.

use cg_vehicle::error::VehicleError;

/// The greatest bank of a road.
pub const GREATEST_BANK_RAD: f64 = 0.3;
/// The greatest grade of a road.
pub const GREATEST_GRADE_RAD: f64 = 0.3;
/// The greatest curvature: a radius of 5 m.
pub const GREATEST_CURVATURE_PER_M: f64 = 0.2;

/// A road at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadPoint {
    /// Distance from the start.
    pub distance_m: f64,
    /// Curvature, to the left positive.
    pub curvature_per_m: f64,
    /// Bank, left side higher positive.
    pub bank_rad: f64,
    /// Grade, uphill positive.
    pub grade_rad: f64,
    /// Speed limit; infinite without one.
    pub speed_mps: f64,
}

/// A road: a table over the distance, linear between its points (so every transition of the
/// curvature is a clothoid) and constant beyond its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Road {
    name: String,
    points: Vec<RoadPoint>,
    /// Direction of the road at each point, relative to the first one.
    heading_rad: Vec<f64>,
    pub(super) usual_duration_s: Option<f64>,
    is_twisted: bool,
}

impl Road {
    /// A road through these points.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if there are fewer than two points, the distance does not increase,
    /// or a value is not possible.
    pub fn new(name: &str, points: Vec<RoadPoint>) -> Result<Self, VehicleError> {
        if points.len() < 2 {
            return Err(VehicleError::Model(format!("{name}: a road has at least two points")));
        }
        for (k, point) in points.iter().enumerate() {
            let fault = point.fault().map(|(_, fault)| fault).or_else(|| {
                let before = k.checked_sub(1).map(|before| points[before].distance_m)?;
                (point.distance_m <= before).then(|| falling(point.distance_m, before))
            });
            if let Some(fault) = fault {
                return Err(VehicleError::Model(format!("{name}: point {}: {fault}", k + 1)));
            }
        }
        let mut heading_rad = vec![0.0];
        for pair in points.windows(2) {
            let mean = 0.5 * (pair[0].curvature_per_m + pair[1].curvature_per_m);
            let turn_rad = mean * (pair[1].distance_m - pair[0].distance_m);
            heading_rad.push(heading_rad[heading_rad.len() - 1] + turn_rad);
        }
        Ok(Self {
            name: name.to_owned(),
            points,
            heading_rad,
            usual_duration_s: None,
            is_twisted: false,
        })
    }

    /// Its name: the kind, or the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The points of the table.
    pub fn points(&self) -> &[RoadPoint] {
        &self.points
    }

    /// The first point's distance and the last one's.
    pub fn ends_m(&self) -> [f64; 2] {
        [self.points[0].distance_m, self.points[self.points.len() - 1].distance_m]
    }

    /// Whether there is a speed limit on all of it.
    pub fn has_speed(&self) -> bool {
        self.points.iter().all(|point| point.speed_mps.is_finite())
    }

    /// The same road with a speed limit that is nowhere higher than this.
    #[must_use]
    pub fn limited_to(mut self, speed_mps: f64) -> Self {
        for point in &mut self.points {
            point.speed_mps = point.speed_mps.min(speed_mps);
        }
        self
    }

    /// The same road, on which every axle stands on the bank of its own place. Otherwise the whole vehicle
    /// stands on one bank.
    #[must_use]
    pub fn twisted(mut self) -> Self {
        self.is_twisted = true;
        self
    }

    /// Whether every axle stands on the bank of its own place.
    pub fn is_twisted(&self) -> bool {
        self.is_twisted
    }

    /// The same road without bank.
    #[must_use]
    pub fn flat(self) -> Self {
        self.banked_up_to(0.0)
    }

    /// The same road with its bank multiplied, so that this is the greatest one.
    #[must_use]
    pub fn banked_up_to(mut self, greatest_rad: f64) -> Self {
        let steepest = self.points.iter().map(|point| point.bank_rad.abs()).fold(0.0, f64::max);
        if steepest > 0.0 {
            for point in &mut self.points {
                point.bank_rad *= greatest_rad / steepest;
            }
        }
        self
    }

    /// The road at a distance.
    pub fn at(&self, distance_m: f64) -> RoadPoint {
        let (before, share) = self.place(distance_m);
        let (a, b) = (&self.points[before], &self.points[before + 1]);
        let line = |a: f64, b: f64| if share == 0.0 { a } else { a + share * (b - a) };
        RoadPoint {
            distance_m,
            curvature_per_m: line(a.curvature_per_m, b.curvature_per_m),
            bank_rad: line(a.bank_rad, b.bank_rad),
            grade_rad: line(a.grade_rad, b.grade_rad),
            speed_mps: line(a.speed_mps, b.speed_mps),
        }
    }

    /// Direction of the road at a distance, relative to its start. Beyond the ends it goes on with
    /// the same curvature.
    pub fn heading_rad(&self, distance_m: f64) -> f64 {
        let (before, _) = self.place(distance_m);
        let ends = self.ends_m();
        let from = if distance_m > ends[1] { before + 1 } else { before };
        let (point, at) = (&self.points[from], self.at(distance_m));
        let mean = 0.5 * (point.curvature_per_m + at.curvature_per_m);
        self.heading_rad[from] + mean * (distance_m - point.distance_m)
    }

    /// The point before a distance, and the share of the way to the next one.
    fn place(&self, distance_m: f64) -> (usize, f64) {
        let after = self.points.partition_point(|point| point.distance_m <= distance_m);
        let before = after.clamp(1, self.points.len() - 1) - 1;
        let (a, b) = (self.points[before].distance_m, self.points[before + 1].distance_m);
        (before, ((distance_m - a) / (b - a)).clamp(0.0, 1.0))
    }
}

impl RoadPoint {
    /// A value that no road has: its column, and what is wrong with it.
    pub(super) fn fault(&self) -> Option<(usize, String)> {
        let Self { distance_m, curvature_per_m, bank_rad, grade_rad, speed_mps } = *self;
        if !distance_m.is_finite() {
            return Some((0, format!("the distance {distance_m} must be finite")));
        }
        for (column, name, value, most) in [
            (1, "curvature (1/m)", curvature_per_m, GREATEST_CURVATURE_PER_M),
            (2, "bank (rad)", bank_rad, GREATEST_BANK_RAD),
            (4, "grade (rad)", grade_rad, GREATEST_GRADE_RAD),
        ] {
            if !(value.abs() <= most) {
                let text = format!("the {name} {value} must lie between {} and {most}", -most);
                return Some((column, text));
            }
        }
        // 3 km/h: a drive that never ends is an error.
        let fault = || format!("the speed {speed_mps} m/s must be at least 0.8");
        (speed_mps.is_nan() || speed_mps < 0.8).then(|| (3, fault()))
    }
}

pub(super) fn falling(distance_m: f64, before_m: f64) -> String {
    format!("the distance {distance_m} must be greater than {before_m} before it")
}
