//! The vehicle files of the repository.

use cg_vehicle::Vehicle;

#[test]
fn the_fixtures_are_usual() {
    for name in crate::NAMES {
        let (_, warnings) = Vehicle::load_checked(crate::path(name)).unwrap();
        let told: Vec<String> = warnings.iter().map(|warning| warning.in_file(name)).collect();
        assert!(told.is_empty(), "{}", told.join("\n"));
    }
}
