//! The tests of the library for C.

mod c;
mod common;
mod same;
