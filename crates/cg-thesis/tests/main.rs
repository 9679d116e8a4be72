//! The tests of the studies and of the thesis's tables. They are one program, because to build one for each file
//! takes longer than most of them.

mod accuracy;
mod catalog;
#[path = "../../cg-vehicle/tests/common/mod.rs"]
mod common;
mod coverage;
mod drawn_trucks;
mod in_service;
mod measured_springs;
mod pages;
mod reproduce;
mod s_curves;
mod study;
mod superelevation;
mod tractor_yaw;
mod truck;
mod trucks;
