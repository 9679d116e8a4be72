//! The thesis's linear model, term by term from eqs. 4.2–4.31 (appendix B, corrected).
//!
//! It is written in the thesis's signs (y right, z down: steer, yaw and lateral velocity positive
//! to the right). At the end the signs of these columns are changed to obtain ISO 8855.

use nalgebra::DMatrix;

use crate::equations::{Equations, q, w};
use crate::error::VehicleError;
use crate::load::Load;
use crate::vehicle::{AsPrinted, PlacedAxle, Vehicle};

/// A linear form in the thesis's unknowns `(V, Ψ1, Φ1, Ψ2, Φ2, Φu…)` whose coefficients are
/// polynomials `d0 + d1 s + d2 s²`.
#[derive(Clone)]
struct Form(Vec<[f64; 3]>);

mod column {
    pub(super) const V: usize = 0;
    pub(super) const YAW_1: usize = 1;
    pub(super) const ROLL_1: usize = 2;
    pub(super) const YAW_2: usize = 3;
    pub(super) const ROLL_2: usize = 4;
    pub(super) const AXLE: usize = 5;
}

impl Form {
    fn zero(axles: usize) -> Self {
        Self(vec![[0.0; 3]; column::AXLE + axles])
    }

    /// Adds `coefficient s^power` times the unknown with index `unknown`.
    fn plus(mut self, unknown: usize, power: usize, coefficient: f64) -> Self {
        self.0[unknown][power] += coefficient;
        self
    }

    /// Adds `factor` times another form.
    fn add(mut self, factor: f64, other: &Self) -> Self {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0) {
            for (a, b) in mine.iter_mut().zip(theirs) {
                *a += factor * b;
            }
        }
        self
    }

    /// The form multiplied by s; it must not contain s².
    fn derivative(&self) -> Self {
        Self(self.0.iter().map(|[d0, d1, _]| [0.0, *d0, *d1]).collect())
    }
}

struct Context<'a> {
    printed: &'a AsPrinted,
    speed_mps: f64,
    gravity_mps2: f64,
    axles: Vec<PlacedAxle<'a>>,
    hitch_behind_m: f64,       // Xsc1
    hitch_ahead_m: f64,        // Xsc2
    tractor_cg_m: f64,         // h1
    trailer_cg_m: f64,         // h
    tractor_above_m: f64,      // Zsc1
    trailer_above_m: f64,      // Zsc2
    trailer_unit_above_m: f64, // Zc2
}

pub(crate) fn equations(
    vehicle: &Vehicle,
    speed_mps: f64,
    load: Load,
) -> Result<Equations, VehicleError> {
    let printed = vehicle.as_printed.as_ref().ok_or_else(|| {
        VehicleError::AsPrinted("needs an [as_printed] table in the vehicle file".to_owned())
    })?;
    let known_kg = printed.trailer_mass_kg;
    // Another mass would need other inertias, which the thesis does not give.
    if (load.trailer_mass_kg - known_kg).abs() > 1e-3 * known_kg {
        return Err(VehicleError::AsPrinted(format!(
            "is known at a trailer mass of {known_kg:.0} kg only, not at {:.0} kg",
            load.trailer_mass_kg
        )));
    }
    let sprung = vehicle.trailer_sprung_mass(load)?;
    let rise_m = load.cg_height_m - vehicle.trailer.reference_cg_height_m;
    let c = Context {
        printed,
        speed_mps,
        gravity_mps2: vehicle.gravity_mps2,
        axles: vehicle.axles(),
        hitch_behind_m: vehicle.tractor.hitch_behind_cg_m,
        hitch_ahead_m: sprung.cg_behind_hitch_m,
        tractor_cg_m: vehicle.tractor.cg_height_m,
        trailer_cg_m: load.cg_height_m,
        tractor_above_m: vehicle.tractor.cg_height_m - vehicle.hitch.height_m,
        trailer_above_m: printed.trailer_sprung_cg_above_hitch_m + rise_m,
        trailer_unit_above_m: printed.trailer_cg_above_hitch_m
            + rise_m * sprung.mass_kg / printed.trailer_mass_kg,
    };
    let (rows, steer) = c.rows(vehicle.hitch.roll_stiffness_nm_per_rad, vehicle);
    let mut e = Equations::zeros(c.axles.len(), None, speed_mps);
    for (i, row) in rows.iter().enumerate() {
        set_row(&mut e, i, row);
        e.steer[i] = -steer[i];
    }
    // Lateral acceleration of the sprung c.g.: s V2 + u s Ψ2, to the left.
    let lateral = c.trailer_velocity().derivative().plus(column::YAW_2, 1, speed_mps);
    let mut row = Equations::zeros(c.axles.len(), None, speed_mps);
    set_row(&mut row, 0, &lateral);
    e.lateral_rate = -row.mass.row(0).transpose();
    e.lateral_bias = -row.damping.row(0).transpose();
    Ok(e)
}

