//! The tables of the thesis recomputed.
//!
//! [`table`] recomputes every number of one table with the production code and returns it with the
//! printed number. The input is the baseline vehicle file or, where the thesis itself starts from
//! printed numbers (most of chapter 5), those numbers; the note of the row states which. Recomputed
//! numbers are not stored: the files of `fixtures/thesis` contain only the printed ones.
//!
//! | file | tables |
//! |---|---|
//! | `loads` | static balance: 2.1–2.3, 2.9 |
//! | `transfer` | the linear model: 4.1, 4.2, appendix C |
//! | `compensated`, `step_error` | its compensation and reduction: 5.1–5.3, eqs. 5.12, 5.19 |
//! | `identified` | identification without noise and with one draw of noise: 5.4, 5.5, 5.8 |
//! | `heights` | heights from ratios: 5.6, 5.7, 5.11, eq. 5.17 |
//! | `springs`, `own_springs` | other springs: 5.10, as printed and with this project's plant |
//! | `monte_carlo`, `study`, `bound` | many draws in place of one: 5.9, sections 5.6.1–5.6.3 |
//! | `row`, `printed`, `continuous` | rows, printed digits, conversion of ARX models to `s` |

mod continuous;
mod printed;
mod baseline;
mod monte_carlo;
mod bound;
mod row;
mod loads;
mod solved;
mod own_springs;
mod step_error;
mod transfer;
mod compensated;
mod identified;
mod springs;
mod study;
mod heights;
mod list;

pub use baseline::Options;
pub use list::{table, tables, title};
pub use row::Row;
