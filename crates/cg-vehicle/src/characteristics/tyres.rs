//! Lateral force and aligning moment of a tire as functions of slip angle and load.

use crate::tables::{AligningMomentTable, LateralForceTable};
use crate::vehicle::Tyre;

const BUCKETS: usize = 64;
const LAST_BUCKET: f64 = 63.0;
/// Increasing nodes that start at zero, with a lookup table of equal buckets to find them.
#[derive(Clone, Debug)]
struct Nodes {
    at: Vec<f64>,
    /// The nodes after the first one, and infinity: the end of each interval.
    end: Vec<f64>,
    bucket: [u8; BUCKETS],
    buckets_per_unit: f64,
}

impl Nodes {
    fn new(mut at: Vec<f64>) -> Self {
        at.push(0.0);
        at.retain(|x| *x >= 0.0);
        at.sort_by(f64::total_cmp);
        at.dedup();
        let last = at[at.len() - 1].max(f64::MIN_POSITIVE);
        let buckets_per_unit = LAST_BUCKET / last;
        let mut bucket = [0; BUCKETS];
        let mut start = 0.0;
        for place in &mut bucket {
            // The edge is slightly below the bucket, so that rounding cannot skip a node. The first
            // 255 nodes are found directly, others by a further search.
            let edge = start / buckets_per_unit * (1.0 - 1e-9);
            let below = at.iter().rposition(|x| *x <= edge).unwrap_or(0);
            *place = u8::try_from(below).unwrap_or(u8::MAX);
            start += 1.0;
        }
        let end = at[1..].iter().copied().chain([f64::INFINITY]).collect();
        Self { at, end, bucket, buckets_per_unit }
    }

    /// Index of the last node at or below `x ≥ 0`.
    #[inline]
    fn below(&self, x: f64) -> usize {
        // The result is within 0 and 63; NaN goes to the first bucket.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let bucket = (x * self.buckets_per_unit).min(LAST_BUCKET) as i32 as usize % BUCKETS;
        self.search(x, usize::from(self.bucket[bucket]))
    }

    /// The same, searching upwards from node `i`, which must not be above `x`.
    #[inline]
    fn search(&self, x: f64, mut i: usize) -> usize {
        while x >= self.end[i] {
            i += 1;
        }
        i
    }

    /// The same, if it is probably `guess`.
    #[inline]
    fn below_near(&self, x: f64, guess: usize) -> usize {
        if x >= self.at[guess] && x < self.end[guess] { guess } else { self.below(x) }
    }
}

/// Bilinear function of slip and load, measured from the lower corner of its cell.
#[derive(Clone, Copy, Debug, Default)]
struct Patch([f64; 4]);

impl Patch {
    #[inline]
    fn at(&self, slip: f64, load: f64) -> f64 {
        self.0[0] + self.0[1] * slip + (self.0[2] + self.0[3] * slip) * load
    }

    /// The derivative with respect to the slip.
    #[inline]
    fn by_slip(&self, load: f64) -> f64 {
        self.0[1] + self.0[3] * load
    }

    /// The bilinear function through the values at the corners of the cell. An unbounded cell
    /// continues the function beyond the last node: constant, or linearly along the axis.
    fn through(f: impl Fn(f64, f64) -> f64, slip: (f64, f64), load: (f64, f64)) -> Self {
        let (da, dl) = (slip.1 - slip.0, load.1 - load.0);
        let corner = f(slip.0, load.0);
        let along_slip = (f(slip.1, load.0) - corner) / da;
        let along_load = (f(slip.0, load.1) - corner) / dl;
        let twist = (f(slip.1, load.1) - corner - along_slip * da - along_load * dl) / (da * dl);
        Self([corner, along_slip, along_load, twist])
    }
}

/// Lateral force and aligning moment of one tire type.
#[derive(Clone, Debug)]
pub struct Grip {
    by_slip: Nodes,
    by_load: Nodes,
    /// Ordered by slip, then load: the lateral force (divided by the load if it comes from a table)
    /// and the aligning moment.
    cells: Vec<(Patch, Patch)>,
    /// The force is the patch times `scale.0 + scale.1 · load`: the factor is 1, or the load.
    scale: (f64, f64),
}

/// Position in a table: the node below and the share of the interval, limited to the table.
fn place(nodes: &[f64], x: f64) -> (usize, f64) {
    let last = nodes.len().saturating_sub(2);
    let i = nodes.iter().rposition(|&node| node <= x).unwrap_or(0).min(last);
    if nodes.len() < 2 {
        return (0, 0.0);
    }
    (i, ((x - nodes[i]) / (nodes[i + 1] - nodes[i])).clamp(0.0, 1.0))
}