/// Writes a form into row `i`; the signs of the columns of lateral and yaw motion are reversed.
fn set_row(e: &mut Equations, i: usize, row: &Form) {
    let file = |matrix: &mut DMatrix<f64>, j: usize, value: f64| matrix[(i, j)] = value;
    let [d0, d1, _] = row.0[column::V];
    file(&mut e.damping, w::LATERAL, -d0);
    file(&mut e.mass, w::LATERAL, -d1);
    // Without derivatives, Ψ1 and Ψ2 occur only as their difference (after the correction of B.22).
    for (from, to) in [(column::YAW_1, w::YAW_1), (column::YAW_2, w::YAW_2)] {
        let [_, d1, d2] = row.0[from];
        file(&mut e.damping, to, -d1);
        file(&mut e.mass, to, -d2);
    }
    file(&mut e.stiffness, q::ARTICULATION, -row.0[column::YAW_1][0]);
    for (from, to) in [(column::ROLL_1, 0), (column::ROLL_2, 1)]
        .into_iter()
        .chain((column::AXLE..row.0.len()).map(|k| (k, k - column::AXLE + 2)))
    {
        let [d0, d1, d2] = row.0[from];
        file(&mut e.stiffness, q::ROLL_1 + to, d0);
        file(&mut e.damping, w::ROLL_1 + to, d1);
        file(&mut e.mass, w::ROLL_1 + to, d2);
    }
}

