//! The thesis's tables beside ours.
//!
//! [`table`] computes every number of one table anew, with the code that serves the product, and
//! sets it beside the printed one. Inputs are the baseline vehicle file, or, where the thesis
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
