//! The tests of logs, their estimates and their calibration. They are one program, because to build one for each file
//! takes longer than most of them.

mod banked_roads;
mod calibration;
mod calibration_file;
mod can;
mod columns;
mod common;
mod faulty_runs;
mod fuzz_seeds;
mod independent_truck;
mod key_on;
mod learn;
mod log;
mod mass_in_turns;
mod shapes;
mod short_turns;
mod slow_turns;
mod spikes;
mod twisting_frame;
mod uncertain_runs;
mod unsteady_turns;
