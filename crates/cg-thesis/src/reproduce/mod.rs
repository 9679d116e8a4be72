//! The source's tables beside ours.
//!
//! [`table`] computes every number of one table anew, with the code that serves the product, and
//! sets it beside the printed one. Inputs are the baseline vehicle file, or, where the source
//! itself starts from printed numbers (most of chapter 5), those; the row's note says which.
//! Nothing of ours is stored: the files of `fixtures/thesis` hold the printed side only.
//!
//! | file | tables |
//! |---|---|
//! | `loads` | static balance: 2.1–2.3, 2.9 |
//! | `transfer` | the linear model: 4.1, 4.2, appendix C |
//! | `compensated`, `step_error` | its compensation and reduction: 5.1–5.3, eqs. 5.12, 5.19 |
//! | `identified` | identification without noise and with one draw of it: 5.4, 5.5, 5.8 |
//! | `heights` | heights from ratios: 5.6, 5.7, 5.11, eq. 5.17 |
//! | `springs`, `own_springs` | other springs: 5.10, printed and in a plant of our own |
//! | `monte_carlo`, `study`, `bound` | many draws in place of one: 5.9, sections 5.6.1–5.6.3 |
//! | `row`, `printed`, `continuous` | what a row is, printed digits, ARX to `s` |

mod bound;
mod compensated;
mod continuous;
mod heights;
mod identified;
mod loads;
mod monte_carlo;
mod own_springs;
mod printed;
mod row;
mod springs;
mod step_error;
mod study;
mod transfer;

use cg_core::RatioLine;
use serde::Deserialize;

use cg_vehicle::error::VehicleError;
use cg_vehicle::linear::{LinearModel, Variant};
use cg_vehicle::vehicle::Vehicle;
use printed::{Printed, thesis};

pub use row::Row;

/// Metres in an inch, the source's unit of height.
const METRES_PER_INCH: f64 = 0.0254;

/// How [`table`] computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Draws of the noise in each cell of a Monte-Carlo table.
    pub runs: u32,
    /// Seed of the first draw.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { runs: 1000, seed: 1 }
    }
}

type Compute = fn(&'static str, &Baseline, &Options) -> Result<Vec<Row>, VehicleError>;

/// One table, equation or figure.
struct Entry {
    name: &'static str,
    title: &'static str,
    compute: Compute,
}

/// In the order of the source's pages.
const ENTRIES: [Entry; 22] = [
    Entry {
        name: "2.1",
        title: "Figure 2.1: static balance of the tractor",
        compute: loads::tractor,
    },
    Entry {
        name: "2.2",
        title: "Figure 2.2: static balance of the semitrailer",
        compute: loads::trailer,
    },
    Entry { name: "2.3", title: "Figure 2.3: axle loads of TruckSim", compute: loads::trucksim },
    Entry {
        name: "2.9",
        title: "Table 2.9: static balance with air suspension",
        compute: loads::air,
    },
    Entry {
        name: "4.1",
        title: "Table 4.1: coefficients of the transfer function",
        compute: transfer::coefficients,
    },
    Entry { name: "4.2", title: "Table 4.2: poles, zeros and gain", compute: transfer::roots },
    Entry {
        name: "5.1",
        title: "Table 5.1: compensation functions",
        compute: compensated::functions,
    },
    Entry {
        name: "5.2",
        title: "Table 5.2: the compensated transfer function",
        compute: compensated::product,
    },
    Entry { name: "5.3", title: "Table 5.3: its reductions", compute: compensated::reductions },
    Entry {
        name: "5.12",
        title: "Eq. 5.12: the reduced transfer function",
        compute: compensated::equation_5_12,
    },
    Entry {
        name: "5.4",
        title: "Table 5.4: identification under steps of different rate",
        compute: identified::by_rate,
    },
    Entry { name: "5.5", title: "Table 5.5: their DC ratios", compute: identified::ratios },
    Entry {
        name: "5.17",
        title: "Eq. 5.17: the DC ratio over height",
        compute: heights::ratio_line,
    },
    Entry {
        name: "5.19",
        title: "Eq. 5.19: the compensation",
        compute: compensated::equation_5_19,
    },
    Entry { name: "5.6", title: "Table 5.6: heights without noise", compute: heights::by_rate },
    Entry { name: "5.7", title: "Table 5.7: heights with noise", compute: heights::by_noise },
    Entry {
        name: "5.8",
        title: "Table 5.8: identification with noise",
        compute: identified::by_noise,
    },
    Entry {
        name: "5.6.3",
        title: "Sections 5.6.1 to 5.6.3: input rate and noise, as Monte-Carlo",
        compute: study::by_rate,
    },
    Entry {
        name: "5.9",
        title: "Table 5.9: heights by order and noise, as Monte-Carlo",
        compute: study::by_order,
    },
    Entry {
        name: "5.10",
        title: "Table 5.10: heights with other springs",
        compute: springs::table,
    },
    Entry {
        name: "5.11",
        title: "Table 5.11: heights other than the baseline's",
        compute: heights::over_range,
    },
    Entry {
        name: "C",
        title: "Appendix C: steady values of all responses",
        compute: transfer::steady_values,
    },
];

const NAMES: [&str; ENTRIES.len()] = {
    let mut names = [""; ENTRIES.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = ENTRIES[i].name;
        i += 1;
    }
    names
};

/// The names of all tables, in the order of the source's pages.
pub fn tables() -> &'static [&'static str] {
    &NAMES
}

