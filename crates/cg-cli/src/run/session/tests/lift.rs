//! An axle that is raised while the truck drives.

use super::*;
use cg_logs::estimate::Truck;

/// The wall clock may be set, by years after a start without a battery; that an axle has moved is a matter of a second.
#[test]
fn a_clock_that_is_set_moves_no_axle() {
    let mut session = session(None, 0.0);
    let raised = Truck::new(&truck(), &design(), EstimateOptions::default());
    session.lift = Lift::new(None, Some(raised));
    learn(&mut session, [Some(2.0), Some(2.0)]);
    let mut moves = |offset_s: f64, tenths: u32, value: f64| {
        let stamp_s = offset_s + 0.1 * f64::from(tenths);
        session.tick(stamp_s, u64::from(tenths) * SECOND_US / 10);
        session.follow_lift_axle(value).unwrap();
        names(&mut session).contains(&"load_changed".to_owned())
    };
    assert!(!moves(0.0, 980, 0.0) && !moves(0.0, 990, 0.0) && !moves(0.0, 1000, 1.0));
    assert!(!moves(3e7, 1005, f64::NAN), "set forward");
    assert!(!moves(-3e7, 1009, f64::NAN), "set backward");
    assert!(moves(-3e7, 1011, f64::NAN));
}
