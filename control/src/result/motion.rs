//! Figures of a solved extremal, and its values at the nodes.

use crate::options::Verify;
use crate::progress::Iteration;
use crate::result::nodes::Nodes;
use crate::result::verification::Verification;
use crate::result::verify::verification_bound;
use crate::status::{BoundViolation, Status};
use serde::{Deserialize, Serialize};

/// What is known about the second variation, for ends that are fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Certificate {
    /// No conjugate time up to T, of any multiplicity: a strict local minimum among all motions between these
    /// ends in this time.
    ///
    /// Conjugate times are counted over pieces of the motion. A bound on the second variation shows that no
    /// piece holds two of them. The bound uses the Jacobian where the integration of the Jacobi fields
    /// evaluates it, several times in each mesh interval. Two assumptions remain: that y'F_xx - l_xx has no
    /// peak between these points, and `H_yy >= 0`, which [`ends_are_fixed`] promises.
    ///
    /// [`ends_are_fixed`]: crate::BoundaryValueProblem::ends_are_fixed
    LocalMinimum,
    /// A strict local minimum among the motions of its mesh, up to what the barrier of the limits costs.
    ///
    /// Of the direct method: the Newton matrix of the last step, with exact second derivatives and without
    /// damping, is positive definite. It is the Hessian of cost and barrier plus squares of the equations, so
    /// the Hessian is positive definite along all changes that keep them. Ends and times may be free, limits
    /// active. Of a polished motion about which conjugate times say nothing: that of the direct motion it
    /// began with.
    LocalMinimumOnMesh,
    /// A saddle among the motions of its mesh: stationary, but that Hessian has a negative eigenvalue, also
    /// with a small damping, so that a motion nearby on the same mesh costs less, with the barrier of its
    /// limits. Of the direct method, where going on along a direction of negative curvature led to nothing
    /// cheaper. Disturb the guess (`starts`), or begin at another motion.
    SaddleOnMesh,
    /// A conjugate time lies before T: motions nearby cost less.
    NotMinimal,
    /// Not shown: of extremals free ends, controls that reach a bound, a smoothed control, rounding that
    /// hides the answer; of motions of the direct method second derivatives whose smallest eigenvalue is
    /// about zero, or seems to be negative while nothing that costs less is found along its direction;
    /// motions that are not converged or not verified.
    NotChecked,
}

/// Figures of a solved extremal.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Motion {
    /// How the solve ended.
    pub status: Status,
    /// Integral of the running cost without penalties; `c_t T + integral of 1/2 sum r_i u_i^2` for a robot.
    pub cost: f64,
    /// Integral of the penalties.
    pub penalty_cost: f64,
    /// Weight of the smoothing that is left, relative to one that matters; 0 for the problem itself.
    pub smoothing: f64,
    /// By how much the cost may be above that of the problem itself because of the smoothing, relative to it;
    /// of the direct method, 0 without smoothing and of extremals.
    pub smoothing_bound: f64,
    /// T (s); NaN without a motion.
    pub final_time: f64,
    /// `H* = -dJ/dT`: its mean over the nodes and inner points; of the direct method that of the last
    /// phase, whose time T changes where those of vias stay, and of steps with double support, all phases of
    /// which stretch, the mean over their time. With [references](crate::Reference) over time H*
    /// is not constant: then that at the end, the mean of $H^\\ast(t) - \int\_t^T l\_t \\, dt$.
    pub hamiltonian: f64,
    /// H* in each phase of a motion of the direct method: minus the derivative of the least cost on its mesh
    /// by the time of the phase, from the Lagrange function. Phases between which a via has a free time have
    /// the same: a later via would gain in one what it costs in the other.
    pub phase_hamiltonians: Vec<f64>,
    /// `max |H* - mean| / max (|y'f| + |l|)`, the mean that of the phase: zero for an exact solution. Of the
    /// direct method H* is the mean on an interval of the mesh.
    pub hamiltonian_drift: f64,
    /// x at the end when the motion is integrated again from its start with the control that was found;
    /// `None` where the integration stopped, or for a motion that is not converged.
    pub end_state: Option<Vec<f64>>,
    /// What was done to verify the motion: the level of the options, or [`Verify::None`] where there was no
    /// motion to verify, or the search was stopped. Of the direct method also for the best iterate of a
    /// problem that is not solved, if it keeps its limits.
    pub verification: Verify,
    /// How much the equations amplify rounding errors: the largest change of a component at a node, in parts
    /// of its largest value, when the equations of all intervals change by independent errors of size 1;
    /// NaN unless verified by [`Verify::Factors`].
    pub conditioning: f64,
    /// Largest relative mismatch when 20 segments of the motion, costates included, are integrated again from
    /// their starts, or the sum of the mismatches of all intervals of the mesh where that is too large;
    /// infinite where the integration stopped, or for a motion that is not converged. Of the
    /// direct method the sum over 20 parts of the motion, without costates, where it misses its end
    /// integrated once through; infinite where that was not needed.
    pub shooting_defect: f64,
    /// By how much the cost changes on the mesh with halved intervals, relative to it: the error that this
    /// mesh had, not an estimate, less that of the finer one; with what it costs to move limits inside, where
    /// some were moved. NaN unless verified by [`Verify::Full`] with the direct method, for polished motions
    /// and least time with a cost of torques, and where that mesh has too many nodes or is not solved in a
    /// few steps.
    pub finer_mesh: f64,
    /// Sum of slack times multiplier of all limits, relative to the cost: about what the barrier costs at
    /// most. NaN without the direct method.
    pub duality_gap: f64,
    /// Twice what another step of Newton's method promises to gain, relative to the cost: the squared
    /// residual of the optimality conditions in the metric of the inverse Hessian, damped as in the last
    /// step. NaN without the direct method.
    pub newton_decrement: f64,
    /// The residual of stationarity: what is left of the gradient of the Lagrange function by positions,
    /// rates and so on, the largest entry of each joint in parts of the largest sum of magnitudes of its
    /// terms. [`duality_gap`](Self::duality_gap) is that of complementarity, and
    /// [`hamiltonian`](Self::hamiltonian), which is zero for a free time, that by times. NaN without the
    /// direct method.
    pub stationarity: f64,
    /// First conjugate time (s), if there is one up to T.
    pub conjugate_time: Option<f64>,
    /// Number of independent Jacobi fields that vanish at the conjugate time; 0 without one.
    pub conjugate_multiplicity: usize,
    /// What the second variation shows.
    pub certificate: Certificate,
    /// Estimated error of each component of z in the coordinates of the search, relative to its largest
    /// value; of a motion of the direct method that of the cost alone, relative to it.
    pub errors: Vec<f64>,
    /// Newton steps, those of the direct method included.
    pub iterations: Vec<Iteration>,
    /// Times (s) at which a control reaches or leaves a bound.
    pub switches: Vec<f64>,
    /// With [`Status::BoundsNotReached`]: where the motion with the narrowest bounds that could be solved
    /// exceeds the bounds of the problem most.
    pub bound_violation: Option<BoundViolation>,
}

