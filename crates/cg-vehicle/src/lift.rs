//! Lift axles of the trailer: the vehicle with them raised.
//!
//! A raised axle carries nothing and belongs to the sprung mass. The springs and tires of the others carry its load, so the
//! trailer rolls by a third more with one of three axles raised, and by more than a half with one of two.

use serde::{Deserialize, Serialize};

use crate::equations::Variant;
use crate::error::VehicleError;
use crate::vehicle::{Axle, HeightRange, Tare, Vehicle};

/// Greatest distance of a value from that of a position: some loggers interpolate, and half way between is neither.
const NEAR: f64 = 0.1;

/// The position of the lift axles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LiftAxle {
    /// On the road.
    #[default]
    Down,
    /// Raised.
    Raised,
}

cg_core::words!(LiftAxle {
    Down => "down", "The lift axles are on the road";
    Raised => "raised", "The lift axles are raised";
});

impl LiftAxle {
    /// Whether they are on the road.
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde asks for")]
    pub fn is_down(&self) -> bool {
        *self == Self::Down
    }

    /// The other position.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Down => Self::Raised,
            Self::Raised => Self::Down,
        }
    }

    /// The value of a signal in this position.
    pub fn value(self) -> f64 {
        f64::from(u8::from(self == Self::Raised))
    }

    /// The position that a signal says: 0 is down and 1 raised. A value that is not near either is none.
    pub fn of_value(value: f64) -> Option<Self> {
        let positions = [(0.0, Self::Down), (1.0, Self::Raised)];
        positions
            .into_iter()
            .find(|(of, _)| (value - of).abs() <= NEAR)
            .map(|(_, position)| position)
    }
}

/// A vehicle with its lift axles in both positions.
#[derive(Debug)]
pub struct Positions<'a> {
    down: &'a Vehicle,
    raised: Option<Vehicle>,
}

impl<'a> Positions<'a> {
    /// The vehicle in every position that it can have.
    ///
    /// # Errors
    /// As [`Vehicle::raised`].
    pub fn of(vehicle: &'a Vehicle) -> Result<Self, VehicleError> {
        Ok(Self { down: vehicle, raised: vehicle.raised()? })
    }

    /// The vehicle in a position.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if it has no lift axle to raise.
    pub fn at(&self, position: LiftAxle) -> Result<&Vehicle, VehicleError> {
        match position {
            LiftAxle::Down => Ok(self.down),
            LiftAxle::Raised => self.raised.as_ref().ok_or_else(|| none_to_raise(self.down)),
        }
    }
}

fn none_to_raise(vehicle: &Vehicle) -> VehicleError {
    VehicleError::Model(format!(
        "vehicle \"{}\" has no lift axle to raise; give lift_m to the [[trailer.axle]] that is one",
        vehicle.name
    ))
}

impl Vehicle {
    /// Whether the trailer has a lift axle.
    pub fn has_lift_axle(&self) -> bool {
        self.trailer.axle.iter().any(|axle| axle.lift_m.is_some())
    }

    /// The vehicle with its lift axles in a position.
    ///
    /// # Errors
    /// [`VehicleError::Model`] if they are raised, but it has none; and as [`raised`](Self::raised).
    pub fn with_lift_axle(self, position: LiftAxle) -> Result<Self, VehicleError> {
        if position == LiftAxle::Down {
            return Ok(self);
        }
        self.raised()?.ok_or_else(|| none_to_raise(&self))
    }

    /// The vehicle with its lift axles in a given position, or down; and with them raised, too, if none is given, so that a log
    /// may say that they are. The printed equations are those of one load on all axles.
    ///
    /// # Errors
    /// As [`with_lift_axle`](Self::with_lift_axle).
    pub fn in_positions(
        &self,
        given: Option<LiftAxle>,
        variant: Variant,
    ) -> Result<(Self, Option<Self>), VehicleError> {
        let is_open = given.is_none() && variant == Variant::Complete;
        let raised = if is_open { self.raised()? } else { None };
        Ok((self.clone().with_lift_axle(given.unwrap_or_default())?, raised))
    }

