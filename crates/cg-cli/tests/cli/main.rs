//! The command line as its users meet it: the built binary, its exit status, both its streams
//! and the files it leaves.
//!
//! | file | what |
//! |---|---|
//! | `common` | scratch folders, runs, and what every refusal has in common |
//! | `calibrate` | calibrations made, used and refused |
//! | `logs` | logs that are no logs, and logs that hold no answer |
//! | `streams` | lines without end, standard input, closed pipes |
//! | `vehicles` | vehicle files with one mistake each |
//! | `usage` | arguments that make no sense |
//! | `output` | the formats of `cg estimate` |
//! | `design` | designs for firmware |
//! | `files` | what may be written, and what an interrupt leaves |
//! | `model` | `cg model` beside the printed numbers |
//! | `simulate` | logs with known truth, there and back |
//! | `rollover` | every measure with its unit and its meaning |
//! | `reproduce` | the source's tables beside ours |
//! | `run` | recorded drives replayed as if live, restarts, full disks, a service manager |
//! | `study` | chapter 2 as tables and figures |
//! | `memory` | long logs in the memory of short ones |
//! | `left_out` | a build without features, where they are needed (`make package`) |
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

mod calibrate;
mod can;
mod common;
mod consistent;
mod design;
#[cfg(unix)]
mod files;
#[cfg(not(any(feature = "dbc", feature = "parquet", feature = "plots")))]
mod left_out;
mod logs;
mod memory;
mod model;
mod output;
mod reproduce;
mod run;
mod rollover;
mod simulate;
mod streams;
mod study;
mod usage;
mod vehicles;
