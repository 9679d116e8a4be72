//! The tests of the vehicle model. They are one program, because to build one for each file
//! takes longer than most of them.

mod check;
mod common;
mod design;
mod eigen;
mod guide;
mod in_band;
mod linear;
mod place;
mod reduction;
mod steady_turn;
mod twisting;
