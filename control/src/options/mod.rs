//! Options of a solver.

mod choices;

use crate::problem::error::ProblemError;
pub use choices::{JacobianRoute, MachineCode, Method, Polish, Strategy, Verify};
pub use costate::Coordinates;
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::time::Duration;

/// How to solve a problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[non_exhaustive]
pub struct SolverOptions {
    /// Of the direct method the largest estimated error of the cost, relative to it, 1e-4 by default. Of the
    /// others that of a component, relative to the largest value that it takes along the motion, 1e-6 by
    /// default.
    pub tolerance: f64,
    /// How the boundary-value problem is discretised.
    pub method: Method,
    /// Nodes of the first mesh; of every mesh in multiple shooting.
    pub nodes: usize,
    /// Most nodes. Least time by the direct method takes fewer, and tries a cost of torques that becomes
    /// smaller, before it takes these.
    pub max_nodes: usize,
    /// Most Newton steps on one mesh.
    pub max_iterations: usize,
    /// The matrix of Newton's method.
    pub jacobian: JacobianRoute,
    /// The coordinates of z.
    pub coordinates: Coordinates,
    /// Which attempts are made.
    pub strategy: Strategy,
    /// How a solution is verified.
    pub verify: Verify,
    /// Whether the motion of the direct method is polished.
    pub polish: Polish,
    /// Lobatto points in an interval: 3 (order 4) or 4 (order 6).
    pub points: usize,
    /// Number of starts, each solved to the end: the first from the guess that [`Solver`](crate::Solver)
    /// describes, the others from random disturbances of it. `None`: one, and the direct method chooses its
    /// guess among several that it looks at on a coarse mesh ([`StartResult::looks`]).
    ///
    /// [`StartResult::looks`]: crate::StartResult#structfield.looks
    pub starts: Option<usize>,
    /// Threads for several starts; by default as many as the processor runs at once. Results do not depend on
    /// it.
    pub threads: Option<usize>,
    /// When the dynamics are compiled, in the direct method.
    pub machine_code: MachineCode,
    /// Seed of the disturbances.
    pub seed: u64,
    /// Longest time that solving may take, all starts together; it is checked before each Newton step, before
    /// each point of a continuation, and during verifications. The best iterate is kept, with
    /// [`Status::TimeLimit`](crate::Status::TimeLimit). In files in seconds.
    #[serde(with = "seconds")]
    pub time_limit: Option<Duration>,
}

/// An optional duration as a number of seconds.
mod seconds {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::time::Duration;

    pub fn serialize<S: Serializer>(limit: &Option<Duration>, serializer: S) -> Result<S::Ok, S::Error> {
        limit.map(|limit| limit.as_secs_f64()).serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Duration>, D::Error> {
        let limit = Option::<f64>::deserialize(deserializer)?;
        limit.map(Duration::try_from_secs_f64).transpose().map_err(serde::de::Error::custom)
    }
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            tolerance: TOLERANCE,
            method: Method::Direct,
            nodes: 21,
            max_nodes: 6001,
            max_iterations: 200,
            jacobian: JacobianRoute::Exact,
            coordinates: Coordinates::Hamiltonian,
            strategy: Strategy::Full,
            verify: Verify::Full,
            polish: Polish::Auto,
            points: 4,
            starts: None,
            threads: None,
            machine_code: MachineCode::Later,
            seed: 0,
            time_limit: None,
        }
    }
}

/// Default tolerance of the direct method. Limits are kept between the points to the same part of their
/// ranges ([`direct_method`](crate::direct_method)); a tighter one refines around jumps that change the cost
/// by less than any robot repeats it.
const TOLERANCE: f64 = 1e-4;
/// That of the others, whose error falls with a high power of the number of nodes.
const TOLERANCE_OF_EXTREMALS: f64 = 1e-6;

impl SolverOptions {
    /// The default options of a method. The direct one takes more and cheaper steps than the others.
    pub fn of(method: Method) -> Self {
        let (tolerance, max_iterations) = match method {
            Method::Direct => (TOLERANCE, 200),
            Method::Collocation | Method::Shooting => (TOLERANCE_OF_EXTREMALS, 60),
        };
        Self { method, tolerance, max_iterations, ..Self::default() }
    }
}

/// Options one by one, from [`SolverOptions::default`].
///
/// ```
/// use costate_control::{Method, SolverOptions};
/// let options = SolverOptions::default().with_method(Method::Shooting).with_tolerance(1e-8);
/// assert!(options.check().is_ok());
/// ```
impl SolverOptions {
    /// Sets [`tolerance`](Self#structfield.tolerance).
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// Sets [`method`](Self#structfield.method). A tolerance that is the default of the former method becomes
    /// that of this one.
    #[must_use]
    pub fn with_method(self, method: Method) -> Self {
        let is_default = self.tolerance == Self::of(self.method).tolerance;
        let tolerance = if is_default { Self::of(method).tolerance } else { self.tolerance };
        Self { method, tolerance, ..self }
    }

