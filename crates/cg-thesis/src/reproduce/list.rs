//! All tables by name.

use cg_vehicle::error::VehicleError;

use super::baseline::{Baseline, Options};
use super::row::Row;
use super::{
    by_order, compensated, criteria, heights, histories, identified, inputs, loads, springs, study,
    transfer,
};

type Compute = fn(&'static str, &Baseline, &Options) -> Result<Vec<Row>, VehicleError>;

/// One table, equation or figure.
struct Entry {
    name: &'static str,
    title: &'static str,
    compute: Compute,
}

/// All entries, in the order of the thesis's pages.
const ENTRIES: [Entry; 25] = [
    Entry {
        name: "inputs",
        title: "Tables 2.1 to 2.8: the printed inputs and those of the vehicle files",
        compute: inputs::table,
    },
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
    Entry {
        name: "2.3",
        title: "Figure 2.3: wheel and axle loads at rest",
        compute: loads::trucksim,
    },
    Entry {
        name: "2.4",
        title: "Figure 2.4: deviation from the specified axle loads",
        compute: loads::deviations,
    },
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
        name: "5.8-histories",
        title: "Figure 5.8: the log of section 5.7",
        compute: histories::log,
    },
    Entry {
        name: "5.6.3",
        title: "Sections 5.6.1 to 5.6.3: input rate and noise, as Monte Carlo",
        compute: study::by_rate,
    },
    Entry {
        name: "5.9",
        title: "Table 5.9: heights by order and noise, as Monte Carlo",
        compute: by_order::by_order,
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
        title: "Fig. 4.2 and appendix C: the ten responses to a rounded step",
        compute: histories::steady_values,
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

/// The names of all tables, in the order of the thesis's pages.
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

/// Name of a table in the thesis and its subject.
///
/// # Errors
/// [`VehicleError::UnknownTable`].
pub fn title(name: &str) -> Result<&'static str, VehicleError> {
    Ok(entry(name)?.title)
}

/// Computes one table. Valid names are for example `5.11`, `Table 5.11`, `eq. 5.12`, `Fig. 2.1` and `c`.
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
        return Err(VehicleError::Model("a Monte-Carlo table needs at least one run".to_owned()));
    }
    let rows = (entry.compute)(entry.name, &Baseline::new()?, options)?;
    Ok(rows.into_iter().map(criteria::judged).collect())
}
