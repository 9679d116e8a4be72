//! The tables of the thesis recomputed.
//!
//! [`table`] recomputes every number of one table with the production code and returns it with the
//! printed number. The input is the baseline vehicle file or, where the thesis itself starts from
//! printed numbers (most of chapter 5), those numbers; the note of the row states which. Recomputed
//! numbers are not stored: the files of `fixtures/thesis` contain only the printed ones.
//!
//! | file | tables |
//! |---|---|
//! | `inputs` | the vehicle's inputs: Tables 2.1–2.8 |
//! | `loads` | static balance and loads at rest: Figs. 2.1–2.4, Table 2.9 |
//! | `transfer` | the linear model: 4.1, 4.2 |
//! | `histories` | the ten responses as time histories: Fig. 4.2, appendix C; Fig. 5.8 |
//! | `compensated`, `step_error` | its compensation and reduction: 5.1–5.3, eqs. 5.12, 5.19 |
//! | `identified` | identification without noise and with one draw of noise: 5.4, 5.5, 5.8 |
//! | `heights` | heights from ratios: 5.6, 5.7, 5.11, eq. 5.17 |
//! | `springs` | other springs: 5.10 |
//! | `nonlinear` | section 5.7's data: logs of this project's nonlinear plant, both procedures |
//! | `monte_carlo`, `study`, `by_order`, `bound` | many draws in place of one: 5.9, sections 5.6.1–5.6.3 |
//! | `figures` | the figures and insets that belong to the tables |
//! | `criteria` | how far a recomputed number may be from the printed one, and why |
//! | `row`, `printed`, `continuous` | rows, printed digits, conversion of ARX models to `s` |

mod continuous;
mod printed;
mod baseline;
mod monte_carlo;
mod bound;
mod row;
mod solved;
mod nonlinear;
mod histories;
mod loads;
mod step_error;
mod transfer;
mod inputs;
mod compensated;
mod identified;
mod springs;
mod study;
mod by_order;
mod heights;
mod criteria;
mod list;
mod figures;

pub use baseline::Options;
pub use figures::{figure_names, figures};
pub use list::{table, tables, title};
pub use row::Row;
