//! The tests of the core. They are one program, because to build one for each file
//! takes longer than most of them.

mod alignment;
mod arx;
mod combined;
mod common;
mod conditioning;
mod design;
mod door;
mod filtered;
mod judgment;
mod layers;
mod maneuvers;
mod monte_carlo;
mod oracle;
mod properties;
mod road;
mod signals;
mod spread;
