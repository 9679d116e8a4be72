//! Tests of the command line with the built binary: exit status, both output streams and files.
//!
//! | file | what |
//! |---|---|
//! | `common` | temporary folders, runs of the binary, and common checks of errors |
//! | `calibrate` | calibrations that are written, used and refused |
//! | `can` | CAN logs: candump formats, several buses, masses, slow or missing signals |
//! | `consistent` | channels that contradict each other |
//! | `faults` | faults of trucks in service, each with a message |
//! | `logs` | files that are not logs, and logs without a result |
//! | `sources` | options for frames: an address that nobody sends, and options that no log can use |
//! | `state` | the state file: unreadable, shared by two programs, and when standard output fails |
//! | `stopping` | `cg run` ends in order: signals while its input stalls, damaged logs |
//! | `streams` | endless lines, standard input, closed pipes |
//! | `wind` | a side wind on the body that the vehicle file describes |
//! | `vehicles` | vehicle files with one mistake each |
//! | `new_truck` | `cg vehicle`: from a new vehicle file to a height |
//! | `usage` | wrong arguments |
//! | `output` | the formats of `cg estimate` |
//! | `design` | designs for firmware |
//! | `gateway` | signals of the trailer that a gateway repeats, by a DBC file |
//! | `files` | which files may be written, and what an interrupt leaves |
//! | `model` | `cg model` compared with the printed numbers |
//! | `simulate` | logs with known truth |
//! | `rollover` | every measure with its unit and its meaning |
//! | `reproduce` | the thesis's tables with recomputed values |
//! | `learn` | a truck that learns itself from empty driving |
//! | `replay` | replays of compressed logs, of negative time stamps, and over long gaps |
//! | `run` | replays of recorded drives, restarts, full disks, a service manager |
//! | `serve` | the live page over real connections, slow ones among them |
//! | `study` | chapter 2 as tables and figures |
//! | `memory` | long logs need no more memory than short ones |
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

mod calibrate;
mod can;
mod common;
mod consistent;
mod design;
mod empty;
mod faults;
mod gateway;
#[cfg(unix)]
mod files;
mod learn;
mod lift;
mod logs;
mod lost_inputs;
mod memory;
mod model;
mod new_truck;
mod output;
mod reproduce;
#[cfg(unix)]
mod preparation;
mod replay;
mod run;
mod rollover;
#[cfg(unix)]
mod serve;
mod simulate;
mod sources;
#[cfg(target_os = "linux")]
mod state;
#[cfg(target_os = "linux")]
mod stopping;
mod streams;
mod study;

mod usage;
mod vehicles;
mod wind;