    /// The vehicle with its lift axles raised; `None` if it has none. The axles belong to the tare, at the height to
    /// which they are raised, and all heights of the vehicle are those of the sprung mass with them. Sensors stay
    /// where they are, and a gauge on the bellows of all axles has the pressure of those that are left.
    ///
    /// # Errors
    /// [`VehicleError`] if no axle is left on the road, or if the static loads do not follow from the file.
    pub fn raised(&self) -> Result<Option<Self>, VehicleError> {
        if !self.has_lift_axle() {
            return Ok(None);
        }
        let mut raised = self.clone();
        raised.as_printed = None;
        let place_m = self.accelerometer_positions_m().1;
        raised.sensors.accelerometer.behind_hitch_m = Some(place_m);
        raised.trailer.axle.retain(|axle| axle.lift_m.is_none());
        let (left, all) = (raised.trailer.axle.len(), self.trailer.axle.len());
        if left == 0 {
            return Err(VehicleError::Model(format!(
                "vehicle \"{}\": every axle of the trailer has lift_m, but one must stay on the road",
                self.name
            )));
        }
        for axle in &self.trailer.axle {
            if let Some(lift_m) = axle.lift_m {
                raised.trailer.tare =
                    with_body(&raised.trailer.tare, axle.behind_hitch_m, lift_m, &axle.axle);
            }
        }
        self.move_heights(&mut raised);
        #[allow(clippy::cast_precision_loss)] // a few axles
        let share = left as f64 / all as f64;
        if let Some(readings) = &mut raised.trailer.suspension_pressure {
            readings.axle_load_kg = readings.axle_load_kg.map(|load_kg| share * load_kg);
        }
        let tractor = self.tractor.axle.len();
        let stays = |i: &usize| *i < tractor || self.trailer.axle[i - tractor].lift_m.is_none();
        let kept: Vec<usize> = (0..tractor + all).filter(stays).collect();
        let load = raised.reference_load();
        self.level(&mut raised, &kept, load)?;
        Ok(Some(raised))
    }

    /// Gives a vehicle with raised axles the heights of the same loads.
    fn move_heights(&self, raised: &mut Self) {
        let mass_kg = self.trailer.reference_mass_kg;
        let sprung_kg = mass_kg - self.trailer_unsprung_mass_kg();
        let (down, up) = (&self.trailer.tare, &raised.trailer.tare);
        let payload_kg = sprung_kg - down.sprung_mass_kg;
        let payload_moment =
            sprung_kg * self.trailer.reference_cg_height_m - down.sprung_mass_kg * down.cg_height_m;
        raised.trailer.reference_cg_height_m = (payload_moment
            + up.sprung_mass_kg * up.cg_height_m)
            / (payload_kg + up.sprung_mass_kg);
        let lower_m = down.cg_height_m - up.cg_height_m;
        let HeightRange { least_m, greatest_m } = self.height;
        raised.height = HeightRange { least_m: least_m - lower_m.max(0.0), greatest_m };
    }
}