fn entry(name: &str) -> Result<&'static Entry, VehicleError> {
    let asked = name.trim().to_lowercase();
    let bare = ["table", "figure", "fig.", "fig", "equation", "eq.", "eq", "section", "appendix"]
        .iter()
        .find_map(|prefix| asked.strip_prefix(prefix))
        .unwrap_or(&asked)
        .trim()
        .trim_matches(['(', ')']);
    let bare = if matches!(bare, "5.6.1" | "5.6.2") { "5.6.3" } else { bare };
    ENTRIES.iter().find(|entry| entry.name.eq_ignore_ascii_case(bare)).ok_or_else(|| {
        VehicleError::UnknownTable { name: name.to_owned(), known: NAMES.join(", ") }
    })
}

/// What a table is called in the source and what it is about.
///
/// # Errors
/// [`VehicleError::UnknownTable`].
pub fn title(name: &str) -> Result<&'static str, VehicleError> {
    Ok(entry(name)?.title)
}

/// Computes one table; `5.11`, `Table 5.11`, `eq. 5.12`, `Fig. 2.1` and `c` are all names.
///
/// ```
/// use cg_thesis::reproduce::{Options, table};
///
/// let rows = table("eq. 5.19", &Options::default())?;
/// assert!(rows[0].relative_error.unwrap().abs() < 1e-4);
/// # Ok::<(), cg_vehicle::VehicleError>(())
/// ```
///
/// # Errors
/// [`VehicleError::UnknownTable`]; [`VehicleError::Model`] if there are no runs.
pub fn table(name: &str, options: &Options) -> Result<Vec<Row>, VehicleError> {
    let entry = entry(name)?;
    if options.runs == 0 {
        return Err(VehicleError::Model("a Monte-Carlo table needs one run at least".to_owned()));
    }
    (entry.compute)(entry.name, &Baseline::new()?, options)
}

/// What the tables start from.
struct Baseline {
    vehicle: Vehicle,
    /// Appendix B at the reference load and speed.
    as_printed: LinearModel,
    /// The same vehicle with all terms.
    complete: LinearModel,
    /// Eq. 5.17 as printed.
    printed_line: RatioLine<f64>,
    equation_5_17: Equation517,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Equation517 {
    a0: Printed,
    a1: Printed,
    b0: Printed,
    b1: Printed,
    true_height_in: Printed,
}

impl Baseline {
    fn new() -> Result<Self, VehicleError> {
        let text = include_str!("../../fixtures/vehicles/baseline.toml");
        let vehicle = Vehicle::parse(text, "fixtures/vehicles/baseline.toml")?;
        let model = |variant| {
            LinearModel::new(&vehicle, variant, vehicle.nominal_speed_mps, vehicle.reference_load())
        };
        let (as_printed, complete) = (model(Variant::AsPrinted)?, model(Variant::Complete)?);
        let line: Equation517 = thesis!("equation_5_17.toml")?;
        let printed_line = RatioLine {
            a0: line.a0.value,
            a1: line.a1.value,
            b0: line.b0.value,
            b1: line.b1.value,
        };
        Ok(Self { vehicle, as_printed, complete, printed_line, equation_5_17: line })
    }

    /// The height of the baseline's trailer, inches.
    fn true_height_in(&self) -> f64 {
        self.equation_5_17.true_height_in.value
    }
}
