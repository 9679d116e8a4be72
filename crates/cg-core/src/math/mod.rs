//! Numbers and small matrices: the two floating-point types, packed triangles, Householder reflections.

pub mod real;
pub mod linalg;
