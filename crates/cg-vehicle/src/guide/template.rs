//! Commented vehicle files with typical values, one for each kind of truck.
//!
//! `templates` contains the values; the comments come from the table of keys. The values are round
//! numbers that belong together, not those of one product. Masses and lengths are those of trucks
//! at their legal weight; for measured springs, tires and roll centers see Fancher, Ervin, Winkler
//! and Gillespie, *A factbook of the mechanical properties of the components for single-unit and
//! articulated heavy trucks*, UMTRI-86-12.

use super::tree;
use crate::check::{self, Key};

/// A kind of truck for which there is a template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TruckKind {
    /// Two-axle tractor, three-axle semitrailer.
    FourByTwoThreeAxle,
    /// Three-axle tractor, two-axle semitrailer.
    SixByFourTwoAxle,
    /// Three-axle tractor, three-axle semitrailer.
    SixByFourThreeAxle,
}

cg_core::words!(TruckKind {
    FourByTwoThreeAxle => "4x2-3axle",
        "Two-axle tractor and three-axle semitrailer on air springs, 40 t, as in Europe";
    SixByFourTwoAxle => "6x4-2axle",
        "Three-axle tractor and two-axle semitrailer on air springs, 36 t, as in North America";
    SixByFourThreeAxle => "6x4-3axle",
        "Three-axle tractor and three-axle semitrailer on leaf springs, 44 t";
});

impl TruckKind {
    /// The file without its comments.
    fn values(self) -> &'static str {
        match self {
            Self::FourByTwoThreeAxle => include_str!("templates/4x2-3axle.toml"),
            Self::SixByFourTwoAxle => include_str!("templates/6x4-2axle.toml"),
            Self::SixByFourThreeAxle => include_str!("templates/6x4-3axle.toml"),
        }
    }
}

/// The first lines of every template.
const HEAD: &str = "\
# Vehicle file with typical values, to be replaced by those of your truck. docs/vehicle.md explains
# every key and has a drawing; `cg vehicle check FILE` says which numbers matter most.
#
# Known from papers, a weighbridge and a tape measure: masses, positions of axles and fifth wheel,
# tires, the dimensions of the payload. Springs, roll centers and inertias may stay as they are:
# [uncertainty] says how well they are known, and a calibration improves them.
#
# SI units. Heights are above the ground at rest under the reference load. Other positions are
# distances from the point that the key names. A line that begins with # and a key is optional:
# remove the # to use it.

";

/// A commented vehicle file with typical values.
///
/// ```
/// use cg_vehicle::Vehicle;
/// use cg_vehicle::guide::{TruckKind, template};
///
/// let text = template(TruckKind::FourByTwoThreeAxle);
/// let (vehicle, findings) = Vehicle::check(&text, "truck.toml")?;
/// assert!(vehicle.axles().len() == 5 && findings.is_empty());
/// # Ok::<(), cg_vehicle::VehicleError>(())
/// ```
pub fn template(kind: TruckKind) -> String {
    HEAD.to_owned() + &commented(kind.values())
}

/// The file with a comment before the first occurrence of every table and key.
fn commented(values: &str) -> String {
    let mut text = String::new();
    let mut path = String::new();
    let mut told: Vec<String> = Vec::new();
    let mut tell = |place: &str, comment: &dyn Fn() -> String, text: &mut String| {
        if !told.iter().any(|known| known == place) {
            text.extend(["# ", &comment(), "\n"]);
            told.push(place.to_owned());
        }
    };
    for line in values.lines() {
        let bare = line.trim_start_matches('#');
        if let Some(table) = bare.strip_prefix('[') {
            path = path_of(table);
            tell(&path, &|| capital(tree::meaning(&path)), &mut text);
        } else if let Some((name, _)) = bare.split_once(" = ") {
            let place = tree::within(&path, name);
            if let Some(key) = check::key(&place) {
                tell(&place, &|| comment(key), &mut text);
            }
        }
        text.extend([line, "\n"]);
    }
    text
}

/// The path of a table, from what follows the first bracket of its header.
fn path_of(header: &str) -> String {
    let name = header.trim_matches(['[', ']']);
    let list = if header.starts_with('[') { "[i]" } else { "" };
    // The tables of a tire are in the last tire.
    let name = name.strip_prefix("tyre.").map_or(name.to_owned(), |part| format!("tyre[i].{part}"));
    name + list
}

fn comment(key: &Key) -> String {
    match key.range() {
        Some(range) => {
            let unit = if key.unit.is_empty() { "" } else { ", " };
            let usual = range.usual_in("");
            format!("{}{unit}{} (usual: {usual})", capital(key.meaning), key.unit)
        }
        None => capital(key.meaning),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A file with every optional key of a template.
pub(super) fn everything() -> String {
    let values = TruckKind::SixByFourThreeAxle.values();
    values.lines().flat_map(|line| [line.trim_start_matches('#'), "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::Vehicle;

    /// The page takes the values of absent keys from it.
    #[test]
    fn the_file_with_every_key_can_be_read() {
        Vehicle::parse(&everything(), "everything").unwrap();
    }
}
