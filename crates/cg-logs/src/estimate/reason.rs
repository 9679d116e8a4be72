//! Why a maneuver has no height, with what the design says about it.

use cg_core::{Design, HeightError, Reject};

/// The reason in words. What is outside the design is named with the range.
pub(super) fn reason(design: &Design<f64>, reject: &Reject<f64>) -> String {
    if let Reject::Height(HeightError::OutOfRange { .. }) = reject {
        let (least_m, greatest_m) = (design.least_height_m, design.greatest_height_m);
        return format!(
            "{reject} ({least_m:.2} to {greatest_m:.2} m by [height] in the vehicle file)"
        );
    }
    let &Reject::OutsideDesign { speed_mps, trailer_mass_kg } = reject else {
        return reject.to_string();
    };
    let outside = |name: &str, value: f64, axis: &[f64], digits: usize, unit: &str| {
        let (least, greatest) = (*axis.first()?, *axis.last()?);
        (value < least || value > greatest).then(|| {
            format!(
                "{name} {value:.digits$} {unit} is outside the design ({least:.digits$} to \
                 {greatest:.digits$} {unit})"
            )
        })
    };
    let speed = outside("speed", speed_mps, &design.speed_mps, 1, "m/s");
    let mass = outside("trailer mass", trailer_mass_kg, &design.trailer_mass_kg, 0, "kg");
    match (speed, mass) {
        (None, None) => reject.to_string(),
        (speed, mass) => speed.into_iter().chain(mass).collect::<Vec<_>>().join(", and "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::trial::design;

    #[test]
    fn what_is_outside_the_design_is_named_with_its_range() {
        let design = design();
        let of = |speed_mps, trailer_mass_kg| {
            reason(&design, &Reject::OutsideDesign { speed_mps, trailer_mass_kg })
        };
        let (usual_mps, usual_kg) = (design.nominal_speed_mps, design.nominal_trailer_mass_kg);
        let mass = of(usual_mps, 90e3);
        assert!(mass.starts_with("trailer mass 90000 kg is outside the design ("), "{mass}");
        let greatest_kg = design.trailer_mass_kg.last().unwrap();
        assert!(mass.ends_with(&format!(" to {greatest_kg:.0} kg)")) && !mass.contains("speed"));
        let speed = of(55.0, usual_kg);
        assert!(speed.starts_with("speed 55.0 m/s is outside the design ("), "{speed}");
        assert!(!speed.contains("mass"), "{speed}");
        let height = reason(&design, &Reject::Height(HeightError::OutOfRange { height_m: 0.5 }));
        let range = format!("({:.2} to {:.2} m", design.least_height_m, design.greatest_height_m);
        assert!(height.starts_with("height 0.50 m is") && height.contains(&range), "{height}");
        assert!(of(55.0, 90e3).contains("m/s), and trailer mass 90000 kg"));
        assert_eq!(reason(&design, &Reject::Absent), Reject::<f64>::Absent.to_string());
    }
}
