//! Numbers and small matrices: the floating-point types and recursive least squares.

pub mod real;
mod rows;
pub mod linalg;
#[cfg(feature = "serde")]
mod packed_serde;
#[cfg(test)]
pub(crate) mod white;
