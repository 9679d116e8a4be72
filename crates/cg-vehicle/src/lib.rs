//! Vehicle files, the linear model of a tractor-semitrailer, its reduction, and log files.

pub mod log;
