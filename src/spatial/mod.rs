//! Rigid-body algebra over any scalar: vectors, inertias, transforms between joint frames.
//!
//! Body frames with the joint axis along z: a joint motion vector is `(e_z; 0)` or `(0; e_z)`, so products
//! with it are components, not multiplications.

mod inertia;
mod motion;
mod quaternion;
mod screw;
mod transform;
#[cfg(test)]
mod transform_tests;
mod turn;
mod vector;

pub use inertia::{ConstantInertia, Inertia, Symmetric3};
pub use motion::{Force, Motion};
pub use quaternion::{Quaternion, Rotation};
pub use screw::FixedScrew;
pub use transform::{JointPosition, Transform};
pub use turn::{FixedTurn, Turn};
pub use vector::Vec3;
