//! How a problem is solved, and what is told meanwhile.

use crate::problem::error::ProblemError;
pub use costate::Coordinates;
use serde::{Deserialize, Serialize};

/// The matrix of Newton's method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JacobianRoute {
    /// Exact, with the contracted Hessian y'F_xx.
    #[default]
    Exact,
    /// Central differences of the right-hand side; for comparison.
    Differences,
    /// Exact but for the blocks y'F_xx, which are left out; for comparison.
    WithoutHessian,
}

/// How motions between nodes are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Polynomials that satisfy the equations at Lobatto's points, on meshes that are refined.
    #[default]
    Collocation,
    /// Integration from node to node by an adaptive integrator, together with the variational equations.
    Shooting,
}

/// What is tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ways {
    /// Newton's method from the guess, then from a path of low cost where that fails or costs more, then all ways by easier
    /// problems where both fail.
    #[default]
    All,
    /// Newton's method from the guess on finer and finer meshes, and nothing else; for comparison.
    Direct,
}

/// How to solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SolverOptions {
    /// Largest estimated error of a component, in parts of the largest value that it takes along the motion.
    pub tolerance: f64,
    /// How motions between nodes are found.
    pub method: Method,
    /// Nodes of the first mesh; of all in multiple shooting.
    pub nodes: usize,
    /// Most nodes.
    pub max_nodes: usize,
    /// Most Newton steps on one mesh.
    pub max_iterations: usize,
    /// The matrix of Newton's method.
    pub jacobian: JacobianRoute,
    /// The coordinates of z.
    pub coordinates: Coordinates,
    /// What is tried.
    pub ways: Ways,
    /// Points of Lobatto's quadrature in an interval: 3 (fourth order) or 4 (sixth).
    pub points: usize,
    /// Number of guesses tried: the first as said in [`Solver`](crate::Solver), the others disturbed at random.
    pub starts: usize,
    /// Seed of the disturbances.
    pub seed: u64,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            tolerance: 1e-9,
            method: Method::Collocation,
            nodes: 21,
            max_nodes: 6001,
            max_iterations: 60,
            jacobian: JacobianRoute::Exact,
            coordinates: Coordinates::Hamiltonian,
            ways: Ways::All,
            points: 4,
            starts: 1,
            seed: 0,
        }
    }
}

impl SolverOptions {
    /// Whether all are in range.
    ///
    /// # Errors
    /// [`ProblemError::BadOption`].
    pub fn check(&self) -> Result<(), ProblemError> {
        let bad = |key, value, remedy| Err(ProblemError::BadOption { key, value, remedy });
        if !(1e-13..=0.1).contains(&self.tolerance) {
            return bad("tolerance", self.tolerance, "must be between 1e-13 and 0.1");
        }
        if self.nodes < 3 {
            return bad("nodes", self.nodes as f64, "must be 3 or more");
        }
        if self.max_nodes < self.nodes {
            return bad(
                "nodes",
                self.nodes as f64,
                "must not be more than max_nodes, 6001 unless set from Rust",
            );
        }
        if self.max_iterations == 0 {
            return bad("max_iterations", 0.0, "must be 1 or more");
        }
        if !(3..=4).contains(&self.points) {
            return bad("points", self.points as f64, "must be 3 or 4");
        }
        if self.starts == 0 {
            return bad("starts", 0.0, "must be 1 or more");
        }
        Ok(())
    }
}

/// One Newton step, on the extremal or on the way down to the path that it is looked for from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// What was being solved: "fixed time", "free time", "from path", "without limits", "nearer end", "penalties", "bounds",
    /// "smoothing", "switches", "continuation"; "path" on the way down to a path of low cost.
    pub phase: String,
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Number of the step on this mesh, from 1.
    pub number: usize,
    /// Length of the full correction, in parts of the size of the components (root mean square); of a path, the part
    /// of the cost that was gained.
    pub residual: f64,
    /// Damping: the part of the correction that was taken; of a path, 1 / (1 + damping of Levenberg and Marquardt).
    pub step: f64,
    /// T (s).
    pub final_time: f64,
    /// Cost so far, penalties included.
    pub cost: f64,
}