    /// Sets [`nodes`](Self#structfield.nodes).
    #[must_use]
    pub fn with_nodes(self, nodes: usize) -> Self {
        Self { nodes, ..self }
    }

    /// Sets [`max_nodes`](Self#structfield.max_nodes).
    #[must_use]
    pub fn with_max_nodes(self, max_nodes: usize) -> Self {
        Self { max_nodes, ..self }
    }

    /// Sets [`max_iterations`](Self#structfield.max_iterations).
    #[must_use]
    pub fn with_max_iterations(self, max_iterations: usize) -> Self {
        Self { max_iterations, ..self }
    }

    /// Sets [`jacobian`](Self#structfield.jacobian).
    #[must_use]
    pub fn with_jacobian(self, jacobian: JacobianRoute) -> Self {
        Self { jacobian, ..self }
    }

    /// Sets [`coordinates`](Self#structfield.coordinates).
    #[must_use]
    pub fn with_coordinates(self, coordinates: Coordinates) -> Self {
        Self { coordinates, ..self }
    }

    /// Sets [`strategy`](Self#structfield.strategy).
    #[must_use]
    pub fn with_strategy(self, strategy: Strategy) -> Self {
        Self { strategy, ..self }
    }

    /// Sets [`verify`](Self#structfield.verify).
    #[must_use]
    pub fn with_verify(self, verify: Verify) -> Self {
        Self { verify, ..self }
    }

    /// Sets [`polish`](Self#structfield.polish).
    #[must_use]
    pub fn with_polish(self, polish: Polish) -> Self {
        Self { polish, ..self }
    }

    /// Sets [`points`](Self#structfield.points).
    #[must_use]
    pub fn with_points(self, points: usize) -> Self {
        Self { points, ..self }
    }

    /// Sets [`starts`](Self#structfield.starts).
    #[must_use]
    pub fn with_starts(self, starts: usize) -> Self {
        Self { starts: Some(starts), ..self }
    }

    /// Sets [`threads`](Self#structfield.threads).
    #[must_use]
    pub fn with_threads(self, threads: usize) -> Self {
        Self { threads: Some(threads), ..self }
    }

    /// Sets [`machine_code`](Self#structfield.machine_code).
    #[must_use]
    pub fn with_machine_code(self, machine_code: MachineCode) -> Self {
        Self { machine_code, ..self }
    }

    /// Sets [`seed`](Self#structfield.seed).
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Sets [`time_limit`](Self#structfield.time_limit).
    #[must_use]
    pub fn with_time_limit(self, time_limit: Duration) -> Self {
        Self { time_limit: Some(time_limit), ..self }
    }
}

/// Most starts: more take longer than anybody waits.
const MOST_STARTS: usize = 1_000_000;

/// Most nodes of a mesh: far more than any motion needs.
const MOST_NODES: usize = 1_000_000;

/// Most threads: systems refuse many more.
const MOST_THREADS: usize = 1024;

impl SolverOptions {
    /// The number of starts that are solved to the end.
    pub(crate) fn count(&self) -> usize {
        self.starts.unwrap_or(1)
    }

    /// The number of threads for the starts.
    pub(crate) fn threads(&self) -> usize {
        let starts = self.count();
        let all = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        if starts == 1 { 1 } else { self.threads.unwrap_or_else(all).min(starts) }
    }

    /// Whether all options are in range.
    ///
    /// # Errors
    /// [`ProblemError::BadOption`] names the first option that is not, as the key of a problem file.
    pub fn check(&self) -> Result<(), ProblemError> {
        let bad = |key, value, remedy| Err(ProblemError::BadOption { key, value, remedy });
        if !(1e-13..=0.1).contains(&self.tolerance) {
            return bad("tolerance", self.tolerance, "must be between 1e-13 and 0.1");
        }
        if self.nodes < 3 {
            return bad("nodes", self.nodes as f64, "must be 3 or more");
        }
        if self.max_nodes < self.nodes {
            if self.nodes == Self::of(self.method).nodes {
                let remedy = "must be at least solver.nodes, which is 21 by default";
                return bad("max_nodes", self.max_nodes as f64, remedy);
            }
            let remedy = "must not exceed solver.max_nodes, which is 6001 by default";
            return bad("nodes", self.nodes as f64, remedy);
        }
        if self.max_nodes > MOST_NODES {
            return bad("max_nodes", self.max_nodes as f64, "must be at most 1000000");
        }
        if self.max_iterations == 0 {
            return bad("max_iterations", 0.0, "must be 1 or more");
        }
        if !(3..=4).contains(&self.points) {
            return bad("points", self.points as f64, "must be 3 or 4");
        }
        if !(1..=MOST_STARTS).contains(&self.count()) {
            return bad("starts", self.count() as f64, "must be between 1 and 1000000");
        }
        if let Some(threads) = self.threads.filter(|threads| !(1..=MOST_THREADS).contains(threads)) {
            return bad("threads", threads as f64, "must be between 1 and 1024");
        }
        if self.time_limit == Some(Duration::ZERO) {
            return bad("time_limit", 0.0, "must be a positive number of seconds");
        }
        Ok(())
    }
}