impl Context<'_> {
    fn zero(&self) -> Form {
        Form::zero(self.axles.len())
    }

    /// `V2`, eq. 4.38.
    fn trailer_velocity(&self) -> Form {
        self.zero()
            .plus(column::V, 0, 1.0)
            .plus(column::YAW_1, 0, self.speed_mps)
            .plus(column::YAW_1, 1, -self.hitch_behind_m)
            .plus(column::ROLL_1, 1, -self.tractor_above_m)
            .plus(column::YAW_2, 0, -self.speed_mps)
            .plus(column::YAW_2, 1, -self.hitch_ahead_m)
            .plus(column::ROLL_2, 1, self.trailer_above_m)
    }

    /// `a1y`, eq. 4.36.
    fn tractor_acceleration(&self) -> Form {
        let p = self.printed;
        self.zero()
            .plus(column::V, 1, 1.0)
            .plus(column::YAW_1, 1, self.speed_mps)
            .plus(column::YAW_1, 2, p.tractor_cg_ahead_of_hitch_m - self.hitch_behind_m)
            .plus(column::ROLL_1, 2, p.tractor_cg_above_hitch_m - self.tractor_above_m)
    }

    /// `a2y`, eq. 4.37.
    fn trailer_acceleration(&self) -> Form {
        let behind_m = self.printed.trailer_cg_behind_hitch_m;
        self.trailer_velocity()
            .derivative()
            .plus(column::YAW_2, 1, self.speed_mps)
            .plus(column::YAW_2, 2, self.hitch_ahead_m - behind_m)
            .plus(column::ROLL_2, 2, self.trailer_unit_above_m - self.trailer_above_m)
    }

    /// Velocity, yaw and roll columns, c.g. height and position of an axle's unit.
    fn unit(&self, placed: &PlacedAxle<'_>) -> (Form, usize, usize, f64, f64) {
        if placed.on_trailer {
            let ahead_m = self.hitch_ahead_m - placed.position_m;
            (self.trailer_velocity(), column::YAW_2, column::ROLL_2, self.trailer_cg_m, ahead_m)
        } else {
            let velocity = self.zero().plus(column::V, 0, 1.0);
            (velocity, column::YAW_1, column::ROLL_1, self.tractor_cg_m, placed.position_m)
        }
    }

    /// The rows of both units without their axles: lateral, yaw 1, yaw 2, roll 1, roll 2.
    fn units(&self, k1: f64, vehicle: &Vehicle) -> [Form; 5] {
        let p = self.printed;
        let (a1, a2) = (self.tractor_acceleration(), self.trailer_acceleration());
        let lateral = self.zero().add(p.tractor_mass_kg, &a1).add(p.trailer_mass_kg, &a2); // 4.11
        let yaw_1 = self // 4.30
            .zero()
            .add(-p.tractor_cg_ahead_of_hitch_m * p.tractor_mass_kg, &a1)
            .plus(column::YAW_1, 2, -p.tractor_yaw_inertia_about_hitch_kgm2);
        let yaw_2 = self // 4.31
            .zero()
            .add(p.trailer_cg_behind_hitch_m * p.trailer_mass_kg, &a2)
            .plus(column::YAW_2, 2, -p.trailer_yaw_inertia_about_hitch_kgm2);
        let trailer_roll_inertia = vehicle
            .trailer_sprung_mass(vehicle.reference_load())
            .map_or(f64::NAN, |sprung| sprung.roll_inertia_kgm2);
        let roll_1 = self // 4.16
            .zero()
            .plus(column::ROLL_1, 2, -vehicle.tractor.roll_inertia_kgm2)
            .plus(column::ROLL_2, 0, k1)
            .plus(column::ROLL_1, 0, -k1);
        let roll_2 = self // 4.17
            .zero()
            .plus(column::ROLL_2, 2, -trailer_roll_inertia)
            .plus(column::ROLL_1, 0, k1)
            .plus(column::ROLL_2, 0, -k1);
        [lateral, yaw_1, yaw_2, roll_1, roll_2]
    }

    /// All rows, and the coefficients of the steer angle.
    fn rows(&self, k1: f64, vehicle: &Vehicle) -> (Vec<Form>, Vec<f64>) {
        let (p, n) = (self.printed, self.axles.len());
        let mut steer = vec![0.0; column::AXLE + n];
        let [mut lateral, mut yaw_1, mut yaw_2, mut roll_1, mut roll_2] = self.units(k1, vehicle);
        let mut axle_rows = Vec::with_capacity(n);
        for (i, placed) in self.axles.iter().enumerate() {
            let own = column::AXLE + i;
            let (velocity, yaw, roll, cg_m, ahead_m) = self.unit(placed);
            let below_cg_m = cg_m - placed.axle.roll_center_height_m; // ZR
            let tyres = Tyres::of(placed, p.axle_load_n[i]);
            let slip = self.slip(velocity.clone(), placed, own, (yaw, ahead_m), (roll, below_cg_m));
            let delta = if placed.steered { 1.0 } else { 0.0 };

            lateral = lateral.add(tyres.cornering, &slip);
            steer[w::LATERAL] += tyres.cornering * delta;
            if placed.on_trailer {
                yaw_2 = yaw_2.add(tyres.cornering * placed.position_m + tyres.aligning, &slip);
            } else {
                let arm = tyres.aligning - tyres.cornering * (ahead_m + self.hitch_behind_m);
                yaw_1 = yaw_1.add(arm, &slip);
                steer[1] += arm * delta;
            }
            let inertia =
                self.axle_inertia(&velocity, placed, own, (yaw, ahead_m), (roll, below_cg_m));
            let reaction = inertia.add(tyres.cornering, &slip); // F_R without its φu terms
            let sprung_n = p.axle_load_n[i] - p.unsprung_weight_n[i];
            let spring = placed.suspension_roll_stiffness_nm_per_rad();
            let body_row = if placed.on_trailer { &mut roll_2 } else { &mut roll_1 };
            *body_row = body_row
                .clone()
                .add(below_cg_m, &reaction)
                .plus(roll, 0, below_cg_m * sprung_n - spring)
                .plus(own, 0, spring);
            if !placed.on_trailer {
                steer[2] += below_cg_m * tyres.cornering * delta;
            }
            axle_rows.push(self.axle_row(placed, i, &reaction, &slip, roll));
            steer[own] = placed.axle.roll_center_height_m * tyres.cornering * delta;
        }
        // The order of C in appendix B: lateral, yaw 1, roll 1, yaw 2, roll 2, axles.
        let mut rows = vec![lateral, yaw_1, roll_1, yaw_2, roll_2];
        rows.append(&mut axle_rows);
        (rows, steer)
    }

    /// Slip angle without the part of the steer angle: `v_axle / u`, eqs. 4.2 and 4.4.
    fn slip(
        &self,
        velocity: Form,
        placed: &PlacedAxle<'_>,
        own: usize,
        (yaw, ahead_m): (usize, f64),
        (roll, below_cg_m): (usize, f64),
    ) -> Form {
        let v_axle = velocity.plus(yaw, 1, ahead_m).plus(roll, 1, -below_cg_m).plus(
            own,
            1,
            -placed.axle.roll_center_height_m,
        );
        self.zero().add(1.0 / self.speed_mps, &v_axle)
    }

    /// `m_u` times the lateral acceleration of the axle, eq. 4.8.
    fn axle_inertia(
        &self,
        velocity: &Form,
        placed: &PlacedAxle<'_>,
        own: usize,
        (yaw, ahead_m): (usize, f64),
        (roll, below_cg_m): (usize, f64),
    ) -> Form {
        let above_axle_m = placed.axle.roll_center_height_m - placed.axle.center_height_m; // Zu
        let acceleration = velocity
            .derivative()
            .plus(yaw, 1, self.speed_mps)
            .plus(yaw, 2, ahead_m)
            .plus(roll, 2, -below_cg_m)
            .plus(own, 2, -above_axle_m);
        self.zero().add(placed.axle.unsprung_mass_kg, &acceleration)
    }

    /// The roll equation of an axle, eqs. 4.23–4.27.
    fn axle_row(
        &self,
        placed: &PlacedAxle<'_>,
        i: usize,
        reaction: &Form,
        slip: &Form,
        roll: usize,
    ) -> Form {
        let own = column::AXLE + i;
        let axle = placed.axle;
        let above_axle_m = axle.roll_center_height_m - axle.center_height_m;
        let load_n = self.printed.axle_load_n[i];
        let spring = placed.suspension_roll_stiffness_nm_per_rad();
        let cornering = Tyres::of(placed, load_n).cornering;
        self.zero()
            .add(above_axle_m, reaction)
            .add(cornering * axle.center_height_m, slip)
            .plus(own, 2, -axle.roll_inertia_kgm2)
            .plus(roll, 0, spring)
            .plus(
                own,
                0,
                load_n * (above_axle_m + self.printed.wheel_radius_m)
                    - axle.unsprung_mass_kg * self.gravity_mps2 * above_axle_m
                    - spring
                    - placed.tyre_roll_stiffness_nm_per_rad(),
            )
    }
}

/// Sums over all tires of an axle.
struct Tyres {
    cornering: f64,
    aligning: f64,
}

impl Tyres {
    fn of(placed: &PlacedAxle<'_>, load_n: f64) -> Self {
        let (cornering, aligning) = placed.tyre.stiffness_at(load_n / placed.tyres());
        Self { cornering: placed.tyres() * cornering, aligning: placed.tyres() * aligning }
    }
}
