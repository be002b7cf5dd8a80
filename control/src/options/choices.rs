//! What an option may be.

use serde::{Deserialize, Serialize};

/// The matrix of Newton's method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum JacobianRoute {
    /// Exact, with the contracted Hessian y'F_xx.
    #[default]
    Exact,
    /// Central differences of the right-hand side; for comparison.
    Differences,
    /// Exact except for the blocks y'F_xx, which are dropped; for comparison.
    WithoutHessian,
}

/// How the boundary-value problem is discretised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Method {
    /// Collocation at Lobatto points on refined meshes.
    Collocation,
    /// Multiple shooting: adaptive integration from node to node, with the variational equations.
    Shooting,
    /// The direct method: motions as piecewise polynomials, torques from inverse dynamics, an interior-point
    /// method. The only one that keeps the [limits](crate::MotionLimits) of a problem. For robots: problems
    /// of other models are solved by collocation. [`direct_method`](crate::direct_method) has its formulas
    /// and their sources.
    #[default]
    Direct,
}

/// Whether the motion of the direct method becomes the first guess of an extremal, for problems in which
/// nothing but controls is at its limits. [`Solution::polish`](crate::Solution::polish) says which of the two
/// is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Polish {
    /// Where it applies, for at most ten times the work of the direct method: Newton steps times nodes, which
    /// is the same on all machines.
    #[default]
    Auto,
    /// Where it applies.
    Always,
    /// Not at all.
    Never,
}

/// How a solution that was found is verified. The equations are solved and the error is estimated at every
/// level; the levels differ in what is done afterwards, and [`Motion::verification`] says what that was.
///
/// [`Motion::verification`]: crate::Motion::verification
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Verify {
    /// Not at all: what was found has the status [`Status::NotVerified`](crate::Status::NotVerified).
    None,
    /// By what solving has computed. Of collocation and shooting: the estimated error, and the rounding
    /// errors that the factored matrix makes of those of the equations
    /// ([`Motion::conditioning`](crate::Motion::conditioning)), are both below the tolerance. Of the
    /// direct method: the estimated error of the cost, all limits, and what they cut off torques between
    /// points. Nothing is integrated, so there are no end defect, shooting defect and conjugate times.
    Factors,
    /// An adaptive integrator repeats the motion from its start with the control that was found, and looks
    /// for conjugate times. The direct method solves once more on halved intervals
    /// ([`Motion::finer_mesh`](crate::Motion::finer_mesh)).
    #[default]
    Full,
}

/// Which attempts a search makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Strategy {
    /// Newton's method from the motion that the direct method finds; from cubics, if that fails; by
    /// continuation from relaxed problems, if both fail.
    #[default]
    Full,
    /// Newton's method from cubics alone; for comparison.
    Direct,
}

/// When the direct method compiles the dynamics of the robot to machine code (feature `jit`, x86-64 with
/// AVX2).
///
/// Machine code takes a fifth to a tenth of the time of the generic code, and some milliseconds to make for a
/// robot of six joints. It is kept for the last four robots. Results differ by rounding. Robots of more than
/// 14 joints, and very long programs, are left to the generic code, and so is all on processors without AVX2
/// or FMA and on other architectures, in the lanes of vectors where these have any. Robots with
/// [constraints](crate::Problem) are always evaluated by the generic code, one point after the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum MachineCode {
    /// After as many evaluations by the generic code as show that it will pay.
    #[default]
    Later,
    /// Before the first evaluation: for many problems of one robot.
    AtOnce,
    /// Never.
    Never,
}
