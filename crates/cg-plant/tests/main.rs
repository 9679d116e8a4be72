//! The tests of the nonlinear plant, and of the estimator with it. They are one program, because to build one for each file
//! takes longer than most of them.

mod acceleration_channel;
mod articulation;
#[path = "../../cg-logs/tests/common/mod.rs"]
mod common;
mod compensated;
mod drawn;
mod end_to_end;
mod faults;
mod friction;
mod lane_changes;
mod lift_axle;
mod masses;
mod nonlinear;
mod payload_place;
mod prediction;
mod residual;
mod road;
mod road_sensors;
mod roll_rate;
mod rollover;
mod sensors;
mod threshold;
mod tight_turns;
mod truck_in_noise;
mod twisting;
mod two_loads;
mod wind;
mod tyre_slopes;
mod unsteady;