impl Motion {
    /// Figures of a motion that does not exist.
    pub(crate) fn missing(status: Status, final_time: f64) -> Self {
        Self {
            status,
            cost: f64::INFINITY,
            penalty_cost: 0.0,
            smoothing: 0.0,
            smoothing_bound: 0.0,
            final_time,
            hamiltonian: f64::NAN,
            phase_hamiltonians: Vec::new(),
            hamiltonian_drift: f64::INFINITY,
            end_state: None,
            verification: Verify::None,
            conditioning: f64::NAN,
            shooting_defect: f64::INFINITY,
            finer_mesh: f64::NAN,
            duality_gap: f64::NAN,
            newton_decrement: f64::NAN,
            stationarity: f64::NAN,
            conjugate_time: None,
            conjugate_multiplicity: 0,
            certificate: Certificate::NotChecked,
            errors: Vec::new(),
            iterations: Vec::new(),
            switches: Vec::new(),
            bound_violation: None,
        }
    }

    /// Cost and penalties together: what was minimised.
    pub fn total(&self) -> f64 {
        self.cost + self.penalty_cost
    }

    /// Whether it is one of the direct method, not an extremal.
    pub(crate) fn is_direct(&self) -> bool {
        !self.newton_decrement.is_nan()
    }

    /// Largest end defect, relative to the size of each component of x, with which a motion that was solved
    /// to this tolerance counts as verified: `max(100 tolerance, 1e-6)`.
    pub fn verification_bound(tolerance: f64) -> f64 {
        verification_bound(tolerance)
    }
}

/// A solved extremal: its figures, and its values at the nodes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ExtremalSolution {
    /// The figures.
    pub motion: Motion,
    /// The values at the nodes.
    pub nodes: Nodes,
    /// What its verification found; `None` without [`Verify::Full`], or where nothing was solved.
    pub verified: Option<Verification>,
}

impl ExtremalSolution {
    /// Changes the coordinates of all values of z and of the end state; what cannot be mapped becomes
    /// undefined. The polynomial between the nodes belongs to the old coordinates and is dropped when values
    /// change.
    pub(crate) fn map<F: FnMut(&mut [f64]) -> Result<(), costate::EvalError>>(&mut self, mut map: F) {
        let before = self.nodes.z.clone();
        for z in self.nodes.z.iter_mut().chain(&mut self.motion.end_state) {
            if map(z).is_err() {
                z.fill(f64::NAN);
            }
        }
        if self.nodes.z != before {
            self.nodes.interpolant = None;
        }
    }
}
