//! The cornering stiffness of a tire with a slip table.
//!
//! The lateral force grows ever more slowly with the slip angle, so a linear tire can be right at one
//! amplitude only. The linear model wants the secant at the lateral acceleration of usual maneuvers: at
//! the slip angle at which the force is that share of the load. The slope at zero slip, which data sheets
//! give, is some percent greater.

use crate::tables::LateralForceTable;
use crate::vehicle::Tyre;

/// Lateral acceleration of usual maneuvers, g.
pub const USUAL_G: f64 = 0.15;

impl LateralForceTable {
    /// Lateral force per slip angle at a load, N/rad: the slope at zero slip and the secant at which the
    /// lateral force is `share` of the load. `None` if no force in the table is so great, or if the table
    /// is not one.
    pub fn slopes_n_per_rad(&self, load_n: f64, share: f64) -> Option<[f64; 2]> {
        let sound = !self.slip_rad.is_empty()
            && self.coefficient.len() == self.slip_rad.len()
            && !self.load_n.is_empty()
            && self.coefficient.iter().all(|row| row.len() == self.load_n.len());
        if !sound {
            return None;
        }
        let column = |row: &[f64]| {
            let above = self.load_n.iter().position(|&load| load >= load_n);
            match above {
                Some(0) => row[0],
                None => row[row.len() - 1],
                Some(j) => {
                    let (low, high) = (self.load_n[j - 1], self.load_n[j]);
                    row[j - 1] + (row[j] - row[j - 1]) * (load_n - low) / (high - low)
                }
            }
        };
        let (mut slip_rad, mut coefficient) = (0.0, 0.0);
        let first = column(&self.coefficient[0]) / self.slip_rad[0];
        for (&next_rad, row) in self.slip_rad.iter().zip(&self.coefficient) {
            let next = column(row);
            if next >= share && next > coefficient {
                let part = (share - coefficient) / (next - coefficient);
                let secant = share / (slip_rad + part * (next_rad - slip_rad));
                return Some([first * load_n, secant * load_n]);
            }
            (slip_rad, coefficient) = (next_rad, next);
        }
        None
    }
}

impl Tyre {
    /// Computes an absent cornering stiffness from the slip table, if there is one.
    pub(crate) fn complete_cornering_stiffness(&mut self) {
        let Some(table) = &self.lateral_force else { return };
        if self.cornering_stiffness_n_per_rad.is_empty() {
            let secants = self.load_n.iter().map(|&n| Some(table.slopes_n_per_rad(n, USUAL_G)?[1]));
            self.cornering_stiffness_n_per_rad =
                secants.collect::<Option<Vec<f64>>>().unwrap_or_default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> LateralForceTable {
        LateralForceTable {
            load_n: vec![10e3, 30e3],
            slip_rad: vec![0.01, 0.03],
            coefficient: vec![vec![0.12, 0.10], vec![0.24, 0.22]],
        }
    }

    /// At 20 kN the coefficients are 0.11 and 0.23: 0.15 is a third of the way from 0.01 to 0.03 rad.
    #[test]
    fn the_secant_is_between_the_nodes() {
        let [zero, secant] = table().slopes_n_per_rad(20e3, 0.15).unwrap();
        assert!((zero - 0.11 / 0.01 * 20e3).abs() < 1e-6, "{zero}");
        assert!((secant - 0.15 / (0.01 + 0.02 / 3.0) * 20e3).abs() < 1e-6, "{secant}");
        let [zero, secant] = table().slopes_n_per_rad(20e3, 0.1).unwrap();
        assert!((zero - secant).abs() < 1e-6);
        // No load has no force, and no tire of this table reaches 0.3.
        assert_eq!(table().slopes_n_per_rad(0.0, 0.15).map(|slopes| slopes[1]), Some(0.0));
        assert_eq!(table().slopes_n_per_rad(20e3, 0.3), None);
        let broken = LateralForceTable { slip_rad: vec![0.01], ..table() };
        assert_eq!(broken.slopes_n_per_rad(20e3, 0.15), None);
    }
}
