//! The vehicle files of the repository, and files that are too large.

use cg_vehicle::Vehicle;
use cg_vehicle::calibration::Calibration;

#[test]
fn the_fixtures_are_usual() {
    for name in crate::check::NAMES {
        let (_, warnings) = Vehicle::load_checked(crate::check::path(name)).unwrap();
        let told: Vec<String> = warnings.iter().map(|warning| warning.in_file(name)).collect();
        assert!(told.is_empty(), "{}", told.join("\n"));
    }
}

/// A file of the greatest size is read, and a file with one byte more is refused.
#[test]
fn a_file_beyond_its_limit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("truck.toml");
    let mut text = crate::check::text("kraz");
    text += &"#".repeat((1 << 20) - text.len());
    std::fs::write(&path, &text).unwrap();
    assert_eq!(Vehicle::load(&path).unwrap().name, "kraz");
    std::fs::write(&path, text + "#").unwrap();
    let error = Vehicle::load(&path).unwrap_err().to_string();
    assert!(error.contains("it has more than the 1 MiB that such a file may have"), "{error}");
}

#[cfg(unix)]
#[test]
fn an_endless_file_is_refused_at_once() {
    let endless = std::path::Path::new("/dev/zero");
    let kraz = Vehicle::load(crate::check::path("kraz")).unwrap();
    for error in [
        Vehicle::load(endless).unwrap_err().to_string(),
        Calibration::load(endless, &kraz).unwrap_err().to_string(),
    ] {
        assert!(error.starts_with("/dev/zero: cannot be read"), "{error}");
        assert!(error.contains("MiB that such a file may have"), "{error}");
    }
}