/// Bilinear interpolation with constant edges; at zero slip all values are zero.
fn held(slip_rad: &[f64], load_n: &[f64], rows: &[Vec<f64>], slip: f64, load: f64) -> f64 {
    let (j, share) = place(load_n, load);
    let row = |i: usize| {
        let row = &rows[i];
        row[j] + share * (row[(j + 1).min(row.len() - 1)] - row[j])
    };
    if slip <= slip_rad[0] {
        return row(0) * slip / slip_rad[0];
    }
    let (i, share) = place(slip_rad, slip);
    row(i) + share * (row((i + 1).min(rows.len() - 1)) - row(i))
}

fn coefficient(table: &LateralForceTable, slip: f64, load: f64) -> f64 {
    held(&table.slip_rad, &table.load_n, &table.coefficient, slip, load)
}

fn moment_nm(table: &AligningMomentTable, slip: f64, load: f64) -> f64 {
    let first = table.load_n[0];
    let share = if load < first { load / first } else { 1.0 };
    share * held(&table.slip_rad, &table.load_n, &table.moment_nm, slip, load.max(first))
}

/// Lateral force of a tire, N, at a slip angle and a load that are not negative: as that of a [`Grip`], without its
/// tables, which are worth their time in a simulation.
pub(crate) fn lateral_force_n(tyre: &Tyre, slip_rad: f64, load_n: f64) -> f64 {
    match &tyre.lateral_force {
        Some(table) => load_n * coefficient(table, slip_rad, load_n),
        None => tyre.stiffness_at(load_n).0.max(0.0) * slip_rad,
    }
}

impl Grip {
    /// From the tables of a tire, or from its stiffnesses if it has no tables or if `linear` is
    /// true.
    pub fn new(tyre: &Tyre, linear: bool) -> Self {
        let force = tyre.lateral_force.as_ref().filter(|_| !linear);
        let moment = tyre.aligning_moment.as_ref().filter(|_| !linear);
        let mut slips = Vec::new();
        let mut loads = tyre.load_n.clone();
        if let Some(table) = force {
            slips.extend(&table.slip_rad);
            loads.extend(&table.load_n);
        }
        if let Some(table) = moment {
            slips.extend(&table.slip_rad);
            loads.extend(&table.load_n);
        }
        let (by_slip, by_load) = (Nodes::new(slips), Nodes::new(loads));
        // A stiffness that is extrapolated below its first load must not become negative.
        let stiffness = |load: f64| tyre.stiffness_at(load);
        let force_at = |a: f64, l: f64| match force {
            Some(table) => coefficient(table, a, l),
            None => stiffness(l).0.max(0.0) * a,
        };
        let moment_at = |a: f64, l: f64| match moment {
            Some(table) => moment_nm(table, a, l),
            None => stiffness(l).1.max(0.0) * a,
        };
        let reach = |nodes: &[f64], i: usize, more: f64| {
            (nodes[i], nodes.get(i + 1).copied().unwrap_or(nodes[i] + more))
        };
        let mut cells = Vec::new();
        for i in 0..by_slip.at.len() {
            for j in 0..by_load.at.len() {
                let (a, l) = (reach(&by_slip.at, i, 0.1), reach(&by_load.at, j, 1e3));
                cells.push((Patch::through(force_at, a, l), Patch::through(moment_at, a, l)));
            }
        }
        let scale = if force.is_some() { (0.0, 1.0) } else { (1.0, 0.0) };
        Self { by_slip, by_load, cells, scale }
    }

    /// Lateral force (N, opposite to the slip) and aligning moment (N m, in the direction of the
    /// slip) at a slip angle and a positive load.
    #[inline]
    pub fn at(&self, slip_rad: f64, load_n: f64) -> (f64, f64) {
        self.near(slip_rad, load_n, self.by_slip.below(slip_rad.abs()))
    }

    /// The row of the table for a slip angle, as a guess for [`near`](Self::near).
    #[inline]
    pub fn row(&self, slip_rad: f64) -> usize {
        self.by_slip.below(slip_rad.abs())
    }

    /// The same as [`at`](Self::at), if the slip is probably in row `guess`.
    #[inline]
    pub fn near(&self, slip_rad: f64, load_n: f64, guess: usize) -> (f64, f64) {
        let ((force, moment), a, l) = self.cell(slip_rad.abs(), load_n, guess);
        let force_n = force.at(a, l) * (self.scale.0 + self.scale.1 * load_n);
        (force_n.copysign(-slip_rad), moment.at(a, l).copysign(slip_rad))
    }

    /// The same, and the derivatives of both with respect to the slip angle.
    #[inline]
    pub fn sloped(&self, slip_rad: f64, load_n: f64, guess: usize) -> [(f64, f64); 2] {
        let ((force, moment), a, l) = self.cell(slip_rad.abs(), load_n, guess);
        let scale = self.scale.0 + self.scale.1 * load_n;
        [
            ((force.at(a, l) * scale).copysign(-slip_rad), moment.at(a, l).copysign(slip_rad)),
            (-force.by_slip(l) * scale, moment.by_slip(l)),
        ]
    }

