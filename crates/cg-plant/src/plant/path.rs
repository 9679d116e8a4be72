//! Paths to follow (section 2.6): points at equal distances along them.

use std::f64::consts::PI;

/// Distance between the points.
const SPACING_M: f64 = 0.1;

/// A path on the road that continues straight beyond its end.
#[derive(Clone, Debug)]
pub struct Path {
    /// Points at equal arc length.
    point_m: Vec<[f64; 2]>,
}

impl Path {
    /// Through these points (at least two), by straight lines.
    pub fn through(points_m: &[[f64; 2]]) -> Self {
        let mut point_m: Vec<[f64; 2]> = points_m.iter().take(1).copied().collect();
        // The rest of the last piece.
        let mut ahead_m = SPACING_M;
        for pair in points_m.windows(2) {
            let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
            let length_m = libm::hypot(dx, dy);
            while ahead_m <= length_m {
                let share = ahead_m / length_m;
                point_m.push([pair[0][0] + share * dx, pair[0][1] + share * dy]);
                ahead_m += SPACING_M;
            }
            ahead_m -= length_m;
        }
        Self { point_m }
    }

    /// Lane change to the left over a gate length: half a cosine (eq. 2.5).
    pub fn lane_change(start_m: f64, gate_m: f64, width_m: f64) -> Self {
        let points = (0..=1000).map(|k| {
            let share = f64::from(k) / 1000.0;
            [start_m + share * gate_m, 0.5 * width_m * (1.0 - libm::cos(PI * share))]
        });
        let end = [start_m + gate_m + 10.0, width_m];
        let all: Vec<_> = [[0.0, 0.0]].into_iter().chain(points).chain([end]).collect();
        Self::through(&all)
    }

    /// Straight, a turn to the left of constant radius through an angle, straight.
    pub fn turn(start_m: f64, radius_m: f64, angle_rad: f64) -> Self {
        let points = (0..=2000).map(|k| {
            let (sin, cos) = libm::sincos(angle_rad * f64::from(k) / 2000.0);
            [start_m + radius_m * sin, radius_m * (1.0 - cos)]
        });
        let (sin, cos) = libm::sincos(angle_rad);
        let end = [start_m + radius_m * sin + 10.0 * cos, radius_m * (1.0 - cos) + 10.0 * sin];
        let all: Vec<_> = [[0.0, 0.0]].into_iter().chain(points).chain([end]).collect();
        Self::through(&all)
    }

    /// The point at an arc length; beyond the ends along the first or last piece.
    pub fn point(&self, arc_m: f64) -> [f64; 2] {
        let Some(last) = self.point_m.len().checked_sub(2) else { return [arc_m, 0.0] };
        let at = arc_m / SPACING_M;
        // The cast saturates; the index is then limited to the path.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let i = (at.max(0.0) as usize).min(last);
        #[allow(clippy::cast_precision_loss)]
        let share = at - i as f64;
        let (a, b) = (self.point_m[i], self.point_m[i + 1]);
        [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
    }

    /// The arc length nearest to a position. It is found from the last one by projection on the
    /// tangent there, twice.
    pub fn nearest(&self, position_m: [f64; 2], last_m: f64) -> f64 {
        let mut arc_m = last_m;
        for _ in 0..2 {
            let (a, b) = (self.point(arc_m), self.point(arc_m + SPACING_M));
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let along = (position_m[0] - a[0]) * dx + (position_m[1] - a[1]) * dy;
            arc_m += along / libm::hypot(dx, dy).max(f64::MIN_POSITIVE);
        }
        arc_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_at_their_arc_length() {
        let turn = Path::turn(20.0, 100.0, PI / 2.0);
        let [x, y] = turn.point(20.0 + 100.0 * PI / 4.0);
        let expected = 100.0 * (PI / 4.0).sin();
        // Chords of 0.1 m on a radius of 100 m are 1e-9 too short; points between them are 1e-5 inside.
        assert!((x - 20.0 - expected).abs() < 1e-3 && (y - 100.0 + expected).abs() < 1e-3);
        let end = turn.point(20.0 + 50.0 * PI + 30.0);
        assert!((end[0] - 120.0).abs() < 2e-2 && (end[1] - 130.0).abs() < 2e-2, "{end:?}");
    }

    #[test]
    fn the_nearest_point_is_found_beside_the_path() {
        let turn = Path::turn(20.0, 100.0, PI / 2.0);
        let angle = 0.5_f64;
        let beside = [20.0 + 97.0 * angle.sin(), 100.0 - 97.0 * angle.cos()];
        assert!((turn.nearest(beside, 69.0) - 70.0).abs() < 0.01);
    }
}