/// A tare that carries a raised axle, too.
fn with_body(tare: &Tare, behind_hitch_m: f64, lift_m: f64, axle: &Axle) -> Tare {
    let kg = axle.unsprung_mass_kg;
    let mass_kg = tare.sprung_mass_kg + kg;
    let share = kg / mass_kg;
    let behind_m = behind_hitch_m - tare.cg_behind_hitch_m;
    let above_m = axle.center_height_m + lift_m - tare.cg_height_m;
    // Two bodies about their common c.g.: the reduced mass at their distance.
    let reduced_kg = tare.sprung_mass_kg * share;
    let (along, up) = (reduced_kg * behind_m * behind_m, reduced_kg * above_m * above_m);
    Tare {
        sprung_mass_kg: mass_kg,
        cg_behind_hitch_m: tare.cg_behind_hitch_m + share * behind_m,
        cg_height_m: tare.cg_height_m + share * above_m,
        roll_inertia_kgm2: tare.roll_inertia_kgm2 + axle.roll_inertia_kgm2 + up,
        yaw_inertia_kgm2: tare.yaw_inertia_kgm2 + axle.roll_inertia_kgm2 + along,
        pitch_inertia_kgm2: tare.pitch_inertia_kgm2.map(|own| own + along + up),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balance::static_balance;
    use crate::guide::{TruckKind, template};

    fn with_lift(lift_m: [Option<f64>; 3]) -> Vehicle {
        let mut truck = Vehicle::parse(&template(TruckKind::FourByTwoThreeAxle), "truck").unwrap();
        for (axle, lift_m) in truck.trailer.axle.iter_mut().zip(lift_m) {
            axle.lift_m = lift_m;
        }
        truck
    }

    fn close(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn a_value_near_a_position_is_that_position() {
        let positions = [0.0, 0.05, 1.0, 0.97, 0.5, 2.0, -0.2, f64::NAN].map(LiftAxle::of_value);
        let (down, up) = (Some(LiftAxle::Down), Some(LiftAxle::Raised));
        assert_eq!(positions, [down, down, up, up, None, None, None, None]);
    }

    /// Mass, weight on the road and moment about the ground are those of the same truck; the load of the raised axle is
    /// carried by fifth wheel and other axles.
    #[test]
    fn nothing_gets_lighter_by_raising_an_axle() {
        let truck = with_lift([Some(0.1), None, None]);
        let raised = truck.raised().unwrap().unwrap();
        assert!(!raised.has_lift_axle() && raised.trailer.axle.len() == 2);
        close(raised.empty_trailer_mass_kg(), truck.empty_trailer_mass_kg());
        for payload_kg in [0.0, 15e3] {
            let mass_kg = truck.empty_trailer_mass_kg() + payload_kg;
            let loads = [&truck, &raised].map(|one| {
                let load = crate::Load { trailer_mass_kg: mass_kg, ..one.reference_load() };
                static_balance(one, load).unwrap()
            });
            let [down_n, up_n] = loads.map(|balance| balance.axle_load_n);
            close(up_n.iter().sum(), down_n.iter().sum());
            assert!(up_n[1] > down_n[1] && up_n[2] > 1.3 * down_n[3], "{up_n:?} {down_n:?}");
        }
        let moment = |one: &Vehicle, sprung_kg: f64| {
            let axles =
                one.trailer.axle.iter().map(|a| a.axle.unsprung_mass_kg * a.axle.center_height_m);
            sprung_kg * one.trailer.reference_cg_height_m + axles.sum::<f64>()
        };
        let sprung_kg = truck.trailer.reference_mass_kg - truck.trailer_unsprung_mass_kg();
        let kg = truck.trailer.axle[0].axle.unsprung_mass_kg;
        close(moment(&raised, sprung_kg + kg), moment(&truck, sprung_kg) + 0.1 * kg);
        // Two bodies about a common c.g. have the sum of their moments about any point less that of the sum.
        let (tare, both, axle) =
            (&truck.trailer.tare, &raised.trailer.tare, &truck.trailer.axle[0]);
        let about_hitch = |inertia: f64, kg: f64, behind_m: f64| inertia + kg * behind_m * behind_m;
        close(
            about_hitch(both.yaw_inertia_kgm2, both.sprung_mass_kg, both.cg_behind_hitch_m),
            about_hitch(tare.yaw_inertia_kgm2, tare.sprung_mass_kg, tare.cg_behind_hitch_m)
                + about_hitch(axle.axle.roll_inertia_kgm2, kg, axle.behind_hitch_m),
        );
    }

    /// Under one axle load, an air spring is the same whether another axle is raised or not.
    #[test]
    fn air_springs_follow_the_load_that_they_carry() {
        let truck = with_lift([Some(0.1), None, None]);
        let raised = truck.raised().unwrap().unwrap();
        let stiffness_per_n = |one: &Vehicle, axle: usize, mass_kg: f64| {
            let load = crate::Load { trailer_mass_kg: mass_kg, ..one.reference_load() };
            let springs = one.with_springs_at(load).unwrap();
            let placed = &springs.axles()[axle];
            let unsprung_n = placed.axle.unsprung_mass_kg * one.gravity_mps2;
            let sprung_n = static_balance(one, load).unwrap().axle_load_n[axle] - unsprung_n;
            placed.axle.spring_stiffness_n_per_m / sprung_n
        };
        for mass_kg in [12e3, 25e3] {
            for (down, up) in [(1, 1), (3, 2), (4, 3)] {
                close(
                    stiffness_per_n(&raised, up, mass_kg),
                    stiffness_per_n(&truck, down, mass_kg),
                );
            }
        }
    }

    #[test]
    fn sensors_stay_where_they_are() {
        let mut truck = with_lift([Some(0.1), None, None]);
        truck.trailer.suspension_pressure = Some(crate::sensor_places::SuspensionPressure {
            gauge_pa: [1e5, 5e5],
            axle_load_kg: [6e3, 24e3],
        });
        let raised = truck.raised().unwrap().unwrap();
        close(raised.accelerometer_positions_m().1, truck.accelerometer_positions_m().1);
        let mass_kg = |one: &Vehicle, pa: f64| {
            let [at_zero_kg, per_pa] = one.align_settings().mass_of_suspension_pressure.unwrap();
            at_zero_kg + per_pa * pa
        };
        // One pressure is two thirds of the axle load, which a longer wheelbase makes of a heavier trailer.
        let [empty_kg, slope] = raised.mass_of_axle_load().unwrap();
        close(mass_kg(&raised, 3e5), empty_kg + slope * 10e3);
        assert!(mass_kg(&raised, 3e5) < mass_kg(&truck, 3e5));
    }

    #[test]
    fn a_trailer_of_three_axles_without_a_lift_axle_is_noted() {
        let is_noted = |vehicle: &Vehicle| {
            let mut all = crate::assumptions::Assumption::of(vehicle).into_iter();
            all.any(|one| {
                one.key == "trailer.axle.lift_m" && one.note.contains("none of the 3 axles")
            })
        };
        assert!(is_noted(&with_lift([None; 3])));
        assert!(!is_noted(&with_lift([Some(0.1), None, None])));
        let two = Vehicle::parse(&template(TruckKind::SixByFourTwoAxle), "truck").unwrap();
        assert!(!is_noted(&two));
    }

    #[test]
    fn a_log_may_say_a_position_that_is_not_given() {
        let truck = with_lift([Some(0.1), None, None]);
        let raised = truck.raised().unwrap();
        for (given, variant, present, other) in [
            (None, Variant::Complete, Some(&truck), raised.as_ref()),
            (Some(LiftAxle::Down), Variant::Complete, Some(&truck), None),
            (Some(LiftAxle::Raised), Variant::Complete, raised.as_ref(), None),
            (None, Variant::AsPrinted, Some(&truck), None),
        ] {
            let found = truck.in_positions(given, variant).unwrap();
            assert_eq!((Some(&found.0), found.1.as_ref()), (present, other), "{given:?} {variant}");
        }
    }

    #[test]
    fn one_axle_must_stay_on_the_road() {
        assert!(with_lift([None; 3]).raised().unwrap().is_none());
        let error = with_lift([Some(0.1); 3]).raised().unwrap_err().to_string();
        assert!(error.contains("one must stay on the road"), "{error}");
        let none = with_lift([None; 3]).with_lift_axle(LiftAxle::Raised).unwrap_err().to_string();
        assert!(none.contains("no lift axle to raise"), "{none}");
        assert_eq!(
            with_lift([None; 3]).with_lift_axle(LiftAxle::Down).unwrap(),
            with_lift([None; 3])
        );
    }
}