    /// The cell of force and moment, and slip and load measured from its corner.
    #[inline]
    fn cell(&self, slip_rad: f64, load_n: f64, guess: usize) -> (&(Patch, Patch), f64, f64) {
        let (i, j) = (self.by_slip.below_near(slip_rad, guess), self.by_load.below(load_n));
        let cell = &self.cells[i * self.by_load.at.len() + j];
        (cell, slip_rad - self.by_slip.at[i], load_n - self.by_load.at[j])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::Vehicle;

    fn tyre(file: &str) -> Tyre {
        let path = format!("{}/../../fixtures/vehicles/{file}", env!("CARGO_MANIFEST_DIR"));
        Vehicle::load(path).unwrap().tyre.remove(0)
    }

    #[test]
    fn the_nodes_of_the_tables_are_met() {
        let tyre = tyre("baseline-tables.toml");
        let grip = Grip::new(&tyre, false);
        let force = tyre.lateral_force.unwrap();
        for (i, &slip) in force.slip_rad.iter().enumerate() {
            for (j, &load) in force.load_n.iter().enumerate() {
                let (side, _) = grip.at(slip, load);
                let expected = -force.coefficient[i][j] * load;
                assert!((side - expected).abs() < 1e-9 * load, "{slip} {load}");
                assert!((grip.at(-slip, load).0 + side).abs() < 1e-300);
            }
        }
        let moment = tyre.aligning_moment.unwrap();
        for (i, &slip) in moment.slip_rad.iter().enumerate() {
            for (j, &load) in moment.load_n.iter().enumerate() {
                assert!((grip.at(slip, load).1 - moment.moment_nm[i][j]).abs() < 1e-8);
            }
        }
    }

    /// At nodes, between and beyond them.
    #[test]
    fn a_single_force_is_that_of_the_grip() {
        for file in ["baseline-tables.toml", "baseline.toml"] {
            let tyre = tyre(file);
            let grip = Grip::new(&tyre, false);
            for slip_rad in [0.0, 0.003, 0.0173, 0.0349, 0.07, 0.2, 0.5] {
                for load_n in [0.0, 700.0, 8_850.0, 13_345.0, 20_100.0, 42_001.0, 60_000.0] {
                    let (expected_n, found_n) =
                        (-grip.at(slip_rad, load_n).0, lateral_force_n(&tyre, slip_rad, load_n));
                    let off_n = (found_n - expected_n).abs();
                    assert!(
                        off_n < 1e-12 * (1.0 + load_n),
                        "{file} {slip_rad} {load_n}: {found_n}"
                    );
                }
            }
        }
    }

    /// A central difference is exact within a cell up to rounding, because force and moment are linear in the slip there.
    #[test]
    fn slopes_are_those_of_the_grip() {
        for file in ["baseline-tables.toml", "baseline.toml"] {
            let grip = Grip::new(&tyre(file), false);
            for slip_rad in [-0.2, -0.05, -0.003, 0.003, 0.05, 0.2] {
                for load_n in [700.0, 13_345.0, 20_100.0, 60_000.0] {
                    let row = grip.row(slip_rad);
                    let [here, slopes] = grip.sloped(slip_rad, load_n, row);
                    assert_eq!(here, grip.near(slip_rad, load_n, row));
                    let [more, less] = [1e-6, -1e-6].map(|step| grip.at(slip_rad + step, load_n));
                    let by_force = (more.0 - less.0) / 2e-6;
                    let by_moment = (more.1 - less.1) / 2e-6;
                    // Rounding of the forces, divided by the step: 60 kN · 2⁻⁵² / 1e-6 is 13 µN/rad.
                    assert!((slopes.0 - by_force).abs() < 1e-4, "{file} {slip_rad} {load_n}");
                    assert!((slopes.1 - by_moment).abs() < 1e-4, "{file} {slip_rad} {load_n}");
                }
            }
        }
    }

    #[test]
    fn beyond_the_tables_the_coefficient_stays_and_without_load_nothing_is_left() {
        let grip = Grip::new(&tyre("baseline-tables.toml"), false);
        assert!((grip.at(1.0, 60_000.0).0 + 0.61 * 60_000.0).abs() < 1e-6);
        assert!((grip.at(1.0, 100.0).0 + 0.91 * 100.0).abs() < 1e-9);
        let (side, moment) = grip.at(0.05, 1e-9);
        assert!(side.abs() < 1e-9 && moment.abs() < 1e-9);
    }

    #[test]
    fn without_tables_force_and_moment_are_those_of_the_stiffnesses() {
        let tyre = tyre("baseline.toml");
        let grip = Grip::new(&tyre, false);
        for load in [100.0, 8_850.0, 20_000.0, 41_993.0, 60_000.0] {
            let (cornering, aligning) = tyre.stiffness_at(load);
            let (side, moment) = grip.at(-0.02, load);
            assert!((side / (0.02 * cornering) - 1.0).abs() < 1e-12);
            assert!((moment / (-0.02 * aligning) - 1.0).abs() < 1e-12);
        }
    }
}
