//! The functions of FMI 3.0, which call [`cg_fmu::Instance`].
//!
//! | file | what |
//! |---|---|
//! | `types` | the types of the headers |
//! | `component` | what an instance of C points to: the instance and its logger |
//! | `life` | functions that make an instance, lead it through its life, and free it |
//! | `values` | functions that read and set variables |
//! | `state` | functions that keep a state and return to it |
//! | `absent` | functions of what these FMUs do not have; they fail and say so |
//!
//! Pointers come from C, so this crate has `unsafe`. A null pointer where there must be none is reported; for
//! the rest the caller keeps the rules of FMI: a pointer that is not null points to what its type says,
//! texts end with a zero, and no two threads use an instance at the same time.
#![allow(unsafe_code)] // pointers from C
#![allow(non_snake_case)] // names of FMI
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod types;
mod component;
pub mod life;
pub mod values;
pub mod state;
pub mod absent;
